"""The package as it is installed loads the library in the folder that is named, and no other, and finds the tensions of a
chain of three bonds that hangs.

    installed.py FOLDER
"""

import os
import sys

import numpy

import holonomic as hol

folder = os.path.realpath(sys.argv[1])
package = os.path.dirname(hol.__file__)
assert "site-packages" in package or package.startswith(folder), package
with open("/proc/self/maps") as file:
    libraries = {line.split()[-1] for line in file if "libholonomic" in line}
assert libraries and all(name.startswith(folder) for name in libraries), libraries
molecules = hol.Molecules([0, 1, 1, 1])
molecules.add([(0, 1), (1, 2), (2, 3)], 1.0)
r = -numpy.outer(range(4), [0, 0, 1.0])
tensions = molecules.forces(r, None, numpy.outer([0, 1, 1, 1], [0, 0, -10.0])).tensions
assert abs(tensions - [30, 20, 10]).max() < 1e-13, tensions
print(f"{hol.version()}, {hol.instruction_set()}: {tensions}")
