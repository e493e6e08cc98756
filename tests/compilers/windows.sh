#!/usr/bin/env bash
# Builds for Windows by MinGW-w64 and runs the tests of the C interface and of the Fortran module, the reference cases and the fuzzing
# corpus under Wine, the interface's tests with each set of kernels.
#
#   windows.sh BUILD_DIRECTORY
#
# The last lines say how many passed, and what they took. Exit status 77: no MinGW-w64, or no Wine.
set -u
top=$(cd "$(dirname "$0")/../.." && pwd) || exit 1
build=$1
target=x86_64-w64-mingw32
compiler() { command -v "$target-$1-posix" || command -v "$target-$1"; } # gcc, g++ or gfortran, as the toolchain file takes them
compiler g++ >/dev/null || { echo "no $target-g++"; exit 77; }
wine=$(command -v wine64 || ls /usr/lib/wine/wine64 2>/dev/null || command -v wine) || { echo "no wine"; exit 77; }
mkdir -p "$build" || exit 1
build=$(cd "$build" && pwd)
export WINEDEBUG=-all WINEPREFIX=$build/wine WINEPATH="Z:$build/capi;Z:$build/fortran" DISPLAY=

cmake -S "$top" -B "$build" -DCMAKE_TOOLCHAIN_FILE="$top/cmake/mingw-w64.cmake" -DHOLONOMIC_BUILD_TESTS=ON \
    -DHOLONOMIC_TESTS_WITHOUT_CMOCKA=ON -DHOLONOMIC_TESTS_WITH_VALGRIND=OFF >"$build/log" 2>&1 || { tail -n 20 "$build/log"; exit 1; }
targets=(holonomic check_oracle instruction_set fuzz_replay layout_c layout_cpp capi_tests)
make_all() { # make_all FOLDER [OPTION...]
    cmake --build "$1" -j "${JOBS:-2}" "${@:2}" >"$build/log" 2>&1 ||
        { grep -E 'error|undefined' "$build/log" | head -n 20; tail -n 5 "$build/log"; exit 1; }
}
make_all "$build" --target "${targets[@]}"
[ ! -e "$build/tests/fortran/Makefile" ] || make_all "$build/tests/fortran"

# The DLLs need what Windows has, and export what the header declares.
for dll in "$build"/capi/*.dll "$build"/fortran/*.dll; do
    [ -e "$dll" ] || continue
    needs=$($target-objdump -p "$dll" | sed -n 's/.*DLL Name: //p' | grep -vixE '(kernel32|msvcrt|user32|advapi32|api-ms-win-.*|ucrtbase|libholonomic-0)\.dll')
    [ -z "$needs" ] || { echo "$(basename "$dll") needs $needs"; exit 1; }
done
$target-objdump -p "$build"/capi/libholonomic-*.dll |
    awk '/Ordinal\/Name Pointer/ { inside = 1; next } /^$/ { inside = 0 } inside { print $NF }' | sort >"$build/exports"
sed -n 's/^ *\(hol_[a-z_0-9]*\);.*/\1/p' "$top/capi/holonomic.map" | sort | diff - "$build/exports" || { echo "the DLL exports something else"; exit 1; }

# Wine makes its own Windows at first.
"$wine" wineboot -i >"$build/output" 2>&1
best=$("$wine" "$build/tests/compilers/instruction_set.exe" | tr -d '\r')
echo "kernels here: $best"
passed=0 failed=0 began=$SECONDS
run() { # run NAME PROGRAM ARGUMENT...
    local name=$1
    shift
    if timeout 900 "$wine" "$@" >"$build/output" 2>&1; then
        passed=$((passed + 1))
    else
        echo "$name: status $?"
        tail -n 5 "$build/output"
        failed=$((failed + 1))
    fi
}
for folder in oracle oracle/molecules oracle/rigid; do
    run "$folder" "$build/tests/reference/check_oracle.exe" "$top/tests/$folder"
done
for program in abi/layout_c abi/layout_cpp; do
    run "$program" "$build/tests/$program.exe"
