#!/bin/sh
# On the least x86-64 processor there is (emulated), the library picks its baseline kernels, also if told otherwise, and
# its results are right. The control shows that the emulated processor does refuse AVX.
#
#   without_avx.sh QEMU INSTRUCTION_SET USES_AVX CHECK_ORACLE ORACLE_DIRECTORY
set -u
qemu=$1 instruction_set=$2 uses_avx=$3 check_oracle=$4 oracle=$5
least=qemu64,-sse3
"$qemu" -cpu $least "$uses_avx" >/dev/null 2>&1
[ $? -gt 128 ] || { echo "the emulated processor runs AVX: this test shows nothing"; exit 1; }
for wish in '' avx2 avx512 baseline; do
    picked=$(HOLONOMIC_ISA=$wish "$qemu" -cpu $least "$instruction_set")
    [ "$picked" = baseline ] || { echo "HOLONOMIC_ISA='$wish': the library picked '$picked'"; exit 1; }
done
exec "$qemu" -cpu $least "$check_oracle" "$oracle"
