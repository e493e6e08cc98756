#!/usr/bin/env bash
# Whether clang accepts for other systems what needs nothing of them: the header in C and C++, and the kernels, which know no standard
# library, for Apple's processors. Nothing is compiled, and no system's own headers are there.
#
#   clang_targets.sh SOURCES CLANG
set -u
cd "$1" || exit 1
clang=$2
temporary=$(mktemp -d) || exit 1
trap 'rm -rf "$temporary"' EXIT
flags="-ffreestanding -fsyntax-only -Wall -Wextra -Wpedantic -Wshadow -Werror -nostdinc++ -I. -Icapi"
for target in arm64-apple-macos12 x86_64-apple-macos12 x86_64-pc-windows-msvc aarch64-pc-windows-msvc x86_64-unknown-freebsd13; do
    for language in c:c99 c++:c++03 c++:c++17; do
        echo '#include "holonomic.h"' | $clang -target $target $flags -x "${language%:*}" -std="${language#*:}" - ||
            { echo "$target, $language: the header"; exit 1; }
    done
    echo "$target: the header"
done
# Of the C++ library the names of a few integers are used.
echo '#include <stddef.h>
namespace std { using ::size_t; using ::ptrdiff_t; }' >"$temporary/cstddef"
echo '#include <stdint.h>
namespace std { using ::int32_t; using ::int64_t; using ::uint32_t; using ::uint64_t; }' >"$temporary/cstdint"
mapfile -t files < <(find core/kernels -name '*.cpp')
[ ${#files[@]} -gt 0 ] || { echo "no kernels"; exit 1; }
# shellcheck disable=SC2086
printf '%s\n' "${files[@]}" | xargs -P "$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 2)" -I{} $clang -target arm64-apple-macos12 $flags \
    -Wconversion -Wno-psabi -Wno-unknown-warning-option -isystem "$temporary" -std=c++17 -ffp-contract=off \
    -DHOL_ISA=neon -DHOL_LANES=2 -DHOL_EXTENDED=double_double_fma {} || { echo "arm64-apple-macos12: the kernels"; exit 1; }
echo "arm64-apple-macos12: ${#files[@]} files of kernels"
