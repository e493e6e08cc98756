"""The symmetric tridiagonal matrix T with ones on its diagonal and T[k-1, k] = -gamma[k-1], in twice the precision.

gamma is (n-1,); rows are counted from 0. NotDefiniteError says at which row the matrix stops being positive definite.
"""

from __future__ import annotations

from ctypes import byref, c_double
from typing import Tuple

import numpy as np

from ._arrays import address, integer, numbers
from ._library import library
from ._types import Floats
from .errors import ask


def _rows(gamma: Floats) -> Tuple[int, np.ndarray]:
    gamma = numbers(gamma, None, "gamma", "row but the first")
    return len(gamma) + 1, gamma


def pivots(gamma: Floats) -> np.ndarray:
    """Pivots Omega^2 of the elimination from the first row on, (n,)."""
    n, gamma = _rows(gamma)
    omega2 = np.empty(n)
    ask(library.hol_tridiagonal_pivots(n, address(gamma), address(omega2)))
    return omega2


def log_det(gamma: Floats) -> float:
    """ln det T."""
    n, gamma = _rows(gamma)
    value = c_double()
    ask(library.hol_tridiagonal_log_det(n, address(gamma), byref(value)))
    return value.value


def solve(gamma: Floats, b: Floats) -> np.ndarray:
    """x (n,) of T x = b."""
    n, gamma = _rows(gamma)
    b = numbers(b, n, "b", "row")
    x = np.empty(n)
    ask(library.hol_tridiagonal_solve(n, address(gamma), address(b), address(x)))
    return x


def inverse_entry(gamma: Floats, i: int, j: int) -> float:
    """One element of the inverse."""
    n, gamma = _rows(gamma)
    value = c_double()
    ask(library.hol_tridiagonal_inverse_entry(n, address(gamma), integer(i, "i"), integer(j, "j"), byref(value)))
    return value.value


def inverse_band(gamma: Floats, width: int) -> np.ndarray:
    """The diagonal of the inverse and `width` diagonals beside it, (n, width+1): element (i, i+k) at [i, k]."""
    n, gamma = _rows(gamma)
    width = integer(width, "width")
    band = np.empty((n, max(width, 0) + 1))
    ask(library.hol_tridiagonal_inverse_band(n, address(gamma), width, address(band)))
    return band
