#!/bin/sh
# Whether clang compiles the kernels of a plan for a GPU, in each precision.
#
#   clang.sh CLANG LANGUAGE DEVICE_TEXT FOLDER      LANGUAGE: cuda, hip or opencl
set -eu
clang=$1 language=$2 text=$3 folder=$4
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$folder"
cd "$folder"

compile() { # compile SOURCE
    case $language in
        cuda) "$clang" -x cuda -nocudainc -nocudalib --cuda-gpu-arch=sm_70 --cuda-device-only -Wno-unknown-cuda-version \
            -include "$here/gpu_words.hpp" -emit-llvm -S "$1" -o kernels.s ;;
        hip) "$clang" -x hip -nogpuinc -nogpulib --offload-arch=gfx90a --cuda-device-only \
            -include "$here/gpu_words.hpp" -emit-llvm -S "$1" -o kernels.s ;;
        opencl) "$clang" -x cl -cl-std=CL1.2 -Xclang -finclude-default-header -target amdgcn-amd-amdhsa -mcpu=gfx90a -nogpulib \
            -emit-llvm -S "$1" -o kernels.s ;;
    esac
}

# A clang without this language or this GPU is none of ours.
case $language in
    opencl) echo '__kernel void k(__global double *x) { *x = 1; }' >small ;;
    *) echo '__global__ void k(double *x) { *x = 1; }' >small ;;
esac
compile small 2>log || { echo "skipped: this clang++ does not compile $language"; exit 77; }

for precision in 0 1 2; do
    "$text" "$precision" >kernels
    compile kernels
    for name in hol_positions_0 hol_velocities_3; do
        grep -q "$name" kernels.s || { echo "no $name for precision $precision"; exit 1; }
    done
done
