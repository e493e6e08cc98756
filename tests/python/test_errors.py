"""Errors are exceptions that say what and where; what was good is complete."""

import unittest

import numpy as np

import holonomic as hol


def dimers(n):
    molecules = hol.Molecules(np.ones(2 * n))
    molecules.add_molecules(n, 2, [(0, 1)], 1)
    r = np.zeros((2 * n, 3))
    r[:, 1] = 10 * (np.arange(2 * n) // 2)
    r[1::2, 0] = 1
    return molecules, r


class Errors(unittest.TestCase):
    def test_wrong_arguments_have_their_classes(self):
        molecules = hol.Molecules(np.ones(4))
        with self.assertRaises(hol.NumberError) as caught:
            molecules.add([(0, 9)], 1)
        self.assertIsInstance(caught.exception, IndexError)
        self.assertEqual(caught.exception.atom, 9)
        self.assertIn("atom 9", str(caught.exception))
        molecules.add([(0, 1)], 1)
        with self.assertRaises(hol.SharedAtomError):
            molecules.add([(1, 2)], 1)
        for wrong in (-1.0, np.nan, 1e-160):
            with self.assertRaises(hol.ArgumentError):
                molecules.add([(2, 3)], wrong)
        with self.assertRaises(ValueError):
            hol.Molecules([1.0, -1.0])
        with self.assertRaises(TypeError):
            molecules.add([(2.0, 3.0)], 1)
        for bonds, lengths in (([2, 3], 1), ([(2, 3)], [1, 2])):
            with self.assertRaises(hol.ArgumentError):
                molecules.add(bonds, lengths)
        with self.assertRaises(ValueError) as caught:  # no arithmetic is wrong there
            molecules.add([(2, 3), (3, 2)], 1)
        self.assertNotIsInstance(caught.exception, ArithmeticError)
        with self.assertRaises(IndexError):
            molecules.molecule(1)

    def test_a_bad_molecule_is_named_and_the_others_are_complete(self):
        molecules, r = dimers(5)
        f = np.zeros_like(r)
        f[1::2, 0] = 2.0
        f[7] = np.nan
        out = np.full_like(r, 99.0)
        with self.assertRaises(hol.NotFiniteError) as caught:
            molecules.forces(r, None, f, out=out)
        error = caught.exception
        self.assertEqual((error.molecule, error.atom, error.n_bad, error.status), (3, 7, 1, 6))
        np.testing.assert_array_equal(out[6:8], 99.0)
        np.testing.assert_array_equal(out[[0, 2, 4, 8], 0], 1.0)

    def test_every_bad_molecule_is_named(self):
        molecules, r = dimers(6)
        with self.assertRaises(hol.StateError):
            molecules.outcomes()
        trial = r + 0.0
        trial[1::2, 0] += 0.1
        trial[2:4] = r[2:4]
        molecules.keep_outcomes = True
        self.assertTrue(molecules.keep_outcomes)
        report = molecules.project_positions(r, trial, 1)
        found = molecules.outcomes()
        self.assertEqual(found.bad.size, 0)
        self.assertEqual(found.iterations[1], 0)
        self.assertTrue(np.all(found.iterations[[0, 2, 3, 4, 5]] > 0))
        self.assertEqual(found.iterations.max(), report.iterations)
        r[3, 1] = np.nan
        r[9] = r[8]
        with self.assertRaises(hol.NotFiniteError) as caught:
            molecules.forces(r)
        self.assertEqual(caught.exception.n_bad, 2)
        found = molecules.outcomes()
        np.testing.assert_array_equal(found.bad, [1, 4])
        np.testing.assert_array_equal(found.status, [0, 6, 0, 0, 7, 0])

    def test_positions_that_cannot_be_reached_stay(self):
        molecules, r = dimers(3)
        moved = r + 0.0
        moved[3] = r[3] + (0, 5.0, 0)  # no multiple of the reference bond brings it back
        trial = moved.copy()
        molecules.checks = "never"
        with self.assertRaises(hol.NoConvergenceError) as caught:
            molecules.project_positions(r, moved, 1)
        self.assertEqual((caught.exception.molecule, caught.exception.bond), (1, 0))
        np.testing.assert_array_equal(moved, trial)

    def test_lengths_that_do_not_fit_are_an_error_of_the_first_call(self):
        molecules, r = dimers(3)
        with self.assertRaises(hol.LengthsError) as caught:
            molecules.project_positions(10 * r, 10 * r, 1)
        self.assertIn("length", str(caught.exception))
        with self.assertRaises(hol.LengthsError):
            molecules.check(10 * r)
        molecules.check(r)

    def test_labels_are_in_the_message(self):
        molecules, r = dimers(2)
        molecules.set_labels(np.arange(4) + 9000)
        r[2] = np.inf
        with self.assertRaisesRegex(hol.NotFiniteError, "9002"):
            molecules.forces(r)

    def test_settings_out_of_range_change_nothing(self):
        molecules, _ = dimers(2)
        for name, wrong in (("threads", 0), ("tolerance", -1.0), ("max_iterations", 0), ("box", 0.5), ("checks", "perhaps"),
                            ("memory_limit", -1), ("active", [True]), ("box", [1, 2]), ("box_rate", np.nan)):
            before = getattr(molecules, name)
            with self.assertRaises(ValueError, msg=name):
                setattr(molecules, name, wrong)
            self.assertEqual(getattr(molecules, name), before)


if __name__ == "__main__":
    unittest.main()
