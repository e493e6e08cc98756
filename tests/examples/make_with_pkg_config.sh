#!/bin/sh
# Builds the C examples with their Makefile against an installed prefix, and runs them.
#   make_with_pkg_config.sh PREFIX SOURCE WORK
set -eu
prefix=$1 source=$2 work=$3
unset CPATH C_INCLUDE_PATH CPLUS_INCLUDE_PATH LIBRARY_PATH LD_LIBRARY_PATH LD_PRELOAD MAKEFLAGS || :
PKG_CONFIG_PATH=$(dirname "$(find "$prefix" -name holonomic.pc)")
export PKG_CONFIG_PATH
rm -rf "$work"
cp -r "$source" "$work"
make -C "$work"
"$work/shortest" | grep -x 'tensions: 30 20 10'
"$work/tensions" "$work/rotor.txt" | grep 'constraint virial: -120'
make -C "$work" clean
[ ! -e "$work/shortest" ]
