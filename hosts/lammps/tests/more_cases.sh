# SPDX-License-Identifier: GPL-2.0-only
# Further tests of case.sh, which reads this.

# The stock lmp with LD_PRELOAD gives the same numbers.
preload() {
    "$SCENE" melt 16 32 >data
    run 1 own "$INPUTS/beads.lmp" data data rigid holonomic dt 0.003
    LD_PRELOAD=$1 "$2" -in "$INPUTS/beads.lmp" -var data data -var rigid holonomic -var dt 0.003 -log none >stock 2>&1
    same 1e-14 TotEng own stock
}

# In two dimensions: the trajectory of fix rattle, and the same on four ranks; nothing leaves the plane.
flat() {
    local plane=(first "dimension 2" before "fix plane all enforce2d")
    "$SCENE" sheet 200 3 >data
    agree data data dt 0.003 "${plane[@]}"
    "$SCENE" sheet 40 32 >data
    for n in 1 4; do
        run $n ranks$n "$INPUTS/beads.lmp" data data rigid holonomic dt 0.003 "${plane[@]}" \
            after "write_dump all custom end id x y z vx vy vz modify format float %.17g"
        awk '/^ITEM: ATOMS/ { reading = 1; next } reading { ++n; if ($4 != 0 || $7 != 0) bad = 1 } END { exit bad || n != 1280 }' end ||
            fail "atoms have left the plane"
    done
    same 1e-12 TotEng ranks1 ranks4
    below 1e-13 'f_rigid[1]' ranks4
}

# However LAMMPS keeps its bonds and cuts its box, the trajectory is the same.
layouts() {
    "$SCENE" melt 40 32 >data
    run 1 plain "$INPUTS/beads.lmp" data data rigid holonomic dt 0.003 steps 300
    run 2 off "$INPUTS/beads.lmp" data data rigid holonomic dt 0.003 steps 300 first "newton off"
    run 3 tiled "$INPUTS/beads.lmp" data data rigid holonomic dt 0.003 steps 300 first "comm_style tiled" later "balance 1.0 rcb"
    run 4 grid "$INPUTS/beads.lmp" data data rigid holonomic dt 0.003 steps 300 first "processors 1 1 4"
    for layout in off tiled grid; do same 1e-12 TotEng plain $layout; done
}

# Virials per atom add up to the pressure, constraint forces to nothing, tensions to the virial; on any number of ranks.
outputs() {
    "$SCENE" melt 40 32 >data
    for n in 1 4; do
        run $n out$n "$INPUTS/beads.lmp" data data rigid holonomic dt 0.003 more "forces 50 tensions 100 divide ${1:-0}" \
            before "compute s all stress/atom NULL fix" later "include $INPUTS/sums.lmp" steps "${2:-200}"
        # The last step of the dump, by atoms.
        awk '/^ITEM: ENTRIES/ { n = 0; next } /^ITEM/ { reading = /ENTRIES/; next } NF == 4 { row[n++] = $0 }
            END { for (k = 0; k < n; ++k) print row[k] }' tensions.dump | sort -n -k 1 >tensions$n
    done
    same 1e-10 v_p out1 out4
    paste <(column v_p out1) <(column Press out1) | awk '{ d = $1 - $2; if (d < 0) d = -d; if (d > w) w = d }
        END { printf "pressure of atoms and of the box: %.3g\n", w; exit !(NR > 1 && w < 1e-10) }' || fail 'pressure of atoms'
    below 1e-10 v_net out1
    below 1e-10 v_net out4
    near 1e-7 "$(awk '{ s += $3 * $4 } END { printf "%.15g", s }' tensions4)" "$(column v_trace out4 | tail -n 1)" \
        'sum of tension and length, and the virial'
    paste tensions1 tensions4 | awk '{ d = $3 - $7; if (d < 0) d = -d; if (d > w) w = d; if ($1 != $5 || $2 != $6) bad = 1 }
        END { printf "tensions of %d bonds on one and four ranks: %.3g\n", NR, w; exit !(NR == 1240 && !bad && w < 1e-9) }' ||
        fail tensions
}

