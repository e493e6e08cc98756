#!/usr/bin/env bash
# A program linked to the library of an earlier release runs with today's. Program and library are built from the sources
# of that release as they were, out of the history.
#
#   earlier_sources.sh SOURCE LIBRARY WORK COMMIT
# CC and CMAKE name programs. Exit status 77: the history is not there.
set -eu
source=$1 library=$2 work=$3 commit=$4
git -C "$source" cat-file -e "$commit^{commit}" 2>/dev/null || { echo "skipped: commit $commit is not in this copy"; exit 77; }
rm -rf "$work"
mkdir -p "$work/source"
git -C "$source" archive "$commit" | tar -x -C "$work/source"
# Not optimized, and for no instruction set but the baseline: what counts is what it exports.
"$CMAKE" -S "$work/source" -B "$work/build" -DCMAKE_BUILD_TYPE=None -DHOLONOMIC_INSTRUCTION_SETS= \
    -DHOLONOMIC_BUILD_FORTRAN=OFF >"$work/log" 2>&1 && "$CMAKE" --build "$work/build" --target holonomic >>"$work/log" 2>&1 ||
    { tail -n 30 "$work/log"; exit 1; }
"${CC:-cc}" -I "$work/source/capi" "$work/source/tests/abi/every_function.c" -o "$work/program" -L "$work/build/capi" -lholonomic -lm
echo "with the library of $commit:"
LD_LIBRARY_PATH=$work/build/capi "$work/program"
echo "with today's:"
LD_LIBRARY_PATH=$(dirname "$library") "$work/program"
