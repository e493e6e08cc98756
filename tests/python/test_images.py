"""Bonds whose periodic images are told."""

import copy
import pickle
import unittest

import numpy as np

import holonomic as hol


class Images(unittest.TestCase):
    def test_a_bond_longer_than_half_the_cell(self):
        r, f = np.array([[0.1, 0, 0], [3.9295, 0, 0]]), np.array([[-1.0, 0.5, 0], [3.0, 0, 0]])
        molecules = hol.Molecules([1.0, 2.0])
        molecules.box = [7.22, 7.22, 7.22]
        with self.assertRaises(hol.ArgumentError):
            molecules.add([(0, 1)], 3.8295)
        molecules.add([(0, 1)], 3.8295, images=[(0, 0, 0)])
        free = hol.Molecules([1.0, 2.0])
        free.add([(0, 1)], 3.8295)
        self.assertAlmostEqual(molecules.forces(r, f=f).tensions[0], free.forces(r, f=f).tensions[0], 14)
        r[1, 0] -= 7.22
        with self.assertRaises(hol.LengthsError):
            molecules.check(r)
        molecules.images = [(1, 0, 0)]
        molecules.check(r)
        self.assertAlmostEqual(molecules.forces(r, f=f).tensions[0], free.forces(r + [[0, 0, 0], [7.22, 0, 0]], f=f).tensions[0], 14)
        for other in (copy.copy(molecules), pickle.loads(pickle.dumps(molecules))):
            self.assertEqual(other.images.tolist(), [[1, 0, 0]])
            self.assertEqual(other.forces(r, f=f).tensions[0], molecules.forces(r, f=f).tensions[0])

    def test_wrong_arguments(self):
        molecules = hol.Molecules([1.0, 2.0, 1.0])
        molecules.add([(0, 1)], 1.0)
        for wrong in ([(0, 0)], [(0, 0, 0), (0, 0, 0)], [(1, 0, 0)]):
            with self.assertRaises(hol.ArgumentError):
                molecules.images = wrong
        molecules.images = [(0, 0, 0)]
        with self.assertRaises(hol.ArgumentError):
            hol.Molecules([1.0, 1.0]).add([(0, 1)], 1.0, images=[(0, 0)])
        with self.assertRaises(TypeError):
            hol.Molecules([1.0, 1.0]).add([(0, 1)], 1.0, images=[(0, 0.5, 0)])


if __name__ == "__main__":
    unittest.main()
