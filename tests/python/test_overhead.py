"""What a call from Python takes beyond the same call in C, for 100 bonds: at most 3 us. The least of many runs, in turns with C:
other programs on the machine make single runs longer, so it goes on until the least is small enough, or for two minutes."""

import ctypes
import os
import time
import unittest

import numpy as np

import holonomic as hol

BONDS, CALLS, MOST_US, PATIENCE_S = 100, 200, 3.0, 120
loop = ctypes.CDLL(os.environ["HOLONOMIC_LOOP"])
for name in ("forces_in_c", "positions_in_c", "velocities_in_c"):
    getattr(loop, name).restype = ctypes.c_double


def at(array):
    return array.ctypes.data_as(ctypes.c_void_p)


class Overhead(unittest.TestCase):
    def setUp(self):
        rng = np.random.default_rng(1)
        n = BONDS + 1
        steps = rng.normal(size=(BONDS, 3))
        steps /= np.linalg.norm(steps, axis=1)[:, None]
        self.r = np.vstack([np.zeros(3), np.cumsum(steps, axis=0)])
        self.v, self.f = rng.normal(size=(n, 3)), rng.normal(size=(n, 3))
        self.molecules = hol.Molecules(np.ones(n))
        self.molecules.add_chain(range(n), 1.0)
        self.moved = self.r.copy()
        self.molecules.project_positions(self.r, self.moved, 1e-3, self.v)
        self.handle = self.molecules._handle

    def compare(self, what, in_c, in_python):
        least_c = least_python = float("inf")
        began = time.monotonic()
        runs = 0
        while runs < 100 or (least_python - least_c > MOST_US and time.monotonic() - began < PATIENCE_S):
            runs += 1
            taken = in_c() / 1000
            self.assertGreater(taken, 0)
            least_c = min(least_c, taken)
            start = time.perf_counter()
            for _ in range(CALLS):
                in_python()
            least_python = min(least_python, (time.perf_counter() - start) / CALLS * 1e6)
        print(f"{what}: {least_c:.2f} us in C, {least_python - least_c:.2f} us beyond it", flush=True)
        self.assertLessEqual(least_python - least_c, MOST_US)

    def test_forces(self):
        out = np.zeros(2 * BONDS + 9 + self.r.size)
        self.compare("forces", lambda: loop.forces_in_c(self.handle, CALLS, at(self.r), at(self.v), at(self.f), at(out)),
                     lambda: self.molecules.forces(self.r, self.v, self.f))

    def test_positions(self):
        trial = self.moved.copy()  # right already: the call's own work is least
        self.compare("positions", lambda: loop.positions_in_c(self.handle, CALLS, at(self.r), at(trial), at(self.v)),
                     lambda: self.molecules.project_positions(self.r, trial, 1e-3, self.v))

    def test_velocities(self):
        self.compare("velocities", lambda: loop.velocities_in_c(self.handle, CALLS, at(self.r), at(self.v)),
                     lambda: self.molecules.project_velocities(self.r, self.v))


if __name__ == "__main__":
    unittest.main()
