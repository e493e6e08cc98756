#!/bin/sh
# The first program in README.md in the language given compiles as README says and prints what it says.
#
#   run_readme_program.sh README PREFIX WORK LANGUAGE EXPECTED        LANGUAGE: c or fortran
# CC, FC and PKG_CONFIG name the programs to use.
set -eu
readme=$1 prefix=$2 work=$3 language=$4 expected=$5
case $language in
    c) program=program.c compiler=$CC package=holonomic ;;
    fortran) program=program.f90 compiler=$FC package=holonomic-fortran ;;
esac
rm -rf "$work"
mkdir -p "$work"
cd "$work"
awk -v start="^\`\`\`$language\$" '$0 ~ start { inside = 1; next } /^```/ && inside { exit } inside' "$readme" >$program
[ -s $program ] || { echo "README has no program in $language"; exit 1; }
pc_file=$(find "$prefix" -name holonomic.pc)
PKG_CONFIG_LIBDIR=$(dirname "$pc_file")
export PKG_CONFIG_LIBDIR
# shellcheck disable=SC2046
$compiler $program -o program $("$PKG_CONFIG" --cflags --libs $package)
printed=$(LD_LIBRARY_PATH=$(dirname "$PKG_CONFIG_LIBDIR") ./program)
echo "$printed"
[ "$printed" = "$expected" ] || { echo "expected: $expected"; exit 1; }
grep -q -F "$expected" "$readme" || { echo "README does not say so"; exit 1; }
