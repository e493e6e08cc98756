"""The constraint for ASE: dynamics and minimisation keep the bonds, beside ASE's own constraint and a dense solution."""

import copy
import unittest

import dense
import numpy as np
from ase import Atoms, units
from ase.calculators.calculator import Calculator
from ase.constraints import FixAtoms, FixBondLengths, dict2constraint
from ase.md.langevin import Langevin
from ase.md.verlet import VelocityVerlet
from ase.optimize import BFGS, FIRE

from holonomic.ase import Constraint


class Springs(Calculator):
    """Every pair of atoms on a weak spring: an energy with gradients, soft enough for steps of a femtosecond."""

    implemented_properties = ["energy", "forces"]

    def calculate(self, atoms=None, properties=("energy",), system_changes=()):
        super().calculate(atoms, properties, system_changes)
        d = self.atoms.positions[:, None] - self.atoms.positions[None]
        length = np.sqrt((d**2).sum(2)) + np.eye(len(d))
        stretch = (length - 2.5) * (1 - np.eye(len(d)))
        self.results = {"energy": 0.25 * 0.05 * (stretch**2).sum(),
                        "forces": -0.05 * ((stretch / length)[:, :, None] * d).sum(1)}


def propane_like(seed=0):
    """A branched molecule of 11 atoms of different masses, all bonds and one angle rigid."""
    rng = np.random.default_rng(seed)
    r, bonds, _ = dense.random_molecule(rng, 11)
    atoms = Atoms("C3H5O2N", positions=r, calculator=Springs())
    atoms.set_momenta(rng.normal(size=r.shape) * 0.3)
    return atoms, bonds


def lengths_of(atoms, pairs):
    return np.array([atoms.get_distance(i, j, mic=True) for i, j in pairs])


