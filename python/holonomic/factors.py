"""Factors of a set of molecules at one configuration, kept for any number of right-hand sides."""

from __future__ import annotations

import weakref
from ctypes import addressof, byref, c_void_p
from typing import TYPE_CHECKING, Any, NoReturn, Optional

import numpy as np

from ._arrays import address, numbers
from ._library import library
from ._types import Array, Floats
from .errors import ArgumentError, ask
from .results import Forces

if TYPE_CHECKING:
    from .molecules import Molecules


class Factors:
    """Factors of all molecules at the positions r, from `Molecules.factors(r)`: for several force groups at one configuration
    (r-RESPA), terms that relax errors, many right-hand sides. A solve with them makes no elimination.

    They belong to the positions, box and rate of the box of the last `update`; after a change of the molecules calls raise
    StateError until the next one. They keep the molecules alive.
    """

    __slots__ = ("_handle", "_molecules", "_destroy", "_columns", "__weakref__")

    def __init__(self, molecules: Molecules, r: Floats):
        handle = c_void_p()
        ask(library.hol_factors_create(molecules._handle, byref(handle)))
        self._handle, self._molecules = handle, molecules
        self._destroy = weakref.finalize(self, library.hol_factors_destroy, handle)
        self.update(r)

    def __reduce__(self) -> NoReturn:
        raise TypeError("Factors can't be copied or pickled: copy the Molecules, and ask them for factors(r)")

    def update(self, r: Floats) -> None:
        """Makes the factors at positions r (n_atoms, 3), which are copied."""
        ask(library.hol_factors_update_view(self._handle, self._molecules._view(r, "r")))
        self._columns = np.shape(r)[1]

    def forces(self, v: Array = None, f: Array = None, *, out: Optional[np.ndarray] = None, add: bool = False) -> Forces:
        """`Molecules.forces` at the positions of the factors."""
        molecules = self._molecules
        n, memory = molecules._n_bonds, molecules._outputs()
        g_view, columns = self._into(memory, out)
        start = addressof(memory)
        ask(library.hol_factors_forces_view(self._handle, molecules._view(v, "v"), molecules._view(f, "f"), start,
                                            start + 8 * n, g_view, int(add), start + 16 * n))
        return Forces(memory, n, out, True, columns)

    def solve(self, rhs: Floats, *, out: Optional[np.ndarray] = None, add: bool = False) -> Forces:
        """`Molecules.solve` at the positions of the factors."""
        molecules = self._molecules
        n, memory = molecules._n_bonds, molecules._outputs()
        rhs = numbers(rhs, n, "rhs", "bond")
        g_view, columns = self._into(memory, out)
        start = addressof(memory)
        ask(library.hol_factors_solve_view(self._handle, 1, address(rhs), start, g_view, int(add), start + 16 * n))
        return Forces(memory, n, out, False, columns)

    def multipliers(self, rhs: Floats) -> np.ndarray:
        """Multipliers alone, of any number of right-hand sides at once: of rhs (k, n_bonds), in the same shape."""
        n = self._molecules._n_bonds
        rhs = np.ascontiguousarray(rhs, dtype=np.float64)
        if rhs.ndim != 2 or rhs.shape[1] != n:
            raise ArgumentError(f"rhs has the shape {rhs.shape}; it must be (k, {n}), a number for each bond")
        lambda_ = np.zeros_like(rhs)
        ask(library.hol_factors_solve_view(self._handle, len(rhs), address(rhs), address(lambda_), None, 0, None))
        return lambda_

    def _into(self, memory: Any, out: Optional[np.ndarray]) -> Any:
        return self._molecules._forces_into(memory, np.empty((0, self._columns)), out)

    def __repr__(self) -> str:
        return f"<holonomic.Factors of {self._molecules!r}>"
