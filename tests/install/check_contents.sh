#!/bin/sh
# An installed prefix holds the header and that for C++, no trace of the trees that it was built in, and no private dependency.
#
#   check_contents.sh PREFIX SOURCE BUILD
set -eu
cd "$1"
source=$2 build=$3
fail() {
    echo "$*"
    exit 1
}

headers=$(find include -name '*.h' -o -name '*.hpp' -o -name '*.inl' | sort | tr '\n' ' ')
[ "$headers" = 'include/holonomic.h include/holonomic.hpp ' ] || fail "headers: $headers"
cmp include/holonomic.h "$source/capi/holonomic.h"
cmp include/holonomic.hpp "$source/capi/holonomic.hpp"
[ -f share/doc/holonomic/LICENSE ] || fail "no licence"

# Every page that the header cites, and the manual, which names every function.
for page in $(grep -o 'docs/[a-z_]*\.md' include/holonomic.h | sort -u); do
    [ -f "share/doc/holonomic/$page" ] || fail "the header cites $page, which is not installed"
done
[ -f share/doc/holonomic/docs/fortran_reference.md ] || fail "no reference of the Fortran module"
for function in $(sed -n 's/^ *\(hol_[a-z_0-9]*\);.*/\1/p' "$source/capi/holonomic.map"); do
    grep -q "$function" share/man/man3/holonomic.3 || fail "the manual does not name $function"
done
! grep -n '@' share/man/man3/*.3 || fail "the manual is not filled in"

# Each function has a page of its own, which shows how it is called, or leads to one that does.
for function in $(sed -n 's/^ *\(hol_[a-z_0-9]*\);.*/\1/p' "$source/capi/holonomic.map") hol_status hol_view hol_report; do
    page=share/man/man3/$function.3
    [ -s "$page" ] || fail "there is no manual of $function"
    led=$(sed -n 's/^\.so //p' "$page")
    sed -n '/^\.SH SYNOPSIS/,/^\.fi/p' "${led:+share/man/}${led:-$page}" | grep -q "$function[(;]" || fail "$page does not show $function"
    grep -q '^\.SH DESCRIPTION' "${led:+share/man/}${led:-$page}" || fail "$page says nothing of it"
done
grep -q 'sigma.. = 0, that is' share/man/man3/hol_forces.3 && grep -q '^\.IR "tension" " (out)"' share/man/man3/hol_forces.3 || fail "hol_forces(3) lacks what the header says"
# They are in man's language.
if command -v groff >/dev/null; then
    words=$(cd share/man && groff -man -ww -Tascii -z man3/*.3 2>&1)
    [ -z "$words" ] || fail "$words"
fi

# Links between installed pages lead to what is installed.
"$source/tests/docs/links.sh" "$PWD/share/doc/holonomic" || fail "installed pages have links that lead nowhere"

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