class Dynamics(unittest.TestCase):
    def test_velocity_verlet_is_that_of_fix_bond_lengths(self):
        ends = []
        for make in (FixBondLengths, Constraint):
            atoms, bonds = propane_like()
            atoms.set_constraint(make(bonds))
            atoms.set_momenta(atoms.get_momenta())  # onto the constraints
            before, energy = lengths_of(atoms, bonds), atoms.get_total_energy()
            VelocityVerlet(atoms, 0.5 * units.fs).run(50)
            self.assertLess(abs(lengths_of(atoms, bonds) - before).max(), 1e-11)
            self.assertLess(abs(atoms.get_total_energy() - energy), 2e-4 * atoms.get_kinetic_energy())
            ends.append((atoms.positions, atoms.get_momenta()))
        np.testing.assert_allclose(ends[0][0], ends[1][0], atol=1e-9)
        np.testing.assert_allclose(ends[0][1], ends[1][1], atol=1e-8)

    def test_momenta_are_those_of_the_dense_solution(self):
        atoms, bonds = propane_like(1)
        constraint = Constraint(bonds, angles=[(bonds[0][0], bonds[0][1], bonds[1][1])] if bonds[0][1] == bonds[1][0] else ())
        masses = atoms.get_masses()
        wanted = dense.velocities(atoms.positions, atoms.get_velocities(), constraint.pairs, masses) * masses[:, None]
        atoms.set_constraint(constraint)
        atoms.set_momenta(atoms.get_momenta())
        np.testing.assert_allclose(atoms.get_momenta(), wanted, atol=1e-12)

    def test_langevin_keeps_lengths_and_temperature(self):
        n = 40  # dimers: five degrees of freedom each
        rng = np.random.default_rng(2)
        positions = np.repeat(rng.uniform(0, 30, (n, 3)), 2, axis=0)
        positions[1::2, 0] += 1.1
        atoms = Atoms("N" * (2 * n), positions=positions)
        pairs = np.arange(2 * n).reshape(n, 2)
        constraint = Constraint(pairs)

        class Nothing(Calculator):
            implemented_properties = ["energy", "forces"]

            def calculate(self, atoms=None, properties=("energy",), system_changes=()):
                self.results = {"energy": 0.0, "forces": np.zeros((2 * n, 3))}

        atoms.calc = Nothing()
        atoms.set_constraint(constraint)
        self.assertEqual(atoms.get_number_of_degrees_of_freedom() if hasattr(atoms, "get_number_of_degrees_of_freedom")
                         else 6 * n - constraint.get_removed_dof(atoms), 5 * n)
        md = Langevin(atoms, 2 * units.fs, temperature_K=300, friction=0.1, fixcm=False, rng=np.random.default_rng(3))
        md.run(50)
        temperatures = []
        for _ in range(150):
            md.run(2)
            temperatures.append(2 * atoms.get_kinetic_energy() / (5 * n * units.kB))
        # Mean of 150 samples that are independent after a few steps, of 200 degrees of freedom each: 300 +- 6 K; at 5 fs^-1
        # friction ASE's Langevin has an error of its own of a few K.
        self.assertLess(abs(np.mean(temperatures) - 300), 25)
        np.testing.assert_allclose(lengths_of(atoms, pairs), 1.1, atol=1e-12)

    def test_a_bond_longer_than_half_the_cell(self):
        """A reaction coordinate: its length says which image is meant, wherever the atoms are put in the cell."""
        for shift in (0, 7.22):
            atoms = Atoms("HO", positions=[[0.3, 1, 1], [4.13 - shift, 1, 1]], cell=[7.22] * 3, pbc=True)
            atoms.set_constraint(Constraint([(0, 1)], 3.8295))
            new = atoms.positions + [[0.03, 0.2, 0], [0, 0, 0.1]]
            atoms.set_positions(new)
            d = atoms.positions[1] - atoms.positions[0] + [shift, 0, 0]
            self.assertLess(abs(np.linalg.norm(d) - 3.8295), 1e-13)
            self.assertLess(np.abs(atoms.positions - new).max(), 0.05)

    def test_wrapped_molecules_in_a_cell(self):
        ends = []
        for wrap in (False, True):
            atoms, bonds = propane_like(3)
            atoms.set_cell([[14, 0, 0], [2, 14, 0], [0, -3, 14]])
            atoms.pbc = True
            lengths = lengths_of(atoms, bonds)
            old, new = atoms.positions.copy(), atoms.positions + 0.02 * atoms.get_momenta()
            if wrap:
                atoms.wrap()
                new += atoms.positions - old
                self.assertGreater(abs(atoms.positions - old).max(), 5)
            constraint = Constraint(bonds)
            shift = atoms.positions - old
            atoms.set_constraint(constraint)
            atoms.set_positions(new)
            np.testing.assert_allclose(lengths_of(atoms, bonds), lengths, atol=1e-13)
            ends.append(atoms.positions - shift)
        np.testing.assert_allclose(ends[0], ends[1], atol=1e-12)

    def test_held_atoms_stay_whichever_comes_first(self):
        ends = []
        for first in (True, False):
            atoms, bonds = propane_like(4)
            pair = [FixAtoms([0, 4]), Constraint(bonds)]
            atoms.set_constraint(pair if first else pair[::-1])
            held = atoms.positions[[0, 4]].copy()
            atoms.set_momenta(atoms.get_momenta())
            lengths = lengths_of(atoms, bonds)
            VelocityVerlet(atoms, 0.5 * units.fs).run(20)
            np.testing.assert_array_equal(atoms.positions[[0, 4]], held)
            np.testing.assert_allclose(lengths_of(atoms, bonds), lengths, atol=1e-12)
            ends.append(atoms.positions.copy())
        np.testing.assert_array_equal(*ends)


