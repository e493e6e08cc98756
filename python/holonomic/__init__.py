"""Exact Lagrange multipliers and constraint forces of molecules with rigid bonds.

    import holonomic as hol
    molecules = hol.Molecules(masses)                      # (n_atoms,); 0: held fixed
    molecules.add(bonds, lengths)                          # (n, 2) and (n,): any molecules, in any order
    molecules.project_positions(r_ref, r, dt, v)           # SHAKE, RATTLE's first half: r and v in place
    molecules.project_velocities(r, v)                     # RATTLE's second half
    result = molecules.forces(r, v, f)                     # .lambda_ .tensions .forces .virial

`help(holonomic.Molecules)` has all of it; errors are subclasses of `holonomic.Error`. For ASE: `holonomic.ase`.
"""

from . import tridiagonal
from ._library import instruction_set, version
from ._queries import Molecule
from .device import DevicePlan, Launch
from .errors import (ArgumentError, DegenerateError, Error, LengthsError, LengthsWarning, MasslessWarning,
                     NoConvergenceError, NotDefiniteError, NotFiniteError, NumberError, OutOfMemoryError, ReferenceWarning,
                     SharedAtomError, StateError, UnsupportedError)
from .equimomental import equimomental_points
from .factors import Factors
from .inverse import Inverse
from .molecules import Molecules
from .partition import PartitionFunction, partition_function
from .results import Forces, Impulse, Metric, Outcomes, Reactions, Report, Violation

__version__ = "0.3.0"
__all__ = [
    "ArgumentError", "DegenerateError", "DevicePlan", "Error", "Factors", "Forces", "Impulse", "Inverse", "Launch", "LengthsError",
    "LengthsWarning", "MasslessWarning", "Metric", "Molecule", "Molecules", "NoConvergenceError", "NotDefiniteError",
    "NotFiniteError", "NumberError", "OutOfMemoryError", "Outcomes", "PartitionFunction", "Reactions",
    "ReferenceWarning", "Report", "SharedAtomError",
    "StateError", "UnsupportedError", "Violation", "equimomental_points", "instruction_set", "partition_function",
    "tridiagonal", "version",
]
