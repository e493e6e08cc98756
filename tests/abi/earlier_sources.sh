#!/usr/bin/env bash
# The same with header, symbols and program as the last sources of a release had them, out of the history.
#
#   earlier_sources.sh SOURCE LIBRARY WORK COMMIT        the rest as every_function.sh
# Exit status 77: the history is not there.
set -eu
source=$1 library=$2 work=$3 commit=$4
git -C "$source" cat-file -e "$commit^{commit}" 2>/dev/null || { echo "skipped: commit $commit is not in this copy"; exit 77; }
rm -rf "$work.sources"
mkdir -p "$work.sources"
git -C "$source" archive "$commit" capi tests/abi | tar -x -C "$work.sources"
exec "${0%/*}/every_function.sh" "$library" "$work" "$work.sources/capi/holonomic.h" "$work.sources/capi/holonomic.map" \
    "$work.sources/tests/abi/every_function.c"
