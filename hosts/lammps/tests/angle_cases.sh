# SPDX-License-Identifier: GPL-2.0-only
# Tests of case.sh, which reads this: all bonds and angles of a molecule, and bodies that share an atom.

# angled OUTPUT VARIABLE VALUE...: the molecules that angles.py has made last
angled() {
    local output=$1 ranks=1
    shift
    case $output in *_on_*) ranks=${output##*_on_} ;; esac
    run "$ranks" "$output" "$INPUTS/angles.lmp" "$@"
}

# scene MOLECULE N DECIMALS: makes it; `select` is what holds it
scene() {
    "$PYTHON" "$INPUTS/../angles.py" make "$@" || fail "no scene"
    select="b $(seq -s ' ' "$(awk '/ bond types/ { print $1 }' data)") a $(seq -s ' ' "$(awk '/ angle types/ { print $1 }' data)")"
    [ "$1" = joined ] && select="bodies bodies.txt"
}

# keeps OUTPUT PART: the energy stays within this part of it, lengths and rates to rounding.
keeps() {
    column TotEng "$1" | awk -v part="$2" 'NR == 1 { e = $1 } { d = $1 / e - 1; if (d < 0) d = -d; if (d > w) w = d }
        END { printf "largest change of the energy %.3g of it\n", w; exit !(NR > 10 && w < part) }' || fail energy
    below 1e-12 'f_rigid[1]' "$1"
    below 1e-12 'f_rigid[2]' "$1"
}

# The trajectory of SHAKE run to its end, on any number of ranks; energy, freedoms: angles MOLECULE FREEDOMS
angles() {
    scene "$1" 3
    angled shaken select "$select" dump yes steps 20 every 5
    "$PYTHON" "$INPUTS/../angles.py" check trajectory.dump 0.01 3.0 | tee off
    awk '/positions/ { p = $2 } /velocities/ { v = $2 } /moved/ { m = $2 }
        END { exit !(p != "" && p < 1e-10 && v < 1e-9 && m > 0.02) }' off || fail "not the trajectory of SHAKE"
    for n in 1 2 4; do angled ranks_on_$n select "$select" steps 200; done
    for n in 2 4; do same 1e-11 TotEng ranks_on_1 ranks_on_$n; done
    column 'f_rigid[5]' ranks_on_4 | awk '$1 > 0 { divided = 1 } END { exit !divided }' || fail "no molecule was divided among ranks"
    angled long select "$select" steps 2000 every 100
    keeps long 2e-4
    angled start select "$select" steps 1 every 1 later "include $INPUTS/freedom.lmp"
    near 1e-6 "$(column v_free start | head -n 1)" $((27 * $2 - 3)) 'degrees of freedom'
}

# The same body by fix rigid/small, up to the second order of both integrators: beside_small MOLECULE
beside_small() {
    local half
    scene "$1" 3
    for half in 1 2; do
        angled holonomic$half select "$select" dt "$(awk "BEGIN { print 0.02 / $half }")" steps $((50 * half)) every $((50 * half))
        angled small$half rigid small dt "$(awk "BEGIN { print 0.02 / $half }")" steps $((50 * half)) every $((50 * half))
    done
    awk -v a="$(last PotEng holonomic1)" -v b="$(last PotEng small1)" -v c="$(last PotEng holonomic2)" -v d="$(last PotEng small2)" '
        BEGIN { q = (a - b) / (c - d); printf "difference to fix rigid/small: %.3g, %.3g in half steps, ratio %.3g\n", a - b, c - d, q
                exit !(q > 3.5 && q < 4.5) }' || fail 'not the trajectory of fix rigid/small'
}

# Angles as a force field has them do not quite fit: they are adjusted, which is said, within the tolerance; what such a
# molecule can not be, and a list of bodies that is wrong, are refused.
unfit() {
    scene hexane 2 1
    angled rounded select "$select tensions 100" steps 2000 every 100
    grep 'WARNING.*adjusted in the least way, that of atoms [0-9]* and [0-9]* most, by 0.0[0-9]* per cent' rounded || fail "no warning"
    keeps rounded 2e-4
    for n in 1 2; do angled whole_on_$n select "$select divide 4" steps 100; done
    grep -q ' 0 molecules divided' whole_on_2 || fail "divided, though distances depend on each other"
    same 1e-11 TotEng whole_on_1 whole_on_2
    stops angles "atoms [0-9]* and [0-9]*.*more than the tolerance" select "$select tolerance 1e-6"
    stops angles "tolerance needs a part of a length" select "$select tolerance 0.5"
    scene joined 2
    sed '3s/$/ 99999/' bodies.txt >missing.txt
    stops angles "body 3 of the file missing.txt has 5 atoms, of which 4 are in the group" select "bodies missing.txt"
    echo "17 1 1 2 1" >twice.txt
    stops angles "body 17 of the file twice.txt has atom 1 twice" select "bodies twice.txt"
    stops angles "the list of bodies nothing can't be read" select "bodies nothing"
    # Bodies that share an atom, and a molecule's bodies of which none does.
    angled both select "$select rigid" steps 100
    angled alone select "$select" steps 100
    same 1e-12 TotEng both alone
}
