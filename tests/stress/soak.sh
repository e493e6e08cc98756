#!/bin/sh
# Hostile chains, molecules and bodies from the number of this commit on, a third of the time each. At most PERCENT may
# exceed a bound, by a factor of three.
#   soak.sh SECONDS SOURCE_DIRECTORY STRESS STRESS_MOLECULES STRESS_BODIES PROCESSES PERCENT
set -u
first=$("${0%/*}/first_number.sh" "$2")
third=$(($1 / 3))
echo "numbers from $first on"
"$3" $third "" "$first" "$6" 2000 "$7"
chains=$?
"$4" $third "" "$first" "$6" "$7"
molecules=$?
"$5" $third "$first" "$6" "$7"
bodies=$?
worst=$((molecules > chains ? molecules : chains))
exit $((bodies > worst ? bodies : worst))
