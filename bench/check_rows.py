#!/usr/bin/env python3
"""Fails if rows that the comparison owes are missing from a results.csv, and says which.

    check_rows.py RESULTS.CSV [quick]

Rows of packages that this machine lacks (LAPACK, OpenMM) and of a second core are only asked for if there are any."""
import sys

quick = len(sys.argv) > 2
with open(sys.argv[1]) as results:
    # level, problem, chains, bonds, threads, method, setting
    rows = {tuple(line.rstrip("\n").split(",")[:7]) for line in results.readlines()[1:]}
methods = {row[5] for row in rows}
two = any(int(row[4]) > 1 for row in rows)
of_any_size = {row[:2] + row[5:] for row in rows}
missing = 0


def miss(*what):
    global missing
    print("missing:", ", ".join(what))
    missing += 1


def here(method):
    package = "lapack-dptsv" if method.startswith(("lapack", "milc")) else method
    return not method.startswith(("lapack", "milc", "openmm")) or package in methods


def demand(level, problem, size, method, settings, threads=1):
    """Each setting of a list with semicolons."""
    if not here(method) or (threads > 1 and not two):
        return
    for setting in settings.split(";"):
        if (level, problem, *size.split("x"), str(threads), method, setting) not in rows:
            miss(level, problem, size, f"{threads} threads", method, setting)


def numbers(size):
    chains, bonds = map(int, size.split("x"))
    return chains, bonds, chains * bonds


def tolerances(*digits, more=("",)):
    return ";".join(f"tolerance 1e-{n:02}{words}" for n in digits for words in more)


def own(level, problem, size):
    demand(level, problem, size, "holonomic", "default")
    if level != "solve" and not (quick and numbers(size)[2] < 1000):
        demand(level, problem, size, "holonomic", "default", threads=2)


def direct(level, problem, size, setting=None):
    own(level, problem, size)
    _, n, every = numbers(size)
    for method, usual, possible in (
            ("lapack-dptsv", "assembled", True), ("lapack-dgtsv", "assembled", True), ("omega-recursion", "as printed", True),
            ("eigen-simplicial", "pattern reused", n <= 100000), ("eigen-ldlt", "dense", n <= 100 and every <= 100000),
            ("eq20", "literal", n <= 1000 and every <= 100000)):
        if possible:
            demand(level, problem, size, method, setting or usual)


def acceleration(problem, size):
    direct("acceleration", problem, size)
    demand("acceleration", problem, size, "omega-recursion", "unscaled scalar sweep")


def velocity(problem, size):
    direct("velocity", problem, size)
    chains, n, every = numbers(size)
    if (chains == 1 and n > 10000) or every > 100000 or (problem == "straight5" and n > 100):
        return
    demand("velocity", problem, size, "rattle", tolerances(6) if quick else tolerances(6, 9, 12))
    if problem != "fixed_ends" and every <= 3000:
        demand("velocity", problem, size, "openmm-ccma", tolerances(6, 10))


def position(problem, size):
    own("position", problem, size)
    for method in ("rattle", "milc-shake", "sparse-newton"):
        demand("position", problem, size, method, tolerances(6, 12))
    demand("position", problem, size, "lincs", "order 4 iterations 1;order 8 iterations 4")
    if numbers(size)[2] <= (7000 if quick else 8200):
        demand("position", problem, size, "openmm-ccma", tolerances(6, 10, more=("", " exact angles")))


def accuracy(problem, size):
    own("position", problem, size)
    for method in ("holonomic", "rattle", "milc-shake", "sparse-newton"):
        demand("position", problem, size, method, tolerances(4, 8, 12) if quick else tolerances(4, 6, 8, 10, 12))
    for order in (4, 8, 12):
        for iterations in (1, 2, 4):
            demand("position", problem, size, "lincs", f"order {order} iterations {iterations}")
    if problem != "fixed_ends":
        demand("position", problem, size, "openmm-ccma", tolerances(4, 10, more=("", " exact angles")))


def metric(problem, size):
    own("metric", problem, size)
    for method in ("omega-recursion", "eigen-simplicial", "eigen-ldlt")[:3 if numbers(size)[1] <= 100 else 2]:
        demand("metric", problem, size, method, "log_det alone")


