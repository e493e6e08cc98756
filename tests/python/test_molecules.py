"""What is bonded, settings, and all that is not part of a time step."""

import math
import unittest

import dense
import numpy as np

import holonomic as hol


class Bonds(unittest.TestCase):
    def test_shapes_and_counts(self):
        molecules = hol.Molecules(np.ones(30))
        molecules.add_molecules(2, 4, [(0, 1), (0, 2), (1, 2)], [1, 1, 1.5])  # the fourth is a virtual site
        molecules.add_chains(2, 3, 1.0, first_atom=8)
        molecules.add([(16, 17), (16, 18), (16, 19), (20, 21), (21, 22), (22, 23), (23, 20)], 1.0)
        self.assertEqual((molecules.n_atoms, molecules.n_bonds, molecules.n_molecules), (30, 19, 6))
        self.assertEqual([molecules.n_of_shape(s) for s in ("chain", "tree", "ring", "triangle", "other")], [2, 1, 1, 2, 0])
        self.assertEqual(molecules.degrees_of_freedom(), 3 * 30 - 19)
        self.assertEqual(molecules.degrees_of_freedom(2), 2 * 30 - 19)
        water = molecules.molecule(1)
        self.assertEqual(water.shape, "triangle")
        np.testing.assert_array_equal(water.atoms, [4, 5, 6])
        np.testing.assert_array_equal(water.bonds, [3, 4, 5])
        np.testing.assert_array_equal(molecules.molecules_of_bonds()[-7:], [4, 4, 4, 5, 5, 5, 5])
        self.assertEqual(molecules.n_kinds, 4)
        self.assertGreater(molecules.memory, 1000)

    def test_new_lengths_and_masses(self):
        molecules = hol.Molecules([1.0, 3.0])
        molecules.add([(0, 1)], 1)
        molecules.set_lengths(1.2)
        r_ref = np.array([(0, 0, 0), (1.2, 0, 0.0)])
        r = np.array([(0, 0, 0), (1.24, 0, 0.0)])
        molecules.set_masses([1.0, 1.0])
        molecules.project_positions(r_ref, r, 1)
        np.testing.assert_allclose(r[:, 0], [0.02, 1.22], atol=1e-15)

    def test_inactive_molecules_are_left_alone(self):
        molecules = hol.Molecules(np.ones(4))
        molecules.add([(0, 1), (2, 3)], 1)
        molecules.active = [True, False]
        r = np.array([(0, 0, 0), (1.1, 0, 0), (0, 0, 0), (1.1, 0, 0.0)])
        reference = np.array([(0, 0, 0), (1, 0, 0), (0, 0, 0), (1, 0, 0.0)])
        molecules.project_positions(reference, r, 1)
        np.testing.assert_allclose(r[:, 0], [0.05, 1.05, 0, 1.1], atol=1e-15)
        molecules.active = None
        molecules.project_positions(reference, r, 1)
        np.testing.assert_allclose(r[2:, 0], [0.05, 1.05], atol=1e-15)

    def test_a_loose_tolerance_is_kept_and_reported(self):
        rng = np.random.default_rng(2)
        r, bonds, masses = dense.random_molecule(rng, 20)
        molecules = hol.Molecules(masses)
        molecules.add(bonds, np.linalg.norm(dense.bond_vectors(r, bonds), axis=1))
        molecules.tolerance, molecules.threads, molecules.max_iterations = 1e-3, 2, 10
        self.assertEqual((molecules.tolerance, molecules.threads, molecules.max_iterations), (1e-3, 2, 10))
        moved = r + 0.02 * rng.normal(size=r.shape)
        report = molecules.project_positions(r, moved, 1)
        self.assertLess(report.max_error, 1e-3)
        self.assertAlmostEqual(molecules.violation(moved).length, report.max_error, delta=1e-12)
        self.assertGreater(molecules.violation(moved).length, 1e-14)

    def test_a_rate_of_the_box_is_in_the_velocities(self):
        molecules = hol.Molecules([1.0, 1.0])
        molecules.add([(0, 1)], 1)
        r, v = np.array([(0, 0, 0), (1.0, 0, 0)]), np.zeros((2, 3))
        molecules.box_rate = 0.1
        molecules.project_velocities(r, v)
        np.testing.assert_allclose(v[:, 0], [0.05, -0.05], atol=1e-16)

    def test_the_error_of_a_reference(self):
        molecules = hol.Molecules([1.0, 1.0])
        molecules.add([(0, 1)], 1)
        r = np.array([(0, 0, 0), (1.01, 0, 0)])
        with self.assertRaises(hol.StateError):
            molecules.reference_error()
        molecules.project_positions(r, r, 1)
        error, molecule, bond = molecules.reference_error()
        self.assertAlmostEqual(error, 1.01**2 - 1, places=14)
        self.assertEqual((molecule, bond), (0, 0))


