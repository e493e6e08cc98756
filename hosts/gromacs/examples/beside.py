#!/usr/bin/env python3
"""LINCS and holonomic beside each other in the same GROMACS: its own row "Constraints" against that of LINCS 4, 1, in turns, and
by how much the total energy, as a temperature, changes in free flight. Run by hosts/gromacs/run; all arguments are optional.

    beside.py [--repeat 5] [--threads 1] [--gmx gmx] [--folder FOLDER] [SCENE...]
    beside.py --protein FILE.pdb [...]     a protein of your own, without water: its X-H bonds, and all of its bonds
"""
import argparse
import pathlib
import re
import statistics
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "tests")]
import gromacs as g  # noqa: E402
import helix  # noqa: E402
import scenes as s  # noqa: E402

BOLTZMANN = 0.00831446
FIRST = "LINCS 4, 1"
SOLVERS = {FIRST: dict(lincs_order=4, lincs_iter=1), "LINCS 8, 2": dict(lincs_order=8, lincs_iter=2),
           "LINCS 12, 3": dict(lincs_order=12, lincs_iter=3), "holonomic": dict(lincs_order=4, lincs_iter=1)}
QUIET = dict(nstenergy=100, nstcalcenergy=100, nstlist=20, nstcomm=100, lincs_warnangle=90)


def molecules(*listed, spacing, **mdp):
    def prepare(folder, _):
        s.write(folder, [(make(), count) for make, count in listed], spacing, **{**QUIET, **mdp})
        return {**QUIET, **mdp}
    return prepare


def minimised(make, count, spacing, **mdp):
    def prepare(folder, gmx):
        s.write(folder, [(make(), count)], spacing, **QUIET, integrator="steep", nsteps=500, emtol=100, gen_vel="no")
        g.grompp(folder, gmx, "-o", "topol.tpr")
        g.mdrun(folder, gmx=gmx, holonomic=False, name="conf")
        return {**QUIET, **mdp}
    return prepare


def protein(write, **mdp):
    """write(FILE): a .pdb of one protein, which is minimised without constraints."""
    def prepare(folder, gmx):
        folder.mkdir(parents=True, exist_ok=True)
        write(folder / "protein.pdb")
        g.call([gmx, "-quiet", "pdb2gmx", "-f", "protein.pdb", "-ff", "oplsaa", "-water", "none", "-ignh", "-o", "made.gro"],
               folder)
        g.call([gmx, "-quiet", "editconf", "-f", "made.gro", "-o", "conf.gro", "-princ", "-bt", "triclinic", "-d", "1.2"],
               folder, "System\n")
        s.write_mdp(folder, **QUIET, integrator="steep", nsteps=2000, emtol=100, gen_vel="no")
        g.grompp(folder, gmx, "-o", "topol.tpr")
        g.mdrun(folder, gmx=gmx, holonomic=False, name="conf")
        return {**QUIET, "tcoupl": "v-rescale", "tc_grps": "system", "tau_t": 0.1, "ref_t": 300, **mdp}
    return prepare


def helix_of(sequence):
    return lambda file: helix.write(file, sequence)


def of_file(path):
    """Without its water, which would be a row of SETTLE's."""
    lines = [line for line in path.read_text().splitlines()
             if line.startswith(("ATOM", "TER")) and line[17:20] not in ("HOH", "SOL", "WAT")]
    return lambda file: file.write_text("\n".join(lines) + "\nEND\n")


SCENES = {
    "cholesterol 20 fs": molecules((s.cholesterol, 400), spacing=1.2, interacting=False, dt=0.02, nsteps=2500),
    "cholesterol 30 fs": molecules((s.cholesterol, 400), spacing=1.2, interacting=False, dt=0.03, nsteps=1667),
    "dodecane h-bonds": molecules((lambda: s.alkane(12), 216), spacing=1.7, nsteps=400, constraints="h-bonds"),
    "dodecane all-bonds": molecules((lambda: s.alkane(12), 216), spacing=1.7, nsteps=400, constraints="all-bonds"),
    "lipids h-bonds": minimised(s.lipid, 64, 5.0, constraints="h-bonds", nsteps=400),
    "helix h-bonds": protein(helix_of(196 * "A"), constraints="h-bonds", nsteps=1000),
    "helix all-bonds": protein(helix_of(196 * "A"), constraints="all-bonds", nsteps=1000),
    "lysozyme h-bonds": protein(helix_of(helix.LYSOZYME), constraints="h-bonds", nsteps=1000),
    "lysozyme all-bonds": protein(helix_of(helix.LYSOZYME), constraints="all-bonds", nsteps=1000),
    "coils of 50 bonds": molecules((lambda: s.chain(50), 64), spacing=8.0, interacting=False, dt=0.005, nsteps=1000),
}


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--repeat", type=int, default=5)
    arguments.add_argument("--threads", type=int, default=1)
    arguments.add_argument("--gmx", default=g.MIXED)
    arguments.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("build/beside"))
    arguments.add_argument("--protein", type=pathlib.Path, metavar="FILE.pdb")
    arguments.add_argument("scenes", nargs="*", metavar="SCENE", help="of: " + ", ".join(SCENES))
    options = arguments.parse_args()
    scenes = SCENES
    if options.protein:
        scenes = {f"{options.protein.stem} {bonds}": protein(of_file(options.protein), constraints=bonds, nsteps=1000)
                  for bonds in ("h-bonds", "all-bonds")}
    for name in options.scenes:
        if name not in scenes:
            arguments.error(f"no scene {name}; there are: {', '.join(scenes)}")
    for name in options.scenes or scenes:
        compare(name, scenes[name], options)


def compare(name, prepare, options):
    folder = options.folder.resolve() / name.replace(" ", "-")
    mdp = prepare(folder, options.gmx)
    tags = {solver: re.sub("[ ,]", "", solver) for solver in SOLVERS}
    for solver, orders in SOLVERS.items():
        s.write_mdp(folder, **{**mdp, **orders})
        said = g.grompp(folder, options.gmx, "-o", f"{tags[solver]}.tpr")
    freedoms = float(re.search(r"Number of degrees of freedom in T-Coupling group \w+ is ([\d.]+)", said).group(1))
    seconds, drift = {solver: [] for solver in SOLVERS}, {}
    for _ in range(options.repeat):  # in turns, so that the load of the machine meets all alike
        for solver, tag in tags.items():
            g.mdrun(folder, f"{tag}.tpr", gmx=options.gmx, holonomic=solver == "holonomic", name=tag, threads=options.threads)
            seconds[solver].append(g.constraint_seconds(folder / f"{tag}.log"))
            energy = g.energies(folder, ["Total-Energy"], options.gmx, tag)["Total Energy"]
            drift[solver] = 2 * (energy[-1] - energy[0]) / (freedoms * BOLTZMANN)
    print(f"{name}: {options.gmx}, {options.threads} thread(s), {options.repeat} turns")
    for solver in SOLVERS:
        ratio = statistics.median(b / a for a, b in zip(seconds[FIRST], seconds[solver]))
        print(f"    {solver:12s} {statistics.median(seconds[solver]):8.3f} s  {ratio:6.2f} of the first's  "
              f"changes by {drift[solver]:9.2g} K", flush=True)


if __name__ == "__main__":
    main()
