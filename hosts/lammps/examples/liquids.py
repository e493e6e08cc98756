#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-only
"""Liquids of molecules whose distances depend on each other, at constant energy: 500 acetonitriles (all bonds and all angles; a body
of a molecule file; fix rigid/small) and 64 hexanes (all bonds and all angles; fix shake, which can hold the bonds to hydrogens
alone). All go on from the same positions and velocities, one after the other in turns; the table has the slope of the
total energy, its scatter about the line, and medians of the time of a step and of the fixes in it.

    liquids.py LMP_HOLONOMIC [--ps 4] [--steps 1 2 4] [--rounds 3] [--liquids acetonitrile hexane] [--folder build/liquids]
"""
import argparse
import math
import pathlib
import random
import re
import statistics
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tests"))
from angles import MOLECULES, add, cross, directions, dot, grow, unit  # noqa: E402

BOLTZMANN = 0.0019872067  # kcal/mol/K

# OPLS-AA: mass, well, diameter, by name of the type
TYPES = {"CT": (12.011, 0.066, 3.5), "HC": (1.008, 0.030, 2.5), "YC": (12.011, 0.066, 3.3), "YN": (14.007, 0.170, 3.2),
         "CY": (12.011, 0.066, 3.3), "HY": (1.008, 0.015, 2.5)}
LENGTHS = {"CT CT": 1.529, "CT HC": 1.09, "CY HY": 1.09, "CY YC": 1.458, "YC YN": 1.157}
# Of the dihedrals that stay free: V1, V2, V3, V4
DIHEDRALS = {"CT CT CT CT": (1.3, -0.05, 0.2, 0), "CT CT CT HC": (0, 0, 0.3, 0), "HC CT CT CT": (0, 0, 0.3, 0), "HC CT CT HC": (0, 0, 0.3, 0)}
LIQUIDS = {"acetonitrile": dict(count=500, density=0.786, freedoms=6), "hexane": dict(count=64, density=0.655, freedoms=11)}
# Arguments of the fixes; hydrogens' bonds of hexane are of type 2
FIXES = {"acetonitrile": {"holonomic, all angles": "holonomic b 1 2 3 a 1 2 3", "holonomic, a file": "holonomic rigid molecule.txt",
                          "rigid/small": "rigid/small molecule"},
         "hexane": {"holonomic, all angles": "holonomic b 1 2 a 1 2 3", "holonomic, C-H": "holonomic b 2", "shake 1e-6, C-H": "shake 1e-6 100 0 b 2"}}


def stretched_alkane(n):
    """Places, elements and bonds; all angles are tetrahedral, the chain is a zigzag."""
    half = math.acos(-1 / 3) / 2
    r = [[k * math.sin(half), k % 2 * math.cos(half), 0.0] for k in range(n)]
    bonds = [(k, k + 1) for k in range(n - 1)]
    for k in range(n):
        ways = [unit(add(r[j], r[k], -1)) for j in (k - 1, k + 1) if 0 <= j < n]
        if len(ways) == 1:
            ways = directions("t", ways[0])
        else:
            away, across = unit(add(ways[0], ways[1])), unit(cross(*ways))
            ways = [[-math.cos(half) * a + sign * math.sin(half) * c for a, c in zip(away, across)] for sign in (1, -1)]
        for way in ways:
            bonds.append((k, len(r)))
            r.append(add(r[k], way))
    return r, n * ["C"] + (2 * n + 2) * ["H"], bonds


def molecule(name):
    """Places, types, charges, bonds, angles and dihedrals, with the lengths above; all angles are tetrahedral, or straight."""
    r, elements, bonds = stretched_alkane(6) if name == "hexane" else grow(MOLECULES[name])
    near = [[a + b - i for a, b in bonds if i in (a, b)] for i in range(len(r))]
    if name == "hexane":
        types = ["HC" if e == "H" else "CT" for e in elements]
        charges = [0.06 if t == "HC" else -0.06 * sum(types[k] == "HC" for k in near[i]) for i, t in enumerate(types)]
    else:
        types = ["CY", "YC", "YN"] + 3 * ["HY"]
        charges = [-0.08, 0.46, -0.56, 0.06, 0.06, 0.06]
    pair = lambda a, b: " ".join(sorted((types[a], types[b])))
    # Again, with these lengths: each atom hangs on an earlier one.
    places = [list(r[0])]
    for a, b in sorted(bonds, key=lambda bond: bond[1]):
        places.append(add(places[a], unit(add(r[b], r[a], -1)), LENGTHS[pair(a, b)]))
    angles = [(a, i, b) for i in range(len(r)) for a in near[i] for b in near[i] if a < b]
    dihedrals = [(a, i, j, b) for i, j in bonds for a in near[i] for b in near[j] if a != j and b != i]
    return places, types, charges, bonds, angles, dihedrals if name == "hexane" else []