# Interrupted by a restart file, and by run after run.
restart() {
    "$SCENE" trimers 216 >data
    local motion="npt temp 1.0 1.0 0.5 iso 0.5 0.5 2.0"
    run 1 whole "$INPUTS/beads.lmp" data data rigid holonomic dt 0.003 steps 400 motion "$motion"
    run 1 parts "$INPUTS/beads.lmp" data data rigid holonomic dt 0.003 steps 200 motion "$motion" later "run 200"
    run 1 half "$INPUTS/beads.lmp" data data rigid holonomic dt 0.003 steps 200 motion "$motion" after "write_restart state"
    run 2 rest "$INPUTS/resume.lmp" state state motion "$motion"
    for part in parts rest; do
        near 1e-8 "$(column TotEng $part | tail -n 1)" "$(column TotEng whole | tail -n 1)" "energy, $part"
        near 1e-8 "$(column Press $part | tail -n 1)" "$(column Press whole | tail -n 1)" "pressure, $part"
    done
}

# The selectors of fix rattle: bonds of atom types, of masses, of a group; the same trajectories as with it.
selectors() {
    "$SCENE" stars 216 >data
    local select
    for select in "t 2" "t 1" "m 0.5" "m 7.0 t 2" "b 1"; do
        agree data data select "$select" light 0.5 dt 0.002 steps 200
        grep -q '216 molecules, 864 atoms, 648 rigid' holonomic || fail "$select: not all bonds"
    done
    # Of one group only: the others keep their bond style.
    agree data data light 0.5 dt 0.001 steps 200 before "group half molecule <= 100" whose half
    grep -q '100 molecules, 400 atoms, 300 rigid' holonomic || fail "not those of the group"
}

# Without the fix the bond style acts again, with the energy that it had before.
unfix() {
    "$SCENE" melt 8 16 >data
    run 1 plain "$INPUTS/beads.lmp" data data rigid none steps 50 dt 0.001 every 10
    run 1 left "$INPUTS/beads.lmp" data data rigid none steps 50 dt 0.001 every 10 \
        before "fix first all holonomic b 1" later "unfix first"
    same 1e-14 TotEng plain left
}

# Atoms that are held fixed stay where they are, and their chains hang on them.
fixed() {
    "$SCENE" melt 8 16 >data
    run 2 fixed "$INPUTS/beads.lmp" data data rigid holonomic dt 0.003 steps 1000 \
        before "include $INPUTS/held.lmp" motion "nve" more "fixed held" later "include $INPUTS/hold.lmp"
    below 1e-13 'f_rigid[1]' fixed
    below 1e-13 v_far fixed
    column TotEng fixed | awk 'NR == 1 { e = $1 } { d = $1 - e; if (d < 0) d = -d; if (d > w) w = d }
        END { printf "largest change of the energy per bead %.3g\n", w; exit !(NR > 5 && w < 2e-3) }' || fail energy
}

# A triclinic box gives the trajectory of the same molecules; a box that shears keeps the bonds.
triclinic() {
    "$SCENE" melt 16 32 >data
    run 1 right "$INPUTS/beads.lmp" data data rigid holonomic dt 0.003 steps 300
    run 2 tilted "$INPUTS/beads.lmp" data data rigid holonomic dt 0.003 steps 300 before "change_box all triclinic"
    same 1e-12 TotEng right tilted
    for remap in v x; do
        run 2 shear_$remap "$INPUTS/beads.lmp" data data rigid holonomic dt 0.003 steps 3000 before "change_box all triclinic" \
            later "fix d all deform 1 xy erate 0.05 remap $remap flip yes"  motion "$([ $remap = v ] && echo nvt/sllod || echo nvt) temp 1.0 1.0 0.5"
        below 1e-13 'f_rigid[1]' shear_$remap
        below 1e-12 'f_rigid[2]' shear_$remap
    done
    # A fluid that is sheared resists: both pictures of the motion give the same stress, within their noise.
    near 0.35 "$(mean Pxy shear_v)" "$(mean Pxy shear_x)" 'mean shear stress, remap v and x'
}

# Degrees of freedom, groups, Langevin dynamics: the temperature of a bath is reached.
langevin() {
    "$SCENE" waters 216 >data
    run 1 bath "$INPUTS/beads.lmp" data data rigid holonomic dt 0.003 steps 10000 every 50 more "a 1" \
        motion "nve" before "fix bath all langevin 1.0 1.0 0.5 4711" later "run 2000"
    near 0.02 "$(mean Temp bath)" 1 'mean temperature'
    below 1e-13 'f_rigid[1]' bath
}

