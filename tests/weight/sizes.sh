#!/bin/sh
# Bytes of code and data in the objects of a build of the library: a line "PART FILE BYTES" for each. PART is a set of kernels,
# core, capi or dispatch.
#
#   sizes.sh BUILD
set -eu
cd "$1"
find core/CMakeFiles capi/CMakeFiles -name '*.cpp.o' | grep -v -e _every_set -e '/holonomic_kernels_lanes' | LC_ALL=C sort |
    xargs "${SIZE:-size}" | awk 'NR > 1 && $6 != "(TOTALS)" {
        path = $6
        sub(/.*\/holonomic_(kernels_)?/, "", path); sub(/\.o$/, "", path)
        split(path, part, /\.dir\//)
        print part[1], part[2], $1 + $2 }'
