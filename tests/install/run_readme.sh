#!/bin/sh
# Runs the commands of docs/start.md as they stand, in a home directory that neither pkg-config nor the loader knows: what it builds
# must run and print what README says.
#
#   run_readme.sh PAGE BUILD LIBDIR WORK LANGUAGE...        LANGUAGE: c, fortran
#       BUILD   a build of the library: its commands to configure and build are taken as done there
#       LIBDIR  folder of libraries in a prefix; the page says lib
# CC, FC, CMAKE and PKG_CONFIG name the programs to use.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
readme=$1 build=$2 libdir=$3 work=$4
shift 4
unset CPATH C_INCLUDE_PATH LIBRARY_PATH LD_LIBRARY_PATH LD_RUN_PATH LD_PRELOAD PKG_CONFIG_PATH PKG_CONFIG_LIBDIR || :
rm -rf "$work"
mkdir -p "$work/bin" "$work/home"
cd "$work"
HOME=$work/home PATH=$work/bin:$PATH
export HOME PATH

stand_in() { # stand_in NAME PROGRAM: what README calls NAME
    printf '#!/bin/sh\nexec %s "$@"\n' "$2" >"bin/$1"
    chmod +x "bin/$1"
}
stand_in cc "$CC"
stand_in gfortran "$FC"
stand_in pkg-config "$PKG_CONFIG"
cat >bin/cmake <<END
#!/bin/sh
case "\$1 \$2" in
    "-S ." | "--build build") ;;
    "--install build") shift 2 && exec "$CMAKE" --install "$build" "\$@" ;;
    *) echo "README asks cmake for something else: \$*" && exit 1 ;;
esac
END
chmod +x bin/cmake

# What is indented in README's section on installing, outside of programs.
awk '/^```/ { program = !program } /^## / && !program { inside = $0 == "## Install" }
    inside && !program && /^    / { print substr($0, 5) }' "$readme" | sed "s|\.local/lib/|.local/$libdir/|" >install.sh
grep -q "^cmake " install.sh && grep -q "PKG_CONFIG_PATH" install.sh || { echo "README does not say how to install"; exit 1; }
set +e
. ./install.sh >installed.log 2>&1 || { cat installed.log; exit 1; }
set -e

"$here/readme_programs.sh" "$readme" "$@"
