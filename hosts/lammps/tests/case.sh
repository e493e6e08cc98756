#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-only
# One test: runs LAMMPS with the fix and compares numbers, not exit codes.
#
#   case.sh NAME ARG...      with LMP (the executable), PLUGIN (to be loaded; empty: LMP knows the fix), SCENE (make_scene),
#                            MPIRUN, PYTHON and INPUTS in the environment
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

# lammps RANKS OUTPUT INPUT VARIABLE VALUE...
lammps() {
    local ranks=$1 output=$2 input=$3 variables=()
    shift 3
    while [ $# -gt 0 ]; do
        variables+=(-var "$1" "$2")
        shift 2
    done
    if [ -n "${PLUGIN:-}" ]; then
        printf '%s\n' "plugin load $PLUGIN" "include $input" >with-plugin.lmp
        input=with-plugin.lmp
    fi
    if [ "$ranks" -eq 1 ]; then
        "$LMP" -in "$input" "${variables[@]}" -log none >"$output" 2>&1
    else
        "$MPIRUN" -np "$ranks" "$LMP" -in "$input" "${variables[@]}" -log none >"$output" 2>&1
    fi
}

# The same, which has to end well.
run() {
    lammps "$@" && grep -q '^Loop time' "$2" && return
    tail -n 20 "$2"
    fail "LAMMPS stopped"
}

# column NAME FILE: that column of the last table.
column() {
    awk -v name="$1" '/^ *Step /{for (k = 1; k <= NF; ++k) if ($k == name) c = k; n = 0; reading = 1; next}
        /^Loop time/{reading = 0}
        reading && c && $1 ~ /^[0-9]+$/{value[n++] = $c}
        END{for (k = 0; k < n; ++k) print value[k]}' "$2"
}

# same TOLERANCE NAME FILE FILE: the columns agree, relatively.
same() {
    local tolerance=$1 name=$2 a=$3 b=$4
    paste <(column "$name" "$a") <(column "$name" "$b") >pairs
    awk -v tolerance="$tolerance" -v what="$name of $a and $b" '
        function size(x) { return x < 0 ? -x : x }
        { if (NF != 2) bad = 1
          d = size($1 - $2); s = size($1) > size($2) ? size($1) : size($2)
          if (d > 0 && d / s > worst) worst = d / s }
        END { printf "%s: %d rows, largest relative difference %.3g (allowed %g)\n", what, NR, worst, tolerance
              exit !(NR > 1 && !bad && worst <= tolerance) }' pairs || fail "$name differs"
}

# below LIMIT NAME FILE: every number of the column is below.
below() {
    column "$2" "$3" | awk -v limit="$1" -v name="$2" '{ if ($1 + 0 > worst) worst = $1 + 0; if ($1 != $1 + 0 && $1 !~ /e/) bad = 1 }
        END { printf "%s: %d rows, largest %.3g (allowed %g)\n", name, NR, worst, limit; exit !(NR > 0 && !bad && worst <= limit) }' ||
        fail "$2 is too large"
}

# near TOLERANCE VALUE EXPECTED WHAT
near() {
    awk -v t="$1" -v a="$2" -v b="$3" -v what="$4" 'BEGIN { d = a - b; if (d < 0) d = -d
        printf "%s: %.9g, expected %.9g +- %g\n", what, a, b, t; exit !(a != "" && d <= t) }' || fail "$4"
}

mean() { column "$1" "$2" | awk '{ s += $1 } END { printf "%.12g", s / NR }'; }

# stops INPUT WORDS VARIABLE VALUE...: LAMMPS stops with an error that has these words.
stops() {
    local input=$1 words=$2
    shift 2
    lammps 1 out "$INPUTS/$input.lmp" "$@" && fail "LAMMPS did not stop: $words"
    grep -q "ERROR.*$words" out || { grep ERROR out; fail "not the error expected: $words"; }
    grep -m1 ERROR out
}

more_of() { [ "$1" = waters ] && echo "a 1" || echo " "; }

# Whether fix rattle of this LAMMPS is right across the boundary of the box. In the releases of 2025 and 2026 it leaves a velocity
# along the bonds there.
rattle_is_right() {
    lammps 1 boundary "$INPUTS/rattle_boundary.lmp" &&
        awk '/^d.v of the dimer inside/ { x = $NF; exit !(x * x < 1e-16) }' boundary
}

# agree VARIABLE VALUE...: the trajectory of fix rattle at 1e-13; where that is wrong the positions of fix shake, which are
# the same, by the potential energy: 1e-8 of it are 1e-11 of the total energy.
agree() {
    local reference=shake columns=PotEng tolerance=1e-8 column
    if rattle_is_right; then reference=rattle columns="TotEng Temp" tolerance=1e-11; fi
    echo "the reference is fix $reference"
    for rigid in $reference holonomic; do
        run 1 $rigid "$INPUTS/beads.lmp" rigid $rigid wide 3.5 "$@"
    done
    for column in $columns; do same $tolerance "$column" $reference holonomic; done
    below 1e-13 'f_rigid[1]' holonomic
}