# Positions of a dump give the same potential energy and pressure; a state without motion can be read again.
rerun() {
    "$SCENE" melt 8 16 >data
    run 1 first "$INPUTS/beads.lmp" data data rigid holonomic dt 0.003 steps 200 every 50 \
        later "include $INPUTS/dump.lmp"
    run 1 second "$INPUTS/beads.lmp" data data rigid holonomic dt 0.003 steps 0 every 50 \
        after "rerun trajectory.dump dump x y z vx vy vz"
    same 1e-10 PotEng first second
    same 1e-7 Press first second
}

# What is wrong is said, with the atoms concerned.
errors() {
    "$SCENE" melt 8 16 >data
    stops beads "respa" data data rigid holonomic before "run_style respa 2 2"
    stops beads "no bond type 7" data data rigid holonomic more "b 7"
    stops beads "no keyword" data data rigid holonomic more "colour 7"
    stops beads "molecule of atom 1 has 2 atoms, of which 1" data data rigid holonomic later "include $INPUTS/delete.lmp"
    stops beads "bond lengths can't be reached" data data rigid holonomic dt 0.5
    stops beads "no bond is selected" data data rigid holonomic before "delete_bonds all bond 1 remove"
    stops beads "molecule file nothing can't be read" data data rigid holonomic more "rigid nothing"
    stops beads "no molecule looks like" data data rigid holonomic select "rigid $INPUTS/co2.mol"
    "$SCENE" bent 8 180 >data
    stops beads "fixed" data data rigid holonomic select "rigid $INPUTS/co2.mol fixed held" before "include $INPUTS/held.lmp"
}

# fluid OUTPUT MOLECULE VARIABLE VALUE...
fluid() {
    local output=$1 molecule=$2 ranks=1
    shift 2
    case $output in *_on_*) ranks=${output##*_on_} ;; esac
    run "$ranks" "$output" "$INPUTS/fluid.lmp" INPUTS "$INPUTS" molecule "$molecule" "$@"
}

last() { column "$1" "$2" | tail -n 1; }

# Rigid molecules by a template: bodies MOLECULE SPACING. Fix rigid/small has the same trajectory, up to the second order of
# both integrators; energy and momentum hold, alone and with a barostat; ranks agree.
bodies() {
    local select="rigid $INPUTS/$1.mol" scene=(spacing "$2" select "rigid $INPUTS/$1.mol") half
    for half in 1 2; do
        fluid holonomic$half "$1" "${scene[@]}" steps $((50 * half)) every $((50 * half)) dt $((2 / half))
        fluid small$half "$1" "${scene[@]}" steps $((50 * half)) every $((50 * half)) dt $((2 / half)) rigid small
    done
    near 1e-9 "$(column TotEng holonomic1 | head -n 1)" "$(column TotEng small1 | head -n 1)" 'energy at the start'
    awk -v a="$(last PotEng holonomic1)" -v b="$(last PotEng small1)" -v c="$(last PotEng holonomic2)" -v d="$(last PotEng small2)" '
        BEGIN { q = (a - b) / (c - d); printf "difference to fix rigid/small: %.3g, %.3g in half steps, ratio %.3g\n", a - b, c - d, q
                exit !(q > 3.5 && q < 4.5) }' || fail 'not the trajectory of fix rigid/small'
    fluid nve "$1" "${scene[@]}" steps 400 every 20 before "write_data data nocoeff"
    column TotEng nve | awk 'NR == 1 { e = $1 } { d = $1 - e; if (d < 0) d = -d; if (d > w) w = d }
        END { printf "largest change of the energy %.3g\n", w; exit !(NR == 21 && w < 0.1) }' || fail energy
    below 1e-13 'f_rigid[1]' nve
    below 1e-13 'f_rigid[2]' nve
    below 1e-9 v_momentum nve
    fluid nve_on_2 "$1" "${scene[@]}" steps 400 every 20 data data
    same 1e-9 TotEng nve nve_on_2
    fluid npt "$1" "${scene[@]}" steps 400 every 20 motion "npt temp 320 320 100 iso 200 200 2000"
    below 1e-13 'f_rigid[1]' npt
    below 1e-13 'f_rigid[2]' npt
    below 1e-8 v_momentum npt
    column Econserve npt | awk 'NR == 1 { e = $1 } { d = $1 - e; if (d < 0) d = -d; if (d > w) w = d }
        END { printf "largest change of what the barostat conserves %.3g\n", w; exit !(NR == 21 && w < 0.5) }' || fail npt
    # Virials of atoms add up to the pressure.
    fluid parts "$1" select "$select forces 50 tensions 100" "${scene[@]}" steps 100 \
        before "compute s all stress/atom NULL fix" later "include $INPUTS/sums.lmp"
    paste <(column v_p parts) <(column Press parts) | awk '{ d = $1 - $2; if (d < 0) d = -d; if (d > w) w = d }
        END { printf "pressure of atoms and of the box: %.3g\n", w; exit !(NR > 1 && w < 1e-6) }' || fail 'pressure of atoms'
    below 1e-7 v_net parts
}

