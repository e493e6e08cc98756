"""Arrays of numpy as the library takes them: where they stand, without a copy wherever that is possible."""

from __future__ import annotations

import operator
import weakref
from ctypes import addressof, byref, c_char, c_void_p
from typing import Any, Optional

import numpy as np

from ._library import View
from .errors import ArgumentError

_DOUBLE, _SINGLE = np.dtype(np.float64), np.dtype(np.float32)


class NotPacked(Exception):
    """An array that is no packed array of doubles: it goes to the library as a view."""


class PackedArrays:
    """Addresses of arrays that have been seen before: asking numpy for one takes longer than 100 bonds.

    An array is known again by its identity. The weak reference tells it from a later one at the same place, and keeps
    numpy from moving its memory (ndarray.resize raises as long as there is one).
    """

    def __init__(self, shape: tuple):
        self._shape = shape
        self._known: dict = {}
        self._get = self._known.get

    def pointer(self, array: Any) -> Optional[c_void_p]:
        """For packed doubles that may be written. Raises NotPacked for anything else."""
        known = self._get(id(array))
        if known is not None and known[0]() is array:
            return known[1]
        return self._enter(array)

    def _enter(self, array: Any) -> Optional[c_void_p]:
        if array is None:
            return None
        if type(array) is not np.ndarray or array.dtype != _DOUBLE or array.shape != self._shape or not array.flags.aligned:
            raise NotPacked
        try:
            pointer = c_void_p(addressof(c_char.from_buffer(array)))  # type: ignore  # sooner than by array.ctypes
        except (TypeError, ValueError):  # read-only, not contiguous, or without a byte
            raise NotPacked from None
        if len(self._known) >= 64:  # most of them are gone
            self._known.clear()
        self._known[id(array)] = (weakref.ref(array), pointer)
        return pointer


def _strides_fit(array: np.ndarray) -> bool:
    size = array.itemsize
    return array.flags.aligned and array.strides[0] != 0 and array.strides[0] % size == 0


def view_of(array: Any, rows: int, name: str, what: str = "atoms", output: bool = False):
    """A pointer to a hol_view of an array (rows, 3) or (rows, 2) of float64 or float32, or None for None.

    Inputs of other types are converted; outputs must have one of these two.
    """
    if array is None:
        return None
    if output and not isinstance(array, np.ndarray):
        raise TypeError(f"{name} is written to: it must be an array of numpy, not {type(array).__name__}")
    a = np.asarray(array)
    if a.ndim != 2 or a.shape[0] != rows or a.shape[1] not in (2, 3):
        raise ArgumentError(f"{name} has the shape {a.shape}; it must be ({rows}, 3), or ({rows}, 2), for {rows} {what}")
    if a.dtype != _DOUBLE and a.dtype != _SINGLE or not _strides_fit(a):
        if output:
            raise TypeError(f"{name} is written to: it must be aligned, in rows of its own, of float64 or float32; "
                            f"it is {a.dtype} with strides {a.strides}")
        a = _doubles(np.array(a), name)
    if output and not a.flags.writeable:
        raise ArgumentError(f"{name} is written to, and is read-only")
    start, column = a.__array_interface__["data"][0] if a.size else 8, a.strides[1]
    view = View(start, start + column, start + 2 * column if a.shape[1] == 3 else None, a.strides[0] or a.itemsize,
                0 if a.dtype == _DOUBLE else 1, 0)
    if a is not array:
        view.array = a  # lives as long as what points to it
    return byref(view)


class KnownViews:
    """Views of arrays that have been seen before, as PackedArrays has addresses."""

    def __init__(self, rows: int):
        self._rows = rows
        self._known: dict = {}

    def view(self, array: Any, name: str, output: bool) -> Any:
        known = self._known.get(id(array))
        if known is not None and known[0]() is array and (known[2] or not output):
            return known[1]
        pointer = view_of(array, self._rows, name, output=output)
        if type(array) is np.ndarray and not hasattr(pointer._obj, "array"):  # used where it stands
            if len(self._known) >= 64:
                self._known.clear()
            self._known[id(array)] = (weakref.ref(array), pointer, array.flags.writeable)
        return pointer


def dimensions(array: Any) -> int:
    """2 or 3, the number of columns."""
    return np.shape(array)[1]


def numbers(values: Any, count: Optional[int], name: str, of: str) -> np.ndarray:
    """A packed array [count] of doubles; a single number stands for all."""
    a = _doubles(values, name)
    if a.ndim == 0 and count is not None:
        a = np.full(count, a)
    if a.ndim != 1 or (count is not None and len(a) != count):
        raise ArgumentError(f"{name} has the shape {a.shape}; it must be ({'n' if count is None else count},), one for each {of}")
    return np.ascontiguousarray(a)


def output(array: Any, shape: tuple, name: str) -> np.ndarray:
    """An array of packed doubles that the caller gave to be written to."""
    if not isinstance(array, np.ndarray) or array.dtype != _DOUBLE:
        raise TypeError(f"{name} is written to: it must be an array of float64")
    flags = array.flags
    if array.shape != shape or not (flags.c_contiguous and flags.aligned and flags.writeable):
        raise ArgumentError(f"{name} is written to: it must have the shape {shape}, be contiguous and not read-only")
    return array


def _doubles(values: Any, name: str) -> np.ndarray:
    a = np.asarray(values)
    if a.dtype.kind not in "fiu":
        raise TypeError(f"{name} must be numbers" + (f", not {values!r}" if isinstance(values, str) else f"; it is of {a.dtype}"))
    return a.astype(np.float64, copy=False)


def integer(value: Any, name: str, bits: int = 64) -> int:
    """One that an integer of C can hold: ctypes would cut off what is above."""
    try:
        found = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} must be an integer, not {value!r}") from None
    if not -(1 << (bits - 1)) <= found < 1 << (bits - 1):
        raise ArgumentError(f"{name} is {found}; integers have up to {bits} bits here")
    return found


def boolean(value: Any, name: str) -> bool:
    """True or False, or 1 or 0 in their place."""
    if not isinstance(value, (bool, np.bool_, int, np.integer)) or value not in (0, 1):
        raise TypeError(f"{name} must be True or False, not {value!r}")
    return bool(value)


def number(value: Any, name: str) -> float:
    try:
        return float(operator.truediv(value, 1))  # no text, which float() would read
    except TypeError:
        raise TypeError(f"{name} must be a number, not {value!r}") from None


def integers(values: Any, name: str) -> np.ndarray:
    a = np.asarray(values)
    if a.size and not np.issubdtype(a.dtype, np.integer):
        raise TypeError(f"{name} must be integers, not {a.dtype}")
    return np.ascontiguousarray(a, dtype=np.int64)


def address(array: Optional[np.ndarray]) -> Optional[int]:
    """The caller has to keep the array until the call is over."""
    return None if array is None else array.__array_interface__["data"][0]


def matrix(values: Any, name: str, sides: bool = False) -> Optional[np.ndarray]:
    """A box or rate as (3, 3): from that, from three numbers for the diagonal, or from one for all three. With `sides` these
    are lengths: not negative."""
    if values is None:
        return None
    a = _doubles(values, name)
    if sides and a.ndim < 2 and not np.all(a >= 0):
        raise ArgumentError(f"{name} is {a.tolist()}; sides must be positive, or 0 where it is not periodic")
    if a.shape == ():
        a = np.full(3, a)
    if a.shape == (3,):
        a = np.diag(a)
    if a.shape != (3, 3):
        raise ArgumentError(f"{name} has the shape {a.shape}; it must be one number, three sides, or (3, 3)")
    return np.array(a, order="C")
