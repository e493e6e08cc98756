"""Plans for kernels of a GPU: what the library hands out, as arrays."""

import unittest

import numpy as np

import holonomic as hol


class Plans(unittest.TestCase):
    def setUp(self):
        self.molecules = hol.Molecules(np.ones(9))
        self.molecules.add([(0, 1), (0, 2), (1, 2), (3, 4), (4, 5)], 1.0)
        self.molecules.add([(6, 7), (6, 8), (7, 8)], [1.0, 1.0, 2.0])  # straight: a body

    def test_have_text_arrays_and_launches(self):
        for precision, dtype in ("single", np.float32), ("mixed", np.float64), ("double", np.float64):
            plan = self.molecules.device_plan(precision)
            self.assertEqual((plan.integers.dtype, plan.numbers.dtype, plan.failures.dtype), (np.int32, dtype, np.int32))
            np.testing.assert_array_equal(plan.failures, np.zeros(4))
            np.testing.assert_array_equal(plan.left, [2])
            self.assertEqual(plan.launches, (hol.Launch("hol_positions_0", "hol_velocities_0", 2, 64),))
            for name in plan.launches[0][:2]:
                self.assertIn(f"KERNEL void {name}(", plan.source)
            self.assertGreater(plan.scratch, 0)
            np.testing.assert_array_equal(plan.numbers, 1)  # of all masses and lengths

    def test_say_what_is_wrong(self):
        with self.assertRaisesRegex(hol.ArgumentError, "'half'"):
            self.molecules.device_plan("half")
        with self.assertRaisesRegex(hol.ArgumentError, "at most 1000"):
            self.molecules.device_plan("mixed", max_entries=1001)


if __name__ == "__main__":
    unittest.main()
