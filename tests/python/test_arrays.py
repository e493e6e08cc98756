"""Arrays are used where they stand, whatever their layout; what cannot be used is refused."""

import gc
import threading
import sys
import unittest

import dense
import numpy as np

import holonomic as hol


def scene(seed=1, n=12):
    rng = np.random.default_rng(seed)
    r, bonds, masses = dense.random_molecule(rng, n)
    molecules = hol.Molecules(masses)
    molecules.add(bonds, np.linalg.norm(r[bonds[:, 1]] - r[bonds[:, 0]], axis=1))
    return rng, r, bonds, masses, molecules


class Layouts(unittest.TestCase):
    def layouts(self, values):
        n = len(values)
        records = np.zeros(n, dtype=[("mass", float), ("x", float, 3), ("tag", np.int64)])
        columns = np.zeros((3, n))
        every_other = np.zeros((2 * n, 5))[::2, 1:4]
        backwards = np.zeros((n, 3))[::-1]
        for array in (np.zeros((n, 3)), records["x"], columns.T, every_other, backwards, np.asfortranarray(np.zeros((n, 3)))):
            array[:] = values
            yield array

    def test_doubles_of_any_strides_give_the_same_bits(self):
        rng, r, _, _, molecules = scene()
        v, f = rng.normal(size=r.shape), rng.normal(size=r.shape)
        wanted = molecules.forces(r, v, f)
        moved = r + 0.01 * v
        plain = moved.copy()
        molecules.project_positions(r, plain, 0.1)
        tangent = v.copy()
        molecules.project_velocities(r, tangent)
        for array in self.layouts(r):
            result = molecules.forces(array, v, f)
            for name in ("lambda_", "tensions", "forces", "virial"):
                np.testing.assert_array_equal(getattr(result, name), getattr(wanted, name))
        for array in self.layouts(moved):
            molecules.project_positions(r, array, 0.1)
            np.testing.assert_array_equal(array, plain)
        for array in self.layouts(v):
            molecules.project_velocities(r, array)
            np.testing.assert_array_equal(array, tangent)
        for array in self.layouts(f):
            molecules.forces(r, v, f, out=array, add=True)
            np.testing.assert_array_equal(array, f + wanted.forces)

    def test_what_stands_between_is_not_touched(self):
        rng, r, _, _, molecules = scene()
        memory = np.full((len(r), 5), 7.0)
        memory[:, 1:4] = r + 0.01 * rng.normal(size=r.shape)
        molecules.project_positions(r, memory[:, 1:4], 1)
        np.testing.assert_array_equal(memory[:, [0, 4]], 7.0)

    def test_singles_are_moved_where_they_stand(self):
        rng, r, bonds, _, molecules = scene()
        r32 = (r + 0.01 * rng.normal(size=r.shape)).astype(np.float32)
        kept = r32
        molecules.project_positions(r, r32, 1)
        self.assertIs(kept, r32)
        self.assertEqual(r32.dtype, np.float32)
        self.assertLess(molecules.violation(r32).length, 1e-6)
        exact = molecules.forces(r32.astype(float), None, r).lambda_
        np.testing.assert_array_equal(molecules.forces(r32, None, r).lambda_, exact)

    def test_two_dimensions(self):
        rng = np.random.default_rng(4)
        r = np.cumsum(rng.normal(size=(6, 2)), axis=0)
        v, f = rng.normal(size=r.shape), rng.normal(size=r.shape)
        bonds = np.array([(i, i + 1) for i in range(5)])
        molecules = hol.Molecules(np.ones(6))
        molecules.add(bonds, np.linalg.norm(np.diff(r, axis=0), axis=1))
        result = molecules.forces(r, v, f)
        multipliers, force = dense.forces(r, v, f, bonds, np.ones(6))
        np.testing.assert_allclose(result.lambda_, multipliers, rtol=1e-10)
        np.testing.assert_allclose(result.forces, force, atol=1e-10 * abs(force).max())
        with self.assertRaises(hol.ArgumentError):
            molecules.forces(r, np.zeros((6, 3)))

    def test_inputs_of_other_types_are_converted(self):
        rng, r, _, _, molecules = scene()
        f = rng.integers(-3, 4, size=r.shape)
        wanted = molecules.forces(r, None, f.astype(float)).lambda_
        frozen = r.copy()
        frozen.flags.writeable = False
        swapped = r.astype(">f8")
        constant = np.broadcast_to([0.0, 0.0, -1.0], r.shape)
        np.testing.assert_array_equal(molecules.forces(r, None, f).lambda_, wanted)
        np.testing.assert_array_equal(molecules.forces(r.tolist(), None, f.tolist()).lambda_, wanted)
        np.testing.assert_array_equal(molecules.forces(frozen, None, f).lambda_, wanted)
        np.testing.assert_array_equal(molecules.forces(swapped, None, f).lambda_, wanted)
        np.testing.assert_array_equal(molecules.forces(r, constant, constant).lambda_,
                                      molecules.forces(r, constant.copy(), constant.copy()).lambda_)

    def test_outputs_of_other_types_are_refused(self):
        _, r, _, _, molecules = scene()
        frozen = r.copy()
        frozen.flags.writeable = False
        for wrong in (r.tolist(), r.astype(int), r.astype(">f8"), np.broadcast_to(r[0], r.shape)):
            with self.assertRaises(TypeError):
                molecules.project_positions(r, wrong, 1)
        with self.assertRaises(ValueError):
            molecules.project_positions(r, frozen, 1)
        with self.assertRaises(ValueError):
            molecules.forces(r, out=frozen)
        with self.assertRaises(TypeError):
            molecules.project_positions(r, r, 1, lambda_=[0] * molecules.n_bonds)

    def test_shapes_that_do_not_fit_are_refused(self):
        _, r, _, _, molecules = scene()
        for wrong in (r[1:], r.ravel(), r[:, :1], np.zeros((len(r) + 1, 3)), r.T, 1.0):
            with self.assertRaises(hol.ArgumentError):
                molecules.forces(wrong)
            with self.assertRaises(hol.ArgumentError):
                molecules.forces(r, wrong)

    def test_an_array_at_the_place_of_an_earlier_one_is_not_taken_for_it(self):
        _, r, _, _, molecules = scene()
        wanted = molecules.forces(r, None, r).lambda_
        for k in range(300):
            f = r * (k + 1)  # often at the address and with the identity of the last
            np.testing.assert_allclose(molecules.forces(r, None, f).lambda_, (k + 1) * wanted, rtol=1e-9)
            del f
            gc.collect(0)

    def test_molecules_that_are_added_later_are_in_the_results(self):
        molecules = hol.Molecules(np.ones(5))
        r = np.array([(i, 0.0, 0.0) for i in range(5)])
        molecules.add([(0, 1)], 1)
        self.assertEqual(len(molecules.forces(r, None, r).lambda_), 1)
        molecules.add_chain([2, 3, 4], 1)
        self.assertEqual(len(molecules.forces(r, None, r).lambda_), 3)
        np.testing.assert_allclose(molecules.forces(r, None, r).tensions, [0.5, 1, 1])

    def test_no_atoms_and_no_bonds(self):
        empty = hol.Molecules([])
        self.assertEqual(empty.forces(np.zeros((0, 3))).forces.shape, (0, 3))
        free = hol.Molecules([1.0, 2.0])
        free.project_positions(np.zeros((2, 3)), np.ones((2, 3)), 1)
        np.testing.assert_array_equal(free.forces(np.zeros((2, 3))).forces, 0)


class Threads(unittest.TestCase):
    def test_others_run_during_a_call(self):
        _, r, _, _, molecules = scene()
        has_run = []
        before = sys.getswitchinterval()
        sys.setswitchinterval(1000)  # no thread is interrupted: another runs only if this one lets it
        try:
            thread = threading.Thread(target=lambda: has_run.append(True))
            thread.start()
            for _ in range(100000):
                if has_run:
                    break
                molecules.forces(r)
        finally:
            sys.setswitchinterval(before)
            thread.join()
        self.assertTrue(has_run)

    def test_share_molecules(self):
        rng, r, _, _, molecules = scene()
        scenes = [rng.normal(size=r.shape) for _ in range(4)]
        wanted = [molecules.forces(r, None, f).lambda_.copy() for f in scenes]
        wrong = []

        def work(f, multipliers):
            for _ in range(500):
                if not np.array_equal(molecules.forces(r, None, f).lambda_, multipliers):
                    wrong.append(f)

        threads = [threading.Thread(target=work, args=pair) for pair in zip(scenes, wanted)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertFalse(wrong)


if __name__ == "__main__":
    unittest.main()