done
run "corpus" "$build/tests/fuzz/fuzz_replay.exe" "$top"/tests/fuzz/corpus/*
for program in "$build"/tests/fortran/fortran_test_*.exe; do
    [ -e "$program" ] || continue
    name=$(basename "$program" .exe)
    arguments=()
    case $name in fortran_test_oracle | fortran_test_metric) arguments=("$top/tests/oracle") ;; esac
    run "$name" "$program" "${arguments[@]}"
done
# What measures time or takes minutes is left out, and test_accuracy, whose bounds are those of the very chains that this system's
# mathematical functions make.
export HOLONOMIC_TESTS_QUICK=1
for set in ${WINDOWS_SETS:-avx512vl avx2 scalar baseline}; do
    export HOLONOMIC_ISA=$set
    [ "$("$wine" "$build/tests/compilers/instruction_set.exe" | tr -d '\r')" = "$set" ] || { echo "$set: not here"; continue; }
    for program in "$build"/tests/capi/test_*.exe; do
        name=$(basename "$program" .exe)
        case $name in test_accuracy | test_trajectories | test_partition) continue ;; esac
        run "$set.$name" "$program"
    done
done
unset HOLONOMIC_ISA

# The archive and the wheel, as users get them: programs in C and Fortran print what they print elsewhere, and the DLL that the
# package for Python asks for by name lies in it and can be loaded.
packed() {
    local here=$build/unpacked prefix fortran
    rm -rf "$here" && mkdir -p "$here/wheel" && (cd "$top" && BUILD_DIR="$build" scripts/windows) || return 1
    (cd "$here" && cmake -E tar xf "$build"/packages/holonomic-*-windows-x86_64.zip) || return 1
    prefix=$(ls -d "$here"/holonomic-*)
    (
        export WINEPATH="Z:$prefix/bin"
        cd "$here" || exit 1
        "$(compiler gcc)" "$top/tests/install/programs/rotor.c" -I"$prefix/include" -L"$prefix/lib" -lholonomic -o rotor_c.exe || exit 1
        ls "$prefix"/bin/*.dll "$prefix"/lib/* || exit 1
        "$wine" rotor_c.exe | tr -d '\r' | tee printed
        grep -q '^tension 1.000 forces 1.000 -1.000$' printed || exit 1
        fortran=$(compiler gfortran) || exit 0
        "$fortran" "$top/tests/install/programs/rotor_free.f90" -I"$(dirname "$(find "$prefix" -name holonomic.mod)")" -L"$prefix/lib" \
            -lholonomic_fortran "$prefix/lib/libholonomic.dll.a" -static -o rotor_f.exe || exit 1
        "$wine" rotor_f.exe | tr -d '\r' | tee printed
        grep -q '^tension 1.000 forces 1.000 -1.000$' printed
    ) || return 1
    ls "$build"/packages/*.whl >/dev/null 2>&1 || return 0
    (cd "$here/wheel" && cmake -E tar xf "$build"/packages/holonomic-*-py3-none-win_amd64.whl) || return 1
    cat >"$here/load.c" <<'END'
#include <stdio.h>
#include <windows.h>
int main(int n, char **name)
{
    HMODULE library = LoadLibraryA(name[n - 1]);
    const char *(*version)(void) = library ? (const char *(*)(void))(void *)GetProcAddress(library, "hol_version") : NULL;
    return version ? printf("wheel: holonomic %s\n", version()) < 0 : 1;
}
END
    "$(compiler gcc)" "$here/load.c" -o "$here/load.exe" || return 1
    (
        unset WINEPATH
        name=$(sed -n 's/^_NAME = "\(.*\)" if os.name == "nt".*/\1/p' "$here/wheel/holonomic/_library.py")
        cd "$here" && [ -n "$name" ] && "$wine" load.exe "wheel\\holonomic\\$name"
    )
}
if packed >"$build/packed.log" 2>&1; then
    passed=$((passed + 1))
else
    echo "packages: status $?"
    tail -n 5 "$build/packed.log"
    failed=$((failed + 1))
fi
echo "$passed passed, $failed failed, in $((SECONDS - began)) s"
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
