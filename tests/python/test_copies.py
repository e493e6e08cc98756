"""Copies of sets and of results: each is a set of its own, and nobody uses what another one has released."""

import copy
import gc
import pickle
import unittest

import dense
import numpy as np

import holonomic as hol

WAYS = (copy.copy, copy.deepcopy, lambda thing: pickle.loads(pickle.dumps(thing)))


def everything():
    """A set to which molecules were added in every way, with places for its 40 atoms."""
    rng = np.random.default_rng(0)
    masses = rng.uniform(1, 3, 40)
    masses[25] = 0
    molecules = hol.Molecules(masses, fixed=[30])
    r = np.cumsum(rng.uniform(0.5, 1, (40, 3)), axis=0)
    distance = lambda bonds: np.linalg.norm(np.diff(r[np.array(bonds)], axis=1)[:, 0], axis=1)
    molecules.add([(0, 1), (1, 2), (3, 1)], distance([(0, 1), (1, 2), (3, 1)]))
    r[7:10] = r[4:7] + 20
    molecules.add_molecules(2, 3, [(0, 1), (0, 2), (1, 2)], distance([(4, 5), (4, 6), (5, 6)]), first_atom=4)
    molecules.add_chain([12, 10, 11], distance([(12, 10), (10, 11)]))
    r[16:19] = r[13:16] - 20
    molecules.add_chains(2, 2, distance([(13, 14), (14, 15)]), first_atom=13)
    r[25] = 0.5 * r[22] + 0.3 * r[23] + 0.2 * r[24]  # a massless site
    molecules.add_rigid([[22, 23, 24, 25]], [r[22:26]], [(22, 26)], distance([(22, 26)]))
    r[31:34] = r[27:30] + 30
    molecules.add_rigid_molecules(2, 4, [[0, 1, 2]], [r[27:30]], first_atom=27)
    molecules.add([(30, 35)], distance([(30, 35)]))
    return molecules, r


