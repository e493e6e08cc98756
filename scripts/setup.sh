# Set-up that the scripts share; to be read with `.`, in bash, from the top of the tree.
#
#   say TEXT...             a line that says what happens next
#   fail TEXT...            a line on standard error, and the end of the script
#   need NAME...            installs what is missing of these, or says what to install and ends the script
#   want NAME...            the same for what a script can do without: if it can't be had, it says so and goes on
#   help_asked ARGUMENT...  whether the first is --help or -h; then the head comment of the script has been printed
#   build_jobs              prints how many compilations to run at once
#   few_instruction_sets    for HOLONOMIC_INSTRUCTION_SETS where a build is slow and what it is for needs no others: four
#                           lanes and one, the same whatever processor this is
#   own_instruction_sets    prints those that this processor runs, the one that it takes last; all where that is not known
#   baseline_needed         prints ON where the kernels of every processor are needed beside own_instruction_sets, else OFF
#   test_tools              what scripts/test wants beside what it needs
#
# HOLONOMIC_WITHOUT (environment): names that `want` goes without; for a look at what is done where they can't be had.

say() {
    printf '== %s\n' "$*"
}

fail() {
    printf '%s: %s\n' "${0##*/}" "$*" >&2
    exit 1
}

help_asked() {
    case ${1:-} in --help | -h) sed -n '2,/^[^#]/{s/^# \{0,1\}//p}' "$0" ;; *) return 1 ;; esac
}

# Without one of these ctest says which tests it skipped, and why.
test_tools="clang++ valgrind abidiff mpfr qemu-x86_64 flang git gnuplot eigen benchmark lapack numpy venv setuptools ase mypy"

few_instruction_sets="avx2;scalar"

own_instruction_sets() {
    local flags sets=
    flags=" $(awk '/^flags/ { print; exit }' /proc/cpuinfo 2>/dev/null) "
    case $flags in *' avx2 '*) case $flags in *' fma '*) sets="scalar;avx2" ;; esac ;; esac
    case $flags in *' avx512f '*' avx512vl '*) sets="$sets;avx512vl" ;; esac
    if [ "$flags" = "  " ]; then sets="scalar;avx2;avx512vl"; fi
    echo "${sets#;}"
}

baseline_needed() {
    if [ -n "$(own_instruction_sets)" ] && grep -q '^flags' /proc/cpuinfo 2>/dev/null; then echo OFF; else echo ON; fi
}

build_jobs() {
    local cores memory_gb
    cores=$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 2)
    # The kernels take up to half a gigabyte each to compile.
    memory_gb=$(awk '/^MemTotal/ { print int($2 / 1048576) }' /proc/meminfo 2>/dev/null)
    if [ -n "$memory_gb" ] && [ "$((2 * memory_gb))" -lt "$cores" ]; then
        cores=$((memory_gb > 0 ? 2 * memory_gb : 1))
    fi
    echo "$cores"
}

# Whether NAME is there already. A compiler or a library counts only if it compiles something.
present() {
    case $1 in
        c++) command -v c++ >/dev/null && echo 'int main() {}' | c++ -x c++ - -o /dev/null 2>/dev/null ;;
        cmocka) echo '#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
int main(void) { return 0; }' | cc -x c - -lcmocka -o /dev/null 2>/dev/null ;;
        mpfr) echo '#include <mpfr.h>' | cc -x c -fsyntax-only - 2>/dev/null ;;
        libfuzzer) echo 'extern "C" int LLVMFuzzerTestOneInput(const unsigned char *, unsigned long) { return 0; }' |
            clang++ -x c++ -fsanitize=fuzzer,address,undefined - -o /dev/null 2>/dev/null ;;
        benchmark) echo '#include <benchmark/benchmark.h>
int main() { return static_cast<int>(benchmark::CPUInfo::Get().num_cpus) * 0; }' |
            c++ -x c++ - -lbenchmark -pthread -o /dev/null 2>/dev/null ;;
        lapack) echo 'extern "C" void dptsv_(); int main() { dptsv_(); }' | c++ -x c++ - -llapack -o /dev/null 2>/dev/null ;;
        openmm) echo '#include <OpenMM.h>
