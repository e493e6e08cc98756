#!/bin/sh
# The version script, the header and the shared library agree on which functions there are.
#
#   check_symbols.sh SOURCE LIBRARY        NM names the program to use
set -eu
source=$1 library=$2

in_map=$(sed -n 's/^ *\(hol_[a-z_0-9]*\);.*/\1/p' "$source/capi/holonomic.map" | sort)
in_header=$(tr '\n' ' ' <"$source/capi/holonomic.h" | grep -o 'HOL_API [^;(]*(' | grep -o 'hol_[a-z_0-9]*($' | tr -d '(' | sort)
# Columns: address, type, name@@version. The version nodes themselves are absolute symbols.
in_library=$("$NM" -D --defined-only "$library" | awk '$2 != "A" { sub(/@.*/, "", $3); print $3 }' | sort)

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
[ -z "$(printf '%s\n' "$in_map" | uniq -d)" ] || { echo "twice in the version script"; status=1; }

# A name without a version would be a hole in the script.
if "$NM" -D --defined-only "$library" | awk '$2 != "A" && $3 !~ /@@HOLONOMIC_[0-9]/ { bad = 1; print "no version:", $3 } END { exit !bad }'; then
    status=1
fi
exit $status