class Sets(unittest.TestCase):
    def test_a_copy_outlives_what_it_was_made_of(self):
        for way in WAYS:
            molecules = hol.Molecules([1.0, 3.0])
            molecules.add([(0, 1)], 1)
            other = way(molecules)
            del molecules
            gc.collect()
            for _ in range(5):
                hol.Molecules(np.ones(1000)).add_chains(100, 9, 1.0)  # what was released is used for something else
            r, f = np.array([(0, 0, 0), (1.0, 0, 0)]), np.array([(0, 0, 0), (2.0, 0, 0)])
            np.testing.assert_allclose(other.forces(r, None, f).tensions, [0.5], rtol=1e-14)

    def test_what_is_done_to_one_does_not_reach_the_other(self):
        for way in WAYS:
            molecules = hol.Molecules(np.ones(4))
            molecules.add([(0, 1)], 1)
            other = way(molecules)
            molecules.add([(2, 3)], 1)
            molecules.set_lengths(2)
            self.assertEqual((molecules.n_bonds, other.n_bonds), (2, 1))
            np.testing.assert_array_equal(other.lengths, [1])

    def test_all_that_was_added_is_in_it_to_the_bit(self):
        molecules, r = everything()
        rng = np.random.default_rng(1)
        v, f = rng.normal(size=(2, 40, 3))
        molecules.set_masses(molecules.masses * 1.5)
        molecules.set_lengths(molecules.lengths * (1 + 1e-9))
        wanted = molecules.forces(r, v, f)
        for way in WAYS:
            other = way(molecules)
            self.assertEqual([other.n_of_shape(s) for s in ("chain", "tree", "triangle", "rigid")],
                             [molecules.n_of_shape(s) for s in ("chain", "tree", "triangle", "rigid")])
            found = other.forces(r, v, f)
            np.testing.assert_array_equal(found.lambda_, wanted.lambda_)
            np.testing.assert_array_equal(found.forces, wanted.forces)
            np.testing.assert_array_equal(other.bonds, molecules.bonds)
            np.testing.assert_array_equal(other.lengths, molecules.lengths)
            np.testing.assert_array_equal(other.masses, molecules.masses)

    def test_bonds_and_lengths_are_those_of_the_library(self):
        molecules, r = everything()
        self.assertEqual(len(molecules.bonds), molecules.n_bonds)
        np.testing.assert_allclose(np.linalg.norm(dense.bond_vectors(r, molecules.bonds), axis=1), molecules.lengths, rtol=1e-14)
        for number in range(molecules.n_molecules):
            molecule = molecules.molecule(number)
            if len(molecule.bonds):
                self.assertTrue(set(molecules.bonds[molecule.bonds].ravel()) <= set(molecule.atoms) | {30})
        self.assertLess(molecules.residuals(r)[0].max(), 1e-14)

    def test_settings_are_in_it(self):
        molecules, _ = everything()
        molecules.box, molecules.reference_box, molecules.box_rate = [200, 300, 0], 210, 0.1
        molecules.threads, molecules.tolerance, molecules.max_iterations, molecules.memory_limit = 2, 1e-7, 9, 10**9
        molecules.checks, molecules.keep_outcomes = "never", True
        molecules.active = np.arange(molecules.n_molecules) % 2 == 0
        molecules.set_labels(np.arange(40) + 9000)
        for way in WAYS:
            other = way(molecules)
            for name in ("box", "reference_box", "box_rate", "active"):
                np.testing.assert_array_equal(getattr(other, name), getattr(molecules, name))
            for name in ("threads", "tolerance", "max_iterations", "memory_limit", "checks", "keep_outcomes"):
                self.assertEqual(getattr(other, name), getattr(molecules, name))
            np.testing.assert_array_equal(other.labels[0], np.arange(40) + 9000)
            np.testing.assert_array_equal(other.labels[1], np.arange(molecules.n_molecules))
            r = np.zeros((40, 3))
            with self.assertRaisesRegex(hol.DegenerateError, "90"):
                other.forces(r)

    def test_arrays_that_were_given_may_change_afterwards(self):
        masses, bonds, lengths = np.ones(2), np.array([(0, 1)]), np.ones(1)
        molecules = hol.Molecules(masses)
        molecules.add(bonds, lengths)
        masses[:], bonds[:], lengths[:] = 7, 0, 7
        other = copy.copy(molecules)
        np.testing.assert_array_equal(other.masses, [1, 1])
        np.testing.assert_array_equal(other.bonds, [(0, 1)])
        np.testing.assert_array_equal(other.lengths, [1])

    def test_classes_derived_from_it_keep_what_they_add(self):
        class Named(hol.Molecules):
            def __init__(self, masses, name):
                super().__init__(masses)
                self.name = name

        named = Named(np.ones(2), "oil")
        named.add([(0, 1)], 1)
        for way in WAYS[:2]:
            other = way(named)
            self.assertIsInstance(other, Named)
            self.assertEqual((other.name, other.n_bonds), ("oil", 1))


class Results(unittest.TestCase):
    def test_are_copied_with_their_numbers(self):
        molecules, r = everything()
        f = np.random.default_rng(1).normal(size=(40, 3))
        for of in (molecules.forces(r, None, f), molecules.forces(r, None, f, out=np.zeros((40, 3)))):
            for way in WAYS:
                other = way(of)
                for name in ("lambda_", "tensions", "virial", "forces"):
                    np.testing.assert_array_equal(getattr(other, name), getattr(of, name))
        report = molecules.project_positions(r, r + 0.0, 1, multipliers=True)
        for way in WAYS:
            self.assertEqual(way(report).iterations, report.iterations)
            np.testing.assert_array_equal(way(report).lambda_, report.lambda_)

    def test_an_inverse_is_its_own_copy_and_says_why_it_cannot_be_pickled(self):
        molecules, r = everything()
        inverse = molecules.inverse(0, r)
        wanted = inverse.matrix()
        other, deep = copy.copy(inverse), copy.deepcopy(inverse)
        del inverse, molecules
        gc.collect()
        np.testing.assert_array_equal(other.matrix(), wanted)
        np.testing.assert_array_equal(deep.matrix(), wanted)
        with self.assertRaisesRegex(TypeError, "pickle the Molecules"):
            pickle.dumps(other)


if __name__ == "__main__":
    unittest.main()