# water_file BOND DEGREES: a molecule file of waters as make_scene writes them.
water_file() {
    awk -v a="$1" -v angle="$2" 'BEGIN { angle *= atan2(0, -1) / 180
        printf "# water\n\n3 atoms\n\nCoords\n\n1 %.17g 0 0\n2 0 0 0\n3 %.17g %.17g 0\n\nTypes\n\n1 1\n2 2\n3 1\n", a, a * cos(angle), a * sin(angle) }'
}

# Which molecules a file's shape holds: the one that fits best; a warning and an error if none fits well; all as they stand
# without a file; molecules of an atom style that has no bonds.
shapes() {
    local n
    "$SCENE" waters 216 >data
    water_file 1.05 109.47 >right.mol
    water_file 1.06 109.47 >near.mol
    water_file 1.05 80 >bent.mol
    { sed '/^Types/q' right.mol; printf '\n1 1\n2 2\n3 2\n'; } >other.mol
    run 1 right "$INPUTS/atomic.lmp" data data select "rigid right.mol"
    grep -q 'largest displacement' right && [ "$(grep -c 'largest displacement' right)" -gt 0 ] && fail "a warning without a reason"
    run 2 best "$INPUTS/atomic.lmp" data data select "rigid other.mol rigid near.mol rigid bent.mol rigid right.mol"
    same 1e-12 TotEng right best
    run 1 warned "$INPUTS/atomic.lmp" data data select "rigid near.mol"
    # By hand: the molecule moves along its axis by a third of 2 x 0.01 cos(54.735 deg) at the ends, less at the middle.
    grep -q 'WARNING.* is 0.00[89][0-9]* from where the file near.mol has it, the largest displacement' warned || { grep WARN warned; fail "no warning"; }
    stops atomic 'molecule [0-9]* is 0.[12][0-9]* from where the file bent.mol has it' data data select "rigid bent.mol"
    for n in 1 2; do
        run $n stand$n "$INPUTS/atomic.lmp" data data select rigid
        same 1e-10 TotEng right stand$n
    done
    awk '/ (bonds|angles|bond types|angle types)$/ { next } /^Bonds/ { exit } /^Atoms/ { print "Atoms # atomic"; reading = 1; next }
        reading && NF { id[++n] = $1; molecule[n] = $2; print $1, $3, $4, $5, $6; next } { print }
        END { print "\nMolecules\n"; for (k = 1; k <= n; ++k) print id[k], molecule[k] }' data >data.atomic
    run 2 atomic "$INPUTS/atomic.lmp" data "data.atomic fix id NULL Molecules" style atomic select "rigid right.mol forces 10" \
        first "fix id all property/atom mol ghost yes"
    same 1e-10 TotEng right atomic
    below 1e-13 'f_rigid[1]' atomic
}

# Fix shake that holds bonds of the same atoms is told of, whichever comes first; that of other atoms is not.
beside() {
    local n ranks
    "$SCENE" trimers 125 >plain
    # Every other bond, or all of every other molecule, is of type 2.
    for n in 1 2; do
        awk -v n=$n '/bond types/ { $1 = 2 } /^Bonds/ { bonds = 1 } /^Angles/ { bonds = 0 }
            bonds && NF == 4 { $2 = 1 + int(($1 - 1) / n) % 2 } { print }' plain >data$n
        printf '%s\n' 'bond_coeff 2 100.0 1.05' "fix other all shake 1e-8 100 0 b 2" >other
        for ranks in 1 2; do
            run $ranks out "$INPUTS/beads.lmp" data data$n rigid holonomic dt 0.002 wide 3.5 before "include other" steps 1
            if [ $n = 1 ]; then
                grep 'WARNING.*Fix other (shake) holds bonds of atoms of fix rigid (holonomic), atom [0-9]* for one' out || fail "no warning"
            else
                grep 'holds bonds' out && fail "a warning without a reason"
            fi
        done
    done
    return 0
}

