"""Rigid bodies move as rigid bodies do."""

import unittest

import numpy as np

import holonomic as hol


class Bodies(unittest.TestCase):
    def test_a_body_has_the_accelerations_of_newton_and_euler(self):
        rng = np.random.default_rng(1)
        n = 6
        places, masses = rng.normal(size=(n, 3)), rng.uniform(1, 5, n)
        molecules = hol.Molecules(masses)
        molecules.add_rigid([range(n)], [places])
        self.assertEqual(molecules.molecule(0).shape, "rigid")
        self.assertEqual(molecules.degrees_of_freedom(), 6)
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        turn *= np.linalg.det(turn)
        r = places @ turn.T + rng.normal(size=3)
        centre = masses @ r / masses.sum()
        d = r - centre
        omega = rng.normal(size=3)
        v = rng.normal(size=3) + np.cross(omega, d)
        f = rng.normal(size=(n, 3))
        inertia = sum(m * (x @ x * np.eye(3) - np.outer(x, x)) for m, x in zip(masses, d))
        alpha = np.linalg.solve(inertia, np.cross(d, f).sum(0) - np.cross(omega, inertia @ omega))
        wanted = f.sum(0) / masses.sum() + np.cross(alpha, d) + np.cross(omega, np.cross(omega, d))
        force = molecules.forces(r, v, f).forces
        np.testing.assert_allclose((f + force) / masses[:, None], wanted, atol=1e-12)

    def test_linear_molecules_in_one_call_keep_their_shape(self):
        rng = np.random.default_rng(2)
        n, length = 20, 1.16
        places = [(-length, 0, 0), (0, 0, 0), (length, 0, 0)]
        molecules = hol.Molecules(np.tile([16.0, 12.0, 16.0], n))
        molecules.add_rigid_molecules(n, 3, [[0, 1, 2]], [places])
        self.assertEqual(molecules.degrees_of_freedom(), 5 * n)
        u = rng.normal(size=(n, 3))
        u /= np.linalg.norm(u, axis=1)[:, None]
        r_ref = (rng.uniform(0, 20, (n, 1, 3)) + np.array([-1, 0, 1])[None, :, None] * length * u[:, None, :]).reshape(-1, 3)
        v = rng.normal(size=r_ref.shape)
        r = r_ref + 0.01 * v
        molecules.project_positions(r_ref, r, 0.01, v)
        molecules.project_velocities(r, v)
        parts = r.reshape(n, 3, 3)
        np.testing.assert_allclose(np.linalg.norm(parts[:, 2] - parts[:, 0], axis=1), 2 * length, rtol=1e-13)
        np.testing.assert_allclose(parts[:, 1], (parts[:, 0] + parts[:, 2]) / 2, atol=1e-13)
        self.assertLess(molecules.violation(r, v).rate, 1e-13)

    def test_lone_pairs_carry_their_forces_to_the_masses(self):
        rng = np.random.default_rng(4)
        places = np.array([(0, 0, 0), (0.586, 0.757, 0), (0.586, -0.757, 0), (-0.404, 0, 0.572), (-0.404, 0, -0.572)])
        masses = np.array([16.0, 1, 1, 0, 0])
        molecules = hol.Molecules(masses)
        molecules.add_rigid([range(5)], [places])
        self.assertEqual(molecules.degrees_of_freedom(), 6)
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        r = places @ (turn * np.linalg.det(turn)).T + rng.normal(size=3)
        f = rng.normal(size=r.shape)
        whole = f.copy()
        molecules.spread_forces(r, whole)
        np.testing.assert_allclose(whole[3:], 0, atol=1e-15)
        np.testing.assert_allclose(whole.sum(0), f.sum(0), atol=1e-14)
        np.testing.assert_allclose(np.cross(r, whole).sum(0), np.cross(r, f).sum(0), atol=1e-14)
        centre = masses @ r / masses.sum()
        omega = rng.normal(size=3)
        v = np.cross(omega, r - centre)
        wanted = v.copy()
        v[3:] = rng.normal(size=(2, 3))
        molecules.project_velocities(r, v)
        np.testing.assert_allclose(v, wanted, atol=1e-14)

    def test_crude_positions_of_bodies(self):
        rng = np.random.default_rng(3)
        places = rng.normal(size=(5, 3))
        molecules = hol.Molecules(np.ones(8))
        molecules.add_rigid([range(5)], [places])
        molecules.add([(5, 6), (6, 7)], 1.0)  # beside molecules without bodies
        r = np.vstack([places, np.outer(range(3), [1.0, 0, 0])]) + 0.2 * rng.normal(size=(8, 3))
        crude = r.copy()
        report = molecules.impose(r)
        self.assertEqual((report.n_corrected, report.n_failed), (2, 0))
        self.assertAlmostEqual(np.linalg.norm(r[5] - r[6]), 1, places=13)
        np.testing.assert_allclose(r[:5].sum(axis=0), crude[:5].sum(axis=0), atol=1e-13)
        pairs = [(i, j) for i in range(5) for j in range(i)]
        for i, j in pairs:
            self.assertAlmostEqual(np.linalg.norm(r[i] - r[j]), np.linalg.norm(places[i] - places[j]), places=13)

    def test_a_body_by_its_inertia_moves_as_eulers_equations_say(self):
        moments, mass = np.array([2.0, 3.0, 4.5]), 5.0
        masses, places = hol.equimomental_points(mass, moments, centre=[1.0, 2.0, 3.0])
        x = places - [1, 2, 3]
        self.assertEqual(masses.tolist(), [1.25] * 4)
        self.assertLess(np.abs(np.einsum("a,ai,aj->ij", masses, x, x) - np.diag([2.75, 1.75, 0.25])).max(), 1e-14)
        site, omega, f = np.array([0.3, -0.4, 0.5]), np.array([0.2, 0.7, -0.1]), np.array([1.0, 2.0, -1.5])
        molecules = hol.Molecules([*masses, 0.0])
        r = np.vstack([x, site])
        molecules.add_rigid([range(5)], [r])
        forces = np.zeros((5, 3))
        forces[4] = f
        total = forces + molecules.forces(r, np.cross(omega, r), forces).forces
        alpha = (np.cross(site, f) - np.cross(omega, moments * omega)) / moments
        a = f / mass + np.cross(alpha, x) + np.cross(omega, np.cross(omega, x))
        self.assertLess(np.abs(total[:4] / masses[:, None] - a).max(), 1e-13)
        with self.assertRaisesRegex(hol.ArgumentError, "sum of the others"):
            hol.equimomental_points(1, [1, 2, 4])

    def test_wrong_arguments(self):
        molecules = hol.Molecules(np.ones(4))
        for bodies, places in (([], []), ([[0, 1]], []), ([[0, 1]], [[(0, 0, 0)]]), ([[0, 0]], [[(0, 0, 0), (1, 0, 0)]])):
            with self.assertRaises(ValueError):
                molecules.add_rigid(bodies, places)


if __name__ == "__main__":
    unittest.main()
