#!/usr/bin/env python3
"""Cholesterol in a bilayer of DPPC, or among chains of beads like Martini's, under one thermostat: the temperature of each kind of
molecule by LINCS and by holonomic.

    temperatures.py [--scene membrane|liquid] [--ps 1500] [--gmx gmx] [--folder FOLDER] [--figure FILE.svg] [--steps 20 30]
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
import membrane  # noqa: E402
import scenes as s  # noqa: E402

BOLTZMANN = 0.00831446
N_STEROLS, N_CHAINS = 300, 450
SOLVERS = {"LINCS 4, 1": (4, 1), "LINCS 8, 2": (8, 2), "LINCS 12, 3": (12, 3), "holonomic": (4, 1)}
QUIET = dict(nstenergy=1000, nstcalcenergy=10, nstlist=20, nstcomm=10, lincs_warnangle=90, rcoulomb=1.1, rvdw=1.1, rlist=1.3,
             vdw_modifier="potential-shift", tcoupl="v-rescale", tc_grps="System", tau_t=1)
LIQUID = dict(ref_t=310, gen_temp=310)
MEMBRANE = dict(ref_t=323, gen_temp=323, coulombtype="reaction-field", epsilon_r=15, epsilon_rf=0)


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


def prepare(folder, gmx, barostat, **mdp):
    """Relaxed, and brought to its density."""
    quiet = {**QUIET, **mdp}
    s.write_mdp(folder, **{**quiet, "integrator": "steep", "nsteps": 200, "emtol": 100, "tcoupl": "no", "gen_vel": "no"})
    g.grompp(folder, gmx)
    g.mdrun(folder, gmx=gmx, name="relaxed")
    s.write_mdp(folder, **{**quiet, "dt": 0.01, "pcoupl": "berendsen", **barostat})
    g.grompp(folder, gmx, "-c", "relaxed.gro")
    g.mdrun(folder, gmx=gmx, name="made")


def liquid(folder, gmx):
    """Compressed from a lattice."""
    sterol, chain = s.cholesterol(), chain_of_beads()
    if not (folder / "made.gro").exists():
        s.write(folder, [(sterol, N_STEROLS), (chain, N_CHAINS)], 2.0)
        martini(folder)
        prepare(folder, gmx, dict(nsteps=8000, tau_p=0.5, ref_p=100, compressibility=3e-4), **LIQUID)
    return [("cholesterol", N_STEROLS, [atom[2] for atom in sterol.atoms], 3 * len(sterol.atoms) - len(sterol.constraints)),
            ("chains", N_CHAINS, [atom[2] for atom in chain.atoms], 3 * len(chain.atoms))]


def bilayer(folder, gmx):
    names = dict(DPPC="DPPC", CHOL="cholesterol", W="water")
    kinds = membrane.write(folder)
    if not (folder / "made.gro").exists():
        prepare(folder, gmx, dict(nsteps=20000, pcoupltype="semiisotropic", tau_p=2, ref_p="1 1", compressibility="3e-4 3e-4"),
                **MEMBRANE)
    return [(names[name], *numbers) for name, *numbers in kinds]


SCENES = {"membrane": (bilayer, MEMBRANE, "DPPC"), "liquid": (liquid, LIQUID, "chains")}


def temperatures(folder, name, kinds):
    """Of each kind, in each frame. Velocities of half steps: for all kinds alike."""
    result = {kind: [] for kind, *_ in kinds}
    for _, v in g.frames(folder / f"{name}.trr"):
        first = 0
        for kind, count, masses, freedoms in kinds:
            end = first + count * len(masses)
            twice = sum(m * (u[0] ** 2 + u[1] ** 2 + u[2] ** 2) for m, u in zip(masses * count, v[first:end]))
            result[kind].append(twice / (count * freedoms * BOLTZMANN))
            first = end
    return result


def mean(values, blocks=15):
    n = len(values) // blocks
    means = [statistics.fmean(values[k * n:(k + 1) * n]) for k in range(blocks)]
    return statistics.fmean(means), statistics.stdev(means) / math.sqrt(blocks)


PLOT = """set terminal svg size 640,340 enhanced background 'white'
set output '{path}'
set xrange [-0.5:3.5]
set ytics nomirror
set xtics ({tics}) nomirror
set ylabel 'T of cholesterol less T of {other} (K)'
set key bottom right
plot 0 with lines linecolor 'gray' notitle, {curves}
"""


def draw(rows, other, path):
    """With gnuplot, as all figures."""
    steps = sorted({step for step, *_ in rows})
    data, curves = "", []
    for k, step in enumerate(steps):
        data += f"$of{step} << END\n"
        for i, (_, _, difference) in enumerate(row for row in rows if row[0] == step):
            data += f"{i + 0.16 * (k - (len(steps) - 1) / 2)} {difference[0]} {difference[1]}\n"
        data += "END\n"
        curves.append(f"$of{step} with yerrorbars pointtype 7 linewidth 1.5 title '{step} fs'")
    tics = ", ".join(f"'{solver}' {i}" for i, solver in enumerate(SOLVERS))
    subprocess.run(["gnuplot"], input=data + PLOT.format(path=path, other=other, tics=tics, curves=", ".join(curves)), text=True, check=True)


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--scene", choices=SCENES, default="membrane")
    arguments.add_argument("--ps", type=float, default=1500)
    arguments.add_argument("--gmx", default=g.MIXED)
    arguments.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("build/temperatures"))
    arguments.add_argument("--figure", type=pathlib.Path)
    arguments.add_argument("--steps", type=int, nargs="+", default=[20, 30])
    options = arguments.parse_args()
    make, mdp, other = SCENES[options.scene]
    folder = options.folder.resolve() / options.scene
    kinds = make(folder, options.gmx)
    rows = []
    for step in options.steps:
        for solver, (order, iterations) in SOLVERS.items():
            name = f"{solver.replace(', ', '-').replace(' ', '')}-{step}"
            s.write_mdp(folder, **{**QUIET, **mdp, "dt": step / 1000, "nsteps": round(1000 * options.ps / step), "nstvout": 40,
                                   "lincs_order": order, "lincs_iter": iterations})
            g.grompp(folder, options.gmx, "-c", "made.gro", "-o", f"{name}.tpr")
            g.mdrun(folder, f"{name}.tpr", gmx=options.gmx, holonomic=solver == "holonomic", name=name)
            found = temperatures(folder, name, kinds)
            found = {kind: values[len(values) // 10:] for kind, values in found.items()}
            means = {kind: mean(values) for kind, values in found.items()}
            rows.append((step, solver, mean([a - b for a, b in zip(found["cholesterol"], found[other])])))
            print(f"{step} fs  {solver:12s} " + "  ".join(f"{kind} {t:7.2f} +- {error:.2f} K" for kind, (t, error) in means.items())
                  + "  cholesterol less {} {:6.2f} +- {:.2f} K".format(other, *rows[-1][2])
                  + f"  seconds in constraints {g.constraint_seconds(folder / f'{name}.log'):.2f}", flush=True)
    if options.figure:
        draw(rows, other, options.figure)


if __name__ == "__main__":
    main()