# Atoms on a line (CO2, acetylene) and all distances of five atoms (methane), by bonds and angles.
cliques() {
    fluid bonds co2 steps 100
    fluid template co2 steps 100 select "rigid $INPUTS/co2.mol"
    same 1e-10 TotEng bonds template
    same 1e-9 Press bonds template
    local scene
    for scene in "lines 180 5" "methanes 109.4712206344907 6"; do
        set -- $scene
        "$SCENE" "$1" 125 >data
        run 2 "$1" "$INPUTS/beads.lmp" data data rigid holonomic more "a 1" angle "$2" dt 0.002 steps 2000 norm no \
            before "special_bonds lj 0 0 0"
        below 1e-12 'f_rigid[1]' "$1"
        below 1e-12 'f_rigid[2]' "$1"
        column TotEng "$1" | awk 'NR == 1 { e = $1 } { d = $1 - e; if (d < 0) d = -d; if (d > w) w = d }
            END { printf "largest change of the energy per molecule %.3g\n", w / 125; exit !(NR == 21 && w / 125 < 2e-3) }' || fail energy
        run 1 start "$INPUTS/beads.lmp" data data rigid holonomic more "a 1" angle "$2" steps 1 every 1 norm no \
            before "special_bonds lj 0 0 0" later "include $INPUTS/freedom.lmp"
        near 1e-6 "$(column v_free start | head -n 1)" $((125 * $3 - 3)) 'degrees of freedom'
    done
}

# Rigid minima are what springs tend to as they stiffen: minimise RANKS STYLE SCENE ARGUMENTS_OF_THE_FIX. With springs of 1, 2
# and 4 times a strength the energies extrapolate to the third order of their softness.
minimise() {
    "$SCENE" $3 >data
    run "$1" out "$INPUTS/minimise.lmp" data data style "$2" select "$4"
    awk '/^rigid / { e = $2; f = $3; bond = $4 } /^springs / { s[n++] = $3; if ($4 > f) f = $4 }
        END { limit = (8 * s[2] - 6 * s[1] + s[0]) / 3; d = limit - e; if (d < 0) d = -d; soft = e - s[2]
              printf "minimum %.12g, of springs %.3g lower, extrapolated %.3g away; largest force %.3g, bond error %.3g\n", e, soft, d, f, bond
              exit !(n == 3 && soft > 1e-6 && d < 0.01 * soft && f < 1.1e-7 && bond < 1e-13) }' out || fail "not the springs' limit"
}

# A protein in water, LAMMPS's own example, is minimised and then runs: bonds of hydrogens, and water with its angle.
peptide() {
    run 2 out "$INPUTS/peptide.lmp" data "$1"
    awk '/^energies / { printf "energy %.9g, minimised %.9g\n", $2, $3; exit !($3 < $2 - 100) }' out || fail "not minimised"
    below 1e-12 'f_rigid[1]' out
    column TotEng out | awk 'NR == 1 { e = $1 } { d = $1 - e; if (d < 0) d = -d; if (d > w) w = d }
        END { printf "largest change of the energy in the run %.3g\n", w; exit !(NR == 6 && w < 5) }' || fail energy
}

