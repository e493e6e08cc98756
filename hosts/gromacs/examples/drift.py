#!/usr/bin/env python3
"""Constant energy: 125 butanes with heavy hydrogens and all bonds constrained, by LINCS and by holonomic, from several starts. The
slope of the total energy, as a temperature, with the error of its mean.

    drift.py [--ps 20] [--starts 4] [--steps 2 4 5] [--folder FOLDER] [SOLVER...]      e.g. "LINCS 8, 2 mixed" "holonomic double"
"""
import argparse
import math
import pathlib
import re
import statistics
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "tests")]
import gromacs as g  # noqa: E402
import scenes as s  # noqa: E402

BOLTZMANN = 0.00831446
ORDERS = {"LINCS 4, 1": (4, 1), "LINCS 8, 2": (8, 2), "LINCS 12, 3": (12, 3), "LINCS 40, 14": (40, 14), "holonomic": (4, 1)}
SOLVERS = [f"{solver} {precision}" for solver in ORDERS for precision in ("mixed", "double")]


def butane():
    """Each hydrogen takes three amu of its carbon."""
    molecule = s.alkane(4)
    hydrogens = {k for k, (kind, *_) in enumerate(molecule.atoms, 1) if kind == "H"}
    mass = [1.008 + 3 if k in hydrogens else 12.011 for k in range(1, len(molecule.atoms) + 1)]
    for i, j, *_ in molecule.bonds:
        for carbon, other in ((i, j), (j, i)):
            if other in hydrogens:
                mass[carbon - 1] -= 3
    molecule.atoms = [(kind, name, m) for (kind, name, _), m in zip(molecule.atoms, mass)]
    return molecule


def slope(times, energies):
    t, e = statistics.fmean(times), statistics.fmean(energies)
    return sum((a - t) * (b - e) for a, b in zip(times, energies)) / sum((a - t) ** 2 for a in times)


def start(folder, seed):
    """A liquid at 300 K, from which all begin: with the same positions and velocities."""
    s.write(folder, [(butane(), 125)], 0.62, constraints="all-bonds", integrator="steep", nsteps=300, emtol=50, gen_vel="no")
    g.grompp(folder)
    g.mdrun(folder, name="relaxed")
    s.write_mdp(folder, constraints="all-bonds", dt=0.002, nsteps=5000, tcoupl="v-rescale", tc_grps="System", tau_t=0.2, ref_t=300,
                gen_seed=seed, ld_seed=seed, nstenergy=500)
    g.grompp(folder, g.DOUBLE, "-c", "relaxed.gro")
    g.mdrun(folder, name="warm")


def measure(folder, solver, step, ps):
    name, precision = solver.rsplit(" ", 1)
    gmx = g.MIXED if precision == "mixed" else g.DOUBLE
    order, iterations = ORDERS[name]
    s.write_mdp(folder, constraints="all-bonds", dt=step / 1000, nsteps=round(1000 * ps / step), gen_vel="no", continuation="yes",
                nstenergy=round(100 / step), nstcalcenergy=1, lincs_order=order, lincs_iter=iterations)
    said = g.grompp(folder, gmx, "-c", "warm.gro", "-t", "warm.cpt", "-o", "run.tpr")
    freedoms = float(re.search(r"Number of degrees of freedom in T-Coupling group rest is ([\d.]+)", said).group(1))
    g.mdrun(folder, "run.tpr", gmx=gmx, holonomic=name == "holonomic")
    energy = g.energies(folder, ["Total-Energy"], gmx)
    return 1000 * slope(energy["time"], energy["Total Energy"]) * 2 / (freedoms * BOLTZMANN)


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--ps", type=float, default=20)
    arguments.add_argument("--starts", type=int, default=4)
    arguments.add_argument("--steps", type=int, nargs="+", default=[2, 4, 5])
    arguments.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("build/drift"))
    arguments.add_argument("solvers", nargs="*", metavar="SOLVER", help="of: " + ", ".join(SOLVERS))
    options = arguments.parse_args()
    folders = [options.folder.resolve() / str(seed) for seed in range(1, options.starts + 1)]
    for seed, folder in enumerate(folders, 1):
        if not (folder / "warm.cpt").exists():
            start(folder, seed)
    for step in options.steps:
        for solver in options.solvers or SOLVERS:
            found = [measure(folder, solver, step, options.ps) for folder in folders]
            error = statistics.stdev(found) / math.sqrt(len(found)) if len(found) > 1 else math.nan
            print(f"{step} fs  {solver:20s} {statistics.fmean(found):8.1f} +- {error:.1f} K/ns", flush=True)


if __name__ == "__main__":
    main()
