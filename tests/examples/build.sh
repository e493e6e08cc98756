#!/bin/sh
# Builds a folder of examples outside of all trees against an installed prefix.
#
#   build.sh PREFIX SOURCE WORK
# CMAKE names the program to use; CC, CXX and FC the compilers.
set -eu
prefix=$1 source=$2 work=$3
unset CPATH C_INCLUDE_PATH CPLUS_INCLUDE_PATH LIBRARY_PATH LD_LIBRARY_PATH LD_PRELOAD || :
rm -rf "$work"
"$CMAKE" -S "$source" -B "$work" -DCMAKE_PREFIX_PATH="$prefix"
"$CMAKE" --build "$work"
