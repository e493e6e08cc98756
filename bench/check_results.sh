#!/bin/sh
# Runs every section of the comparison in its smallest form and checks what it leaves: columns, vocabulary, and that every
# number is one. Nothing is asked of the times.
#   check_results.sh BENCH_HOLONOMIC BENCH_REPORT WORK_FOLDER
set -eu
rm -rf "$3"
mkdir -p "$3"
"$1" --tiny --out "$3"
awk -F, '
    function bad(why) { printf "line %d: %s: %s\n", NR, why, $0; failed = 1 }
    BEGIN { molecules = "water hydrogens dodecane dendrimer comb brush ring triangles arms random_tree protein" }
    function among(x, list) { return index(" " list " ", " " x " ") > 0 }
    NR == 1 {
        if ($0 != "level,problem,chains,bonds,threads,method,setting,error,ns_per_bond,memory_passes") bad("head")
        next
    }
    NF != 10 { bad("ten columns expected"); next }
    !among($1, "acceleration velocity position metric solve setup") { bad("level") }
    !among($2, "coil tetrahedral straight5 light_joints fixed_ends melt") && !among($2, molecules) { bad("problem") }
    $3 !~ /^[1-9][0-9]*$/ || $4 !~ /^[1-9][0-9]*$/ || $5 !~ /^[1-9][0-9]*$/ { bad("chains, bonds, threads") }
    !among($6, "holonomic openmm-ccma lapack-dptsv lapack-dgtsv eigen-ldlt eigen-simplicial rattle milc-shake lincs sparse-newton eq20 omega-recursion") &&
        !among($6, "openmm settle quasi-newton sparse-ldl") { bad("method") }
    $7 == "" { bad("setting") }
    $8 !~ /^(inf|[0-9.]+(e[-+]?[0-9]+)?)$/ { bad("error") }
    $9 + 0 <= 0 || $10 + 0 <= 0 { bad("time") }
    { levels[$1]++; methods[$6]++; if ($6 == "holonomic" && $7 == "default") whole[$1]++ }
    END {
        for (i = split("acceleration velocity position metric solve", names, " "); i > 0; --i) {
            if (!levels[names[i]]) { printf "no row of level %s\n", names[i]; failed = 1 }
            if (!whole[names[i]]) { printf "no default row of the library at level %s\n", names[i]; failed = 1 }
        }
        for (i = split("holonomic eigen-ldlt eigen-simplicial rattle lincs sparse-newton eq20 omega-recursion settle quasi-newton sparse-ldl", names, " "); i > 0; --i)
            if (!methods[names[i]]) { printf "no row of method %s\n", names[i]; failed = 1 }
        printf "%d rows\n", NR - 1
        exit failed
    }' "$3/results.csv"
# A page's blocks are replaced, and only they.
printf 'before\n<!-- bench glance -->\nold\n<!-- end -->\nafter\n' >"$3/page.md"
"$2" "$3" "$3/page.md"
grep -q '^## Where another method is faster' "$3/report.md"
grep -q '^| work' "$3/page.md"
grep -q '^before' "$3/page.md"
grep -q '^after' "$3/page.md"
if grep -q '^old' "$3/page.md"; then
    echo "the block was not replaced"
    exit 1
fi
