#!/bin/sh
# Hostile chains, molecules and bodies from the number of this commit on; chains, of which there are ten in the time of
# one molecule, a fifth of the time. At most PERCENT may exceed a bound, by a factor of three.
#   soak.sh SECONDS SOURCE_DIRECTORY STRESS STRESS_MOLECULES STRESS_BODIES PROCESSES PERCENT
set -u
first=$("${0%/*}/first_number.sh" "$2")
fifth=$(($1 / 5))
echo "numbers from $first on"
"$3" $fifth "" "$first" "$6" 2000 "$7"
chains=$?
"$4" $((2 * fifth)) "" "$first" "$6" "$7"
molecules=$?
"$5" $((2 * fifth)) "$first" "$6" "$7"
bodies=$?
worst=0 # what is wrong counts more than what is undecided, 77
for status in $chains $molecules $bodies; do
    [ $status -eq 0 ] || { [ $status -eq 77 ] && [ $worst -ne 0 ]; } || worst=$status
done
exit $worst
