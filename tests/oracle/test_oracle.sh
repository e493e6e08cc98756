#!/usr/bin/env bash
# scripts/oracle accepts what is right, also files that are not in the tree, and rejects what is not.
#   test_oracle.sh TOP BUILD MAKE_CASE CHECK_ORACLE MAKE_MOLECULE
set -u
top=$1 build=$2 make_case=$3 checker=$4 make_molecule=$5
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
failures=0

complain() { printf 'FAILED: %s\n' "$*"; failures=$((failures + 1)); }

# expect STATUS WORDS DIR GOT: the exit status and what the output must contain
expect() {
    local status=$4
    [ "$status" -eq "$1" ] || { complain "status $status instead of $1 for $3"; tail -n 5 "$work/out"; }
    grep -q -- "$2" "$work/out" || { complain "no '$2' in the output for $3"; tail -n 5 "$work/out"; }
}

# The whole script, and the program that it runs.
run() { BUILD_DIR=$build "$top/scripts/oracle" "$3" >"$work/out" 2>&1; expect "$@" $?; }
check() { "$checker" "$3" >"$work/out" 2>&1; expect "$@" $?; }

fresh() { rm -rf "$work/$1"; cp -r "$top/tests/oracle" "$work/$1"; echo coil_n005.txt >"$work/$1/INDEX"; }

run 0 '^oracle: 26 cases, worst ratio 0\.' "$top/tests/oracle"
[ "$failures" -eq 0 ] || exit 1
for quantity in lambda G virial lndet fixman_energy 'Fixman force' zinv; do
    grep -q "^coil_n016 .*$quantity .*ok\$" "$work/out" || complain "no line for $quantity"
done

# Files of the same format that nobody has seen before: all kinds of chains, short and long.
mkdir "$work/new"
for kind in 0 1 2 3 4 5 6 7 8 9 10 11 12; do
    for size in 3 19 150; do
        "$make_case" "$work/new" "$kind" "$size" "$((kind + size))" || complain "make_case $kind $size"
    done
done
for size in 1 2 1000; do "$make_case" "$work/new" 1 "$size" 5 || complain "make_case 1 $size"; done
check 0 '^oracle: 42 cases, worst ratio 0\.' "$work/new"
tail -n 1 "$work/out"

# One number wrong by 1e-9 of itself, in each quantity: spoil QUANTITY FIRST_LINE ROW FIELD changes field FIELD of the first
# line that begins with ROW at or after the one that begins with FIRST_LINE.
spoil() {
    fresh spoilt
    awk -v first="$2" -v row="$3" -v field="$4" '
        index($0, first) == 1 { inside = 1 }
        inside && !done && (index($0, row " ") == 1) { $field = sprintf("%.17e", $field * (1 + 1e-9)); done = 1 }
        { print }' "$top/tests/oracle/coil_n005.txt" >"$work/spoilt/coil_n005.txt"
    cmp -s "$work/spoilt/coil_n005.txt" "$top/tests/oracle/coil_n005.txt" && complain "the reference for $1 was not changed"
    check 1 "^coil_n005  *$1 .*OUT OF BOUND" "$work/spoilt"
    [ "$(grep -c 'OUT OF BOUND' "$work/out")" -eq 1 ] || complain "a wrong $1 spoils other quantities"
    tail -n 1 "$work/out" | grep -q '^oracle: 1 cases, worst ratio [1-9]' || complain "no last line after a failure in $1"
}
spoil lndet lndet lndet 2
spoil fixman_energy fixman_energy fixman_energy 2
spoil virial virial virial 4
spoil lambda bonds_out 2 2
spoil G atoms_out 3 4
spoil 'Fixman force' atoms_out 2 6
spoil zinv zinv '1 2' 3
run 1 'zinv .*OUT OF BOUND' "$work/spoilt"
# a reference beside a scale of zero must be met exactly: lambda of a chain at rest
fresh zero
echo zero_n008.txt >"$work/zero/INDEX"
check 0 'lambda .* 0 of .* ok' "$work/zero"
sed -i '/^bonds_out/,/^atoms_out/{s/^3 0.0 0.0/3 1.0e-300 0.0/}' "$work/zero/zero_n008.txt"
check 1 'lambda .*OUT OF BOUND' "$work/zero"

# The format of molecules of any shape (tests/oracle/molecules/README.md).
check 0 '^oracle: 23 cases, worst ratio 0\.' "$top/tests/oracle/molecules"
[ "$(grep -c '^refused.*refused' "$work/out")" -eq 1 ] || complain 'the degenerate molecule is not refused'
[ "$(grep -c '^refused.*a rigid body' "$work/out")" -eq 3 ] || complain 'three lists of distances are no rigid bodies'

# What is zero by symmetry is judged by the scale beside it, either way.
cp -r "$top/tests/oracle/molecules" "$work/symmetric"
echo naphthalene_n001_1.txt >"$work/symmetric/INDEX"
out_of_plane() { # NUMBER: the reference of an atom's Fixman force across the plane, 0.0
    awk -v to="$1" '/^atoms_out/ { inside = 1 } inside && !done && /^2 / { $8 = to; done = 1 } { print }' \
        "$top/tests/oracle/molecules/naphthalene_n001_1.txt" >"$work/symmetric/naphthalene_n001_1.txt"
}
awk '/^atoms_out/ { inside = 1 } inside && /^2 / { exit $8 != "0.0" }' "$top/tests/oracle/molecules/naphthalene_n001_1.txt" ||
    complain 'the Fixman force across the plane of naphthalene is not zero in the file'
