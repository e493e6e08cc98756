#!/bin/sh
# An installed prefix holds one header, no trace of the trees that it was built in, and no private dependency.
#
#   check_contents.sh PREFIX SOURCE BUILD
set -eu
cd "$1"
source=$2 build=$3
fail() {
    echo "$*"
    exit 1
}

headers=$(find . -name '*.h' -o -name '*.hpp' -o -name '*.inl')
[ "$headers" = ./include/holonomic.h ] || fail "headers: $headers"
cmp include/holonomic.h "$source/capi/holonomic.h"
[ -f share/doc/holonomic/LICENSE ] || fail "no licence"

# The text files that others read; object code may name the files that it was compiled from.
text=$(find . -name '*.pc' -o -name '*.cmake')
[ -n "$text" ] || fail "no package files"
# shellcheck disable=SC2086
! grep -n -F -e "$source" -e "$build" $text || fail "names the trees that it was built in"
# shellcheck disable=SC2086
! grep -n -i eigen $text || fail "names Eigen"

for library in $(find . -name '*.so.*.*.*'); do
    ! readelf -d "$library" | grep -F -e "$source" -e "$build" || fail "$library looks for libraries in the build tree"
done
