"""The platform OpenCL: steps with OpenMM's own constraints at two tolerances, beside holonomic's, on one device.

    opencl.py [--platform OpenCL] [--precision mixed] [--rounds 7] [--contexts 3] [SCENE...]

There are no forces: a step is two kernels of the integrator and the constraints. The same steps without constraints are taken off.
Runs alternate; medians are printed, of constraints alone: processor time of all threads, kernels, waits of the host, all per step; and the worst bond.
They are medians over Contexts, too: where the arrays of one happen to stand can cost a processor half as much again. Kernels and waits are counted
of OpenCL alone.
"""

import argparse
import copy
import ctypes
import os
import subprocess
import sys
import tempfile
import time

import numpy as np
import openmm as mm
from openmm import app

here = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(here, "..", "examples"), os.path.join(here, "..")]
from holonomic_openmm import add_holonomic  # noqa: E402
from peptide import peptide  # noqa: E402


def counting():
    """Starts this program again under count_calls.so, and gives its two numbers."""
    if "count_calls.so" not in os.environ.get("LD_PRELOAD", ""):
        folder = tempfile.mkdtemp()
        library = os.path.join(folder, "count_calls.so")
        subprocess.run(["cc", "-O1", "-shared", "-fPIC", os.path.join(here, "count_calls.c"), "-o", library, "-ldl"], check=True)
        os.environ["LD_PRELOAD"] = library
        os.execv(sys.executable, [sys.executable, "-W", "ignore", *sys.argv])
    library = ctypes.CDLL(os.environ["LD_PRELOAD"])
    return [ctypes.c_long.in_dll(library, name) for name in ("n_launches", "n_waits")]


class Molecule:
    """Grows atom by atom, with the angles of a tetrahedron and torsions at random."""

    def __init__(self, rng):
        self.rng, self.masses, self.r, self.bonds, self.free = rng, [], [], [], []

    def corners(self, back):
        """The three directions that make a tetrahedron with one."""
        across = np.cross(back, self.rng.normal(size=3))
        across /= np.linalg.norm(across)
        angles = 2 * np.pi / 3 * np.arange(3)[:, None]
        return list(-back / 3 + np.sqrt(8) / 3 * (np.cos(angles) * across + np.sin(angles) * np.cross(back, across)))

    def add(self, mass, parent=None, length=0.0):
        if parent is None:
            back, place = np.array([1.0, 0, 0]), np.zeros(3)
        else:
            back, place = self.free[parent].pop(), self.r[parent]
            place = place + length * back
            back = -back
            self.bonds.append((parent, len(self.masses)))
        self.masses.append(mass)
        self.r.append(place)
        self.free.append(self.corners(back) + ([back] if parent is None else []))
        return len(self.masses) - 1

    def tail(self, parent, carbons):
        for k in range(carbons):
            parent = self.add(12.011, parent, 0.153)
            for _ in range(2 + (k == carbons - 1)):
                self.add(1.008, parent, 0.109)

    def filled(self, carbon, hydrogens):
        for _ in range(hydrogens):
            self.add(1.008, carbon, 0.109)
        return carbon


def dodecane(rng):
    molecule = Molecule(rng)
    first = molecule.add(12.011)
    molecule.tail(first, 11)
    molecule.filled(first, 3)
    return molecule


def lipid(rng):
    """A glycerol with two chains of 16 carbons and a head of phosphate and choline, with all hydrogens: 130 atoms, as DPPC."""
    molecule = Molecule(rng)
    glycerol = [molecule.add(12.011)]
    glycerol += [molecule.add(12.011, glycerol[0], 0.153)]
    glycerol += [molecule.add(12.011, glycerol[1], 0.153)]
    for carbon in glycerol[:2]:
        oxygen = molecule.add(15.999, carbon, 0.143)
        acid = molecule.add(12.011, oxygen, 0.134)
        molecule.add(15.999, acid, 0.122)
        molecule.tail(acid, 15)
    phosphorus = molecule.add(30.974, molecule.add(15.999, glycerol[2], 0.143), 0.161)
    for _ in range(2):
        molecule.add(15.999, phosphorus, 0.148)
    choline = molecule.add(12.011, molecule.add(15.999, phosphorus, 0.161), 0.143)
    other = molecule.add(12.011, choline, 0.153)
    nitrogen = molecule.add(14.007, other, 0.15)
    for _ in range(3):
        molecule.filled(molecule.add(12.011, nitrogen, 0.15), 3)
    for carbon, n in zip(glycerol + [choline, other], (2, 1, 2, 2, 2)):
        molecule.filled(carbon, n)
    return molecule


