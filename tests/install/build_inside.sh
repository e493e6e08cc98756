#!/bin/sh
# Builds a project that has the library's source as one of its folders, and runs its program.
#
#   build_inside.sh SOURCE WORK HOW VERSION OPTIONS        HOW: subdirectory | fetch (FetchContent); OPTIONS: a file of cmake's
# CC and CMAKE name the programs to use.
set -eu
source=$1 work=$2 how=$3 version=$4 options=$5
here=$(cd "$(dirname "$0")" && pwd)
rm -rf "$work"
mkdir -p "$work"
cp "$here/projects/subdirectory/CMakeLists.txt" "$here/programs/rotor.c" "$work"
"$CMAKE" -C "$options" -S "$work" -B "$work/build" -DHOW="$how" -DHOLONOMIC_SOURCE="$source" -DPROGRAM=rotor.c
# The library is the same either way: it is compiled once.
[ "$how" = subdirectory ] || exit 0
"$CMAKE" --build "$work/build" -j 2
"$work/build/program" | tee "$work/printed"
grep -q "^holonomic $version$" "$work/printed" || { echo "another library answered"; exit 1; }
# Nothing is installed unless asked for.
"$CMAKE" --install "$work/build" --prefix "$work/prefix"
[ -z "$(find "$work/prefix" -type f 2>/dev/null)" ] || { echo "installed without being asked for"; exit 1; }