class Metric(unittest.TestCase):
    def test_determinants_and_the_gradient_of_the_energy(self):
        for shape in ("tree", "ring"):
            rng = np.random.default_rng(3)
            r, bonds, masses = dense.random_molecule(rng, 8, shape)
            molecules = hol.Molecules(masses)
            molecules.add(bonds, np.linalg.norm(dense.bond_vectors(r, bonds), axis=1))
            found = molecules.metric(r, kT=2.5)
            z = dense.matrix(r, bonds, masses)
            scale = 1 / np.sqrt(np.diag(z))
            self.assertAlmostEqual(found.log_det_z[0], np.linalg.slogdet(z)[1], places=10)
            self.assertAlmostEqual(found.log_det[0], np.linalg.slogdet(z * scale[:, None] * scale)[1], places=10)
            self.assertAlmostEqual(found.energy, 2.5 / 2 * found.log_det[0], places=12)
            h = 1e-5
            for i, a in ((0, 0), (3, 1), (7, 2)):
                ends = []
                for sign in (-1, 1):
                    moved = r.copy()
                    moved[i, a] += sign * h
                    ends.append(molecules.metric(moved, kT=2.5).energy)
                self.assertAlmostEqual(found.forces[i, a], -(ends[1] - ends[0]) / (2 * h), places=7)

    def test_inverse_and_its_bound(self):
        rng = np.random.default_rng(5)
        r, bonds, masses = dense.random_molecule(rng, 10, "chain")
        molecules = hol.Molecules(masses)
        molecules.add(bonds, np.linalg.norm(dense.bond_vectors(r, bonds), axis=1))
        inverse = molecules.inverse(0, r)
        z = dense.matrix(r, bonds, masses)
        wanted = np.linalg.inv(z)
        np.testing.assert_allclose(inverse.matrix(physical=True), wanted, atol=1e-11 * abs(wanted).max())
        np.testing.assert_allclose(inverse.row(2, physical=True), wanted[2], atol=1e-11 * abs(wanted).max())
        self.assertAlmostEqual(inverse.entry(2, 5, physical=True), wanted[2, 5], places=10)
        band = inverse.band(2, physical=True)
        self.assertEqual(band.shape, (9, 3))
        np.testing.assert_allclose(band[:7, 2], np.diag(wanted, 2), atol=1e-11 * abs(wanted).max())
        unit = z / np.sqrt(np.outer(np.diag(z), np.diag(z)))
        norm = np.linalg.norm
        self.assertAlmostEqual(inverse.condition() / (norm(unit, np.inf) * norm(np.linalg.inv(unit), np.inf)), 1, places=9)
        f = rng.normal(size=r.shape)
        exact = molecules.forces(r, None, f).lambda_
        bound, relative = inverse.error_bound(exact + 1e-6, None, f)
        self.assertTrue((bound >= 1e-6 * (1 - 1e-6)).all())
        self.assertLess(inverse.error_bound(exact, None, f)[1], 1e-13)
        self.assertGreater(relative, 1e-8)
        with self.assertRaises(IndexError):
            inverse.row(9)

    def test_tridiagonal(self):
        gamma = np.array([0.3, -0.4, 0.2, 0.5])
        t = np.eye(5) - np.diag(gamma, 1) - np.diag(gamma, -1)
        inverse = np.linalg.inv(t)
        b = np.arange(5.0)
        np.testing.assert_allclose(hol.tridiagonal.solve(gamma, b), inverse @ b, atol=1e-14)
        self.assertAlmostEqual(hol.tridiagonal.log_det(gamma), math.log(np.linalg.det(t)), places=14)
        self.assertAlmostEqual(np.prod(hol.tridiagonal.pivots(gamma)), np.linalg.det(t), places=14)
        self.assertAlmostEqual(hol.tridiagonal.inverse_entry(gamma, 1, 3), inverse[1, 3], places=14)
        np.testing.assert_allclose(hol.tridiagonal.inverse_band(gamma, 1)[:4, 1], np.diag(inverse, 1), atol=1e-14)
        with self.assertRaises(hol.NotDefiniteError):
            hol.tridiagonal.log_det([2.0])

    def test_partition_function_of_a_trimer(self):
        # det Z~ = 1 - gamma^2 with gamma uniform in 0 .. 1/2: the means of its powers -1/2 and 1/2 are elementary.
        found = hol.partition_function(2)
        he = math.asin(0.5) / 0.5
        rigid = (0.5 * math.sqrt(0.75) + math.asin(0.5)) / 2 / 0.5
        self.assertAlmostEqual(found.log_he, math.log(he), places=14)
        self.assertAlmostEqual(found.log_rigid, math.log(rigid), places=14)
        self.assertAlmostEqual(found.log_volume, math.log(0.5), places=14)
        with self.assertRaises(hol.ArgumentError):
            hol.partition_function(3, [1, 1])


if __name__ == "__main__":
    unittest.main()
