#!/bin/sh
# Compiles the module and some of the tests with another Fortran compiler, and runs them against the C library.
#
#   second_compiler.sh COMPILER MODULE_SOURCES COMPILE_ORDER LIBRARY_DIR WORK ORACLE_DIR
# Status 77 (skipped) if the compiler says itself that it can't do it yet.
set -eu
compiler=$1 sources=$2 order=$3 library=$4 work=$5 oracle=$6
here=$(cd "$(dirname "$0")" && pwd)
rm -rf "$work"
mkdir -p "$work"
cd "$work"

compile() {
    if ! "$compiler" "$@" >log 2>&1; then
        cat log
        if grep -q "not yet implemented" log; then exit 77; fi
        exit 1
    fi
}

while read -r file; do
    compile -O2 -c "$sources/$file"
done <"$order"
compile -c "$here/checks.f90"
compile -c "$here/oracle_case.f90"
for test in test_oracle.f90 test_layouts.f90 test_arguments.f90 test_levels.f90 test_metric.f90 test_fixed.f; do
    compile -O1 "$here/$test" ./*.o -o program "-L$library" -lholonomic "-Wl,-rpath,$library"
    echo "$test"
    ./program "$oracle"
done
