"""Distances that depend on each other, as topology files have them, against singular values of all of them."""

import itertools
import unittest

import numpy as np

import holonomic as hol

CORNERS = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) / np.sqrt(3)


def about(axis, angle):
    k = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


def alkane(rng, skeleton, n):
    """Carbons joined by these bonds, any torsions, with hydrogens: positions, masses, bonds."""
    places, hydrogens = {0: np.zeros(3)}, []
    before, left = {0: None}, [0]
    while left:
        i = left.pop()
        corners = CORNERS @ np.linalg.qr(rng.normal(size=(3, 3)))[0]
        if before[i] is not None:
            u = places[before[i]] - places[i]
            u /= np.linalg.norm(u)
            half = (corners[0] + u) / np.linalg.norm(corners[0] + u)
            corners = (about(u, rng.uniform(0, 6)) @ about(half, np.pi) @ corners.T).T[1:]
        corners = list(corners)
        for a, b in skeleton:
            j = b if a == i else a if b == i else None
            if j is None or j in places:
                continue
            places[j], before[j] = places[i] + 1.53 * corners.pop(), i
            left.append(j)
        hydrogens += [(i, places[i] + 1.09 * corner) for corner in corners]
    r = np.array([places[i] for i in range(n)] + [place for _, place in hydrogens])
    return r, np.array([12.0] * n + [1.0] * len(hydrogens)), list(skeleton) + [(i, n + k) for k, (i, _) in enumerate(hydrogens)]


def with_angles(bonds):
    partners = {}
    for a, b in bonds:
        partners.setdefault(a, []).append(b)
        partners.setdefault(b, []).append(a)
    ends = {tuple(sorted(pair)) for its in partners.values() for pair in itertools.combinations(its, 2)}
    return sorted(ends | {tuple(sorted(bond)) for bond in bonds})


def random_skeleton(rng, n):
    bonds, degree = [], [0] * n
    for i in range(1, n):
        j = int(rng.choice([k for k in range(i) if degree[k] < 4]))
        bonds.append((j, i))
        degree[i] += 1
        degree[j] += 1
    return bonds


class Alkanes(unittest.TestCase):
    def check(self, r, masses, pairs, freedoms):
        lengths = np.array([np.linalg.norm(r[j] - r[i]) for i, j in pairs])
        molecules = hol.Molecules(masses)
        molecules.add(pairs, lengths)
        rows = np.zeros((len(pairs), len(masses), 3))
        for k, (i, j) in enumerate(pairs):
            rows[k, j] = r[j] - r[i]
            rows[k, i] = -rows[k, j]
        root = np.sqrt(np.repeat(masses, 3))
        _, sizes, axes = np.linalg.svd(rows.reshape(len(pairs), -1) / root)
        axes = axes[: (sizes > 1e-9 * sizes[0]).sum()]
        self.assertEqual(molecules.degrees_of_freedom(), freedoms)
        self.assertEqual(3 * len(masses) - len(axes), freedoms)
        self.assertEqual(molecules.implied().sum(), len(pairs) - len(axes))
        rng = np.random.default_rng(8)
        v, f = rng.normal(size=(2,) + r.shape)
        pulled, force = f.ravel() / root, molecules.forces(r, np.zeros_like(r), f)
        wanted = -(axes.T @ (axes @ pulled)) * root
        np.testing.assert_allclose(force.forces.ravel(), wanted, atol=1e-9)
        moving = v.ravel() * root
        molecules.project_velocities(r, v)
        np.testing.assert_allclose(v.ravel(), (moving - axes.T @ (axes @ moving)) / root, atol=1e-9)
        for _ in range(20):
            moved = r + 0.005 * v
            molecules.project_positions(r, moved, 0.005, v)
            r = moved
            molecules.project_velocities(r, v)
        np.testing.assert_allclose([np.linalg.norm(r[j] - r[i]) for i, j in pairs], lengths, rtol=1e-11)

    def test_all_bonds_and_angles_leave_torsions(self):
        rng = np.random.default_rng(5)
        skeletons = [[(i, i + 1) for i in range(n - 1)] for n in (2, 3, 6, 16)]
        skeletons += [[(0, k) for k in range(1, n)] for n in (4, 5)]  # isobutane, neopentane
        skeletons += [random_skeleton(rng, n) for n in (5, 7, 9, 11)]
        for skeleton in skeletons:
            n = len(skeleton) + 1
            r, masses, bonds = alkane(rng, skeleton, n)
            order = rng.permutation(len(masses))
            place = np.argsort(order)
            pairs = [(int(place[i]), int(place[j])) for i, j in with_angles(bonds)]
            self.check(r[order], masses[order], pairs, 6 + n - 1)


class Files(unittest.TestCase):
    def test_carbon_dioxide_from_rounded_coordinates(self):
        rng = np.random.default_rng(6)
        for decimals in (3, 4, 5, 6):
            for _ in range(20):
                u = rng.normal(size=3)
                u *= 1.16 / np.linalg.norm(u)
                r = np.round(rng.uniform(0, 30, 3) + np.outer([-1, 0, 1], u), decimals)
                pairs = [(0, 1), (1, 2), (0, 2)]
                molecules = hol.Molecules([16.0, 12.0, 16.0])
                molecules.add(pairs, [np.linalg.norm(r[j] - r[i]) for i, j in pairs])
                self.assertEqual(molecules.degrees_of_freedom(), 5)
                v = rng.normal(size=(3, 3))
                moved = r + 0.01 * v
                molecules.project_positions(r, moved, 0.01, v)
                self.assertLess(molecules.violation(moved).length, 1e-12)

    def test_full_digits_are_flat_to_rounding_alone(self):
        rng = np.random.default_rng(7)
        for height in (1.2345678e-3, 1.3456789e-5, 1.4567891e-6, 3.1415927e-7):
            for a, b in [(0.5, 0.5)] + rng.uniform(0.5, 2, (20, 2)).tolist():  # halves: nearly a grid, but not of decimals
                for scale in (1.0, 2.0**-40, 2.0**40):
                    lengths = [np.hypot(a, height) * scale, np.hypot(b, height) * scale, (a + b) * scale]
                    molecules = hol.Molecules([16.0, 12.0, 16.0])
                    molecules.add([(0, 1), (1, 2), (0, 2)], lengths)
                    self.assertEqual((molecules.degrees_of_freedom(), molecules.adjustment), (6, (0.0, None)))
        molecules = hol.Molecules([16.0, 12.0, 16.0])
        molecules.add([(0, 1), (1, 2), (0, 2)], [1.1234567890123, 1.2345678901234, 1.1234567890123 + 1.2345678901234])
        self.assertEqual(molecules.degrees_of_freedom(), 5)

    def test_the_adjustment_is_told_and_bounded(self):
        circle = 2 * np.pi * np.arange(3) / 3
        r = np.vstack([np.zeros(3), 0.126 * np.c_[np.cos(circle), np.sin(circle), np.zeros(3)]])
        pairs = list(itertools.combinations(range(4), 2))
        lengths = np.round([np.linalg.norm(r[j] - r[i]) for i, j in pairs], 4)
        molecules = hol.Molecules([14.0, 16, 16, 16])
        self.assertEqual(molecules.adjustment, (0.0, None))
        molecules.add(pairs, lengths)
        largest, bond = molecules.adjustment
        self.assertTrue(0 < largest < 1e-3 and 0 <= bond < 6)
        with self.assertRaises(hol.ArgumentError):
            molecules.length_tolerance = 0.1


if __name__ == "__main__":
    unittest.main()
