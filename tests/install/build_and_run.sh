#!/bin/sh
# Builds one of programs/ outside of all trees against an installed prefix, as a user would, and checks what it prints.
#
#   build_and_run.sh PREFIX WORK FINDER PROGRAM LINK VERSION
#       PREFIX   where the library was installed
#       WORK     folder to make, build and run in
#       FINDER   pkg-config | cmake | sources (the module is compiled from the installed Fortran sources)
#       PROGRAM  rotor.c | rotor.cpp | rotor_free.f90 | rotor_fixed.f
#       LINK     shared | static (no shared library at all) | archive (libholonomic.a, the system's libraries shared)
#       VERSION  the version that is expected
# CC, CXX, FC, CMAKE and PKG_CONFIG name the programs to use.
set -eu
prefix=$1 work=$2 finder=$3 program=$4 link=$5 version=$6
here=$(cd "$(dirname "$0")" && pwd)

show() {
    echo "$*"
    "$@"
}

rm -rf "$work"
mkdir -p "$work"
cp "$here/programs/$program" "$work"
cd "$work"

# Nothing but the prefix and the system may be seen.
unset CPATH C_INCLUDE_PATH CPLUS_INCLUDE_PATH LIBRARY_PATH LD_LIBRARY_PATH LD_PRELOAD PKG_CONFIG_PATH || :
pc_file=$(find "$prefix" -name holonomic.pc)
libdir=$(dirname "$(dirname "$pc_file")")
PKG_CONFIG_LIBDIR=$libdir/pkgconfig
export PKG_CONFIG_LIBDIR

case $program in
    *.c) compiler=$CC package=holonomic language=c ;;
    *.cpp) compiler=$CXX package=holonomic language=cpp ;;
    *) compiler=$FC package=holonomic-fortran language=fortran ;;
esac

case $finder in
    pkg-config)
        if [ "$link" = static ]; then
            flags="$("$PKG_CONFIG" --static --cflags --libs $package) -static"
        else
            flags=$("$PKG_CONFIG" --cflags --libs $package)
        fi
        # shellcheck disable=SC2086
        show $compiler "$program" -o program $flags
        ;;
    sources)
        folder=$("$PKG_CONFIG" --variable=fsrcdir holonomic)
        # shellcheck disable=SC2046
        show $FC $(sed "s|^|$folder/|" "$folder/compile-order.txt") "$program" -o program \
            $("$PKG_CONFIG" --libs holonomic)
        ;;
    cmake)
        target=holonomic
        [ $language != fortran ] || target=fortran
        # In a prefix without a shared library the plain name is the static one.
        [ "$link" != archive ] || [ ! -e "$libdir/libholonomic.so" ] || target=${target}_static
        cp "$here/projects/$language/CMakeLists.txt" .
        show "$CMAKE" -S . -B build -DCMAKE_PREFIX_PATH="$prefix" -DPROGRAM="$program" \
            -DHOLONOMIC_TARGET=holonomic::$target
        show "$CMAKE" --build build
        cp build/program .
        ;;
esac

# Which libraries the program asks for at its start.
needed=$(readelf -d program | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p')
echo "needs:" $needed
case $link in
    shared) echo "$needed" | grep -q '^libholonomic.*\.so\.' || { echo "does not use the shared library"; exit 1; } ;;
    archive) ! echo "$needed" | grep -q holonomic || { echo "uses the shared library"; exit 1; } ;;
    static) [ -z "$needed" ] || { echo "is not a static program"; exit 1; } ;;
esac
if [ $language != fortran ] && echo "$needed" | grep -q fortran; then
    echo "asks for a Fortran library"
    exit 1
fi

./program >printed
cat >expected <<END
holonomic $version
tension 1.000 forces 1.000 -1.000
again: HOL_ERR_SHARED_ATOM
END
diff expected printed
