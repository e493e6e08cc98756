#!/bin/sh
# Builds and installs the static library alone, as somebody does who wants no shared one.
#
#   install_static_only.sh SOURCE BUILD PREFIX FORTRAN OPTIONS      FORTRAN: ON or OFF; OPTIONS: a file of cmake's
# CC, CXX, FC and CMAKE name the programs to use.
set -eu
source=$1 build=$2 prefix=$3 fortran=$4 options=$5
rm -rf "$build" "$prefix"
"$CMAKE" -C "$options" -S "$source" -B "$build" -DBUILD_SHARED_LIBS=OFF -DHOLONOMIC_BUILD_FORTRAN="$fortran"
"$CMAKE" --build "$build" -j 2
"$CMAKE" --install "$build" --prefix "$prefix"
