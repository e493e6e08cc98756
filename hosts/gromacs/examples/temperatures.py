#!/usr/bin/env python3
"""Cholesterol among chains of beads, under one thermostat: the temperature of each kind of molecule by LINCS and by holonomic.
Beads and chains are like those of Martini: 72 amu, sigma 0.47 nm, epsilon 3.5 kJ/mol, bonds of 0.47 nm.

    temperatures.py [--ps 600] [--gmx gmx] [--folder FOLDER] [--figure FILE.svg] [--steps 20 30]
"""
import argparse
import math
import pathlib
import statistics
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "tests")]
import gromacs as g  # noqa: E402
import scenes as s  # noqa: E402

BOLTZMANN = 0.00831446
N_STEROLS, N_CHAINS = 300, 450
SOLVERS = {"LINCS 4, 1": (4, 1), "LINCS 8, 2": (8, 2), "LINCS 12, 3": (12, 3), "holonomic": (4, 1)}
QUIET = dict(nstenergy=1000, nstcalcenergy=10, nstlist=20, nstcomm=10, lincs_warnangle=90, rcoulomb=1.1, rvdw=1.1, rlist=1.3,
             vdw_modifier="potential-shift", tcoupl="v-rescale", tc_grps="System", tau_t=1, ref_t=310, gen_temp=310)


def chain_of_beads(n=4, length=0.47):
    places = [(k * length, 0, 0) for k in range(n)]
    return s.Molecule("LIP", [("C", f"B{k + 1}", 72.0) for k in range(n)], places,
                      bonds=[(k, k + 1, length, 1250.0) for k in range(1, n)],
                      angles=[(k, k + 1, k + 2, 180.0, 25.0) for k in range(1, n - 1)])


def martini(folder):
    """One kind of bead in place of those of scenes.py."""
    sigma, epsilon = 0.47, 3.5
    lines = (folder / "topol.top").read_text().splitlines()
    lines = [f"C 6 12 0 A {4 * epsilon * sigma ** 6} {4 * epsilon * sigma ** 12}" if line.startswith("C 6 12") else line
             for line in lines]
    (folder / "topol.top").write_text("\n".join(lines) + "\n")


def prepare(folder, gmx):
    """A liquid: compressed from a lattice."""
    s.write(folder, [(s.cholesterol(), N_STEROLS), (chain_of_beads(), N_CHAINS)], 2.0,
            **{**QUIET, "integrator": "steep", "nsteps": 200, "emtol": 100, "tcoupl": "no", "gen_vel": "no"})
    martini(folder)
    g.grompp(folder, gmx)
    g.mdrun(folder, gmx=gmx, name="relaxed")
    s.write_mdp(folder, **{**QUIET, "dt": 0.01, "nsteps": 8000, "pcoupl": "berendsen", "tau_p": 0.5, "ref_p": 100,
                           "compressibility": 3e-4})
    g.grompp(folder, gmx, "-c", "relaxed.gro")
    g.mdrun(folder, gmx=gmx, name="made")


def temperatures(folder, name):
    """Of sterols and chains, in each frame. Velocities of half steps: for all kinds alike."""
    sterol, chain = s.cholesterol(), chain_of_beads()
    masses = [atom[2] for atom in sterol.atoms] * N_STEROLS + [atom[2] for atom in chain.atoms] * N_CHAINS
    first = len(sterol.atoms) * N_STEROLS
    freedoms = (N_STEROLS * (3 * len(sterol.atoms) - len(sterol.constraints)), 3 * len(chain.atoms) * N_CHAINS)
    result = []
    for _, v in g.frames(folder / f"{name}.trr"):
        twice = [m * (u[0] ** 2 + u[1] ** 2 + u[2] ** 2) for m, u in zip(masses, v)]
        result.append((sum(twice[:first]) / (freedoms[0] * BOLTZMANN), sum(twice[first:]) / (freedoms[1] * BOLTZMANN)))
    return result


def mean(values, blocks=10):
    n = len(values) // blocks
    means = [statistics.fmean(values[k * n:(k + 1) * n]) for k in range(blocks)]
    return statistics.fmean(means), statistics.stdev(means) / math.sqrt(blocks)


PLOT = """set terminal svg size 640,340 enhanced background 'white'
set output '{path}'
set xrange [-0.5:3.5]
set ytics nomirror
set xtics ({tics}) nomirror
set ylabel 'T of cholesterol less T of chains (K)'
set key bottom right
plot 0 with lines linecolor 'gray' notitle, {curves}
"""


def draw(rows, path):
    """With gnuplot, as all figures."""
    steps = sorted({step for step, *_ in rows})
    data, curves = "", []
    for k, step in enumerate(steps):
        data += f"$of{step} << END\n"
        for i, (_, _, sterol, chain) in enumerate(row for row in rows if row[0] == step):
            at = i + 0.16 * (k - (len(steps) - 1) / 2)
            data += f"{at} {sterol[0] - chain[0]} {math.hypot(sterol[1], chain[1])}\n"
        data += "END\n"
        curves.append(f"$of{step} with yerrorbars pointtype 7 linewidth 1.5 title '{step} fs'")
    tics = ", ".join(f"'{solver}' {i}" for i, solver in enumerate(SOLVERS))
    subprocess.run(["gnuplot"], input=data + PLOT.format(path=path, tics=tics, curves=", ".join(curves)), text=True, check=True)


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--ps", type=float, default=600)
    arguments.add_argument("--gmx", default=g.MIXED)
    arguments.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("build/temperatures"))
    arguments.add_argument("--figure", type=pathlib.Path)
    arguments.add_argument("--steps", type=int, nargs="+", default=[20, 30])
    options = arguments.parse_args()
    folder = options.folder.resolve()
    if not (folder / "made.gro").exists():
        prepare(folder, options.gmx)
    rows = []
    for step in options.steps:
        for solver, (order, iterations) in SOLVERS.items():
            name = f"{solver.replace(', ', '-').replace(' ', '')}-{step}"
            s.write_mdp(folder, **{**QUIET, "dt": step / 1000, "nsteps": round(1000 * options.ps / step), "nstvout": 40,
                                   "lincs_order": order, "lincs_iter": iterations})
            g.grompp(folder, options.gmx, "-c", "made.gro", "-o", f"{name}.tpr")
            g.mdrun(folder, f"{name}.tpr", gmx=options.gmx, holonomic=solver == "holonomic", name=name)
            found = temperatures(folder, name)
            found = found[len(found) // 10:]
            rows.append((step, solver, mean([t[0] for t in found]), mean([t[1] for t in found])))
            print("{} fs  {:12s} cholesterol {:7.2f} +- {:.2f} K  chains {:7.2f} +- {:.2f} K  seconds in constraints {:.2f}".format(
                step, solver, *rows[-1][2], *rows[-1][3], g.constraint_seconds(folder / f"{name}.log")), flush=True)
    if options.figure:
        draw(rows, options.figure)


if __name__ == "__main__":
    main()
