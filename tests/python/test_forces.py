"""Forces, velocities and positions agree with the dense solution."""

import copy
import unittest

import dense
import numpy as np

import holonomic as hol

# Z of these molecules has condition numbers up to some thousands, which the dense solution loses.
CLOSE = 1e-10


def made(seed, n, shape):
    rng = np.random.default_rng(seed)
    r, bonds, masses = dense.random_molecule(rng, n, shape)
    lengths = np.linalg.norm(r[bonds[:, 1]] - r[bonds[:, 0]], axis=1)
    molecules = hol.Molecules(masses)
    molecules.add(bonds, lengths)
    return rng, r, bonds, lengths, masses, molecules


class Forces(unittest.TestCase):
    def compare(self, molecules, r, v, f, bonds, masses, box=None):
        multipliers, force = dense.forces(r, v, f, bonds, masses, box)
        result = molecules.forces(r, v, f)
        scale = abs(multipliers).max()
        np.testing.assert_allclose(result.lambda_, multipliers, atol=CLOSE * scale, rtol=0)
        np.testing.assert_allclose(result.forces, force, atol=CLOSE * abs(force).max(), rtol=0)
        d = dense.bond_vectors(r, bonds, box)
        np.testing.assert_allclose(result.tensions, 2 * multipliers * np.linalg.norm(d, axis=1), atol=CLOSE * scale, rtol=0)
        np.testing.assert_allclose(result.virial, -2 * np.einsum("k,ka,kb->ab", multipliers, d, d),
                                   atol=len(d) * CLOSE * scale, rtol=0)

    def test_of_every_shape(self):
        for seed, (n, shape) in enumerate([(2, "chain"), (7, "chain"), (40, "chain"), (5, "tree"), (30, "tree"), (3, "ring"),
                                           (6, "ring"), (20, "ring")]):
            with self.subTest(n=n, shape=shape):
                rng, r, bonds, _, masses, molecules = made(seed, n, shape)
                self.compare(molecules, r, rng.normal(size=r.shape), rng.normal(size=r.shape), bonds, masses)

    def test_with_atoms_that_are_held(self):
        rng, r, bonds, lengths, masses, _ = made(11, 12, "chain")
        masses[0] = masses[-1] = 0
        molecules = hol.Molecules(masses)
        molecules.add(bonds, lengths)
        self.compare(molecules, r, rng.normal(size=r.shape) * (masses > 0)[:, None], rng.normal(size=r.shape), bonds, masses)

    def test_of_velocities_and_forces_that_are_left_out(self):
        rng, r, bonds, _, masses, molecules = made(3, 9, "tree")
        v, zero = rng.normal(size=r.shape), np.zeros_like(r)
        np.testing.assert_array_equal(molecules.forces(r, v).forces, molecules.forces(r, v, zero).forces)
        np.testing.assert_array_equal(molecules.forces(r, None, v).forces, molecules.forces(r, zero, v).forces)

    def test_in_boxes_of_three_sides_and_of_three_vectors(self):
        rng, r, bonds, _, masses, molecules = made(5, 15, "tree")
        v, f = rng.normal(size=r.shape), rng.normal(size=r.shape)
        for box in ([5.0, 6.0, 7.0], [[5.0, 0, 0], [1.0, 6.0, 0], [-0.5, 2.0, 7.0]]):
            molecules.box = box
            cell = np.diag(box) if np.ndim(box) == 1 else np.array(box)
            np.testing.assert_array_equal(molecules.box, cell)
            wrapped = r + rng.integers(-1, 2, size=r.shape) @ cell
            self.compare(molecules, wrapped, v, f, bonds, masses, cell)

    def test_written_to_an_array_or_added_to_it(self):
        rng, r, _, _, _, molecules = made(6, 10, "tree")
        f = rng.normal(size=r.shape)
        g = molecules.forces(r, None, f).forces
        out = np.full_like(r, 3.0)
        self.assertIs(molecules.forces(r, None, f, out=out).forces, out)
        np.testing.assert_array_equal(out, g)
        total = f.copy()
        molecules.forces(r, None, total, out=total, add=True)
        np.testing.assert_array_equal(total, f + g)

    def test_solve_of_any_right_hand_side(self):
        rng, r, bonds, _, masses, molecules = made(7, 14, "ring")
        rhs = rng.normal(size=len(bonds))
        result = molecules.solve(r, rhs)
        np.testing.assert_allclose(dense.matrix(r, bonds, masses) @ result.lambda_, rhs, atol=1e-10 * abs(rhs).max())
        rows = dense.gradients(dense.bond_vectors(r, bonds), bonds, len(r))
        np.testing.assert_allclose(result.forces.ravel(), -result.lambda_ @ rows, atol=1e-12)
        self.assertIsNone(result.tensions)

    def test_reactions_of_multipliers(self):
        rng, r, bonds, _, _, molecules = made(8, 14, "tree")
        multipliers = rng.normal(size=len(bonds))
        found = molecules.reactions(r, multipliers)
        d = dense.bond_vectors(r, bonds)
        rows = dense.gradients(d, bonds, len(r))
        np.testing.assert_allclose(found.forces.ravel(), -multipliers @ rows, atol=1e-13)
        np.testing.assert_allclose(found.tensions, 2 * multipliers * np.linalg.norm(d, axis=1), rtol=1e-14)
        np.testing.assert_allclose(found.bond_virial[:, 1], -2 * multipliers * d[:, 0] * d[:, 1], atol=1e-14)
        np.testing.assert_allclose(found.virial, -2 * np.einsum("k,ka,kb->ab", multipliers, d, d), atol=1e-13)


