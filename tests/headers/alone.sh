#!/usr/bin/env bash
# Whether every header below FOLDER compiles by itself, and is read once however often it is included.
#
#   alone.sh SOURCES FOLDER WHICH COMPILER FLAG...        WHICH: all headers, or those with conditions
set -u
sources=$1 folder=$2 which=$3
shift 3
cd "$sources" || exit 1
temporary=$(mktemp -d) || exit 1
trap 'rm -rf "$temporary"' EXIT
compile="$* -std=c++17 -ffp-contract=off -Wall -Wextra -Werror -Wno-psabi -Wno-unknown-warning-option -I. -Icapi"
if [ "$folder" = core/kernels ]; then
    # Nearly all of the time would go to the compiler's own header of vector instructions: read once.
    printf '#ifdef __x86_64__\n#include <immintrin.h>\n#endif\n' >"$temporary/vectors.h"
    $compile -x c++-header "$temporary/vectors.h" -o "$temporary/vectors.h.gch" && compile+=" -include $temporary/vectors.h"
fi
export compile
alone() { # included twice, which only one that is read once survives
    printf '#include "%s"\n#include "%s"\n' "$1" "$1" | $compile -fsyntax-only -x c++ - || { echo "not alone: $1"; exit 1; }
}
export -f alone
headers=$(find "$folder" -name '*.hpp')
[ -n "$headers" ] || { echo "no headers in $folder"; exit 1; }
if find core -name '*.inl' | grep .; then echo "no .inl files in core"; exit 1; fi
[ "$folder" = core/kernels ] || headers=$(printf '%s\n' "$headers" | grep -v '^core/kernels/.*/')
if [ "$which" = conditions ]; then headers=$(printf '%s\n' "$headers" | xargs grep -lE '^ *# *if'); fi
printf '%s\n' "$headers" | xargs -P "$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 2)" -I{} bash -c 'alone {}'