rattle() {
    "$SCENE" "$1" 500 >data
    agree data data more "$(more_of "$1")" light "${2:-1.0}" dt "${3:-0.005}"
}

# The same trajectory on 1 to 4 ranks: ranks N_CHAINS N_BEADS DT
ranks() {
    "$SCENE" melt "$1" "$2" >data
    for n in 1 2 3 4; do
        run "$n" ranks$n "$INPUTS/beads.lmp" data data rigid holonomic dt "$3" steps "${4:-500}"
    done
    for n in 2 3 4; do same 1e-12 TotEng ranks1 ranks$n; done
    same 1e-10 Press ranks1 ranks4
    column 'f_rigid[5]' ranks4 | awk '$1 > 0 { divided = 1 } END { exit !divided }' || fail "no molecule was divided among ranks"
    below 1e-13 'f_rigid[1]' ranks4
}

# The same, where the molecules are divided on 2, 3 and 4 ranks: divided SCENE [VARIABLE VALUE...]
divided() {
    local scene=$1
    shift
    # shellcheck disable=SC2086
    "$SCENE" $scene >data
    for n in 1 2 3 4; do
        run "$n" divided$n "$INPUTS/beads.lmp" data data rigid holonomic more "divide 100" steps 50 every 10 norm no "$@"
        if [ "$n" -gt 1 ] && grep -q ' 0 molecules divided' divided$n; then fail "not divided on $n ranks"; fi
    done
    for column in TotEng Econserve; do
        for n in 2 3 4; do same 1e-12 $column divided1 divided$n; done
    done
    same 1e-9 Press divided1 divided4
    below 1e-13 'f_rigid[1]' divided4
    below 1e-13 'f_rigid[2]' divided4
}

# Energy holds.
nve() {
    "$SCENE" melt 16 32 >data
    run 1 nve "$INPUTS/beads.lmp" data data rigid holonomic dt 0.003 steps 10000 every 500 \
        before "run 0" later "run 2000"
    # Per bead and unit of time: between the means of the first and the last five.
    column TotEng nve | awk '{ e[NR] = $1 } END { for (k = 1; k <= 5; ++k) d += e[NR + 1 - k] - e[k]
        d /= 5 * 24; printf "drift %.3g\n", d; exit !(NR == 21 && d < 2e-5 && d > -2e-5) }' || fail drift
    below 1e-13 'f_rigid[1]' nve
    below 1e-13 'f_rigid[2]' nve
}

# The barostat reaches its pressure, and its conserved quantity holds: of so few trimers it takes a random walk, some 4e-4.
npt() {
    "$SCENE" "$1" "$2" "${4#-}" >data
    run 1 npt "$INPUTS/beads.lmp" data data rigid holonomic dt 0.0025 steps 32000 every 20 norm no \
        motion "npt temp 1.0 1.0 0.5 $5 $3 $3 2.0" later "run 6000"
    near 0.02 "$(mean Press npt | awk -v p="$3" '{ print $1 / p }')" 1 'mean pressure over the target'
    column Econserve npt | awk -v beads="$(awk '/ atoms$/ { print $1 }' data)" '{ e[NR] = $1 }
        END { h = int(NR / 2); for (k = 1; k <= h; ++k) d += e[NR + 1 - k] - e[k]
        d /= h * h * 0.05 * beads; printf "drift of the conserved quantity per bead and unit of time: %.3g\n", d
        exit !(h > 100 && d < 2e-3 && d > -2e-3) }' || fail 'conserved quantity'
}

# A rigid angle close to straight.
bent() {
    "$SCENE" bent 64 "$1" >data
    run 1 bent "$INPUTS/beads.lmp" data data rigid holonomic more "a 1" angle "$1" dt 0.002 steps 2000
    column TotEng bent | awk 'NR == 1 { e = $1 } { d = $1 - e; if (d < 0) d = -d; if (d > w) w = d }
        END { printf "largest change of the energy per bead %.3g\n", w; exit !(NR == 21 && w < 2e-4) }' || fail energy
    below 1e-12 'f_rigid[1]' bent
}

name=$1
shift
case $name in
    rattle | ranks | divided | nve | npt | bent) "$name" "$@" ;;
    long_npt) . "$(dirname "${BASH_SOURCE[0]}")/more_cases.sh" && . "$(dirname "${BASH_SOURCE[0]}")/long_npt.sh" && "$name" "$@" ;;
    *) . "$(dirname "${BASH_SOURCE[0]}")/more_cases.sh" && . "$(dirname "${BASH_SOURCE[0]}")/angle_cases.sh" && "$name" "$@" ;;
esac
