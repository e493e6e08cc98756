"""Molecular dynamics of two xtbs with all bonds held, at constant energy: as it is, and with holonomic.

    beside.py AS_IT_IS WITH_HOLONOMIC FOLDER [--test] [--picoseconds P] [--molecule NAME]

For each molecule and step: how far bonds get from their lengths, the drift of the energy, its scatter, and when the run ends if it
does before its time. Temperatures, steps and masses are as xtb's default for dynamics (hydrogens of 4 u) but for the thermostat, which
is off.
"""

import argparse
import os
import subprocess
import sys
import time

import numpy as np

KT = 3.1668e-6 * 300  # hartree, at 300 K


def alkane(n):
    """Stretched, crude: it is minimised before."""
    atoms = []
    for k in range(n):
        up = 1 if k % 2 else -1
        at = np.array([1.27 * k, 0.42 * up, 0])
        ends = [(0, 0.65 * up, 0.88), (0, 0.65 * up, -0.88)]
        ends += [(-0.9, -0.62 * up, 0)] if k == 0 else [(0.9, -0.62 * up, 0)] if k == n - 1 else []
        atoms += [("C", at)] + [("H", at + end) for end in ends]
    return atoms


def polyyne(n):
    """H-(C=C)n-H with triple bonds: straight."""
    x = np.cumsum([0, 1.06] + [1.21, 1.36] * (n - 1) + [1.21, 1.06])
    return [("H" if k in (0, len(x) - 1) else "C", np.array([x[k], 1e-3 * (k % 3), 1e-3 * (k % 2)])) for k in range(len(x))]


