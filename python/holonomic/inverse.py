"""The inverse of the matrix Z of one molecule."""

from __future__ import annotations

import weakref
from ctypes import byref, c_double, c_void_p
from typing import NoReturn, Tuple

import numpy as np

from ._arrays import address, integer, numbers, view_of
from ._library import library
from ._types import Array, Floats
from .errors import ask


class Inverse:
    """Inverse of Z of one molecule in one conformation, from `Molecules.inverse`; lambda = Z^-1 (K + C).

    Everything is copied: the molecules and r may change afterwards. Numbers i, j are those of bonds within the molecule
    (`Molecules.molecule(i).bonds`). With physical=True elements are those of Z, in 1/(length^2/mass), otherwise those of
    Z~, which has ones on its diagonal.
    """

    __slots__ = ("_handle", "_n_atoms", "_n_bonds", "_destroy", "__weakref__")

    def __init__(self, chains: c_void_p, molecule: int, r_view: object, n_atoms: int):
        handle = c_void_p()
        ask(library.hol_inverse_create_view(chains, integer(molecule, "molecule"), r_view, byref(handle)))
        self._handle, self._n_atoms = handle, n_atoms
        self._n_bonds = library.hol_inverse_n_bonds(handle)
        self._destroy = weakref.finalize(self, library.hol_inverse_destroy, handle)

    # It never changes: one does for all.
    def __copy__(self) -> Inverse:
        return self

    def __deepcopy__(self, memo: dict) -> Inverse:
        return self

    def __reduce__(self) -> NoReturn:
        raise TypeError("an Inverse can't be pickled: pickle the Molecules and r, and ask them for it again; or its matrix()")

    @property
    def n_bonds(self) -> int:
        """Number of bonds of the molecule, i.e. of rows."""
        return self._n_bonds

    def entry(self, i: int, j: int, physical: bool = False) -> float:
        """One element."""
        value = c_double()
        ask(library.hol_inverse_entry(self._handle, int(physical), integer(i, "i"), integer(j, "j"), byref(value)))
        return value.value

    def row(self, i: int, physical: bool = False) -> np.ndarray:
        """Row i, (n_bonds,)."""
        row = np.empty(self._n_bonds)
        ask(library.hol_inverse_row(self._handle, int(physical), integer(i, "i"), address(row)))
        return row

    def band(self, width: int, physical: bool = False) -> np.ndarray:
        """The diagonal and `width` diagonals beside it, (n_bonds, width+1): element (i, i+k) at [i, k]."""
        width = integer(width, "width")
        band = np.empty((self._n_bonds, max(width, 0) + 1))
        ask(library.hol_inverse_band(self._handle, int(physical), width, address(band)))
        return band

    def matrix(self, physical: bool = False) -> np.ndarray:
        """The whole inverse, (n_bonds, n_bonds)."""
        matrix = np.empty((self._n_bonds, self._n_bonds))
        ask(library.hol_inverse_matrix(self._handle, int(physical), address(matrix)))
        return matrix

    def condition(self) -> float:
        """Condition number of Z~ in the infinity norm."""
        condition = c_double()
        ask(library.hol_inverse_condition(self._handle, byref(condition)))
        return condition.value

    def error_bound(self, lambda_: Floats, v: Array = None, f: Array = None) -> Tuple[np.ndarray, float]:
        """How far multipliers of any source are from the exact ones at most: for each bond (n_bonds,), and relative to the
        largest. v and f as they were given to `forces`; lambda_ is the molecule's part, in the order of its bonds."""
        lambda_ = numbers(lambda_, self._n_bonds, "lambda_", "bond of the molecule")
        bound, relative = np.empty(self._n_bonds), c_double()
        ask(library.hol_inverse_error_bound_view(self._handle, view_of(v, self._n_atoms, "v"),
                                                 view_of(f, self._n_atoms, "f"), address(lambda_), address(bound),
                                                 byref(relative)))
        return bound, relative.value
