"""Butane through ASE, its bonds to hydrogen rigid: steps may be twice as long for the same error of the energy."""

import warnings

import numpy as np
from ase import units
from ase.build import molecule
from ase.calculators.calculator import Calculator, all_changes
from ase.md.velocitydistribution import MaxwellBoltzmannDistribution
from ase.md.verlet import VelocityVerlet

from holonomic.ase import Constraint

warnings.simplefilter("ignore", DeprecationWarning)


class Springs(Calculator):
    """A toy force field: springs between atoms that are one, two or three bonds apart, stiff, less so and soft."""

    implemented_properties = ["energy", "forces"]

    def __init__(self, atoms):
        super().__init__()
        d = atoms.get_all_distances()
        heavy = atoms.numbers > 1
        bonded = (d > 0) & (d < np.where(heavy[:, None] & heavy, 1.7, np.where(heavy[:, None] | heavy, 1.2, 0.0)))
        one = bonded.astype(int)
        two, three = one @ one > 0, one @ one @ one > 0
        k = np.where(bonded, 30.0, np.where(two, 6.0, np.where(three, 0.3, 0.0)))
        self.i, self.j = np.nonzero(np.triu(k, 1))
        self.k, self.length = k[self.i, self.j], d[self.i, self.j]

    def calculate(self, atoms=None, properties=("energy",), system_changes=all_changes):
        super().calculate(atoms, properties, system_changes)
        d = self.atoms.positions[self.j] - self.atoms.positions[self.i]
        length = np.linalg.norm(d, axis=1)
        pull = (self.k * (length - self.length) / length)[:, None] * d
        forces = np.zeros((len(self.atoms), 3))
        np.add.at(forces, self.i, pull)
        np.add.at(forces, self.j, -pull)
        self.results = {"energy": 0.5 * (self.k * (length - self.length) ** 2).sum(), "forces": forces}


def scatter(rigid, fs):
    """Of the total energy, eV, over 150 fs."""
    atoms = molecule("trans-butane")
    atoms.calc = Springs(atoms)
    if rigid:
        atoms.set_constraint(Constraint.hydrogens(atoms))
    MaxwellBoltzmannDistribution(atoms, temperature_K=300, rng=np.random.RandomState(3))
    lengths = [atoms.get_distance(i, j) for i, j in (atoms.constraints[0].pairs if rigid else [])]
    run = VelocityVerlet(atoms, fs * units.fs)
    total = []
    for _ in range(round(150 / fs)):
        run.run(1)
        total.append(atoms.get_total_energy())
    if rigid:
        now = [atoms.get_distance(i, j) for i, j in atoms.constraints[0].pairs]
        assert len(now) == 10 and np.abs(np.array(now) / lengths - 1).max() < 1e-13
        assert atoms.constraints[0].get_removed_dof(atoms) == 10
    return np.std(total)


free, rigid, long = scatter(False, 1.0), scatter(True, 1.0), scatter(True, 2.0)
print(f"butane, total energy scatters by: all free, 1 fs {free:.1e} eV; C-H rigid, 1 fs {rigid:.1e}, 2 fs {long:.1e}")
assert rigid < 0.5 * free and 2.5 < long / rigid < 6  # of second order in the step
