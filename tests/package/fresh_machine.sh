#!/usr/bin/env bash
# Installs the packages that scripts/package made on a machine with nothing on it, and does there what README tells a
# newcomer to do: its programs in C, Fortran and Python by its own lines, and a CMake project.
#
#   fresh_machine.sh PACKAGES SUITE WORK [MIRROR]
#       PACKAGES  folder of the .deb files        SUITE   bookworm, noble, ...
#       WORK      folder for the machine, a chroot; is removed at the end
#       MIRROR    if not given, from where this machine gets its own packages
# Needs root. Exit status 77: no mmdebstrap, no root, or the distribution can't be had.
set -eu
packages=$(cd "$1" && pwd) suite=$2 work=$3
source=$(cd "$(dirname "$0")/../.." && pwd)

. "$source/tests/machines/bare_machine.sh"
make_machine "$suite" "$work/$suite" "${@:4}"
mkdir -p "$root/srv/packages"
cp "$packages"/*.deb "$root/srv/packages"
for host in lammps openmm gromacs; do
    mkdir "$root/srv/$host"
    mv "$root/srv/packages/holonomic-$host"_*.deb "$root/srv/$host" 2>/dev/null || :
done
# The programs of README, by the lines of README, print what README says: in Python as soon as its packages are there.
mkdir -p "$root/srv/try/tests/install"
cp "$source/README.md" "$source/docs/start.md" "$root/srv/try"
cp "$source/tests/install/readme_programs.sh" "$root/srv/try"
inside mkdir /srv/try/readme
began=$SECONDS
inside apt-get update -qq
inside sh -c 'apt-get install -y -qq --no-install-recommends /srv/packages/libholonomic0_*.deb /srv/packages/python3-holonomic_*.deb' \
    >"$work/$suite.python.log" 2>&1 || { tail -n 20 "$work/$suite.python.log"; exit 1; }
inside sh -c "cd /srv/try/readme && ../readme_programs.sh ../README.md python"
echo "the first result in Python after $((SECONDS - began)) s"
[ $((SECONDS - began)) -le 300 ] || { echo "that is more than five minutes"; exit 1; }
echo "installing the packages, compilers and cmake"
inside sh -c 'apt-get install -y -qq --no-install-recommends gcc g++ gfortran libc6-dev make cmake pkgconf /srv/packages/*.deb' \
    >"$work/$suite.apt.log" 2>&1 || { tail -n 20 "$work/$suite.apt.log"; exit 1; }

cp -r "$source/tests/install/programs" "$source/tests/install/projects" "$root/srv/try/tests/install"
inside sh -c "cd /srv/try/readme && ../readme_programs.sh ../start.md c fortran"
echo "and in C and Fortran after $((SECONDS - began)) s"

for language in c fortran; do
    program=$([ $language = c ] && echo rotor.c || echo rotor_free.f90)
    target=$([ $language = c ] && echo holonomic || echo fortran)
    folder=/srv/try/tests/install/projects/$language
    cp "$root/srv/try/tests/install/programs/$program" "$root$folder"
    inside cmake -S $folder -B /srv/try/$language -DPROGRAM=$program -DHOLONOMIC_TARGET=holonomic::$target >/dev/null
    inside cmake --build /srv/try/$language >/dev/null
    echo "CMake, $language:"
    inside /srv/try/$language/program
done
# The fix for LAMMPS and the plugin for OpenMM are linked with those of the distribution that they were made on.
same_suite=$([ "$suite" = "$(. /etc/os-release && echo "${VERSION_CODENAME:-}")" ] && echo yes || :)
if [ -n "$same_suite" ] && [ -n "$(ls "$root/srv/openmm")" ]; then
    echo "plugin for OpenMM:"
    inside sh -c 'apt-get install -y -qq --no-install-recommends python3-simtk /srv/openmm/*.deb' >"$work/$suite.openmm.log" 2>&1 ||
        { tail -n 20 "$work/$suite.openmm.log"; exit 1; }
    cp "$source/tests/package/trimer_openmm.py" "$root/srv/try"
    inside python3 -W ignore /srv/try/trimer_openmm.py
fi
if [ -n "$same_suite" ] && [ -n "$(ls "$root/srv/lammps")" ]; then
    echo "fix holonomic:"
    inside sh -c 'apt-get install -y -qq --no-install-recommends openmpi-bin /srv/lammps/*.deb' >"$work/$suite.lammps.log" 2>&1 ||
        { tail -n 20 "$work/$suite.lammps.log"; exit 1; }
    cp "$source/tests/package/trimer.lmp" "$root/srv/try"
    inside OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 lmp-holonomic -log none -in /srv/try/trimer.lmp |
        awk '/^ *(0|100) +[-0-9.]+ +[-0-9.e]+ *$/ { print; e[++n] = $2; error = $3 }
             END { exit !(n == 2 && (e[1] - e[2])^2 < 1e-8 && error < 1e-13) }' || { echo "the run went wrong"; exit 1; }
fi
if [ -n "$same_suite" ] && [ -n "$(ls "$root/srv/gromacs")" ]; then
    echo "GROMACS:"
    inside sh -c 'apt-get install -y -qq --no-install-recommends gromacs /srv/gromacs/*.deb' >"$work/$suite.gromacs.log" 2>&1 ||
        { tail -n 20 "$work/$suite.gromacs.log"; exit 1; }
    mkdir "$root/srv/try/gromacs"
    cp -r "$source/hosts/gromacs/tests" "$source/hosts/gromacs/examples" "$root/srv/try/gromacs"
    inside HOLONOMIC_GMX=gmx-holonomic sh -c 'cd /srv/try/gromacs/tests && python3 -m unittest test_gromacs.Accuracy'
fi
inside apt-get purge -y -qq libholonomic0 >/dev/null
[ -z "$(find "$root/usr/lib" "$root/usr/include" -name '*holonomic*')" ] || { echo "files are left after the packages are removed"; exit 1; }
echo "$suite: passed"