int main() { OpenMM::System system; }' | c++ -x c++ - -lOpenMM -o /dev/null 2>/dev/null ;;
        mpi) command -v mpirun >/dev/null && command -v mpicxx >/dev/null ;;
        lammps) command -v lmp >/dev/null && [ -e /usr/include/lammps/lammps.h ] ;;
        gromacs) command -v gmx >/dev/null && command -v gmx_d >/dev/null && [ -e /usr/include/gromacs/version.h ] && command -v python3 >/dev/null ;;
        lammps-examples) [ -e /usr/share/lammps/examples/HEAT/data.spce ] ;;
        openblas | mctc-lib) pkg-config --exists "$1" 2>/dev/null ;;
        gromacs-data) [ -e /usr/share/gromacs/top/spc216.gro ] ;;
        flang) present_any flang flang-new flang-22 flang-21 flang-20 flang-new-19 flang-new-18 ;;
        arm-compiler) command -v aarch64-linux-gnu-g++ >/dev/null ;;
        arm) command -v aarch64-linux-gnu-g++ >/dev/null && command -v qemu-aarch64 >/dev/null ;;
        mingw) present_any x86_64-w64-mingw32-g++-posix x86_64-w64-mingw32-g++ ;;
        wine) present_any wine64 wine || [ -e /usr/lib/wine/wine64 ] ;;
        numpy) [ -n "$(python_with numpy)" ] ;;
        ase) [ -n "$(python_with numpy, ase)" ] ;;
        pytest) [ -n "$(python_with pytest)" ] ;;
        openmm-python) [ -n "$(python_with numpy, openmm)" ] ;;
        opencl-dev) echo '#include <CL/cl.h>