def protein(rng):
    """200 residues with side chains of four carbons and all hydrogens: 3801 atoms."""
    molecule = Molecule(rng)
    last = molecule.add(1.008)
    for _ in range(200):
        nitrogen = molecule.add(14.007, last, 0.134 if last else 0.101)
        molecule.filled(nitrogen, 1)
        alpha = molecule.add(12.011, nitrogen, 0.145)
        last = molecule.add(12.011, alpha, 0.152)
        molecule.tail(alpha, 4)
        molecule.filled(alpha, 1)
        molecule.add(15.999, last, 0.123)
    return molecule


def many(make, copies):
    """Copies of one molecule, turned and moved at random. All have its lengths, to the last bit: OpenMM asks for that in water."""
    rng = np.random.default_rng(1)
    masses, places, bonds = make(rng)
    lengths = [round(float(np.linalg.norm(np.subtract(places[i], places[j]))), 12) for i, j in bonds]
    system, r = mm.System(), []
    for _ in range(copies):
        first = len(r)
        for mass in masses:
            system.addParticle(float(mass))
        for (i, j), length in zip(bonds, lengths):
            system.addConstraint(first + i, first + j, length)
        r += list(np.array(places) @ np.linalg.qr(rng.normal(size=(3, 3)))[0] + rng.uniform(0, 6, 3))
    return system, np.array(r)


def grown(make):
    def molecule(rng):
        one = make(rng)
        return one.masses, one.r, one.bonds
    return molecule


def water(_):
    angle = np.radians(104.52)
    return [15.999, 1.008, 1.008], [(0, 0, 0), (0.09572, 0, 0), (0.09572 * np.cos(angle), 0.09572 * np.sin(angle), 0)], \
        [(0, 1), (0, 2), (1, 2)]


def cholesterol(_):
    return [72, 72, 72, 600], [(0, 0, 0), (0.28, 0.04, -0.07), (-0.19, 0.10, 0.10), (0.03, 0.23, -0.13)], \
        [(0, 1), (0, 2), (1, 2), (1, 3), (2, 3)]


def peptide_in_water(constraints):
    forcefield = app.ForceField("amber14-all.xml", "amber14/tip3p.xml")
    modeller = peptide(forcefield, 0.9)
    system = forcefield.createSystem(modeller.topology, constraints=constraints, rigidWater=True, removeCMMotion=False)
    while system.getNumForces():
        system.removeForce(0)
    context = mm.Context(copy.deepcopy(system), mm.VerletIntegrator(0.001), mm.Platform.getPlatformByName("Reference"))
    context.setPositions(modeller.positions)
    context.applyConstraints(1e-10)
    return system, context.getState(getPositions=True).getPositions(asNumpy=True)._value


SCENES = {
    "water": lambda: many(water, 4000),
    "peptide-hbonds": lambda: peptide_in_water(app.HBonds),
    "peptide-allbonds": lambda: peptide_in_water(app.AllBonds),
    "dodecane": lambda: many(grown(dodecane), 216),
    "lipid": lambda: many(grown(lipid), 128),
    "protein": lambda: many(grown(protein), 1),
    "proteins": lambda: many(grown(protein), 4),
    "cholesterol": lambda: many(cholesterol, 2000),
}


