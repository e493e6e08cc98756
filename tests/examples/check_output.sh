#!/bin/sh
# Runs a program in an empty folder and checks numbers that it prints.
#
#   check_output.sh WORK PROGRAM [ARGUMENT ...] -- [LABEL N OPERATOR VALUE] ...
#
# The last line that begins with LABEL must have an Nth number behind the label that obeys OPERATOR (<, > or =) VALUE.
# LABEL "file", N a name: the program must have written a file of that name with at least VALUE bytes (OPERATOR >).
set -eu
work=$1
shift
rm -rf "$work"
mkdir -p "$work"
cd "$work"

command=
while [ "$1" != -- ]; do
    command="$command '$1'"
    shift
done
shift
eval "$command" >output 2>errors || { cat output errors; echo "the program failed with status $?"; exit 1; }
cat output errors
[ ! -s errors ] || { echo "the program wrote to its standard error"; exit 1; }
if grep -iq nan output; then
    echo "there is a NaN in the output"
    exit 1
fi

bad=0
while [ $# -ge 4 ]; do
    label=$1 n=$2 operator=$3 value=$4
    shift 4
    if [ "$label" = file ]; then
        got=$(wc -c <"$n" || echo 0)
    else
        got=$(awk -v label="$label" -v n="$n" '
            index($0, label) == 1 {
                rest = substr($0, length(label) + 1)
                gsub(/,/, " ", rest)
                found = ""
                count = 0
                words = split(rest, word, " ")
                for (i = 1; i <= words; i++)
                    if (word[i] ~ /^[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?$/ && ++count == n) found = word[i]
            }
            END { print found }' output)
    fi
    if awk -v a="$got" -v o="$operator" -v b="$value" 'BEGIN {
            if (a == "") exit 1
            exit !(o == "<" ? a + 0 < b + 0 : o == ">" ? a + 0 > b + 0 : o == "=" ? a + 0 == b + 0 : 0) }'; then
        echo "ok: $label [$n] = $got $operator $value"
    else
        echo "BAD: $label [$n] = '$got' is not $operator $value"
        bad=1
    fi
done
[ $# -eq 0 ] || { echo "incomplete expectation: $*"; exit 1; }
exit $bad