def skips(size):
    for level in ("acceleration", "velocity", "position", "metric"):
        own(level, "melt", size)
        demand(level, "melt", size, "holonomic", "half inactive;all inactive;box orthorhombic;box triclinic;view of the plain layout;"
               "x y z apart;padded to four doubles;float view;index list;two dimensions;general masses;general lengths;"
               "general masses and lengths;every 10th atom fixed;orthogonal neighbours;HOLONOMIC_ISA=baseline")
        if level != "position":
            demand(level, "light_joints", size, "holonomic", "compensated arithmetic")
    demand("acceleration", "melt", size, "holonomic", "v = NULL;f = NULL;v = NULL and f = NULL;no lambda;no g;tension too;"
           "virial too;g added to;all outputs in one call;all outputs by separate calls")
    demand("velocity", "melt", size, "holonomic", "no lambda;virial too")
    demand("position", "melt", size, "holonomic", "v = NULL;no lambda;r alone;virial too;guess;already satisfied")
    demand("metric", "melt", size, "holonomic", "log_det alone;outputs by separate calls")


def molecule(level, problem, method, settings):
    """Of molecules the sizes are what comes of their kinds: any will do."""
    for setting in settings.split(";") if here(method) else ():
        if (level, problem, method, setting) not in of_any_size:
            miss(level, problem, method, setting)


def molecules(problem):
    for level in ("acceleration", "velocity", "position"):
        molecule(level, problem, "holonomic", "default;bonds in any order;chains instead")
        if level != "position":
            molecule(level, problem, "sparse-ldl", "pattern reused")
            molecule(level, problem, "eigen-simplicial", "pattern reused")
    molecule("velocity", problem, "rattle", tolerances(6, 12))
    for method in ("rattle", "sparse-newton", "quasi-newton"):
        molecule("position", problem, method, tolerances(6, 12))
    molecule("position", problem, "lincs", "order 4 iterations 1;order 8 iterations 4")
    if problem == "water":
        for level in ("velocity", "position"):
            molecule(level, problem, "settle", "default")
            molecule(level, problem, "openmm", tolerances(6, 10))


for n in "1 3 100 1000 10000".split() if quick else "1 2 3 4 5 10 32 100 1000 10000 100000 1000000".split():
    for verb in (acceleration, velocity, position):
        verb("coil", f"1x{n}")
    direct("solve", "coil", f"1x{n}", "matrix given")
    if 2 <= int(n) <= 1000:
        metric("coil", f"1x{n}")
for size in ("10000x3 256x32 1000x100" if quick else "100000x1 10000x3 100000x3 256x32 1000x100 10000x100").split():
    acceleration("melt", size)
    velocity("melt", size)
    position("coil", size)
    if not size.endswith("x1"):
        metric("melt", size)
for scene in ("light_joints:16x100 straight5:4x100" if quick else
              "straight5:64x100 light_joints:64x100 tetrahedral:64x100 fixed_ends:64x100").split():
    for verb in (acceleration, velocity, metric, accuracy):
        verb(*scene.split(":"))
    if not quick:
        direct("solve", scene.split(":")[0], "1x100", "matrix given")
accuracy("coil", "16x100" if quick else "64x100")
skips("1000x100")
if not quick:
    skips("10000x3")
    skips("10000x100")
    acceleration("straight5", "1x1000")
    acceleration("straight5", "1x1000000")
    for threads in (1, 2):
        demand("acceleration", "straight5", "1x1000000", "holonomic", "truly straight", threads)
for method in ("holonomic", "omega-recursion", "lapack-dptsv", "eigen-ldlt"):
    if here(method) and sum(row[5] == method and row[6].startswith("condition") for row in rows) < (8 if quick else 15):
        miss("condition numbers", method)
for problem in "water hydrogens dodecane dendrimer comb brush ring triangles arms random_tree protein".split():
    molecules(problem)
for problem in ("coil", "random_tree", "water"):
    molecule("setup", problem, "holonomic", "bonds in order;as molecules;bonds in any order;bonds and atoms in any order")
if sum(row[6].startswith("energy drift") for row in rows) < (5 if quick else 7):
    miss("energy drifts")
if missing:
    sys.exit(f"{missing} rows are missing")