# Bonds that fix bond/create makes are rigid from the step on in which they come; the molecules are those that a new run finds.
# Breaking flexible bonds moves entries in the lists of rigid ones: all of those stay, and act again after unfix.
react() {
    local n
    "$SCENE" dimers 343 >data
    for n in 1 2; do
        run $n create$n "$INPUTS/react.lmp" start "include $INPUTS/grow.lmp" later "include $INPUTS/on.lmp"
        # Bonds of the fix are those of LAMMPS's, and there are more than before.
        awk '/^ *Step /{ reading = 1; next } /^Loop/{ reading = 0 } reading { if (made == "" || $9 != $7) { bad = bad || $8 != 343 + $9; made = $9 } }
            END { printf "%d bonds made\n", made; exit bad || made < 20 }' create$n || fail "not all bonds are rigid"
        below 1e-12 'f_rigid[1]' create$n
        below 1e-12 'f_rigid[2]' create$n
    done
    same 1e-7 TotEng create1 create2
    # Only the molecules that change are found anew on the way; each run begins with all of them.
    run 1 create_long "$INPUTS/react.lmp" start "include $INPUTS/grow.lmp" steps 1000
    run 1 create_anew "$INPUTS/react.lmp" start "include $INPUTS/grow.lmp" steps "1000 every 100 NULL"
    near 1e-7 "$(last TotEng create_anew)" "$(last TotEng create_long)" 'energy, all found anew every hundred steps'
    run 1 fresh "$INPUTS/resume.lmp" state grown motion nve special "0 1 1"
    paste <(column TotEng create1 | tail -n 2) <(column TotEng fresh) | awk '{ d = $1 / $2 - 1; if (d < 0) d = -d; if (d > w) w = d }
        END { printf "going on and starting anew: %.3g\n", w; exit !(NR == 2 && w < 1e-9) }' || fail "a new run differs"

    run 2 come "$INPUTS/react.lmp" INPUTS "$INPUTS" start "include $INPUTS/come.lmp" steps 600
    awk '/^ *Step /{ reading = 1; next } /^Loop/{ reading = 0 } reading && $1 ~ /^[0-9]+$/ { bad = bad || 2 * $7 != $8; least = least == "" || $8 < least ? $8 : least
        ++n } END { printf "from 686 to %d atoms\n", least; exit bad || n != 7 || least > 660 }' come || fail "molecules are missing"
    below 1e-12 'f_rigid[1]' come
    below 1e-12 'f_rigid[2]' come

    # The same by commands between runs, on any number of ranks.
    for n in 1 2; do
        run $n swap$n "$INPUTS/react.lmp" INPUTS "$INPUTS" start "fix rigid all holonomic b 1" steps 200 later "include $INPUTS/swap.lmp"
        awk '/^swapped /{ printf "%d dimers, %d with one that came\n", $2, $3; ok = $2 < 343 && $2 > 300 && $3 == $2 + 1 } END { exit !ok }' swap$n ||
            fail "not all molecules are there"
        below 1e-12 'f_rigid[1]' swap$n
        below 1e-12 'f_rigid[2]' swap$n
    done
    same 1e-10 TotEng swap1 swap2

    "$SCENE" melt 16 16 >data
    run 2 break "$INPUTS/react.lmp" start "include $INPUTS/cut.lmp" later "include $INPUTS/uncut.lmp" steps 1000 dt 0.001
    awk 'FNR == 1 { ++file }
        file == 1 && /^ITEM: / { types = /ENTRIES/; if (types) sum = 0; next }
        file == 1 && types { sum += $1 }
        file == 2 && /^broken / { printf "%d bonds of 48 broken, %d rigid, sum of types after unfix %d\n", $2, $3, sum
            ok = $2 > 5 && $3 == 192 && sum == 192 + 2 * (48 - $2) && $4 < 1e-12 } END { exit !ok }' types.dump break ||
        fail "rigid bonds were lost"
}

# Fix bond/react, which changes types besides, and by which LAMMPS joins dimers to chains of four. What it chooses depends on
# the number of ranks.
bond_react() {
    local n
    "$SCENE" dimers 343 >data
    for n in 1 2 4; do
        lammps $n join$n "$INPUTS/react.lmp" INPUTS "$INPUTS" start "include $INPUTS/join.lmp" steps 1000
        if grep -q "fix style 'bond/react'" join$n; then
            echo "this LAMMPS has no fix bond/react"
            exit 77
        fi
        grep -q '^Loop time' join$n || fail "LAMMPS stopped"
        awk '/^ *Step /{ reading = 1; next } /^Loop/{ reading = 0 } reading && $1 ~ /^[0-9]+$/ { ++n; bad = bad || $7 != 343 - $9 || $8 != 343 + $9; made = $9 }
            END { printf "%d bonds made\n", made; exit bad || n != 11 || made < 50 }' join$n || fail "molecules or bonds are missing"
        below 1e-12 'f_rigid[1]' join$n
        below 1e-12 'f_rigid[2]' join$n
    done
    run 1 join_anew "$INPUTS/react.lmp" INPUTS "$INPUTS" start "include $INPUTS/join.lmp" steps "400 every 100 NULL"
    near 1e-7 "$(last TotEng join_anew)" "$(column TotEng join1 | sed -n 5p)" 'energy, all found anew every hundred steps'
}

# Velocities of a molecule across the boundary are on the constraints as those of one inside are; what fix rattle makes of the
# same input is said, for it depends on the release.
boundary() {
    local n
    for n in 1 2; do
        run $n out "$INPUTS/rattle_boundary.lmp" rigid "holonomic b 1"
        awk '/^d.v of/ { printf "holonomic: %s\n", $0; ok = $6 * $6 < 1e-24 && $10 * $10 < 1e-24 } END { exit !ok }' out || fail "velocities along bonds"
    done
    run 1 out "$INPUTS/rattle_boundary.lmp"
    grep '^d.v of' out
}
