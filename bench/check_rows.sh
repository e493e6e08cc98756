#!/bin/sh
# Fails if rows that the comparison owes are missing from a results.csv, and says which.
#   check_rows.sh RESULTS.CSV [quick]
# Rows of packages that this machine lacks (LAPACK, OpenMM) and of a second core are only asked for if there are any.
awk -F, -v quick="${2:-}" '
    function has(level, problem, chains, bonds, threads, method, setting) {
        return (level "," problem "," chains "," bonds "," threads "," method "," setting) in row
    }
    function demand(level, problem, size, threads, method, setting,   part) {
        if (method ~ /^lapack|^milc/ && !any["lapack-dptsv"]) return
        if (method == "openmm-ccma" && !any[method]) return
        if (threads > 1 && !two) return
        split(size, part, "x")
        if (has(level, problem, part[1], part[2], threads, method, setting)) return
        printf "missing: %s, %s, %s, %s threads, %s, %s\n", level, problem, size, threads, method, setting
        ++missing
    }
    # Each setting of a list with semicolons.
    function demand_each(level, problem, size, method, settings,   list, i) {
        for (i = split(settings, list, ";"); i > 0; --i) demand(level, problem, size, 1, method, list[i])
    }
    function own(level, problem, size,   part) {
        demand(level, problem, size, 1, "holonomic", "default")
        split(size, part, "x")
        if (level != "solve" && !(quick && part[1] * part[2] < 1000)) demand(level, problem, size, 2, "holonomic", "default")
    }
    function direct(level, problem, size, setting,   part, n, all) {
        split(size, part, "x")
        n = part[2]; all = part[1] * part[2]
        demand(level, problem, size, 1, "lapack-dptsv", setting ? setting : "assembled")
        demand(level, problem, size, 1, "lapack-dgtsv", setting ? setting : "assembled")
        demand(level, problem, size, 1, "omega-recursion", setting ? setting : "as printed")
        if (n <= 100000) demand(level, problem, size, 1, "eigen-simplicial", setting ? setting : "pattern reused")
        if (n <= 100 && all <= 100000) demand(level, problem, size, 1, "eigen-ldlt", setting ? setting : "dense")
        if (n <= 1000 && all <= 100000) demand(level, problem, size, 1, "eq20", setting ? setting : "literal")
    }
    function acceleration(problem, size) {
        own("acceleration", problem, size)
        direct("acceleration", problem, size)
        demand("acceleration", problem, size, 1, "omega-recursion", "unscaled scalar sweep")
    }
    function velocity(problem, size,   part) {
        own("velocity", problem, size)
        direct("velocity", problem, size)
        split(size, part, "x")
        if ((part[1] == 1 && part[2] > 10000) || part[1] * part[2] > 100000 || (problem == "straight5" && part[2] > 100)) return
        demand_each("velocity", problem, size, "rattle", quick ? "tolerance 1e-06" : "tolerance 1e-06;tolerance 1e-09;tolerance 1e-12")
        if (problem != "fixed_ends" && part[1] * part[2] <= 3000)
            demand_each("velocity", problem, size, "openmm-ccma", "tolerance 1e-06;tolerance 1e-10")
    }
    function position(problem, size,   part) {
        own("position", problem, size)
        demand_each("position", problem, size, "rattle", "tolerance 1e-06;tolerance 1e-12")
        demand_each("position", problem, size, "milc-shake", "tolerance 1e-06;tolerance 1e-12")
        demand_each("position", problem, size, "sparse-newton", "tolerance 1e-06;tolerance 1e-12")
        demand_each("position", problem, size, "lincs", "order 4 iterations 1;order 8 iterations 4")
        split(size, part, "x")
        if (part[1] * part[2] <= (quick ? 7000 : 8200))
            demand_each("position", problem, size, "openmm-ccma", "tolerance 1e-06;tolerance 1e-10;tolerance 1e-06 exact angles;tolerance 1e-10 exact angles")
    }
    function accuracy(problem, size,   range, lincs) {
        range = quick ? "tolerance 1e-04;tolerance 1e-08;tolerance 1e-12" : "tolerance 1e-04;tolerance 1e-06;tolerance 1e-08;tolerance 1e-10;tolerance 1e-12"
        own("position", problem, size)
        demand_each("position", problem, size, "holonomic", range)
        demand_each("position", problem, size, "rattle", range)
        demand_each("position", problem, size, "milc-shake", range)
        demand_each("position", problem, size, "sparse-newton", range)
        lincs = "order 4 iterations 1;order 4 iterations 2;order 4 iterations 4;order 8 iterations 1;order 8 iterations 2;order 8 iterations 4"
        demand_each("position", problem, size, "lincs", lincs ";order 12 iterations 1;order 12 iterations 2;order 12 iterations 4")
        if (problem != "fixed_ends")
            demand_each("position", problem, size, "openmm-ccma", "tolerance 1e-04;tolerance 1e-10;tolerance 1e-04 exact angles;tolerance 1e-10 exact angles")
    }
    function metric(problem, size,   part) {
        own("metric", problem, size)
        split(size, part, "x")
        if (part[2] <= 100) demand("metric", problem, size, 1, "eigen-ldlt", "log_det alone")
        demand("metric", problem, size, 1, "eigen-simplicial", "log_det alone")
        demand("metric", problem, size, 1, "omega-recursion", "log_det alone")
    }
    function solve(problem, size) {
        own("solve", problem, size)
        direct("solve", problem, size, "matrix given")
    }
    function skips(size,   i, level) {
        for (i = split("acceleration velocity position metric", level, " "); i > 0; --i) {
            own(level[i], "melt", size)
            demand_each(level[i], "melt", size, "holonomic", "half inactive;all inactive;box orthorhombic;box triclinic;view of the plain layout;x y z apart;padded to four doubles;float view;index list;two dimensions;general masses;general lengths;general masses and lengths;every 10th atom fixed;orthogonal neighbours;HOLONOMIC_ISA=baseline")
            if (level[i] != "position") demand(level[i], "light_joints", size, 1, "holonomic", "compensated arithmetic")
        }
        demand_each("acceleration", "melt", size, "holonomic", "v = NULL;f = NULL;v = NULL and f = NULL;no lambda;no g;tension too;virial too;g added to;all outputs in one call;all outputs by separate calls")
        demand_each("velocity", "melt", size, "holonomic", "no lambda;virial too")
        demand_each("position", "melt", size, "holonomic", "v = NULL;no lambda;r alone;virial too;guess;already satisfied")
        demand_each("metric", "melt", size, "holonomic", "log_det alone;outputs by separate calls")
    }
    # Of molecules the sizes are what comes of their kinds: any will do.
    function molecule(level, problem, method, settings,   list, i) {
        if (method == "openmm" && !any[method]) return
        for (i = split(settings, list, ";"); i > 0; --i)
            if (!((level "," problem "," method "," list[i]) in of_any_size)) {
                printf "missing: %s, %s, %s, %s\n", level, problem, method, list[i]
                ++missing
            }
    }
    function molecules(problem,   i, level) {
        for (i = split("acceleration velocity position", level, " "); i > 0; --i) {
            molecule(level[i], problem, "holonomic", "default;bonds in any order;chains instead")
            if (level[i] == "position") continue
            molecule(level[i], problem, "sparse-ldl", "pattern reused")
            molecule(level[i], problem, "eigen-simplicial", "pattern reused")
        }
        molecule("velocity", problem, "rattle", "tolerance 1e-06;tolerance 1e-12")
        for (i = split("rattle sparse-newton quasi-newton", level, " "); i > 0; --i)
            molecule("position", problem, level[i], "tolerance 1e-06;tolerance 1e-12")
        molecule("position", problem, "lincs", "order 4 iterations 1;order 8 iterations 4")
        if (problem != "water") return
        molecule("velocity", problem, "settle", "default")
        molecule("position", problem, "settle", "default")
        molecule("velocity", problem, "openmm", "tolerance 1e-06;tolerance 1e-10")
        molecule("position", problem, "openmm", "tolerance 1e-06;tolerance 1e-10")
    }
    function adding(problem) {
        molecule("setup", problem, "holonomic", "bonds in order;as molecules;bonds in any order;bonds and atoms in any order")
    }
    NR > 1 {
        of_any_size[$1 "," $2 "," $6 "," $7] = 1
        row[$1 "," $2 "," $3 "," $4 "," $5 "," $6 "," $7] = 1
        any[$6] = 1
        if ($5 > 1) two = 1
        if ($7 ~ /^condition/) conditions[$6]++
        if ($7 ~ /^energy drift/) drifts++
    }
    END {
        many = split(quick ? "1 3 100 1000 10000" : "1 2 3 4 5 10 32 100 1000 10000 100000 1000000", n, " ")
        for (i = 1; i <= many; ++i) {
            acceleration("coil", "1x" n[i])
            velocity("coil", "1x" n[i])
            position("coil", "1x" n[i])
            solve("coil", "1x" n[i])
            if (n[i] >= 2 && n[i] <= 1000) metric("coil", "1x" n[i])
        }
        many = split(quick ? "10000x3 256x32 1000x100" : "100000x1 10000x3 100000x3 256x32 1000x100 10000x100", n, " ")
        for (i = 1; i <= many; ++i) {
            acceleration("melt", n[i])
            velocity("melt", n[i])
            position("coil", n[i])
            if (n[i] !~ /x1$/) metric("melt", n[i])
        }
        many = split(quick ? "light_joints:16x100 straight5:4x100" : "straight5:64x100 light_joints:64x100 tetrahedral:64x100 fixed_ends:64x100", n, " ")
        for (i = 1; i <= many; ++i) {
            split(n[i], what, ":")
            acceleration(what[1], what[2])
            velocity(what[1], what[2])
            metric(what[1], what[2])
            accuracy(what[1], what[2])
            if (!quick) solve(what[1], "1x100")
        }
        accuracy("coil", quick ? "16x100" : "64x100")
        skips("1000x100")
        if (!quick) {
            skips("10000x3")
            skips("10000x100")
            acceleration("straight5", "1x1000")
            acceleration("straight5", "1x1000000")
            demand("acceleration", "straight5", "1x1000000", 1, "holonomic", "truly straight")
            demand("acceleration", "straight5", "1x1000000", 2, "holonomic", "truly straight")
        }
        for (i = split("holonomic omega-recursion lapack-dptsv eigen-ldlt", n, " "); i > 0; --i)
            if (conditions[n[i]] < (quick ? 8 : 15) && (n[i] !~ /lapack/ || any[n[i]])) {
                printf "missing: condition numbers, %s\n", n[i]
                ++missing
            }
        for (i = split("water hydrogens dodecane dendrimer comb brush ring triangles arms random_tree protein", n, " "); i > 0; --i)
            molecules(n[i])
        for (i = split("coil random_tree water", n, " "); i > 0; --i) adding(n[i])
        if (drifts < (quick ? 5 : 7)) { printf "missing: energy drifts\n"; ++missing }
        if (missing) printf "%d rows are missing\n", missing
        exit missing > 0
    }' "$1"
