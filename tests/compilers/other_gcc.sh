#!/usr/bin/env bash
# Builds library, Fortran module and tests with the gcc of another release of Debian, in a machine made for it, and runs the
# tests of the C interface, of Fortran, the reference cases and some hostile chains.
#
#   other_gcc.sh SUITE VERSION WORK        bullseye 9, trixie 14, ...; WORK: folder for the machine, which is removed at the end
# JOBS: how many compilers at once. Needs root. Exit status 77: no mmdebstrap, no root, or the release can't be had.
set -eu
suite=$1 version=$2 work=$3
source=$(cd "$(dirname "$0")/../.." && pwd)

. "$source/tests/machines/bare_machine.sh"
make_machine "$suite" "$work/$suite-gcc$version"
inside sh -c "apt-get update -qq && apt-get install -y -qq --no-install-recommends g++-$version gfortran-$version cmake make libcmocka-dev" \
    >"$root.log" 2>&1 || { tail -n 3 "$root.log"; leave_out "$suite with gcc $version can't be had"; }
mkdir -p "$root/srv/source"
git -C "$source" ls-files -z | (cd "$source" && xargs -0 cp --parents -t "$root/srv/source")

inside "gcc-$version" --version | head -n 1
{
    inside cmake -S /srv/source -B /srv/build -DCMAKE_BUILD_TYPE=Release -DCMAKE_C_COMPILER="gcc-$version" \
        -DCMAKE_CXX_COMPILER="g++-$version" -DCMAKE_Fortran_COMPILER="gfortran-$version" -DHOLONOMIC_BUILD_TESTS=ON \
        '-DHOLONOMIC_INSTRUCTION_SETS=avx2;scalar' &&
        inside cmake --build /srv/build -j "${JOBS:-2}"
} >"$root.log" 2>&1 || { grep -E 'error|warning|undefined' "$root.log" | head -n 20; tail -n 3 "$root.log"; exit 1; }
echo "warnings: $(grep -c 'warning:' "$root.log" || :)"
inside HOLONOMIC_TESTS_QUICK=1 sh -c 'cd /srv/build && ctest -j2 --output-on-failure -R "^(capi|fortran|oracle|core|stress.hostile|abi.layout)" -E "scale|trajectories|allocations|another_compiler"' \
    >"$root.log" 2>&1 || { tail -n 40 "$root.log"; exit 1; }
grep '% tests passed' "$root.log"