def numbered(values):
    kinds = sorted(set(values))
    return kinds, [kinds.index(v) + 1 for v in values]


def write(folder, name):
    """data, with molecules far apart, coefficients and a molecule file; gives the side of the box that the liquid has."""
    r, types, charges, bonds, angles, dihedrals = molecule(name)
    count, n = LIQUIDS[name]["count"], len(r)
    side = math.ceil(count ** (1 / 3) - 1e-9)
    mass = sum(TYPES[t][0] for t in types)
    wanted = (count * mass / 0.602214 / LIQUIDS[name]["density"]) ** (1 / 3)
    middle = [sum(x[c] for x in r) / n for c in range(3)]
    spacing = max(1.35 * wanted / side, 2.1 * max(math.dist(x, middle) for x in r) + 1.5)
    kinds, atom_types = numbered(types)
    bond_kinds, bond_types = numbered([" ".join(sorted((types[a], types[b]))) for a, b in bonds])
    angle_kinds, angle_types = numbered([" ".join([types[b]] + sorted((types[a], types[c]))) for a, b, c in angles])
    dihedral_kinds, dihedral_types = numbered([" ".join(types[k] for k in four) for four in dihedrals])
    lists = [("bond", bonds, bond_types, bond_kinds), ("angle", angles, angle_types, angle_kinds),
             ("dihedral", dihedrals, dihedral_types, dihedral_kinds)]
    chance = random.Random(7)
    out = [f"liquids.py {name}", "", f"{count * n} atoms", f"{len(kinds)} atom types"]
    for word, entries, _, its_kinds in lists:
        out += [f"{count * len(entries)} {word}s", f"{len(its_kinds)} {word} types"]
    out += [f"0 {side * spacing} {axis}lo {axis}hi" for axis in "xyz"]
    out += ["", "Masses", ""] + [f"{k} {TYPES[kind][0]}" for k, kind in enumerate(kinds, 1)] + ["", "Atoms # full", ""]
    for m in range(count):
        u = unit([chance.gauss(0, 1) for _ in range(3)])
        v = unit(cross(u, [chance.gauss(0, 1) for _ in range(3)]))
        axes = (u, v, cross(u, v))
        corner = [(x + 0.5) * spacing for x in (m % side, m // side % side, m // side // side)]
        for i, x in enumerate(r):
            place = [corner[c] + dot([axis[c] for axis in axes], add(x, middle, -1)) for c in range(3)]
            out.append(f"{m * n + i + 1} {m + 1} {atom_types[i]} {charges[i]} " + " ".join(f"{x:.15g}" for x in place))
    for word, entries, its_types, _ in lists:
        if entries:
            out += ["", word.capitalize() + "s", ""]
        for k in range(count * len(entries)):
            m, e = divmod(k, len(entries))
            out.append(f"{k + 1} {its_types[e]} " + " ".join(str(m * n + i + 1) for i in entries[e]))
    (folder / "data").write_text("\n".join(out) + "\n")
    coefficients = [f"pair_coeff {k} {k} {TYPES[kind][1]} {TYPES[kind][2]}" for k, kind in enumerate(kinds, 1)]
    coefficients += [f"bond_coeff {k} 340 {LENGTHS[kind]}" for k, kind in enumerate(bond_kinds, 1)]
    coefficients += [f"angle_coeff {k} 50 {180 if kind.startswith('YC') else math.degrees(math.acos(-1 / 3)):.15g}"
                     for k, kind in enumerate(angle_kinds, 1)]
    coefficients += [f"dihedral_coeff {k} " + " ".join(str(x) for x in DIHEDRALS[kind]) for k, kind in enumerate(dihedral_kinds, 1)]
    (folder / "coefficients.lmp").write_text("\n".join(coefficients) + "\n")
    body = ["# " + name, "", f"{n} atoms", "", "Coords", ""] + [f"{i + 1} " + " ".join(f"{x:.15g}" for x in p) for i, p in enumerate(r)]
    (folder / "molecule.txt").write_text("\n".join(body + ["", "Types", ""] + [f"{i + 1} {t}" for i, t in enumerate(atom_types)]) + "\n")
    return wanted


COMMON = """units real
atom_style full
pair_style lj/gromacs/coul/gromacs 8.0 10.0
pair_modify mix geometric
bond_style harmonic
angle_style harmonic
{dihedrals}
special_bonds lj/coul {special}
{read}
include coefficients.lmp
neighbor 2.0 bin
neigh_modify every 1 delay 0 check yes{exclude}
"""


def lammps(program, folder, text, name):
    (folder / f"{name}.lmp").write_text(text)
    done = subprocess.run([program, "-in", f"{name}.lmp", "-log", "none"], cwd=folder, capture_output=True, text=True)
    if "Loop time" not in done.stdout:
        sys.exit(f"{folder}/{name}.lmp: {done.stdout[-2000:]}{done.stderr}")
    return done.stdout


def common(name, read):
    flexible = name == "hexane"
    return COMMON.format(dihedrals="dihedral_style opls" if flexible else "", special="1e-50 1e-50 0.5" if flexible else "1e-50 1e-50 1e-50",
                         exclude="" if flexible else " exclude molecule/intra all", read=read)


def start(program, folder, name):
    """A liquid: pressed together, then some picoseconds at 300 K."""
    folder.mkdir(parents=True, exist_ok=True)
    if (folder / "warm").exists():
        return
    side = write(folder, name)
    fix = next(iter(FIXES[name].values()))
    text = common(name, "read_data data") + f"""velocity all create 300 4711 loop geom
fix bath all langevin 300 300 200 48279
fix press all deform 1 x final 0 {side} y final 0 {side} z final 0 {side} remap x units box
fix motion all nve
fix rigid all {fix}
timestep 1
thermo 500
run 3000
unfix press
run 2000
unfix bath
run 500
write_restart warm
"""
    lammps(program, folder, text, "start")


def slope(times, energies):
    t, e = statistics.fmean(times), statistics.fmean(energies)
    b = sum((x - t) * (y - e) for x, y in zip(times, energies)) / sum((x - t) ** 2 for x in times)
    return b, math.sqrt(statistics.fmean((y - e - b * (x - t)) ** 2 for x, y in zip(times, energies)))


def measure(program, folder, name, fix, step, n_steps):
    moves = "" if fix.startswith("rigid") else "fix motion all nve\n"
    text = common(name, "read_restart warm") + f"{moves}fix rigid all {fix}\n" + f"""timestep {step}
thermo_style custom step etotal press
thermo_modify format float %.12g norm no
thermo {max(1, round(20 / step))}
run {n_steps}
"""
    said = lammps(program, folder, text, "run")
    rows = [line.split() for line in said.splitlines() if re.match(r"^ *\d+ +-?\d", line) and len(line.split()) == 3]
    first = int(rows[0][0])
    times = [step * (int(row[0]) - first) * 1e-6 for row in rows]  # ns
    drift, scatter = slope(times, [float(row[1]) for row in rows])
    whole = float(re.search(r"Loop time of ([\d.e+-]+)", said).group(1)) / n_steps
    modify = float(re.search(r"^Modify +\| ([\d.e+-]+)", said, re.M).group(1)) / n_steps
    return drift, scatter, 1e3 * whole, 1e3 * modify


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("program", metavar="LMP_HOLONOMIC")
    arguments.add_argument("--ps", type=float, default=4)
    arguments.add_argument("--steps", type=float, nargs="+", default=[1, 2, 4])
    arguments.add_argument("--rounds", type=int, default=3, help="short runs in turns, for the times")
    arguments.add_argument("--liquids", nargs="+", default=list(LIQUIDS))
    arguments.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("build/liquids"))
    options = arguments.parse_args()
    print("| liquid, fs | | slope, kT/ns per freedom | scatter, kcal/mol | ms per step | of which fixes |\n|---|---|---|---|---|---|")
    for name in options.liquids:
        folder = options.folder.resolve() / name
        start(options.program, folder, name)
        times = {fix: [] for fix in FIXES[name]}
        for _ in range(options.rounds):
            for fix, words in FIXES[name].items():
                times[fix].append(measure(options.program, folder, name, words, 1, 200)[2:])
        for step in options.steps:
            for fix, words in FIXES[name].items():
                drift, scatter, *_ = measure(options.program, folder, name, words, step, round(1000 * options.ps / step))
                freedoms = LIQUIDS[name]["count"] * (LIQUIDS[name]["freedoms"] if "C-H" not in fix else 46)
                ms = [statistics.median(column) for column in zip(*times[fix])]
                print(f"| {name}, {step:g} | {fix} | {2 * drift / (freedoms * BOLTZMANN * 300):.3f} | {scatter:.3g} | {ms[0]:.2f} | {ms[1]:.2f} |",
                      flush=True)


if __name__ == "__main__":
    main()
