#!/bin/sh
# Hostile chains and molecules from the number of this commit on, half of the time each. At most PERCENT may exceed a bound,
# by a factor of three.
#   soak.sh SECONDS SOURCE_DIRECTORY STRESS STRESS_MOLECULES PROCESSES PERCENT
set -u
first=$("${0%/*}/first_number.sh" "$2")
half=$(($1 / 2))
echo "numbers from $first on"
"$3" $half "" "$first" "$5" 2000 "$6"
chains=$?
"$4" $half "" "$first" "$5" "$6"
molecules=$?
exit $((molecules > chains ? molecules : chains))