class Velocities(unittest.TestCase):
    def test_projected(self):
        for n, shape in [(2, "chain"), (25, "tree"), (12, "ring")]:
            rng, r, bonds, _, masses, molecules = made(n, n, shape)
            v = rng.normal(size=r.shape)
            wanted = dense.velocities(r, v, bonds, masses)
            before = v.copy()
            impulse = molecules.project_velocities(r, v, multipliers=True, virial=True)
            np.testing.assert_allclose(v, wanted, atol=CLOSE)
            self.assertLess(molecules.violation(r, v).rate, 1e-14)
            moved = masses[:, None] * (v - before)
            np.testing.assert_allclose(molecules.reactions(r, impulse.lambda_).forces, moved, atol=1e-13)
            np.testing.assert_allclose(impulse.virial, r.T @ moved, atol=1e-12)


class Positions(unittest.TestCase):
    def test_projected_with_velocities_and_multipliers(self):
        for n, shape in [(2, "chain"), (25, "tree"), (9, "ring")]:
            rng, r_ref, bonds, lengths, masses, molecules = made(20 + n, n, shape)
            dt = 0.01
            v = rng.normal(size=r_ref.shape)
            r = r_ref + dt * v
            wanted, multipliers = dense.positions(r_ref, r, dt, bonds, lengths, masses)
            report = molecules.project_positions(r_ref, r, dt, v, multipliers=True, virial=True)
            np.testing.assert_allclose(r, wanted, atol=1e-13)
            np.testing.assert_allclose(v, (r - r_ref) / dt, atol=1e-11)
            np.testing.assert_allclose(report.lambda_, multipliers, atol=1e-8 * abs(multipliers).max())
            d = dense.bond_vectors(r_ref, bonds)
            np.testing.assert_allclose(report.virial, -2 * np.einsum("k,ka,kb->ab", report.lambda_, d, d), atol=1e-10)
            self.assertEqual((report.n_corrected, report.n_failed), (1, 0))
            self.assertLess(report.max_error, 1e-14)
            self.assertGreater(report.iterations, 0)
            d = dense.bond_vectors(r, bonds)
            np.testing.assert_allclose((d * d).sum(1), lengths**2, rtol=1e-14)

    def test_a_guess_is_taken_and_replaced(self):
        rng, r_ref, bonds, lengths, masses, molecules = made(33, 10, "tree")
        r = r_ref + 0.01 * rng.normal(size=r_ref.shape)
        plain, multipliers = r.copy(), np.zeros(len(bonds))
        molecules.project_positions(r_ref, plain, 1, lambda_=multipliers)
        again = multipliers.copy()
        report = molecules.project_positions(r_ref, r, 1, lambda_=again, guess=True)
        self.assertIs(report.lambda_, again)
        np.testing.assert_allclose(again, multipliers, atol=1e-12)
        np.testing.assert_allclose(r, plain, atol=1e-14)

    def test_along_bond_vectors(self):
        rng, r_ref, bonds, _, _, molecules = made(35, 10, "tree")
        r = r_ref + 0.01 * rng.normal(size=r_ref.shape)
        plain = r.copy()
        molecules.project_positions(r_ref, plain, 0.1)
        molecules.project_positions_along(dense.bond_vectors(r_ref, bonds), r, 0.1)
        np.testing.assert_allclose(r, plain, atol=1e-14)

    def test_crude_ones_are_imposed_on(self):
        refused = 0
        for seed in range(20):
            rng, r, bonds, lengths, masses, molecules = made(100 + seed, 20, ("chain", "tree", "ring")[seed % 3])
            r = r + rng.normal(size=r.shape)
            centre = masses @ r
            plain = r.copy()
            report = molecules.impose(r)
            d = dense.bond_vectors(r, bonds)
            np.testing.assert_allclose((d * d).sum(1), lengths**2, rtol=1e-13)
            np.testing.assert_allclose(masses @ r, centre, atol=1e-11)
            self.assertEqual(report.n_corrected, 1)
            molecules.checks = "never"
            try:
                molecules.project_positions(plain, plain, 1)
            except hol.NoConvergenceError:
                refused += 1
        self.assertGreater(refused, 5)  # what makes it worth a call of its own

    def test_residuals_are_those_of_each_bond(self):
        rng, r, bonds, lengths, _, molecules = made(37, 10, "ring")
        r = r + 0.01 * rng.normal(size=r.shape)
        v = rng.normal(size=r.shape)
        d, u = dense.bond_vectors(r, bonds), v[bonds[:, 1]] - v[bonds[:, 0]]
        length, rate = molecules.residuals(r, v)
        np.testing.assert_allclose(length, (d * d).sum(1) / lengths**2 - 1, atol=1e-14)
        np.testing.assert_allclose(rate, (d * u).sum(1), atol=1e-14)

    def test_with_a_reference_in_another_box(self):
        rng, r_ref, bonds, lengths, masses, molecules = made(36, 10, "tree")
        plain = r_ref + 0.01 * rng.normal(size=r_ref.shape)
        wrapped = plain % 7.0
        molecules.project_positions(r_ref, plain, 0.1)
        molecules.box, molecules.reference_box = 7.0, 6.9
        molecules.project_positions(r_ref % 6.9, wrapped, 0.1)
        cell = 7.0 * np.eye(3)
        np.testing.assert_allclose(dense.bond_vectors(wrapped, bonds, cell), dense.bond_vectors(plain, bonds), atol=1e-13)


