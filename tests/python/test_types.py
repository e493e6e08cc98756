"""What a type checker says of calls that are right, and of calls that are wrong. Status 77 where there is no mypy."""

import importlib.util
import os
import subprocess
import sys
import tempfile
import unittest

PACKAGE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "python")

RIGHT = """
import numpy as np
import holonomic as hol

molecules = hol.Molecules([1, 2.0, 3])
molecules = hol.Molecules(np.ones(6), fixed=[0])
molecules.add([(0, 1), (1, 2)], 1)
molecules.add(np.array([(0, 1)]), [1.0, 2])
molecules.add([], np.float32(1))
molecules.add_chain([3, 4, 5], np.ones(2))
molecules.add_rigid([[0, 1, 2]], [[(-1, 0, 0), (0, 0, 0), (1, 0, 0)]])
molecules.add_rigid([[0, 1, 2]], [np.eye(3)], [(2, 3)], 1.5)
molecules.box = 31.0
molecules.box = [31, 31.0, 31]
molecules.box = np.eye(3)
molecules.box = None
molecules.active = [True, False]
molecules.threads = 2
box = molecules.box
if box is not None:
    volume: float = float(np.linalg.det(box))
r, v = np.zeros((6, 3)), np.zeros((6, 3))
result = molecules.forces(r, v, [[0.0, 1, 2]])
largest = result.tensions.max() + result.lambda_.max() + result.virial.trace() + result.forces[0]
report = molecules.project_positions(r.tolist(), r, 0.002, v, multipliers=True, virial=True)
total = report.lambda_.sum() + report.virial.trace()
lambda_, virial = molecules.project_velocities(r, v, virial=True)
pressure = virial.trace()
shape: str = molecules.molecule(0).shape
bonds: np.ndarray = molecules.bonds
"""

WRONG = ['molecules.add([(0, 1)], "one")', 'molecules.add("ab", 1)', 'molecules.box = "31"', 'molecules.tolerence = 1e-8',
         'molecules.threads = 1.5', 'hol.Molecules("abc")', 'molecules.project_positions(r, r)', 'molecules.forces("r")',
         'molecules.project_velocities(r, [1.0])']


class Types(unittest.TestCase):
    def checked(self, text):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "program.py")
            with open(path, "w") as file:
                file.write(text)
            command = [sys.executable, "-m", "mypy", "--check-untyped-defs", "--cache-dir", os.path.join(folder, "cache"), path]
            done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "MYPYPATH": PACKAGE})
        return done.stdout + done.stderr

    def test_right_calls_pass_and_wrong_ones_do_not(self):
        self.assertIn("Success", self.checked(RIGHT))
        lines = RIGHT.count("\n")
        said = self.checked(RIGHT + "\n".join(WRONG) + "\n")
        for number, call in enumerate(WRONG, lines + 1):
            self.assertIn(f"program.py:{number}: error", said, call)


if __name__ == "__main__":
    if importlib.util.find_spec("mypy") is None:
        print("there is no mypy")
        sys.exit(77)
    unittest.main()
