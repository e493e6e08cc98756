#!/bin/sh
# Today's library can replace the one that the dump describes: abidiff finds nothing removed and no type changed.
#
#   compare_abi.sh DUMP LIBRARY    ABIDIFF names the program to use
# The library has debugging information for the C interface; see CMakeLists.txt. docs/abi.md says how to make the dump.
set -u
dump=$1 library=$2
"$ABIDIFF" --no-added-syms --suppressions "$(dirname "$0")/opaque_handles.ini" "$dump" "$library"
status=$?
# Bit 0: an error of the tool, bit 1: of its usage, bit 2: a change, bit 3: a change that breaks programs.
[ $status -eq 0 ] || { echo "abidiff: status $status"; exit 1; }
