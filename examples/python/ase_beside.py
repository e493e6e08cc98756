"""holonomic.ase.Constraint beside ASE's own FixBondLengths: molecules in free flight at 300 K, by ASE's velocity Verlet.

    ase_beside.py [--steps N] [--ways]

Without forces the energy is conserved to rounding if the constraints are, and a step costs what they cost. --ways: Langevin, BFGS
and FIRE, with springs that pull every atom to a place near its own.
"""

import argparse
import time

import numpy as np
from ase import Atoms, units
from ase.calculators.calculator import Calculator
from ase.constraints import FixBondLengths
from ase.md.langevin import Langevin
from ase.md.velocitydistribution import MaxwellBoltzmannDistribution
from ase.md.verlet import VelocityVerlet
from ase.neighborlist import natural_cutoffs, neighbor_list
from ase.optimize import BFGS, FIRE

from holonomic.ase import Constraint


class FreeFlight(Calculator):
    implemented_properties = ["energy", "forces"]

    def calculate(self, atoms=None, properties=("energy",), system_changes=()):
        self.results = {"energy": 0.0, "forces": np.zeros((len(atoms), 3))}


class Springs(Calculator):
    """To places about 0.2 away from where the atoms are now."""

    implemented_properties = ["energy", "forces"]

    def __init__(self, atoms):
        super().__init__()
        self.places = atoms.positions + np.random.default_rng(2).normal(scale=0.2, size=atoms.positions.shape)

    def calculate(self, atoms=None, properties=("energy",), system_changes=()):
        d = atoms.positions - self.places
        self.results = {"energy": 2.5 * (d**2).sum(), "forces": -5 * d}


def water(n):
    """n^3 rigid waters in a cell."""
    one = Atoms("OH2", positions=[(0, 0, 0), (0.9572, 0, 0), (-0.23999, 0.92663, 0)], cell=[3.1] * 3)
    atoms = one.repeat((n, n, n))
    atoms.pbc = True
    pairs = [(3 * m + i, 3 * m + j) for m in range(n**3) for i, j in ((0, 1), (0, 2), (1, 2))]
    return atoms, pairs


def alkane(n):
    """A stretched CnH2n+2."""
    symbols, positions = [], []
    for k in range(n):
        up = 1 if k % 2 else -1
        carbon = np.array([1.27 * k, 0.42 * up, 0])
        symbols.append("C")
        positions.append(carbon)
        ends = [(0, 0.65 * up, 0.88), (0, 0.65 * up, -0.88)]
        ends += [(-0.9, -0.62 * up, 0)] if k == 0 else [(0.9, -0.62 * up, 0)] if k == n - 1 else []
        for end in ends:
            symbols.append("H")
            positions.append(carbon + end)
    return Atoms(symbols, positions=positions), None


def peptide(n):
    """A stretched acetyl-(glycine)n-N-methylamide, heavy atoms and the hydrogens of the backbone's nitrogens."""
    symbols, positions = ["C"], [(-2.4, -0.6, 0.0)]
    for k in range(n + 1):
        up = 1 if k % 2 else -1
        x = 3.6 * k
        for symbol, place in (("C", (x - 1.1, 0.15 * up, 0)), ("O", (x - 1.1, 1.38 * up, 0)), ("N", (x, -0.6 * up, 0)),
                              ("H", (x, -1.6 * up, 0)), ("C", (x + 1.25, 0.15 * up, 0))):
            symbols.append(symbol)
            positions.append(place)
    return Atoms(symbols, positions=positions), None


def bonds_of(atoms, pairs):
    if pairs is None:
        i, j = neighbor_list("ij", atoms, natural_cutoffs(atoms, mult=1.15))
        pairs = [(a, b) for a, b in zip(i, j) if a < b]
    return np.array(pairs)


def with_angles(atoms, pairs):
    """Bonds, and as many of the distances beside them as are independent: each atom at three of those before it at most."""
    neighbours = {i: set() for i in range(len(atoms))}
    for i, j in pairs:
        neighbours[i].add(j)
        neighbours[j].add(i)
    more = set()
    for middle, around in neighbours.items():
        around = sorted(around)
        first = around[0] if around else None
        for k, atom in enumerate(around[1:], 1):
            more.add((first, atom))
            if k >= 2:
                more.add((around[1], atom))
    return np.concatenate([pairs, sorted(more)]) if more else pairs