class Kept(unittest.TestCase):
    """Factors that are kept give what the set gives at their positions."""

    def setUp(self):
        rng = np.random.default_rng(5)
        self.molecules = hol.Molecules(rng.uniform(1, 2, 12))
        self.molecules.add([(0, 1), (1, 2), (2, 3), (1, 4), (6, 7), (8, 9), (8, 10), (8, 11)], 1.0)
        self.r, self.v, self.f = rng.normal(size=(3, 12, 3))
        self.rhs = rng.normal(size=(5, 8))

    def test_forces_and_right_hand_sides(self):
        kept = self.molecules.factors(self.r)
        found, wanted = kept.forces(self.v, self.f), self.molecules.forces(self.r, self.v, self.f)
        for name in ("lambda_", "tensions", "forces", "virial"):
            np.testing.assert_allclose(getattr(found, name), getattr(wanted, name), rtol=1e-12, atol=1e-12)
        found, wanted = kept.solve(self.rhs[2]), self.molecules.solve(self.r, self.rhs[2])
        np.testing.assert_allclose(found.forces, wanted.forces, rtol=1e-12, atol=1e-12)
        many = kept.multipliers(self.rhs)
        for k in range(5):
            np.testing.assert_allclose(many[k], self.molecules.solve(self.r, self.rhs[k]).lambda_, rtol=1e-12, atol=1e-12)
        added = self.f.copy()
        self.assertIs(kept.forces(self.v, self.f, out=added, add=True).forces, added)
        np.testing.assert_allclose(added - self.f, self.molecules.forces(self.r, self.v, self.f).forces, rtol=1e-12, atol=1e-12)

    def test_they_belong_to_positions_and_to_the_molecules_as_they_are(self):
        kept = self.molecules.factors(np.zeros((12, 2)) + self.r[:, :2])
        self.assertEqual(kept.forces(None, self.f[:, :2]).forces.shape, (12, 2))
        kept.update(self.r.astype(np.float32))
        np.testing.assert_allclose(kept.forces(None, self.f).lambda_, self.molecules.forces(self.r, None, self.f).lambda_, rtol=1e-3)
        self.molecules.set_lengths(2.0)
        with self.assertRaises(hol.StateError):
            kept.solve(self.rhs[0])
        with self.assertRaisesRegex(hol.ArgumentError, "5, 7"):
            self.molecules.factors(self.r).multipliers(self.rhs[:, :7])
        with self.assertRaises(TypeError):
            copy.copy(kept)
        with self.assertRaises(hol.DegenerateError):
            self.molecules.factors(np.zeros((12, 3)))


if __name__ == "__main__":
    unittest.main()
