#!/usr/bin/env bash
# Builds for another processor with the distribution's cross compiler and runs the tests of the C interface, the reference
# cases, the fuzzing corpus and some hostile chains under emulation. On aarch64 it sees, too, that the kernels are those for its
# vectors, and that chains that come alone get the same bits from theirs.
#
#   emulated.sh PROCESSOR BUILD_DIRECTORY [cases]
#       PROCESSOR  aarch64, s390x (big-endian) or i686 (32 bits)        cases: the library and the reference cases alone
#
# Exit status 77: the cross compiler or the emulator is missing (packages g++-aarch64-linux-gnu and the like, qemu-user).
set -u
top=$(cd "$(dirname "$0")/../.." && pwd) || exit 1
processor=$1 build=$2 cases=${3:-}
target=$processor-linux-gnu
root=/usr/$target
qemu=qemu-${processor/i686/i386}
for tool in $target-g++ $qemu cmake; do
    command -v "$tool" >/dev/null || { echo "no $tool"; exit 77; }
done
[ -d "$root" ] || { echo "no $root"; exit 77; }
mkdir -p "$build" || exit 1
flags=
[ "$processor" = i686 ] && flags='-msse2 -mfpmath=sse' # the tests compare with sums in double precision, not in the x87's
cmake -S "$top" -B "$build" -DCMAKE_BUILD_TYPE=Release -DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR="$processor" \
    -DCMAKE_C_COMPILER="$target-gcc" -DCMAKE_CXX_COMPILER="$target-g++" -DCMAKE_C_FLAGS="$flags" \
    -DCMAKE_CROSSCOMPILING_EMULATOR="$qemu;-L;$root" -DCMAKE_FIND_ROOT_PATH="$root" \
    -DCMAKE_FIND_ROOT_PATH_MODE_LIBRARY=ONLY -DCMAKE_FIND_ROOT_PATH_MODE_INCLUDE=ONLY \
    -DHOLONOMIC_BUILD_FORTRAN=OFF -DHOLONOMIC_BUILD_TESTS=ON -DHOLONOMIC_TESTS_WITHOUT_CMOCKA=ON >"$build/log" 2>&1 ||
    { tail -n 20 "$build/log"; exit 1; }
targets=(check_oracle instruction_set)
[ "$cases" ] || targets+=(stress fuzz_replay layout_c layout_cpp test_boundary test_exceptions capi_tests digest)
cmake --build "$build" -j "${JOBS:-2}" --target holonomic "${targets[@]}" >"$build/log" 2>&1 ||
    { grep -E 'error|undefined' "$build/log" | head -n 20; tail -n 5 "$build/log"; exit 1; }
run() { "$qemu" -L "$root" "$@"; }
# Most x86-64 kernels run 32-bit programs themselves, and qemu's i386 (7.2) hangs where one starts a thread.
loader=$root/lib/ld-linux.so.2
if [ "$processor" = i686 ] && "$loader" --version >/dev/null 2>&1; then
    run() { "$loader" --library-path "$root/lib:$build/capi" "$@"; }
fi
set=$(run "$build/tests/compilers/instruction_set") || exit 1
echo "kernels: $set"
if [ "$processor" = aarch64 ]; then
    [ "$set" = neon ] || { echo "these are not the ones for its vectors"; exit 1; }
    # Two doubles at once: what the compiler makes of the vectors, too.
    fused=$("$target-objdump" -d --no-show-raw-insn "$build/capi/libholonomic.so" | awk '
        /^[0-9a-f]+ </ { neon = /holonomic4neon/ }
        neon && $2 == "fmla" && /v[0-9]+\.2d/ { ++n }
        END { print n + 0 }')
    echo "fmla of two doubles: $fused"
    [ "$fused" -gt 5000 ] || { echo "the kernels are not in lanes"; exit 1; }
fi
for folder in oracle oracle/molecules oracle/rigid; do
    run "$build/tests/reference/check_oracle" "$top/tests/$folder" >"$build/output" || { tail "$build/output"; exit 1; }
    echo "$folder: $(tail -n 1 "$build/output")"
done
[ -z "$cases" ] || exit 0
if [ "$processor" = aarch64 ]; then
    for set in neon scalar; do
        HOLONOMIC_ISA=$set run "$build/tests/lanes/digest" 64 1 >"$build/digest.$set" || { echo "digest, $set"; exit 1; }
    done
    cmp "$build/digest.neon" "$build/digest.scalar" || exit 1
    echo "neon and scalar: the same bits in $(wc -l <"$build/digest.neon") scenes"
fi
for program in abi/layout_c abi/layout_cpp faults/test_boundary faults/test_exceptions; do
    run "$build/tests/$program" >"$build/output" 2>&1 || { echo "$program"; tail -n 5 "$build/output"; exit 1; }
    tail -n 1 "$build/output"
done
run "$build/tests/fuzz/fuzz_replay" "$top"/tests/fuzz/corpus/* 2>/dev/null || exit 1
# As the test stress.hostile_chains; where long double has 64 bits and there is no wider type, it shows nothing.
if [ "$processor" != i686 ]; then
    run "$build/tests/stress/stress" 20 "" 3000 2 250 2 >"$build/output" 2>&1
    case $? in 0 | 77) ;; *) cat "$build/output"; exit 1 ;; esac # 77: without MPFR not all are decided
    tail -n 2 "$build/output"
fi
# Not those that measure time, or would take minutes under emulation, nor test_accuracy: its bounds are those of the very
# chains that the mathematical functions of this processor's library make. Leaks can't be looked for under emulation.
for test in "$build"/tests/capi/test_*; do
    case ${test##*/} in *.* | test_accuracy | test_scale | test_trajectories | test_allocations | test_partition) continue ;; esac
    [ -x "$test" ] || continue
    ASAN_OPTIONS=detect_leaks=0 HOLONOMIC_TESTS_QUICK=1 run "$test" >"$build/output" 2>&1 ||
        { echo "${test##*/}:"; tail -n 5 "$build/output"; exit 1; }
    echo "${test##*/}: $(tail -n 1 "$build/output")"
done
