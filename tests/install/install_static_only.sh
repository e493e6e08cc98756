#!/bin/sh
# Builds and installs the static library alone, as somebody does who wants no shared one.
#
#   install_static_only.sh SOURCE BUILD PREFIX FORTRAN      FORTRAN: ON or OFF
# CC, CXX, FC and CMAKE name the programs to use. Not optimized, for the baseline alone: only the linking of it is tested.
set -eu
source=$1 build=$2 prefix=$3 fortran=$4
rm -rf "$build" "$prefix"
"$CMAKE" -S "$source" -B "$build" -DBUILD_SHARED_LIBS=OFF -DCMAKE_BUILD_TYPE=Debug -DHOLONOMIC_INSTRUCTION_SETS= \
    -DCMAKE_CXX_FLAGS=-DHOL_TESTS_ONLY \
    -DHOLONOMIC_BUILD_FORTRAN="$fortran"
"$CMAKE" --build "$build" -j 2
"$CMAKE" --install "$build" --prefix "$prefix"