def water_cluster(n):
    one = [("O", (0, 0, 0)), ("H", (0.96, 0, 0)), ("H", (-0.24, 0.93, 0))]
    return [(s, np.array(p) + (3.0 * (m // 4), 3.0 * (m // 2 % 2), 3.0 * (m % 2))) for m in range(n) for s, p in one]


MOLECULES = {"hexane": alkane(6), "8 waters": water_cluster(8), "C24H2": polyyne(12)}
RUNS = [("hexane", ["--gfn", "1"]), ("8 waters", ["--gfn", "1"]), ("C24H2", ["--gfn", "1"]), ("hexane", ["--gfnff"])]


def run(program, folder, *arguments):
    done = subprocess.run([program, *arguments], cwd=folder, capture_output=True, text=True,
                          env={**os.environ, "OMP_NUM_THREADS": "1", "OMP_STACKSIZE": "1G"})
    return done.stdout + done.stderr


def frames(path, n_atoms, with_velocities):
    """Energies, positions (count, n, 3) and, half a step earlier, velocities."""
    with open(path) as file:
        lines = file.read().split("\n")
    each = (2 if with_velocities else 1) * n_atoms + 2
    count = len(lines) // each
    energies = [float(lines[k * each + 1].split()[1]) for k in range(count)]
    rows = [[line.split()[-3:] for line in lines[k * each + 2:(k + 1) * each]] for k in range(count)]
    both = np.array(rows, dtype=float).reshape(count, -1, n_atoms, 3)
    return np.array(energies), both[:, 0], both[:, -1]


def bonds_of(symbols, r):
    radius = {"H": 0.32, "C": 0.75, "O": 0.63}
    return np.array([(i, j) for i in range(len(r)) for j in range(i + 1, len(r))
                     if np.linalg.norm(r[i] - r[j]) < 1.2 * (radius[symbols[i]] + radius[symbols[j]])])


def lengths_of(r, pairs):
    return np.linalg.norm(r[..., pairs[:, 0], :] - r[..., pairs[:, 1], :], axis=-1)


def prepare(name, program, folder, method):
    """The molecule, minimised."""
    os.makedirs(folder, exist_ok=True)
    atoms = MOLECULES[name]
    with open(os.path.join(folder, "crude.xyz"), "w") as file:
        file.write(f"{len(atoms)}\n\n" + "".join(f"{s} {x:.6f} {y:.6f} {z:.6f}\n" for s, (x, y, z) in atoms))
    log = run(program, folder, "crude.xyz", "--opt", *method)
    if not os.path.exists(os.path.join(folder, "xtbopt.xyz")):
        sys.exit(f"beside.py: {name} could not be minimised\n{log[-2000:]}")


def dynamics(name, program, folder, step, picoseconds, method):
    symbols = [s for s, _ in MOLECULES[name]]
    mass = np.array([{"H": 4.0, "C": 12.011, "O": 15.999}[s] for s in symbols]) * 1822.888
    with open(os.path.join(folder, "md.inp"), "w") as file:
        file.write(f"$md\n temp=300\n time={picoseconds}\n step={step}\n dump={step}\n velo=true\n nvt=false\n hmass=4\n"
                   " shake=2\n sccacc=0.1\n$end\n")
    trajectory = os.path.join(folder, "xtb.trj")
    if os.path.exists(trajectory):
        os.remove(trajectory)
    began = time.time()
    log = run(program, folder, "xtbopt.xyz", "--md", "--input", "md.inp", "--norestart", *method)
    seconds = time.time() - began
    if not os.path.exists(trajectory):
        sys.exit(f"beside.py: no run of {name}\n{log[-2000:]}")
    u, r, v = frames(trajectory, len(symbols), True)
    pairs = bonds_of(symbols, r[0])
    wanted = lengths_of(r[0], pairs)
    half = 0.5 * (mass[:, None] * v**2).sum(axis=(1, 2))
    total = u[1:-1] + 0.5 * (half[1:-1] + half[2:])  # kinetic energies of half a step before and after
    times = step * np.arange(1, len(total) + 1)
    slope, start = np.polyfit(times, total, 1) if len(total) > 2 else (np.nan, np.nan)
    freedoms = 3 * len(symbols) - 6 - len(pairs)
    return {
        "bonds": len(pairs), "steps": len(r), "of": round(picoseconds * 1000 / step),
        "error": np.abs(lengths_of(r, pairs) / wanted - 1).max(), "gave up": log.count("did not converge"),
        "drift": slope * 1e6 / KT / freedoms, "scatter": (total - slope * times - start).std() / KT if len(total) > 2 else np.nan,
        "ended": "unstable" in log or len(r) < 0.95 * picoseconds * 1000 / step, "ms": 1000 * seconds / max(len(r), 1),
    }


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("programs", nargs=2)
    arguments.add_argument("folder")
    arguments.add_argument("--test", action="store_true")
    arguments.add_argument("--picoseconds", type=float)
    arguments.add_argument("--molecule", choices=[name for name, _ in RUNS])
    chosen = arguments.parse_args()
    chosen.programs = [os.path.abspath(program) for program in chosen.programs]
    picoseconds = chosen.picoseconds or (0.1 if chosen.test else 2.0)
    steps = (4,) if chosen.test else (2, 4, 5)
    wrong = 0
    print(f"{'':26s} {'program':>10s} {'worst bond':>11s} {'drift kT/ns/dof':>16s} {'rms, kT':>9s} {'gave up':>8s} {'ms/step':>8s}  ended")
    for name, method in RUNS:
        if chosen.molecule not in (None, name):
            continue
        folder = os.path.join(chosen.folder, (name + "-".join(method)).replace(" ", "_"))
        prepare(name, chosen.programs[0], folder, method)
        for step in steps:
            for program, title in zip(chosen.programs, ("as it is", "holonomic")):
                found = dynamics(name, program, folder, step, picoseconds, method)
                ends = f"after {found['steps']} of {found['of']} steps" if found["ended"] else "in time"
                print(f"{name + ' ' + method[-1]:14s} {found['bonds']:3d}, {step} fs {title:>12s} {found['error']:11.1e}"
                      f" {found['drift']:16.2f} {found['scatter']:9.4f} {found['gave up']:8d} {found['ms']:8.1f}  {ends}", flush=True)
                if title == "holonomic":
                    # 14 digits after the point in Angstrom, and the rounding of coordinates in bohr
                    wrong += found["ended"] or not found["error"] < 2e-13 or found["gave up"] > 0
    if chosen.test:
        print("bonds are as they should be" if wrong == 0 else f"{wrong} runs are not as they should be")
        sys.exit(wrong)


main()
