#!/usr/bin/env bash
# Whether clang accepts the sources of the library without a warning, and without OpenMP. It only reads them: seconds.
#
#   clang.sh SOURCES CLANG FOLDER FLAG...        FOLDER: core/kernels, or core for all but the kernels and capi
set -u
sources=$1 folder=$3
compile="$2 -std=c++17 -ffp-contract=off -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror
    -Wno-psabi -Wno-unknown-warning-option -I. -Icapi ${*:4}"
cd "$sources" || exit 1
files=$(find "$folder" -name '*.cpp')
if [ "$folder" = core ]; then
    # kernel_choice.cpp includes a list that cmake writes.
    files=$(printf '%s\n' "$files" | grep -v -e '^core/kernels/' -e '/kernel_choice\.cpp$' && find capi -name '*.cpp')
fi
[ -n "$files" ] || { echo "no sources in $folder"; exit 1; }
# The standard library's headers and those of vector instructions are read once; that each source names what it needs is
# seen where the library is built.
temporary=$(mktemp -d) || exit 1
trap 'rm -rf "$temporary"' EXIT
{ printf '#ifdef __AVX__\n#include <immintrin.h>\n#endif\n' && [ "$folder" = core/kernels ] ||
    find core capi -name '*.[ch]pp' -exec grep -hE '^#include <[a-z_]+>' {} + | sort -u; } >"$temporary/read_once.hpp"
# shellcheck disable=SC2086
$compile -x c++-header "$temporary/read_once.hpp" -o "$temporary/read_once.pch" || exit 1
compile+=" -fsyntax-only -include-pch $temporary/read_once.pch"
# shellcheck disable=SC2086
printf '%s\n' "$files" | xargs -P "$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 2)" -I{} $compile {}
