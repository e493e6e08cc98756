#!/usr/bin/env bash
# Builds for 64-bit Arm with the distribution's cross compiler and runs the tests of the C interface, the reference cases,
# the fuzzing corpus and a few hostile chains under emulation.
#
#   aarch64.sh BUILD_DIRECTORY
#
# Exit status 77: the cross compiler or the emulator is missing (packages g++-aarch64-linux-gnu, qemu-user).
set -u
top=$(cd "$(dirname "$0")/../.." && pwd) || exit 1
build=$1
root=/usr/aarch64-linux-gnu
for tool in aarch64-linux-gnu-g++ qemu-aarch64 cmake; do
    command -v $tool >/dev/null || { echo "no $tool"; exit 77; }
done
[ -d $root ] || { echo "no $root"; exit 77; }
cmake -S "$top" -B "$build" -DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR=aarch64 \
    -DCMAKE_C_COMPILER=aarch64-linux-gnu-gcc -DCMAKE_CXX_COMPILER=aarch64-linux-gnu-g++ \
    -DCMAKE_CROSSCOMPILING_EMULATOR="qemu-aarch64;-L;$root" -DCMAKE_FIND_ROOT_PATH=$root \
    -DCMAKE_FIND_ROOT_PATH_MODE_LIBRARY=ONLY -DCMAKE_FIND_ROOT_PATH_MODE_INCLUDE=ONLY \
    -DHOLONOMIC_BUILD_FORTRAN=OFF -DHOLONOMIC_BUILD_TESTS=ON -DHOLONOMIC_TESTS_WITHOUT_CMOCKA=ON || exit 1
cmake --build "$build" -j "${JOBS:-2}" --target holonomic check_oracle stress fuzz_replay capi_tests || exit 1
run() { qemu-aarch64 -L $root "$@"; }
run "$build/tests/reference/check_oracle" "$top/tests/oracle" || exit 1
run "$build/tests/fuzz/fuzz_replay" "$top"/tests/fuzz/corpus/* 2>/dev/null || exit 1
run "$build/tests/stress/stress" 30 || exit 1
# not those that measure time, or would take minutes under emulation
for test in "$build"/tests/capi/test_*; do
    case ${test##*/} in *.*|test_scale|test_trajectories|test_allocations) continue ;; esac
    [ -x "$test" ] || continue
    echo "== ${test##*/}"
    run "$test" >"$build/output" 2>&1 || { tail -n 5 "$build/output"; exit 1; }
    tail -n 1 "$build/output"
done
