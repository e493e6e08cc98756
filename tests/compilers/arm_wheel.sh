#!/usr/bin/env bash
# The wheel for 64-bit Arm, made from what emulated.sh built: its name says so, its library runs under emulation beside what lies in the
# wheel alone, from C, and from Python where one for Arm can be had.
#
#   arm_wheel.sh BUILD_DIRECTORY [python]        python: a Debian's for Arm is unpacked (mmdebstrap), for the package itself
#
# Exit status 77: the cross compiler, the emulator or setuptools is missing; with `python`, also where there is none for Arm.
set -eu
top=$(cd "$(dirname "$0")/../.." && pwd)
build=$(cd "$1" && pwd) python=${2:-}
target=aarch64-linux-gnu
for tool in $target-gcc qemu-aarch64 cmake; do
    command -v "$tool" >/dev/null || { echo "no $tool"; exit 77; }
done
. "$top/scripts/setup.sh"
makes_wheels=$(python_with setuptools, wheel, pip)
[ -n "$makes_wheels" ] || { echo "no Python with setuptools, wheel and pip"; exit 77; }
work=$build/wheel
rm -rf "$work"
mkdir -p "$work/unpacked"

cmake --build "$build" -j "${JOBS:-2}" --target holonomic_wheel >"$work/log" 2>&1 || { tail -n 5 "$work/log"; exit 1; }
(cd "$top" && HOLONOMIC_WHEEL_LIBRARIES=$build/python/libraries "$makes_wheels" -m pip wheel --quiet --no-build-isolation --no-deps \
    --no-index --wheel-dir "$work" .)
(cd "$work/unpacked" && cmake -E tar xf "$work"/holonomic-*-py3-none-manylinux_2_*_aarch64.whl)
basename "$work"/*.whl

libraries=$work/unpacked/holonomic
$target-gcc "$top/tests/install/programs/rotor.c" -I"$top/capi" "$libraries/libholonomic.so.0" -Wl,-rpath-link,"$libraries" -o "$work/rotor"
qemu-aarch64 -L /usr/$target -E LD_LIBRARY_PATH="$libraries" "$work/rotor" | tee "$work/printed"
grep -q '^tension 1.000 forces 1.000 -1.000$' "$work/printed"

[ -n "$python" ] || exit 0
command -v mmdebstrap >/dev/null || { echo "no mmdebstrap"; exit 77; }
# Nothing of it is run to unpack it, so that no other processor's programs need to be known to the kernel.
root=$build/root
[ -e "$root/usr/bin/python3" ] || mmdebstrap --variant=extract --architectures=arm64 --include=python3,python3-numpy bookworm \
    "$root" >"$work/root.log" 2>&1 || { tail -n 3 "$work/root.log"; rm -rf --one-file-system "$root"; echo "no Python for Arm"; exit 77; }
libraries=/usr/lib/$target
PYTHONDONTWRITEBYTECODE=1 PYTHONHOME=$root/usr PYTHONPATH=$work/unpacked qemu-aarch64 -L "$root" \
    -E LD_LIBRARY_PATH="$libraries/blas:$libraries/lapack" "$(readlink -f "$root/usr/bin/python3")" "$top/tests/python/installed.py" "$work/unpacked"
