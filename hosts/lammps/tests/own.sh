#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-only
# LAMMPS's own tests of constraints with fix holonomic in their place: its source tree has the scenes, their commands and
# the numbers that fix shake, rattle or ilves gave at its tolerance.
#
#   own.sh YAML      with LMP, SOURCE (LAMMPS's source tree) and PLUGIN (empty: LMP knows the fix)
#
# "tight" is the fix of the reference at a tolerance of 1e-13: how far it is from the reference's numbers shows what these
# are good for.
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

yaml=$1
scenes=$SOURCE/unittest/force-styles/tests
[ -f "$scenes/$yaml" ] || { echo "SKIPPED: this source tree has no $yaml"; exit 77; }

# entry KEY: what the file has for it, in one line or in the indented ones below.
entry() {
    awk -v key="$1:" '/^[a-z]/ { reading = 0 }
        $1 == key { sub(/^[^:]*: */, ""); if ($0 ~ /^[!|]/) reading = 1; else print; next }
        reading { sub(/^ +/, ""); print }' "$scenes/$yaml" | grep -v '^""$'
}

commands=$(entry post_commands)
style=$(awk '$1 == "fix" && $2 == "test" { print $4 }' <<<"$commands")

# The selectors stay; tolerance, iterations and steps between messages go, or are made tight.
translated() {
    local with="holonomic"
    [ "$1" = tight ] && with="$style 1e-13 500 0"
    sed -E "s/^(fix test [^ ]+) $style [^ ]+ [^ ]+ [^ ]+/\1 $with/" <<<"$commands"
}

# What the scene leaves to a second file, in older releases to the test's source: styles, coefficients and groups; lengths
# and angles for the styles zero.
coefficients() {
    local file=$scenes/coeffs.fourmol source=$SOURCE/unittest/force-styles/test_fix_timestep.cpp
    if [ -f "$file" ]; then cat "$file"; else
        sed -nE 's/^ *command\("((pair_|bond_|angle_|group ).*)"\);/\1/p' "$source"
    fi | if [ "$(entry input_file)" = in.fourmol ]; then cat; else
        awk '$1 ~ /^(bond|angle)_coeff$/ { print $1, $2, $4 } END { print "pair_coeff * *" }'
    fi
}

# scene WHICH START PARTS: the input. START: a restart file, or "" for the scene itself; each step in so many PARTS.
scene() {
    [ -z "$PLUGIN" ] || echo "plugin load $PLUGIN"
    echo "variable input_dir index $scenes"
    if [ -n "$2" ]; then echo "read_restart $2"; else echo "include $scenes/$(entry input_file)"; fi
    if [ -n "$2" ]; then coefficients | sed '/^group/d'; else coefficients; fi
    translated "$1"
    echo "compute p all pressure NULL fix"
    echo "thermo_style custom step c_p[1] c_p[2] c_p[3] c_p[4] c_p[5] c_p[6]"
    echo "thermo_modify norm no format float %.17g"
    echo "timestep $(awk -v n="$3" 'BEGIN { printf "%.17g", 0.25 / n }')"
}

finish() {
    echo "write_dump all custom end id x y z vx vy vz modify format float %.17g sort id"
    # The virial, from the pressure of real units: the scenes have these.
    echo 'variable w equal vol/68568.415'
    for k in 1 2 3 4 5 6; do echo "variable w$k equal c_p[$k]*v_w"; done
    echo 'print "VIRIAL $(v_w1:%.17g) $(v_w2:%.17g) $(v_w3:%.17g) $(v_w4:%.17g) $(v_w5:%.17g) $(v_w6:%.17g)"'
    # Its velocities, made tangent; positions stay.
    [ "$1" = holonomic ] || translated holonomic | sed -n 's/^fix test/unfix test\nfix test/p'
    printf '%s\n' "run 0" "write_dump all custom tangent id vx vy vz modify format float %.17g sort id"
}

