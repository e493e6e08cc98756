#!/usr/bin/env python3
"""LINCS and holonomic beside each other in the same GROMACS: seconds of its own row "Constraints", and how far the total
energy, as a temperature, drifts. Run by hosts/gromacs/run; all arguments are optional.

    beside.py [--repeat 3] [--threads 1] [--gmx gmx] [--folder FOLDER] [SCENE...]
"""
import argparse
import pathlib
import statistics
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tests"))
import gromacs as g  # noqa: E402
import scenes as s  # noqa: E402

BOLTZMANN = 0.00831446
LINCS = {"LINCS 4, 1": dict(lincs_order=4, lincs_iter=1), "8, 2": dict(lincs_order=8, lincs_iter=2),
         "12, 3": dict(lincs_order=12, lincs_iter=3)}
QUIET = dict(nstenergy=100, nstcalcenergy=100, nstlist=20, nstcomm=100, lincs_warnangle=90)

SCENES = {
    "cholesterol 20 fs": dict(molecules=lambda: [(s.cholesterol(), 400)], spacing=1.2, interacting=False, dt=0.02,
                              nsteps=5000),
    "cholesterol 30 fs": dict(molecules=lambda: [(s.cholesterol(), 400)], spacing=1.2, interacting=False, dt=0.03,
                              nsteps=3333),
    "dodecane h-bonds": dict(molecules=lambda: [(s.alkane(12), 216)], spacing=1.7, dt=0.002, nsteps=1000,
                             constraints="h-bonds"),
    "dodecane all-bonds": dict(molecules=lambda: [(s.alkane(12), 216)], spacing=1.7, dt=0.002, nsteps=1000,
                               constraints="all-bonds"),
    "coils of 50 bonds": dict(molecules=lambda: [(s.chain(50), 64)], spacing=8.0, interacting=False, dt=0.005,
                              nsteps=2000),
}


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--repeat", type=int, default=3)
    arguments.add_argument("--threads", type=int, default=1)
    arguments.add_argument("--gmx", default=g.MIXED)
    arguments.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("build/beside"))
    arguments.add_argument("scenes", nargs="*", metavar="SCENE", help="of: " + ", ".join(SCENES))
    options = arguments.parse_args()
    for name in options.scenes or SCENES:
        compare(name, options)


def compare(name, options):
    scene = dict(SCENES[name])
    molecules = scene.pop("molecules")()
    folder = options.folder.resolve() / name.replace(" ", "-")
    solvers = {**LINCS, "holonomic": dict(lincs_order=4, lincs_iter=1)}
    for solver, orders in solvers.items():
        s.write(folder, molecules, **{**QUIET, **scene, **orders})
        g.grompp(folder, options.gmx, "-o", f"{solver.replace(', ', '-').replace(' ', '')}.tpr")
    seconds, drift = {k: [] for k in solvers}, {}
    for _ in range(options.repeat):  # in turns, so that the load of the machine meets all alike
        for solver in solvers:
            tag = solver.replace(", ", "-").replace(" ", "")
            try:
                g.mdrun(folder, f"{tag}.tpr", gmx=options.gmx, holonomic=solver == "holonomic", name=tag,
                        threads=options.threads)
                seconds[solver].append(g.constraint_seconds(folder / f"{tag}.log"))
                kept = g.energies(folder, ["Total-Energy"], options.gmx, tag)["Total Energy"]
                freedoms = 3 * sum(len(m.atoms) * n for m, n in molecules) - 3
                freedoms -= sum((len(m.constraints) or len(m.bonds)) * n for m, n in molecules)
                drift[solver] = 2 * (kept[-1] - kept[0]) / (freedoms * BOLTZMANN)
            except g.Failed as failed:
                drift[solver] = float("nan")
                print(f"{name}, {solver}: {str(failed)[-300:]}")
    print(f"{name}: {options.gmx}, {options.threads} thread(s), median of {options.repeat}")
    for solver in solvers:
        median = statistics.median(seconds[solver]) if seconds[solver] else float("nan")
        print(f"    {solver:12s} {median:8.3f} s   drift {drift.get(solver, float('nan')):10.3g} K")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