class Minimisation(unittest.TestCase):
    def test_bfgs_and_fire_find_a_constrained_minimum(self):
        for optimizer in (BFGS, FIRE):
            atoms, bonds = propane_like(5)
            constraint = Constraint(bonds)
            atoms.set_constraint(constraint)
            lengths = lengths_of(atoms, bonds)
            self.assertTrue(optimizer(atoms, logfile=None).run(fmax=1e-3, steps=1000), optimizer.__name__)
            np.testing.assert_allclose(lengths_of(atoms, bonds), lengths, atol=1e-12)
            # The gradient is a combination of those of the constraints.
            raw = atoms.get_forces(apply_constraint=False).ravel()
            rows = dense.gradients(dense.bond_vectors(atoms.positions, bonds), bonds, len(atoms))
            left = raw - rows.T @ np.linalg.lstsq(rows.T, raw, rcond=None)[0]
            self.assertLess(abs(left).max(), 1e-3)
            np.testing.assert_allclose(atoms.get_forces().ravel(), left, atol=1e-10)
            np.testing.assert_allclose(constraint.constraint_forces.ravel(), left - raw, atol=1e-10)

    def test_crude_positions_are_made_right(self):
        atoms, bonds = propane_like(6)
        wanted = lengths_of(atoms, bonds)
        atoms.positions += 0.15 * np.random.default_rng(1).normal(size=(11, 3))
        constraint = Constraint(bonds, wanted)
        atoms.set_constraint(constraint)
        constraint.impose(atoms)
        np.testing.assert_allclose(lengths_of(atoms, bonds), wanted, atol=1e-13)
        self.assertLess(constraint.molecules(atoms).violation(atoms.positions, atoms.get_velocities()).rate, 1e-14)


class Bookkeeping(unittest.TestCase):
    def test_rigid_water_has_six_degrees_of_freedom(self):
        atoms = Atoms("OH2OH2", positions=[(0, 0, 0), (0.96, 0, 0), (-0.24, 0.93, 0)] * 2)
        atoms.positions[3:] += 5
        constraint = Constraint([(0, 1), (0, 2), (3, 4), (3, 5)], angles=[(1, 0, 2), (4, 3, 5)])
        atoms.set_constraint(constraint)
        self.assertEqual(18 - constraint.get_removed_dof(atoms), 12)
        self.assertEqual(constraint.molecules(atoms).n_of_shape("triangle"), 2)

    def test_copies_selections_and_repetitions(self):
        atoms, bonds = propane_like(7)
        constraint = Constraint(bonds)
        atoms.set_constraint(constraint)
        atoms.set_positions(atoms.positions)  # sets the lengths
        other = atoms.copy().constraints[0]
        self.assertIsInstance(other, Constraint)
        np.testing.assert_array_equal(other.pairs, bonds)
        np.testing.assert_array_equal(copy.deepcopy(constraint).lengths, constraint.lengths)
        part = atoms[[3, 2, 1, 0]].constraints[0]
        kept = [(i, j) for i, j in bonds if i < 4 and j < 4]
        np.testing.assert_array_equal(part.pairs, [(3 - i, 3 - j) for i, j in kept])
        atoms.set_cell([20, 20, 20])
        twice = atoms.repeat((2, 1, 1))
        twice.set_positions(twice.positions + 0.01 * np.random.default_rng(0).normal(size=(22, 3)))
        np.testing.assert_allclose(lengths_of(twice, twice.constraints[0].pairs), np.tile(constraint.lengths, 2), atol=1e-13)

    def test_written_as_a_constraint_that_every_ase_reads(self):
        atoms, bonds = propane_like(8)
        constraint = Constraint(bonds)
        atoms.set_constraint(constraint)
        atoms.set_positions(atoms.positions)
        read = dict2constraint(constraint.todict())
        self.assertIsInstance(read, FixBondLengths)
        np.testing.assert_allclose(read.bondlengths, constraint.lengths)

    def test_wrong_arguments(self):
        for bonds in ([], [1, 2], [(1, 2, 3)]):
            with self.assertRaises(ValueError):
                Constraint(bonds)
        with self.assertRaises(ValueError):
            Constraint([(0, 1)], angles=[(0, 1)])


if __name__ == "__main__":
    unittest.main()
