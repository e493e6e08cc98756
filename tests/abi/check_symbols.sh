#!/bin/sh
# The version script, the header, the shared library, the list of this version in docs/abi.md and the symbols that
# every_function.c calls for it agree on which functions there are.
#
#   check_symbols.sh SOURCE LIBRARY        READELF names the program to use
set -eu
source=$1 library=$2

in_map=$(sed -n 's/^ *\(hol_[a-z_0-9]*\);.*/\1/p' "$source/capi/holonomic.map" | sort)
in_header=$(tr '\n' ' ' <"$source/capi/holonomic.h" | grep -o 'HOL_API [^;(]*(' | grep -o 'hol_[a-z_0-9]*($' | tr -d '(' | sort)
# Columns: number, value, size, type, binding, visibility, section, name@@version.
exported=$("$READELF" --dyn-syms -W "$library" | awk '$4 == "FUNC" && $7 != "UND" && $5 != "LOCAL" || $4 == "OBJECT" && $7 != "UND" && $7 != "ABS" && $5 != "LOCAL" { print $8 }')
in_library=$(echo "$exported" | sed 's/@.*//' | sort)

status=0
compare() {
    if [ "$2" != "$4" ]; then
        echo "only in $1:" $(printf '%s\n' "$2" "$4" "$4" | sort | uniq -u)
        echo "only in $3:" $(printf '%s\n' "$4" "$2" "$2" | sort | uniq -u)
        status=1
    fi
}
[ -n "$in_map" ] || { echo "no function found in the version script"; exit 1; }
compare "the header" "$in_header" "the version script" "$in_map"
compare "the library" "$in_library" "the version script" "$in_map"
version=$(sed -n 's/^#define HOL_VERSION_M.*OR \([0-9]*\)$/\1/p' "$source/capi/holonomic.h" | paste -sd .)
frozen=$source/tests/abi/frozen/holonomic-$version
compare "the version script" "$in_map" "$frozen.map" "$(sed -n 's/^ *\(hol_[a-z_0-9]*\);.*/\1/p' "$frozen.map" | sort)"
compare "HOLONOMIC_$version" "$(sed -n "/^HOLONOMIC_$version {/,/^}/s/^ *\(hol_[a-z_0-9]*\);.*/\1/p" "$source/capi/holonomic.map" | sort)" \
    docs/abi.md "$(sed -n "/^## The functions of $version/,/^## How/s/^    \(hol_[a-z_0-9]*\)$/\1/p" "$source/docs/abi.md" | sort)"
[ -z "$(printf '%s\n' "$in_map" | uniq -d)" ] || { echo "twice in the version script"; status=1; }

# A name without a version would be a hole in the script.
if echo "$exported" | grep -v '@@HOLONOMIC_[0-9]'; then
    echo "have no version"
    status=1
fi
exit $status