def fly(atoms, pairs, make, femtoseconds, steps):
    """Milliseconds per step, worst error of a length, drift of the energy relative to it; or what stopped it."""
    atoms = atoms.copy()
    lengths = np.array([atoms.get_distance(i, j, mic=True) for i, j in pairs])
    atoms.calc = FreeFlight()
    MaxwellBoltzmannDistribution(atoms, temperature_K=300, rng=np.random.default_rng(1))
    step = 0
    try:
        atoms.set_constraint(make(pairs))
        atoms.set_momenta(atoms.get_momenta())
        energy = atoms.get_kinetic_energy()
        dynamics = VelocityVerlet(atoms, femtoseconds * units.fs)
        clock = time.process_time()
        for step in range(steps):
            dynamics.run(1)
        clock = time.process_time() - clock
    except (RuntimeError, ArithmeticError) as error:
        return f"stops at step {step}: {type(error).__name__}"
    now = np.array([atoms.get_distance(i, j, mic=True) for i, j in pairs])
    return (f"{1e3 * clock / steps:9.3f} ms {abs(now / lengths - 1).max():8.1e} "
            f"{abs(atoms.get_kinetic_energy() / energy - 1):8.1e}")


def go(atoms, pairs, make, way, steps):
    """Milliseconds per step, worst error of a length, and the temperature, or the steps to a force below 0.01 eV/A."""
    atoms = atoms.copy()
    lengths = np.array([atoms.get_distance(i, j, mic=True) for i, j in pairs])
    atoms.calc = Springs(atoms)
    MaxwellBoltzmannDistribution(atoms, temperature_K=300, rng=np.random.default_rng(1))
    taken = 0
    clock = time.process_time()
    try:
        atoms.set_constraint(make(pairs))
        if way is Langevin:
            atoms.set_momenta(atoms.get_momenta())
            # the random numbers of both are the same
            motion = Langevin(atoms, 2 * units.fs, temperature_K=300, friction=0.02 / units.fs, rng=np.random.RandomState(3))
            for taken in range(1, steps + 1):
                motion.run(1)
            end = f"{atoms.get_temperature():6.0f} K"
        else:
            motion = way(atoms, logfile=None)
            for _ in motion.irun(fmax=0.01, steps=steps):
                taken = motion.nsteps
            left = np.linalg.norm(atoms.get_forces(), axis=1).max()
            end = f"{taken} steps" if left < 0.01 else f"{left:.2g} eV/A left after {taken}"
    except (RuntimeError, ArithmeticError) as error:
        return f"stops at step {taken}: {type(error).__name__}"
    clock = time.process_time() - clock
    now = np.array([atoms.get_distance(i, j, mic=True) for i, j in pairs])
    return f"{1e3 * clock / max(taken, 1):9.3f} ms {abs(now / lengths - 1).max():8.1e} {end}"


def ways(steps):
    print(f"{'':34s}{'FixBondLengths':48s}holonomic.ase.Constraint")
    print(f"{'':34s}" + 2 * f"{'time per step, lengths, end':48s}")
    for name, (atoms, pairs) in (("8 waters", water(2)), ("hexadecane", alkane(16)), ("glycine peptide", peptide(10))):
        pairs = bonds_of(atoms, pairs)
        for way in Langevin, BFGS, FIRE:
            cells = [go(atoms, pairs, make, way, steps) for make in (FixBondLengths, Constraint)]
            print(f"{f'{name} ({len(pairs)}), {way.__name__}':34s}" + "".join(f"{cell:48s}" for cell in cells), flush=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--steps", type=int, default=50)
    parser.add_argument("--ways", action="store_true")
    chosen = parser.parse_args()
    steps = chosen.steps
    if chosen.ways:
        return ways(steps)
    print(f"{'':44s}{'FixBondLengths':34s}holonomic.ase.Constraint")
    print(f"{'':44s}" + 2 * f"{'time per step, lengths, energy':34s}")
    for name, (atoms, pairs), angles, femtoseconds in (
        ("64 waters, 2 fs", water(4), False, 2), ("64 waters, 8 fs", water(4), False, 8),
        ("hexadecane, bonds, 2 fs", alkane(16), False, 2), ("hexadecane, bonds, 6 fs", alkane(16), False, 6),
        ("hexadecane, bonds and angles, 2 fs", alkane(16), True, 2),
        ("glycine peptide, bonds, 2 fs", peptide(10), False, 2), ("glycine peptide, bonds, 6 fs", peptide(10), False, 6),
    ):
        pairs = bonds_of(atoms, pairs)
        if angles:
            pairs = with_angles(atoms, pairs)
        cells = [fly(atoms, pairs, make, femtoseconds, steps) for make in (FixBondLengths, Constraint)]
        print(f"{f'{name} ({len(pairs)})':44s}" + "".join(f"{cell:34s}" for cell in cells), flush=True)


if __name__ == "__main__":
    main()
