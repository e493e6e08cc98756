#!/bin/sh
# Bytes of code and data in the objects of a build of the library: a line "PART FILE BYTES" for each. PART is a set of kernels,
# core, capi or dispatch. Objects that an older commit has left there, whose source is gone, are none of the library's.
#
#   sizes.sh BUILD
set -eu
top=$(cd "$(dirname "$0")/../.." && pwd)
cd "$1"
find core/CMakeFiles capi/CMakeFiles -name '*.cpp.o' | grep -v -e _every_set -e '/holonomic_kernels_lanes' | LC_ALL=C sort |
    while read -r object; do
        source=${object#*.dir/}
        [ ! -f "$top/${object%%/*}/${source%.o}" ] || echo "$object"
    done |
    xargs "${SIZE:-size}" | awk 'NR > 1 && $6 != "(TOTALS)" {
        path = $6
        sub(/.*\/holonomic_(kernels_)?/, "", path); sub(/\.o$/, "", path)
        split(path, part, /\.dir\//)
        print part[1], part[2], $1 + $2 }'
