"""Mistakes that are made in the first hour: each is an error or a warning, in words of Python."""

import re
import unittest
import warnings

import numpy as np

import holonomic as hol


def dimers(n=3):
    molecules = hol.Molecules(np.ones(2 * n))
    molecules.add_molecules(n, 2, [(0, 1)], 1)
    r = np.zeros((2 * n, 3))
    r[:, 1] = 10 * (np.arange(2 * n) // 2)
    r[1::2, 0] = 1
    return molecules, r


class Mistakes(unittest.TestCase):
    def test_names_that_do_not_exist(self):
        molecules, r = dimers()
        for name in ("tolerence", "thread", "Box"):
            with self.assertRaises(AttributeError, msg=name):
                setattr(molecules, name, 1)
        with self.assertRaises(AttributeError):
            molecules.inverse(0, r).scale = 1

    def test_sides_of_a_box_below_zero(self):
        molecules, _ = dimers()
        for box in (-20, [20, -20, 20], np.nan, [20, np.nan, 20]):
            for name in ("box", "reference_box"):
                with self.assertRaisesRegex(ValueError, f"{name} is .*sides must be positive"):
                    setattr(molecules, name, box)
        molecules.box = np.diag([-20.0, 20, 20])  # vectors have directions
        molecules.box_rate = [-0.1, 0, 0]

    def test_what_is_no_number(self):
        molecules, r = dimers()
        fresh = hol.Molecules(np.ones(2))
        for call in (lambda: fresh.add([(0, 1)], "one"), lambda: fresh.add("ab", 1), lambda: fresh.add([(0, 1)], 1 + 1j),
                     lambda: hol.Molecules(["1", "2"]), lambda: setattr(molecules, "box", "31"),
                     lambda: setattr(molecules, "threads", 1.5), lambda: setattr(molecules, "threads", "2"),
                     lambda: setattr(molecules, "tolerance", "1e-8"), lambda: setattr(molecules, "max_iterations", 2.0),
                     lambda: molecules.molecule(0.5), lambda: molecules.inverse("0", r), lambda: fresh.add_chains(1.0, 1, 1.0),
                     lambda: hol.partition_function(2.5), lambda: molecules.degrees_of_freedom(2.5)):
            with self.assertRaisesRegex(TypeError, "must be"):
                call()
        for call in (lambda: molecules.forces(r * 1j), lambda: molecules.forces([[None] * 3] * 6), lambda: molecules.forces(None),
                     lambda: molecules.forces([["1"] * 3] * 6), lambda: molecules.metric(r, "1"),
                     lambda: setattr(molecules, "keep_outcomes", "no")):
            with self.assertRaises(TypeError):
                call()
        for call in (lambda: molecules.project_positions(r, r + 0.0, 1, guess=True),
                     lambda: molecules.forces(r, out=np.zeros((6, 2)))):
            with self.assertRaisesRegex(hol.ArgumentError, r"lambda_, which holds the guess|\(n, 3\) and some \(n, 2\)"):
                call()
        molecules.threads, molecules.tolerance, molecules.box = np.int32(2), np.float32(0.5), np.int64(31)
        self.assertEqual((molecules.threads, molecules.tolerance, molecules.box[0, 0]), (2, 0.5, 31))

    def test_positions_given_for_velocities(self):
        molecules, r = dimers()
        for call in (lambda: molecules.forces(r, r), lambda: molecules.project_velocities(r, r),
                     lambda: molecules.violation(r, r), lambda: molecules.residuals(r, r),
                     lambda: molecules.project_positions(r, r + 0.0, 1, r),
                     lambda: molecules.project_positions_along(r[::2], r, 1, r)):
            before = r.copy()
            with self.assertRaisesRegex(ValueError, "v is the array that was given for the positions"):
                call()
            np.testing.assert_array_equal(r, before)
        new = r + 0.0
        with self.assertRaises(ValueError):
            molecules.project_positions(r, new, 1, new)

    def test_bonds_that_cannot_be_are_wrong_arguments(self):
        molecules = hol.Molecules(np.ones(4))
        for bonds in ([(0, 1), (1, 0)], [(2, 2)]):
            with self.assertRaises(ValueError) as caught:
                molecules.add(bonds, 1)
            self.assertNotIsInstance(caught.exception, ArithmeticError)
            self.assertIn("bond", str(caught.exception))
        self.assertEqual(molecules.n_bonds, 0)

    def test_adding_nothing_is_allowed(self):
        molecules = hol.Molecules(np.ones(4))
        for lengths in (1.0, [], np.zeros(0)):
            molecules.add([], lengths)
            molecules.add(np.zeros((0, 2), int), lengths)
            molecules.add_molecules(2, 2, [], lengths)
        self.assertEqual((molecules.n_bonds, molecules.n_molecules), (0, 0))
        with self.assertRaises(ValueError):
            molecules.add([], [1.0])

    def test_messages_know_no_names_of_c(self):
        molecules, r = dimers(2)
        one = hol.Molecules(np.ones(3))
        calls = [lambda: molecules.add([(0, 9)], 1), lambda: molecules.add([(0, 1)], 1), lambda: molecules.forces(0 * r),
                 lambda: molecules.check(2 * r), lambda: molecules.project_positions(2 * r, 2 * r, 1), molecules.outcomes,
                 lambda: molecules.molecule(7), lambda: molecules.inverse(7, r), lambda: one.add_chains(2, 3, 1.0),
                 lambda: setattr(molecules, "threads", 0), lambda: setattr(molecules, "box", 0.5), lambda: molecules.metric(r, -1),
                 lambda: molecules.set_lengths(0), lambda: molecules.set_masses(0), lambda: hol.Molecules([1, -1]),
                 lambda: hol.tridiagonal.log_det([2.0]), lambda: one.add_rigid([[0, 1]], [[(0, 0, 0), (0, 0, 0)]]),
                 lambda: hol.partition_function(0)]
        for call in calls:
            with self.assertRaises(hol.Error) as caught:
                call()
            self.assertNotRegex(str(caught.exception), r"hol_|_view|HOL_|NULL|handle")
        with self.assertRaisesRegex(hol.NumberError, "^add: bond 0"):
            molecules.add([(0, 9)], 1)
        with self.assertRaisesRegex(hol.Error, "^threads: "):
            molecules.threads = 0

    def test_crude_positions_are_told_of_impose(self):
        molecules, r = dimers()
        crude = r * (0.85, 1, 1)
        with self.assertRaisesRegex(hol.LengthsError, r"\(impose\)"):
            molecules.project_positions(crude, crude + 0.0, 1)
        molecules.impose(crude)
        molecules.project_positions(crude, crude + 0.0, 1)

    def test_a_step_that_explodes_is_no_matter_of_units(self):
        for is_first in (True, False):
            for far in (3, 40, 1e5):
                molecules, r = dimers()
                if not is_first:
                    molecules.project_positions(r, r + 0.0, 1)
                new = r + 0.0
                new[3] += (0, far, 0)
                with self.assertRaisesRegex(hol.NoConvergenceError, "forces or time step") as caught:
                    molecules.project_positions(r, new, 1)
                self.assertNotRegex(str(caught.exception), "unit|order|counted")
                self.assertLessEqual(len(str(caught.exception)), 240)
                self.assertEqual((caught.exception.molecule, caught.exception.bond), (1, 0))

    def test_messages_about_lengths_fit_in_240_letters(self):
        molecules, r = dimers(1000)
        for wrong in (r * (0.85, 1, 1), r * (10, 1, 1), np.roll(r, 1, axis=0)):
            for box in (None, 30000.0):
                molecules.box = box
                with self.assertRaises(hol.LengthsError) as caught:
                    molecules.project_positions(wrong, wrong + 0.0, 1)
                self.assertLessEqual(len(str(caught.exception)), 240, str(caught.exception))

    def test_one_is_singular(self):
        molecules, r = dimers(1)
        self.assertEqual(repr(molecules), "<holonomic.Molecules: 1 molecule with 1 bond, of 2 atoms>")
        self.assertEqual(repr(molecules.forces(r)), "<holonomic.Forces of 1 bond>")
        molecules, r = dimers(500)
        self.assertEqual(repr(molecules), "<holonomic.Molecules: 500 molecules with 500 bonds, of 1000 atoms>")
        for n in (1, 2):
            molecules, r = dimers(n)
            text = repr(molecules.project_positions(r, r + 0.01 * np.arange(6 * n).reshape(2 * n, 3), 1))
            self.assertIsNone(re.search(r"\b1 \w+s\b", text), text)


class FirstHour(unittest.TestCase):
    """Each of these is said, whatever is wrong; arrays of the caller's stay as they were."""

    def setUp(self):
        self.molecules, self.r = dimers()
        self.v = 0 * self.r

    def test_arrays_of_the_wrong_form(self):
        molecules, r, v = self.molecules, self.r, self.v
        for call in (lambda: molecules.forces(r.T), lambda: molecules.forces(r[:-1]), lambda: molecules.forces(r, v.T),
                     lambda: molecules.forces(r.ravel()), lambda: molecules.project_velocities(r, v[:-1]),
                     lambda: molecules.project_velocities(r, v.tolist()), lambda: molecules.project_velocities(r, v.astype(int)),
                     lambda: molecules.project_positions(r, (r + 0.0).astype(int), 1),
                     lambda: molecules.project_positions(r, (r + 0.0).tolist(), 1), lambda: molecules.project_positions(r[:2], r + 0.0, 1),
                     lambda: molecules.solve(r, [1.0, 2.0]), lambda: molecules.reactions(r, np.zeros(4)),
                     lambda: molecules.set_lengths([1.0, 2.0]), lambda: molecules.set_masses([1.0]),
                     lambda: hol.Molecules(np.ones((3, 3))), lambda: setattr(molecules, "box", np.ones((2, 2))),
                     lambda: setattr(molecules, "box", [10, 10])):
            with self.assertRaises((TypeError, ValueError)):
                call()

    def test_bonds_of_the_wrong_form(self):
        for bonds, lengths in (([(0, 1, 2)], 1.0), ([0, 1], 1.0), (np.array([[0, 2], [1, 3]]).T[:, :1], 1.0), ([(0, 1)], [1.0, 2.0]),
                               ([(0, 1)], -1.0), ([(0, 1)], np.inf), ([(0, 1.5)], 1.0), ([(0, -1)], 1.0), ([(5, 6)], 1.0),
                               ([(0, 1), (1, 2), (0, 2)], [1.0, 1.0, 3.0])):
            molecules = hol.Molecules(np.ones(6))
            with self.assertRaises((TypeError, ValueError, IndexError), msg=str(bonds)):
                molecules.add(bonds, lengths)
            self.assertEqual(molecules.n_bonds, 0)

    def test_steps_that_mean_nothing(self):
        molecules, r, v = self.molecules, self.r, self.v
        new = r + 0.01
        kept = new.copy()
        for dt in (0, np.nan, "1", None):
            with self.assertRaises((TypeError, ValueError)):
                molecules.project_positions(r, new, dt, v)
        for wrong in (np.nan, np.inf):
            bad = new.copy()
            bad[2, 1] = wrong
            with self.assertRaisesRegex(hol.NotFiniteError, "atom 2"):
                molecules.project_positions(r, bad, 1)
            f = np.zeros_like(r)
            f[5, 0] = wrong
            with self.assertRaisesRegex(hol.NotFiniteError, "atom 5"):
                molecules.forces(r, v, f)
        np.testing.assert_array_equal(new, kept)

    def test_where_units_order_and_cells_differ(self):
        for scale, words in ((10, "unit"), (0.1, "unit")):
            molecules, r = dimers()
            with self.assertRaisesRegex(hol.LengthsError, words):
                molecules.project_positions(scale * r, scale * r, 1)
        molecules, r = dimers()
        with self.assertRaisesRegex(hol.LengthsError, "order"):
            molecules.check(r[[0, 2, 1, 3, 4, 5]])
        r[1, 0] -= 20
        with self.assertRaisesRegex(hol.LengthsError, "no box is set"):
            molecules.check(r)
        with self.assertRaises(ValueError):
            molecules.box = 1.5  # narrower than two bonds

    def test_integers_that_c_would_cut_off(self):
        molecules, r = self.molecules, self.r
        for call in (lambda: setattr(molecules, "threads", 2**32 + 2), lambda: setattr(molecules, "max_iterations", 2**32 + 5),
                     lambda: molecules.degrees_of_freedom(2**32 + 3), lambda: molecules.molecule(2**64),
                     lambda: molecules.inverse(2**64, r), lambda: setattr(molecules, "memory_limit", 2**64 + 1)):
            with self.assertRaisesRegex(ValueError, "bits"):
                call()
        self.assertEqual((molecules.threads, molecules.max_iterations), (1, 50))

    def test_numbers_where_true_and_false_are_meant(self):
        molecules = self.molecules
        for call in (lambda: setattr(molecules, "active", [0, 1, 2]), lambda: setattr(molecules, "active", [0.5, 1, 1]),
                     lambda: setattr(molecules, "active", ["a", "b", "c"]), lambda: setattr(molecules, "keep_outcomes", 2),
                     lambda: setattr(molecules, "keep_outcomes", "yes"), lambda: setattr(molecules, "find_bodies", None),
                     lambda: hol.Molecules([True, False]), lambda: setattr(molecules, "box", True),
                     lambda: setattr(molecules, "length_tolerance", "1e-4")):
            with self.assertRaisesRegex(TypeError, "must be"):
                call()
        molecules.active = [1, 0, True]
        self.assertEqual(molecules.active.tolist(), [True, False, True])

    def test_tolerances_that_hold_nothing(self):
        for tolerance in (1, 50, np.inf):
            with self.assertRaisesRegex(ValueError, "below 1"):
                self.molecules.tolerance = tolerance

    def test_a_reference_that_moves_with_the_positions(self):
        molecules, r, v = self.molecules, self.r, self.v
        v[1::2, 1] = 0.1
        before = r  # no copy
        r += v
        with self.assertWarnsRegex(hol.ReferenceWarning, r"before = r\.copy\(\)"):
            molecules.project_positions(before, r, 1.0, v)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            molecules.project_positions(r, r, 1.0, v)  # nothing is to be done
            r[1] += 1e-3
            molecules.project_positions(r, r, 1.0)  # crude positions, made right

    def test_constraint_forces_in_place_of_positions(self):
        molecules, r, v = self.molecules, self.r, self.v
        for out in (r, v):
            kept = out.copy()
            with self.assertRaisesRegex(ValueError, "is the array that was given for"):
                molecules.forces(r, v, out=out)
            np.testing.assert_array_equal(out, kept)
        with self.assertRaisesRegex(ValueError, "is the array that was given for"):
            molecules.solve(r, 1.0, out=r)

    def test_use_before_anything_is_there(self):
        molecules = hol.Molecules(np.ones(2))
        for call in (lambda: molecules.molecule(0), lambda: molecules.inverse(0, np.zeros((2, 3))), molecules.outcomes,
                     lambda: hol.Molecules([1.0, np.nan]), lambda: hol.Molecules([1.0, -1.0]), lambda: hol.Molecules(3)):
            with self.assertRaises((hol.Error, TypeError, ValueError)):
                call()
        with self.assertRaises(AttributeError):
            molecules.masses = [1.0, 2.0]


class Massless(unittest.TestCase):
    """An atom of mass 0 is held in space: what is meant for a massless site is not."""

    water = [(0, 1), (0, 2), (1, 2)]

    def test_a_site_that_is_bonded_to_a_rigid_molecule_is_warned_of(self):
        for site in ([(0, 3)], [(0, 3), (1, 3)], [(3, 0), (3, 1), (3, 2)]):
            molecules = hol.Molecules([16, 1, 1, 0] * 3)
            with self.assertWarnsRegex(hol.MasslessWarning, "atom 3 .* add_rigid"):
                molecules.add(self.water + site, 1.0)
            with self.assertWarnsRegex(hol.MasslessWarning, "atom 7"):
                molecules.add_molecules(2, 4, self.water + site, 1.0, first_atom=4)

    def test_one_that_is_bonded_to_a_body_too(self):
        molecules = hol.Molecules([16, 1, 1, 0])
        with self.assertWarnsRegex(hol.MasslessWarning, "atom 3 .* add_rigid"):
            molecules.add_rigid([[0, 1, 2]], [[(0, 0, 0), (0.6, 0.8, 0), (0.6, -0.8, 0)]], [(0, 3)], 0.15)
        self.assertEqual(molecules.held_sites().tolist(), [False, False, False, True])
        self.assertEqual(molecules.n_bonds, 1)

    def test_what_is_fixed_is_no_site(self):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            for masses, fixed in (([16, 1, 1, np.inf], None), ([16, 1, 1, 0], [3]), ([16, 1, 1, 5], [3])):
                molecules = hol.Molecules(masses, fixed=fixed)
                molecules.add(self.water + [(0, 3)], 1.0)
                self.assertFalse(molecules.held_sites().any())
        held = hol.Molecules([16, 1, 1, 0], fixed=[3])
        with self.assertRaisesRegex(ValueError, "atom 3"):
            held.add_rigid([[0, 1, 2, 3]], [[(0, 0, 0), (0.6, 0.8, 0), (0.6, -0.8, 0), (0.1, 0, 0)]])

    def test_anchors_are_not(self):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            molecules = hol.Molecules([0, 1, 1, 1, 0, 1, 1, 0])
            molecules.add([(0, 1), (1, 2), (2, 3), (3, 4), (4, 5)], 1.0)
            tethered = hol.Molecules([16, 1, 1, 0], fixed=[3])
            tethered.add(self.water + [(0, 3)], 1.0)

    def test_where_it_is_said_what_is_fixed_others_of_mass_0_cannot_be_bonded(self):
        molecules = hol.Molecules([5, 1, 0, 1], fixed=[True, False, False, False])
        self.assertEqual(molecules.masses.tolist(), [0, 1, 0, 1])
        molecules.add([(0, 1)], 1.0)
        with self.assertRaisesRegex(ValueError, "atom 2 has mass 0"):
            molecules.add([(2, 3)], 1.0)
        molecules.set_masses([7, 2, 0, 1])
        self.assertEqual(molecules.masses.tolist(), [0, 2, 0, 1])
        for wrong in ([4], [-1], [True]):
            with self.assertRaises((IndexError, ValueError)):
                hol.Molecules(np.ones(4), fixed=wrong)

    def test_spread_forces_gives_those_on_sites_to_their_bodies(self):
        m = 0.25 * np.array([0.6, 0.8, 0])
        places = np.array([(0, 0, 0), (0.9572, 0, 0), (-0.239987, 0.926627, 0), m])
        molecules = hol.Molecules([16, 1, 1, 0])
        molecules.add_rigid([[0, 1, 2, 3]], [places])
        rng = np.random.default_rng(0)
        q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        r, f = places @ q, rng.normal(size=(4, 3))
        force, torque = f.sum(0), np.cross(r, f).sum(0)
        spread = f.copy()
        molecules.spread_forces(r, spread)
        np.testing.assert_allclose(spread[3], 0, atol=1e-14)
        np.testing.assert_allclose(spread.sum(0), force, atol=1e-13)
        np.testing.assert_allclose(np.cross(r, spread).sum(0), torque, atol=1e-13)
        # One step of RATTLE from rest with either: the kick by the spread forces, and what they do is that of rigid motion.
        dt, w = 1e-4, np.array([1 / 16, 1, 1, 0])[:, None]
        v = 0.5 * dt * w * spread
        moved = r + dt * v
        moved[3] = r[3]
        molecules.project_positions(r, moved, dt, v)
        masses = np.array([16, 1, 1, 0])[:, None]
        np.testing.assert_allclose((masses * v)[:3].sum(0), 0.5 * dt * force, rtol=1e-9)
        np.testing.assert_allclose(np.cross(r, masses * v)[:3].sum(0), 0.5 * dt * torque, atol=1e-6 * dt)


class Boxes(unittest.TestCase):
    def cut(self, edge=9.3, n=40):
        rng = np.random.default_rng(1)
        u = rng.normal(size=(n, 3))
        u /= np.linalg.norm(u, axis=1)[:, None]
        r = np.repeat(rng.uniform(0, edge, (n, 3)), 2, axis=0)
        r[1::2] += u
        molecules = hol.Molecules(np.ones(2 * n))
        molecules.add_molecules(n, 2, [(0, 1)], 1.0)
        return molecules, r % edge

    def test_one_that_is_a_hundredth_off_is_seen(self):
        for box, is_right in ((9.3, True), (9.4, False), (9.21, False)):
            molecules, r = self.cut()
            molecules.box = box
            if is_right:
                molecules.check(r)
            else:
                with self.assertRaisesRegex(hol.LengthsError, "face of the box cuts"):
                    molecules.check(r)
            if is_right:
                molecules.project_positions(r, r + 0.0, 1)
            else:
                with self.assertRaisesRegex(hol.LengthsError, "hardly the box"):
                    molecules.project_positions(r, r + 0.0, 1)
            molecules.checks = "never"
            molecules.project_positions(r, r + 0.0, 1)

    def test_its_message_is_short(self):
        molecules, r = self.cut(n=100000)
        molecules.box = 9.4
        with self.assertRaisesRegex(hol.LengthsError, "hardly the box") as caught:
            molecules.project_positions(r, r + 0.0, 1)
        self.assertLessEqual(len(str(caught.exception)), 240)

    def test_by_bodies_too(self):
        places = np.array([(0, 0, 0), (0.6, 0.8, 0), (0.6, -0.8, 0)])
        rng = np.random.default_rng(1)
        r = np.concatenate([rng.uniform(0, 9.3, 3) + places @ np.linalg.qr(rng.normal(size=(3, 3)))[0] for _ in range(27)]) % 9.3
        for box, is_right in ((9.3, True), (9.4, False), (9.21, False)):
            molecules = hol.Molecules(np.tile([16.0, 1, 1], 27))
            molecules.add_rigid_molecules(27, 3, [[0, 1, 2]], [places])
            molecules.box = box
            if is_right:
                molecules.project_positions(r, r + 0.0, 1)
            else:
                with self.assertRaisesRegex(hol.LengthsError, "molecule .* a face of the box cuts it, .*hardly the box"):
                    molecules.project_positions(r, r + 0.0, 1)

    def test_crude_positions_inside_as_across_are_not_blamed_on_it(self):
        molecules, r = self.cut()
        molecules.box = 9.3
        crude = r + np.random.default_rng(2).normal(size=r.shape) * 0.01
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            molecules.check(crude)
            molecules.project_positions(crude, crude + 0.0, 1)


if __name__ == "__main__":
    unittest.main()