class Run:
    def __init__(self, name, system, options, tolerance=None, holonomic=False, r=None, v=None):
        self.name, self.system, self.r, self.v = name, copy.deepcopy(system), r, v
        if holonomic:
            add_holonomic(self.system)
        if not holonomic and tolerance is None:
            while self.system.getNumConstraints():
                self.system.removeConstraint(self.system.getNumConstraints() - 1)
        self.integrator = mm.VerletIntegrator(0.002)
        self.integrator.setConstraintTolerance(tolerance or 1e-5)
        clock = time.process_time()
        self.context = mm.Context(self.system, self.integrator, mm.Platform.getPlatformByName(options.platform),
                                  {"Precision": options.precision})
        self.rows = []
        self.measure(1, [])
        self.made = time.process_time() - clock
        self.rows.clear()

    def measure(self, steps, counters):
        self.context.setPositions(self.r)
        self.context.setVelocities(self.v)
        self.context.getState(getVelocities=True)  # waits
        before, clock = [counter.value for counter in counters], time.process_time()
        self.integrator.step(steps)
        counts = [counter.value - start for counter, start in zip(counters, before)]
        after = self.context.getState(getPositions=True).getPositions(asNumpy=True)._value  # waits
        self.rows.append([(time.process_time() - clock) / steps, *(count / steps for count in counts)])
        return after

    def medians(self):
        return np.median(np.array(self.rows), axis=0)


def worst(system, r):
    bonds = [system.getConstraintParameters(k) for k in range(system.getNumConstraints())]
    d = np.linalg.norm(r[[i for i, _, _ in bonds]] - r[[j for _, j, _ in bonds]], axis=1)
    return np.abs(d / [length._value for _, _, length in bonds] - 1).max()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("scenes", nargs="*", default=[])
    parser.add_argument("--platform", default="OpenCL")
    parser.add_argument("--precision", default="mixed")
    parser.add_argument("--contexts", type=int, default=5)
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--steps", type=int, default=50)
    options = parser.parse_args()
    counters = counting()
    print(f"{'scene':17s}{'bonds':>7s} {'constraints':14s}{'us/step':>9s}{'kernels':>9s}{'waits':>7s}{'worst bond':>12s}{'made in, s':>12s}")
    for scene in options.scenes or SCENES:
        system, r = SCENES[scene]()
        masses = np.array([system.getParticleMass(i)._value for i in range(system.getNumParticles())])
        v = np.random.default_rng(2).normal(size=r.shape) * np.sqrt(2.494 / masses)[:, None]
        tangent = copy.deepcopy(system)
        add_holonomic(tangent)
        start = mm.Context(tangent, mm.VerletIntegrator(0.001), mm.Platform.getPlatformByName("Reference"))
        start.setPositions(r)
        start.setVelocities(v)
        start.applyVelocityConstraints(1e-8)
        v = start.getState(getVelocities=True).getVelocities(asNumpy=True)._value
        kinds = [("none", {}), ("OpenMM 1e-05", {"tolerance": 1e-5}), ("OpenMM 1e-06", {"tolerance": 1e-6}), ("holonomic", {"holonomic": True})]
        found, errors, made = {name: [] for name, _ in kinds}, {}, {}
        for _ in range(options.contexts):
            runs = [Run(name, system, options, r=r, v=v, **kind) for name, kind in kinds]
            for _ in range(options.rounds):
                for run in runs:
                    errors[run.name] = worst(system, run.measure(options.steps, counters))
            for run in runs:
                found[run.name].append(run.medians())
                made.setdefault(run.name, run.made)
        medians = {name: np.median(rows, axis=0) for name, rows in found.items()}
        for name, _ in kinds[1:]:
            seconds, launches, waits = medians[name] - medians["none"]
            print(f"{scene:17s}{system.getNumConstraints():7d} {name:14s}{1e6 * seconds:9.0f}{launches:9.1f}{waits:7.2f}"
                  f"{errors[name]:12.1e}{made[name]:12.1f}", flush=True)


if __name__ == "__main__":
    main()
