#!/bin/sh
# Compiles the module, the tests of it and the examples with another Fortran compiler, and runs them against the C library.
#
#   second_compiler.sh COMPILER TOP COMPILE_ORDER LIBRARY_DIR WORK      CC is the C compiler
#
# FLAGS: the module and the examples alone, with these, as a program that is compiled so must do it.
# Status 77 (skipped) if there is no such compiler, or if it says itself that it can't do it yet.
set -eu
compiler=$1 top=$2 order=$3 library=$4 work=$5
[ -x "$compiler" ] || { echo "no LLVM Fortran compiler here (package flang-19, or flang of another number)"; exit 77; }
tests=$top/tests/fortran examples=$top/examples/fortran oracle=$top/tests/oracle
rm -rf "$work"
mkdir -p "$work"
cd "$work"
"$compiler" --version | head -n 1

compile() {
    # shellcheck disable=SC2086
    if ! "$compiler" ${FLAGS-} "$@" >log 2>&1; then
        cat log
        if grep -q "not yet implemented" log; then exit 77; fi
        exit 1
    fi
}

# In a program's step nothing is copied: what a compiler says of temporary arrays concerns other procedures.
before_the_steps='/((chains_)?(bonds|groups|images|settings|outcomes)\.inc|box\.inc|holonomic_(chains|status)\.[Ff]90):'
while read -r file; do
    compile -O2 -c "$top/fortran/$file"
    if grep -B4 -e "-Warray-temporaries" log | grep '^/.*:$' | grep -Ev "$before_the_steps"; then
        echo "that makes a temporary array"
        exit 1
    fi
done <"$order"
module=$(ls ./*.o)
link() { # link PROGRAM SOURCE... OBJECT...
    program=$1
    shift
    compile "$@" -o "$program" "-L$library" -lholonomic "-Wl,-rpath,$library"
}

if [ -z "${FLAGS-}" ]; then
    "${CC:-cc}" -c "-I$top/capi" "$tests/c_side.c" -o c_side.obj
    compile -c "$tests/checks.f90"
    compile -c "$tests/dense_bonds.f90"
    compile -c "$tests/oracle_case.f90"

    for test in test_oracle.f90 test_layouts.f90 test_arguments.f90 test_levels.f90 test_molecules.f90 test_graphs.f90 \
        test_metric.f90 test_integrators.f90 test_lifecycle.f90 test_copies.f90 test_fixed.f test_old_arrays.f; do
        extra=
        [ $test != test_lifecycle.f90 ] || extra=c_side.obj
        # shellcheck disable=SC2086
        link program "$tests/$test" ./*.o $extra
        echo "$test"
        ./program "$oracle"
    done

    # Without `stat` an error ends the program with its message.
    # shellcheck disable=SC2086
    link stops "$tests/stops.f90" $module
    if ./stops >output 2>errors; then echo "stops.f90 went on after an error"; exit 1; fi
    grep 'holonomic: add: atom 3, .*outside 1 .. 2' errors
fi

example() { # example NAME SOURCE...
    name=$1
    shift
    # shellcheck disable=SC2086
    link "$name" "$@" $module
}
md=$examples/alkane_md
example alkane_md "$md/alkane_units.f90" "$md/alkane_force_field.f90" "$md/alkane_options.f90" "$md/alkane_xyz.f90" \
    "$md/alkane_shake.f90" "$md/alkane_integrators.f90" "$md/alkane_samples.f90" "$md/alkane_md.f90"
example make_alkane "$md/make_alkane.f90"
melt=$examples/melt_md
example melt_md "$melt/melt_pairs.f90" "$melt/melt_start.f90" "$melt/melt_md.f90"
example legacy_fixed "$examples/legacy_fixed.f"
water=$examples/water_md tip4p=$examples/tip4p_md
example water_md "$water/water_spce.f90" "$water/water_start.f90" "$water/water_plot.f90" "$water/water_md.f90"
example tip4p_md "$tip4p/tip4p_2005.f90" "$tip4p/tip4p_plot.f90" "$tip4p/tip4p_md.f90"
example ring_fixman "$examples/ring_fixman.f90"

here=$(pwd)
check() { # check PROGRAM [ARGUMENT ...] -- EXPECTATION: what the other compiler's programs are checked for, more briefly
    program=$1
    shift
    echo "$program"
    "$top/tests/examples/check_output.sh" "$here/run" "$here/$program" "$@"
}
./make_alkane 16 | cmp - "$md/n-hexadecane.xyz"
check alkane_md "file=$md/n-hexadecane.xyz" steps=2000 -- "degrees of freedom" 1 = 30 "largest bond error" 1 "<" 2e-14 \
    "energy fluctuation" 1 "<" 0.1
check alkane_md "file=$md/n-hexadecane.xyz" integrator=rk4 steps=500 dt=1 -- "observed order" 1 ">" 3.8 \
    "observed order" 2 ">" 3.8
check melt_md chains=16 melt=1000 steps=500 -- "degrees of freedom" 1 = 1037 "largest bond error" 1 "<" 1e-13 \
    "largest |d.v|" 1 "<" 1e-14
check legacy_fixed -- "LARGEST BOND ERROR" 1 "<" 5e-14
check water_md molecules=64 melt=20 steps=50 -- "largest bond error" 1 "<" 1e-13
check tip4p_md molecules=64 melt=20 steps=50 -- "largest shape error" 1 "<" 1e-13
check ring_fixman molecules=200 moves=150 -- "200 rings of" 1 = 6