out_of_plane 1.0e-34
check 0 'Fixman force .*ok' "$work/symmetric"
out_of_plane 1.0e-12
check 1 'Fixman force .*OUT OF BOUND' "$work/symmetric"

# A linear chain in it, alone and among the others.
mkdir "$work/molecule"
"$make_molecule" "$work/molecule" 0 9 1 || complain "make_molecule 0 9 1"
molecule=chain_n009_1
check 0 '^oracle: 1 cases, worst ratio 0\.' "$work/molecule"
for quantity in lambda G virial mu 'projected v' positions 'lambda (r)' 'bonds left' lndet lndetz fixman_energy 'Fixman force'; do
    grep -q "^$molecule .*$quantity .*ok\$" "$work/out" || complain "no line for $quantity of a molecule"
done
fresh mixed && cp "$work/molecule/$molecule.txt" "$work/mixed/" && echo "$molecule.txt" >>"$work/mixed/INDEX"
check 0 '^oracle: 2 cases, worst ratio 0\.' "$work/mixed"

# As spoil, in a file of the new format; multipliers of positions carry fewer digits, which a fifth argument says.
spoil_molecule() {
    rm -rf "$work/spoilt" && cp -r "$work/molecule" "$work/spoilt"
    awk -v first="$2" -v row="$3" -v field="$4" -v part="${5:-1e-9}" '
        index($0, first) == 1 && (first !~ /^#/ || $0 == first) { inside = 1 }
        inside && !done && (index($0, row " ") == 1) { $field = sprintf("%.17e", $field * (1 + part)); done = 1 }
        { print }' "$work/molecule/$molecule.txt" >"$work/spoilt/$molecule.txt"
    cmp -s "$work/spoilt/$molecule.txt" "$work/molecule/$molecule.txt" && complain "the reference for $1 was not changed"
    check 1 "^$molecule  *$1 .*OUT OF BOUND" "$work/spoilt"
    [ "$(grep -c 'OUT OF BOUND' "$work/out")" -eq 1 ] || complain "a wrong $1 spoils other quantities"
}
spoil_molecule lndet lndet lndet 2
spoil_molecule lndetz lndetz lndetz 2
spoil_molecule fixman_energy fixman_energy fixman_energy 2
spoil_molecule virial virial virial 4
spoil_molecule lambda bonds_out 3 2
spoil_molecule mu bonds_out 3 4
spoil_molecule G atoms_out 3 3
spoil_molecule 'Fixman force' atoms_out 4 7
spoil_molecule 'projected v' atoms_out 5 10
spoil_molecule positions positions 6 6
spoil_molecule 'lambda (r)' '# k lambda lambda_scale' 7 2 1e-3
# one that must be refused, and is not
sed -e 's/^expect ok/expect degenerate/' -e '/^lndet/,$d' "$work/molecule/$molecule.txt" >"$work/spoilt/$molecule.txt"
echo end >>"$work/spoilt/$molecule.txt"
check 1 'should be refused' "$work/spoilt"
sed '/^positions/,$d' "$work/molecule/$molecule.txt" >"$work/spoilt/$molecule.txt"
check 2 "$molecule.txt, line .*the file ends too early" "$work/spoilt"
{ cat "$work/spoilt/$molecule.txt"; printf 'positions none\nend\n'; } >"$work/spoilt/whole" && mv "$work/spoilt/whole" "$work/spoilt/$molecule.txt"
check 0 '^oracle: 1 cases, worst ratio 0\.' "$work/spoilt"
sed -i 's/^class tree/class bush/' "$work/spoilt/$molecule.txt"
check 2 "line .*expected 'tree' or 'cyclic'" "$work/spoilt"

# Files that can't be read.
run 2 'there is no folder' "$work/nowhere"
mkdir "$work/empty"
run 2 'no readable file INDEX' "$work/empty"
: >"$work/empty/INDEX"
check 2 'lists no case' "$work/empty"
echo missing.txt >"$work/empty/INDEX"
check 2 'missing.txt: No such file' "$work/empty"
fresh cut && sed -i '30,$d' "$work/cut/coil_n005.txt"
check 2 'coil_n005.txt, line .*the file ends too early' "$work/cut"
fresh word && sed -i 's/^bonds_out/bonds_uot/' "$work/word/coil_n005.txt"
check 2 "line .*expected 'bonds_out'" "$work/word"
fresh number && sed -i 's/^lndet .*/lndet nan/' "$work/number/coil_n005.txt"
check 2 'line .*not finite' "$work/number"
fresh text && sed -i 's/^lndet .*/lndet none/' "$work/text/coil_n005.txt"
check 2 'line .*expected a number' "$work/text"
fresh size && sed -i 's/^nbonds .*/nbonds 4/' "$work/size/coil_n005.txt"
check 2 'coil_n005.txt, line ' "$work/size"
fresh size && sed -i 's/^nbonds .*/nbonds -4/' "$work/size/coil_n005.txt"
check 2 'out of range' "$work/size"
"$top/scripts/oracle" a b >"$work/out" 2>&1
[ $? -eq 2 ] || complain "two arguments are not refused"

[ "$failures" -eq 0 ] && echo "all as expected"
[ "$failures" -eq 0 ]
