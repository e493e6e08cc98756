"""What calls return."""

from __future__ import annotations

import ctypes
from typing import Any, NamedTuple, Optional

import numpy as np


def counted(n: int, noun: str) -> str:
    """"1 bond", "2 bonds"."""
    return f"{n} {noun}" + ("" if n == 1 else "s")


def _forces(memory: bytes, n_bonds: int, out: Optional[np.ndarray], has_tensions: bool, columns: int) -> Forces:
    """One that was pickled or copied."""
    return Forces(bytearray(memory), n_bonds, out, has_tensions, columns)


class Forces:
    """Constraint forces at an instant, from `Molecules.forces` or `Molecules.solve`.

    lambda_   multipliers (n_bonds,), force/length
    tensions  2 lambda |d| (n_bonds,), force, positive under tension; None from `solve`
    forces    constraint forces (n_atoms, 3), force, 0 for atoms without a bond; the caller's array if `out` was given
    virial    (3, 3), energy: sum_i r_i (x) G_i

    Bonds are in the order in which they were given. The arrays are views of memory that belongs to this result.
    """

    __slots__ = ("_memory", "_n_bonds", "_out", "_has_tensions", "_columns", "_array")

    def __init__(self, memory: Any, n_bonds: int, out: Optional[np.ndarray], has_tensions: bool = True, columns: int = 3):
        self._memory, self._n_bonds, self._out = memory, n_bonds, out
        self._has_tensions, self._columns = has_tensions, columns
        self._array: np.ndarray  # made when it is asked for

    def _part(self, start: int, stop: Optional[int]) -> np.ndarray:
        try:
            array = self._array
        except AttributeError:
            self._array = array = np.frombuffer(self._memory)
        return array[start:stop]

    @property
    def lambda_(self) -> np.ndarray:
        """Multipliers (n_bonds,), force/length."""
        return self._part(0, self._n_bonds)

    @property
    def tensions(self) -> Any:
        """2 lambda |d| (n_bonds,), force."""
        return self._part(self._n_bonds, 2 * self._n_bonds) if self._has_tensions else None

    @property
    def virial(self) -> np.ndarray:
        """sum_i r_i (x) G_i (3, 3), energy."""
        start = 2 * self._n_bonds
        return self._part(start, start + 9).reshape(3, 3)

    @property
    def forces(self) -> np.ndarray:
        """Constraint forces G (n_atoms, 3)."""
        if self._out is not None:
            return self._out
        start = 2 * self._n_bonds + 9
        count = (len(self._part(0, None)) - start) // 3
        return self._part(start, start + count * self._columns).reshape(count, self._columns)

    def __reduce__(self) -> tuple:
        return _forces, (bytes(self._memory), self._n_bonds, self._out, self._has_tensions, self._columns)

    def __repr__(self) -> str:
        return f"<holonomic.Forces of {counted(self._n_bonds, 'bond')}>"


class Report(ctypes.Structure):
    """What `project_positions` did.

    iterations   largest number of linear solves that a molecule took
    n_corrected  molecules that were moved; the others were right already
    n_failed     molecules that were left as they were (an exception was raised then, unless it says so)
    molecule     molecule, and
    bond         bond within it, with the largest error left; -1 if there is none
    max_error    that error, |d.d - a^2| / a^2
    lambda_      multipliers (n_bonds,), force/length, or None if they were not wanted
    virial       (3, 3), energy, or None if it was not wanted
    """

    _fields_ = [("iterations", ctypes.c_int64), ("n_corrected", ctypes.c_int64), ("n_failed", ctypes.c_int64),
                ("molecule", ctypes.c_int64), ("bond", ctypes.c_int64), ("max_error", ctypes.c_double)]
    lambda_: Any = None  # an array where it was asked for: who did need not tell a type checker again
    virial: Any = None

    def __repr__(self) -> str:
        return (f"<holonomic.Report: {counted(self.n_corrected, 'molecule')} corrected in at most "
                f"{counted(self.iterations, 'iteration')}, "
                f"largest error {self.max_error:.2g}>")


class Impulse(NamedTuple):
    """What `project_velocities` did.

    lambda_  multipliers of the impulse (n_bonds,), force time/length, or None if they were not wanted
    virial   (3, 3), energy time, or None if it was not wanted
    """

    lambda_: Any
    virial: Any


class Reactions(NamedTuple):
    """What given multipliers do, from `Molecules.reactions`.

    tensions     2 lambda |d| (n_bonds,)
    forces       G (n_atoms, 3): forces, or impulses of the multipliers of velocities
    bond_virial  (n_bonds, 6): xx xy xz yy yz zz of each bond
    virial       (3, 3), their sum
    """

    tensions: np.ndarray
    forces: np.ndarray
    bond_virial: np.ndarray
    virial: np.ndarray


class Outcomes(NamedTuple):
    """What a call has done with each molecule, from `Molecules.outcomes`.

    status      (n_molecules,) of int32: 0, or the `status` of the Error that it alone would have raised
    iterations  (n_molecules,) of int32: linear solves of `project_positions`, steps of `impose`, else 0
    bad         numbers of the molecules whose status is not 0
    """

    status: np.ndarray
    iterations: np.ndarray

    @property
    def bad(self) -> np.ndarray:
        """Numbers of the molecules whose status is not 0."""
        return np.flatnonzero(self.status)


class Violation(ctypes.Structure):
    """How far positions and velocities are from the constraints.

    length           largest |d.d - a^2| / a^2
    length_molecule  its molecule, -1 if there is no bond, and
    length_bond      its bond within the molecule
    rate             largest |d.(v_j - v_i + L d)|, length^2/time; 0 without velocities
    rate_molecule    its molecule, -1 without velocities, and
    rate_bond        its bond
    """

    _fields_ = [("length", ctypes.c_double), ("length_molecule", ctypes.c_int64), ("length_bond", ctypes.c_int64),
                ("rate", ctypes.c_double), ("rate_molecule", ctypes.c_int64), ("rate_bond", ctypes.c_int64)]

    def __repr__(self) -> str:
        return f"<holonomic.Violation: length {self.length:.2g}, rate {self.rate:.2g}>"


class Metric(NamedTuple):
    """Metric determinant and Fixman potential, from `Molecules.metric`.

    log_det    ln det Z~ (n_molecules,), at most 0
    log_det_z  ln det Z (n_molecules,), in the caller's units
    energy     U_F = kT/2 sum ln det Z~
    forces     - grad U_F (n_atoms, 3)
    """

    log_det: np.ndarray
    log_det_z: np.ndarray
    energy: float
    forces: np.ndarray