# take NAME WHICH START PARTS COMMAND...: runs them; NAME.pos, .vel, .tangent and .stress have the numbers.
take() {
    local name=$1 which=$2
    { scene "$2" "$3" "$4" && printf '%s\n' "${@:5}" && finish "$2"; } >"$name.in"
    rm -f end tangent
    "$LMP" -in "$name.in" -log none >"$name.out" 2>&1 && grep -q '^VIRIAL' "$name.out" ||
        { grep -B 3 -A 1 ERROR "$name.out" || tail -n 5 "$name.out"; return 1; }
    awk '/^ITEM: ATOMS/ { reading = 1; next } reading { print $1, $2, $3, $4 > f ".pos"; print $1, $5, $6, $7 > f ".vel" }' f="$name" end
    awk '/^ITEM: ATOMS/ { reading = 1; next } reading' tangent >"$name.tangent"
    awk '/^VIRIAL/ { $1 = "0"; print }' "$name.out" >"$name.stress"
}

# apart FILE FILE: largest difference of any numbers.
apart() {
    paste "$1" "$2" | awk '{ n = NF / 2; if ($1 != $(n + 1)) bad = 1
        for (k = 2; k <= n; ++k) { d = $k - $(n + k); if (d < 0) d = -d; if (d > w) w = d } }
        END { if (bad || NR == 0) print "inf"; else printf "%.3g\n", w }'
}

# at_most LIMIT NUMBER WHAT
at_most() {
    awk -v limit="$1" -v x="$2" -v what="$3" 'BEGIN { printf "%s: %s (allowed %g)\n", what, x, limit; exit !(x != "inf" && x <= limit) }' ||
        fail "$3"
}

entry run_pos >reference.pos
entry run_vel >reference.vel
epsilon=$(entry epsilon)
run=("run 0 post no" "thermo 2" "run 4 post no start 0 stop 8" "write_restart half" "run 4 start 0 stop 8")
if ! take tight tight "" 1 "${run[@]}"; then
    grep -Eq 'Unknown fix|Unrecognized fix' tight.out && { echo "SKIPPED: this LAMMPS has no fix $style"; exit 77; }
    fail "fix $style stopped"
fi
take ours holonomic "" 1 "${run[0]}" "write_restart start" "${run[@]:1}" || fail "fix holonomic stopped"
echo "fix $style at its tolerance and at 1e-13: positions $(apart reference.pos tight.pos), velocities $(apart reference.vel tight.vel)"
if [ "$style" = ilves ]; then
    # It takes a start that is off the constraints in another way: the numbers of the reference belong to that.
    echo "positions of the reference and of fix holonomic: $(apart reference.pos ours.pos)"
else
    at_most "$epsilon" "$(apart reference.pos ours.pos)" "positions, from those of the reference"
    [ "$style" = shake ] ||
        at_most "$epsilon" "$(apart reference.vel ours.vel)" "velocities, from those of the reference"
    at_most 1e-12 "$(apart tight.tangent ours.vel)" "velocities, from those of fix $style made tangent"
fi
take again holonomic half 1 "thermo 2" "run 4" || fail "no restart"
for numbers in pos vel stress; do at_most 1e-13 "$(apart ours.$numbers again.$numbers)" "$numbers after a restart"; done

# From a start on the constraints, in steps and in quarters of them. Fix shake and ilves have the virial of a step's
# impulses, fix rattle one of first order in the step: what they differ by has to go, to nothing.
for parts in 1 4; do
    for which in tight holonomic; do
        take $which$parts $which start $parts "thermo $((2 * parts))" "run $((8 * parts))" || fail "from the start"
    done
    at_most "$([ "$style" = ilves ] && echo 1e-8 || echo 1e-12)" "$(apart tight$parts.pos holonomic$parts.pos)" "positions, from a common start, $parts"
    at_most "$([ "$style" = ilves ] && echo 1e-8 || echo 1e-12)" "$(apart tight$parts.tangent holonomic$parts.tangent)" "velocities, from a common start, $parts"
done
virials=($(apart tight1.stress holonomic1.stress) $(apart tight4.stress holonomic4.stress))
at_most "$(awk -v d="${virials[0]}" 'BEGIN { print d / 3.5 + 1e-7 }')" "${virials[1]}" "virials differ by ${virials[0]}, in quarters of steps"
