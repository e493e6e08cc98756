#!/usr/bin/env bash
# The hosts' own tests (hosts/*/run --test) on a machine with nothing on it: each installs what it needs there.
#
#   hosts.sh SUITE WORK [HOST...]
#       SUITE    bookworm, trixie      WORK      folder for the machine and its logs      HOST     mpi lammps openmm ase gromacs xtb by default
# A line for each host stands at the end. FRESH_CCACHE is a folder for ccache, which is on the machine then; CMAKE_ARGS
# goes to the library's cmake.
# Exit status 77: no mmdebstrap, no root, or the distribution can't be had.
set -u
suite=$1 work=$2
shift 2
[ $# -gt 0 ] || set -- mpi lammps openmm ase gromacs xtb
top=$(cd "$(dirname "$0")/../.." && pwd) || exit 1
. "$top/tests/machines/bare_machine.sh"
make_machine "$suite" "$work/hosts-$suite"
git -C "$top" diff --quiet HEAD || echo "what is not committed is not tried"
git clone --quiet --no-hardlinks "$top" "$root/srv/holonomic" || exit 1
ccache=()
if [ -n "${FRESH_CCACHE:-}" ]; then
    inside sh -c 'apt-get update -qq && apt-get install -y -qq --no-install-recommends ccache' </dev/null >>"$root.log" 2>&1 || exit 1
    ccache=(CCACHE_DIR=/srv/shared CCACHE_BASEDIR=/srv CCACHE_NOHASHDIR=1 CMAKE_C_COMPILER_LAUNCHER=ccache
        CMAKE_CXX_COMPILER_LAUNCHER=ccache)
    shared=$FRESH_CCACHE
fi

# xtb is of Fortran, and comes as the distribution's source package.
fortran=OFF compilers=c++
case " $* " in
    *" xtb "*)
        fortran=ON compilers="c++ gfortran"
        sed -n 's/^deb /deb-src /p' "$root"/etc/apt/sources.list "$root"/etc/apt/sources.list.d/*.list 2>/dev/null |
            sort -u >"$root/etc/apt/sources.list.d/sources.list"
        inside sh -c 'apt-get update -qq && apt-get install -y -qq --no-install-recommends dpkg-dev' </dev/null >>"$root.log" 2>&1 || exit 1
        ;;
esac

# The library, once for all of them.
if ! inside "${ccache[@]}" CMAKE_ARGS="${CMAKE_ARGS:-}" bash -c 'cd /srv/holonomic && . scripts/setup.sh && need '"$compilers"' make cmake &&
    cmake -S . -B build/library -DHOLONOMIC_BUILD_TESTS=OFF -DHOLONOMIC_BUILD_FORTRAN='$fortran' "-DHOLONOMIC_INSTRUCTION_SETS=$few_instruction_sets" ${CMAKE_ARGS:-} &&
    cmake --build build/library -j "$(build_jobs)" && cmake --install build/library --prefix /srv/installed' </dev/null >>"$root.log" 2>&1; then
    tail -n 20 "$root.log"
    exit 1
fi

status=0 lines=()
for host in "$@"; do
    began=$SECONDS log=$root.$host.log
    inside "${ccache[@]}" HOLONOMIC_PREFIX=/srv/installed "/srv/holonomic/hosts/$host/run" --test </dev/null >"$log" 2>&1
    case $? in
        0) result=passed ;;
        77) result="left out" ;;
        *) result=FAILED status=1 && grep -E '\*\*\*Failed|FAILED|rror' "$log" | tail -n 20 ;;
    esac
    counts=$(grep -E 'tests passed|^[0-9=]+.*passed' "$log" | tail -n 1)
    lines+=("$suite: $host $result in $((SECONDS - began)) s${counts:+ ($counts)}")
    echo "${lines[-1]}"
done
printf '%s\n' "${lines[@]}"
exit $status