int main(void) { return clGetPlatformIDs(0, 0, 0); }' | cc -x c -DCL_TARGET_OPENCL_VERSION=120 - -lOpenCL -o /dev/null 2>/dev/null ;;
        opencl) ls /etc/OpenCL/vendors/*.icd >/dev/null 2>&1 ;;
        venv) [ -n "$(python_with numpy, venv, ensurepip)" ] ;;
        setuptools) [ -n "$(python_with setuptools, wheel, pip)" ] ;;
        sphinx) [ -n "$(python_with numpy, sphinx, myst_parser, sphinx_rtd_theme)" ] ;;
        eigen) [ -e /usr/include/eigen3/Eigen/Core ] || pkg-config --exists eigen3 2>/dev/null ;;
        *) command -v "$1" >/dev/null ;;
    esac
}

# The first Python that has these modules, the system's among them; with its folder, as cmake wants it.
python_with() { # python_with MODULE[, MODULE...]
    local name
    for name in python3 /usr/bin/python3; do
        "$name" -c "import $*" >/dev/null 2>&1 && command -v "$name" && return
    done
}

present_any() {
    local name
    for name in "$@"; do
        command -v "$name" >/dev/null && return
    done
    return 1
}

# The Debian package that brings NAME.
debian_package() {
    case $1 in
        c++) echo g++ libc6-dev ;;
        make | cmake | gfortran | pkg-config | valgrind | git) echo "$1" ;;
        cmocka) echo libcmocka-dev ;;
        eigen) echo libeigen3-dev ;;
        mpfr) echo libmpfr-dev ;;
        libfuzzer) echo clang libclang-rt-dev ;;
        qemu-x86_64) echo qemu-user ;;
        arm-compiler) echo g++-aarch64-linux-gnu ;;
        arm) echo g++-aarch64-linux-gnu qemu-user ;;
        mingw) echo g++-mingw-w64-x86-64-posix gfortran-mingw-w64-x86-64-posix ;;
        wine) echo wine wine64 ;;
        clang++) echo clang libomp-dev ;;
        flang) newest_package '^flang-[0-9]+$' flang ;;
        gnuplot) echo gnuplot-nox ;;
        benchmark) echo libbenchmark-dev ;;
        lapack) echo liblapack-dev ;;
        openmm) echo libopenmm-dev ;;
        numpy) echo python3-numpy ;;
        ase) echo python3-numpy python3-ase ;;
        pytest) echo python3-pytest ;;
        venv) echo python3-numpy python3-venv ;;
        setuptools) echo python3-setuptools python3-wheel python3-pip ;;
        sphinx) echo python3-numpy python3-sphinx python3-myst-parser python3-sphinx-rtd-theme ;;
        openmm-python) echo python3-numpy "$(newest_package '^python3-(simtk|openmm)$' python3-openmm)" libopenmm-plugins ;;
        opencl) echo pocl-opencl-icd ;; # on the processor
        opencl-dev) echo ocl-icd-opencl-dev ;;
        ninja) echo ninja-build ;;
        openblas | mctc-lib) echo "lib$1-dev" ;;
        abidiff) echo abigail-tools ;;
        dpkg-shlibdeps) echo dpkg-dev ;;
        mpi) echo openmpi-bin libopenmpi-dev ;;
        lammps) echo lammps liblammps-dev ;;
        gromacs) echo gromacs libgromacs-dev python3 ;;
        *) echo "$1" ;;
    esac
}

# The one with the highest number among the packages whose names match; without an index of packages, a guess.
newest_package() { # newest_package REGULAR_EXPRESSION GUESS
    local name
    name=$(apt-cache --names-only search "$1" 2>/dev/null | cut -d ' ' -f 1 | sort -V | tail -n 1)
    echo "${name:-$2}"
}

missing_of() {
    local name
    for name in "$@"; do
        present "$name" || printf '%s ' "$name"
    done
}

# As root, or by sudo. Another apt may be at work, as on a machine that has just been started: it is waited for, up to five
# minutes. apt's own option is for dpkg's locks alone, not for that of the lists.
apt_get() {
    local as_root=() words status until=$((SECONDS + 300))
    [ "$(id -u)" -eq 0 ] || as_root=(sudo)
    while :; do
        words=$("${as_root[@]}" env LC_ALL=C DEBIAN_FRONTEND=noninteractive \
            apt-get -qq -o DPkg::Lock::Timeout=300 "$@" 2>&1 >/dev/null </dev/null)
        status=$?
        case $words in *'Could not get lock'*) [ "$SECONDS" -ge "$until" ] || { sleep 2; continue; } ;; esac
        printf '%s\n' "$words" | grep -v -e '^$' -e 'delaying package configuration' >&2
        return $status
    done
}

# Installs the packages that bring the names given; fails where that is not possible.
install_names() {
    local name packages=()
    command -v apt-get >/dev/null || return 1
    [ "$(id -u)" -eq 0 ] || command -v sudo >/dev/null || return 1
    if [ -z "${apt_lists_fresh:-}" ]; then
        # Where one of several sources can't be reached, the others may have what is needed.
        apt_get update
        apt_lists_fresh=yes
    fi
    for name in "$@"; do
        # shellcheck disable=SC2207
        packages+=($(debian_package "$name"))
    done
    say "installing ${packages[*]} with apt-get"
    apt_get install -y --no-install-recommends "${packages[@]}" || return 1
}

need() {
    local missing name packages
    missing=$(missing_of "$@")
    [ -n "$missing" ] || return 0
    # shellcheck disable=SC2086
    install_names $missing
    # shellcheck disable=SC2086
    missing=$(missing_of $missing)
    [ -n "$missing" ] || return 0
    packages=$(for name in $missing; do debian_package "$name"; done | tr '\n' ' ')
    fail "these are missing and could not be installed from here: $missing
Please install them and run this again. On Debian or Ubuntu:
    apt-get install $packages
Other systems have them under the same or similar names."
}

want() {
    local name
    for name in $(missing_of "$@"); do
        case " ${HOLONOMIC_WITHOUT:-} " in *" $name "*) say "going on without $name, as HOLONOMIC_WITHOUT says"; continue ;; esac
        # One by one: that one is not to be had must not cost the others.
        install_names "$name"
        present "$name" || say "going on without $name"
    done
}
