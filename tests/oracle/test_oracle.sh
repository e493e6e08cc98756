#!/usr/bin/env bash
# scripts/oracle accepts what is right, also files that are not in the tree, and rejects what is not.
#   test_oracle.sh TOP BUILD MAKE_CASE
set -u
top=$1 build=$2 make_case=$3
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
failures=0

complain() { printf 'FAILED: %s\n' "$*"; failures=$((failures + 1)); }

# run STATUS WORDS DIR: the exit status and what the output must contain
run() {
    local status
    BUILD_DIR=$build "$top/scripts/oracle" "$3" >"$work/out" 2>&1
    status=$?
    [ "$status" -eq "$1" ] || { complain "status $status instead of $1 for $3"; tail -n 5 "$work/out"; }
    grep -q -- "$2" "$work/out" || { complain "no '$2' in the output for $3"; tail -n 5 "$work/out"; }
}

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
run 0 '^oracle: 42 cases, worst ratio 0\.' "$work/new"
tail -n 1 "$work/out"

# One digit wrong in a reference, in each quantity.
spoil() {
    fresh spoilt
    sed -i "$2" "$work/spoilt/coil_n005.txt"
    cmp -s "$work/spoilt/coil_n005.txt" "$top/tests/oracle/coil_n005.txt" && complain "the reference for $1 was not changed"
    run 1 "$1 .*OUT OF BOUND" "$work/spoilt"
    grep -q '^oracle: 1 cases, worst ratio ' "$work/out" || complain "no last line after a failure in $1"
}
change='s/\([0-9]\.[0-9]\{9\}\)[0-4]/\15/; t; s/\([0-9]\.[0-9]\{9\}\)[5-9]/\11/'
spoil lndet "/^lndet/{$change}"
spoil fixman_energy "/^fixman_energy/{$change}"
spoil virial "/^virial/{$change}"
spoil lambda "/^bonds_out/,/^atoms_out/{/^2 /{$change}}"
spoil ' G ' "/^atoms_out/,/^zinv/{/^3 /{$change}}"
spoil zinv "/^zinv/,/^end/{/^1 2 /{$change}}"
# a reference of exactly zero must be met exactly: lambda of a chain at rest
fresh zero
echo zero_n008.txt >"$work/zero/INDEX"
sed -i '/^bonds_out/,/^atoms_out/{s/^3 0.0 0.0/3 1.0e-300 0.0/}' "$work/zero/zero_n008.txt"
run 1 'lambda .*OUT OF BOUND' "$work/zero"

# Files that can't be read.
run 2 'there is no folder' "$work/nowhere"
mkdir "$work/empty"
run 2 'no readable file INDEX' "$work/empty"
: >"$work/empty/INDEX"
run 2 'lists no case' "$work/empty"
echo missing.txt >"$work/empty/INDEX"
run 2 'missing.txt: No such file' "$work/empty"
fresh cut && sed -i '30,$d' "$work/cut/coil_n005.txt"
run 2 'coil_n005.txt, line .*the file ends too early' "$work/cut"
fresh word && sed -i 's/^bonds_out/bonds_uot/' "$work/word/coil_n005.txt"
run 2 "line .*expected 'bonds_out'" "$work/word"
fresh number && sed -i 's/^lndet .*/lndet nan/' "$work/number/coil_n005.txt"
run 2 'line .*not finite' "$work/number"
fresh text && sed -i 's/^lndet .*/lndet none/' "$work/text/coil_n005.txt"
run 2 'line .*expected a number' "$work/text"
fresh size && sed -i 's/^nbonds .*/nbonds 4/' "$work/size/coil_n005.txt"
run 2 'coil_n005.txt, line ' "$work/size"
fresh size && sed -i 's/^nbonds .*/nbonds -4/' "$work/size/coil_n005.txt"
run 2 'out of range' "$work/size"
"$top/scripts/oracle" a b >"$work/out" 2>&1
[ $? -eq 2 ] || complain "two arguments are not refused"

[ "$failures" -eq 0 ] && echo "all as expected"
[ "$failures" -eq 0 ]
