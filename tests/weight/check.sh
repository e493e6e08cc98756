#!/bin/sh
# Fails where the library, or what a set of kernels adds to it, has grown by more than a tenth of what PAGE says. Parts of
# less than 100 kB may grow as they like: they are in the library's size.
#
#   check.sh PAGE BUILD LIBRARY COMPILER
#       PAGE      docs/development/weight.md
#       COMPILER  name and version, as the page has them. Exit status 77: it is another one, whose code is of another size
# SIZE and STRIP name programs.
set -eu
page=$1 build=$2 library=$3 compiler=$4
here=$(cd "$(dirname "$0")" && pwd)
grep -q "^Compiler: $compiler\\." "$page" || { echo "skipped: $compiler is not the compiler of $page"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"${STRIP:-strip}" -o "$work/stripped" "$library"
"$here/sizes.sh" "$build" | awk '{ size[$1] += $3 } END { for (part in size) print part, size[part] }' >"$work/sizes"
echo "library $(wc -c <"$work/stripped")" >>"$work/sizes"

compare() { # PAGE: the parts of both; the library only if it has the sets of the page, no more and no fewer
    awk -F'|' 'NR == FNR { split($0, word, " "); now[word[1]] = word[2]; next }
        /^## / { exit }
        /^\| [a-z0-9]+ \| [0-9]+ \|/ { gsub(/ /, "", $2); was[$2] = $3 + 0 }
        END {
            for (part in now) if (!(part in was)) { print part " is not on the page"; other = 1 }
            for (part in was) if (!(part in now)) { print part " is not in this build"; other = 1 }
            for (part in was) {
                if (!(part in now) || (part == "library" && other)) continue
                ++compared
                printf "%-10s %9d bytes, %9d on the page\n", part, now[part], was[part]
                if (was[part] >= 100000 && now[part] > 1.1 * was[part]) { printf "%s has grown by more than a tenth\n", part; grown = 1 }
            }
            exit grown || !compared
        }' "$work/sizes" "$1"
}

# What it says of a library that has grown: of this one, beside a page on which all was smaller.
awk -F'|' -v OFS='|' '/^\| [a-z0-9]+ \| [0-9]+ \|/ { $3 = " " int($3 / 2) " " } { print }' "$page" >"$work/half"
if compare "$work/half" >/dev/null; then echo "a library twice as large is not noticed"; exit 1; fi
compare "$page"
