"""Settings of a set of molecules: cell, checks, threads, when to stop."""

from __future__ import annotations

from typing import Any, Callable, Optional, Union, overload

import numpy as np

from ._arrays import address, boolean, integer, matrix, number
from ._library import library
from ._queries import Queries
from ._types import Floats
from .errors import ArgumentError, ask

_WHEN = ("never", "at start", "always")


class _ArraySetting:
    """A setting that is given in any form, and is an array or None afterwards: `take` checks and applies it."""

    def __init__(self, take: Callable[[Any, Any], Optional[np.ndarray]]):
        self._take, self.__doc__, self._slot = take, take.__doc__, "_" + take.__name__

    @overload
    def __get__(self, molecules: None, owner: Any) -> "_ArraySetting": ...

    @overload
    def __get__(self, molecules: Settings, owner: Any) -> Optional[np.ndarray]: ...

    def __get__(self, molecules: Optional[Settings], owner: Any) -> Union["_ArraySetting", Optional[np.ndarray]]:
        if molecules is None:
            return self
        value = getattr(molecules, self._slot)
        return None if value is None else value.copy()

    def __set__(self, molecules: Settings, value: Optional[Floats]) -> None:
        setattr(molecules, self._slot, self._take(molecules, value))


class Settings(Queries):
    """The part of Molecules that is set. Settings must not be changed while another thread is in a call."""

    __slots__ = ("_box", "_reference_box", "_box_rate", "_active")

    def __init__(self, masses: Floats, fixed: Any = None):
        super().__init__(masses, fixed)
        self._box: Optional[np.ndarray] = None
        self._reference_box: Optional[np.ndarray] = None
        self._box_rate: Optional[np.ndarray] = None
        self._active: Optional[np.ndarray] = None

    def _settings(self) -> dict:
        """All of them, in an order in which they can be set."""
        names = ("box", "reference_box", "box_rate", "threads", "tolerance", "max_iterations", "length_tolerance",
                 "memory_limit", "checks", "keep_outcomes", "find_bodies", "active", "images")
        return {name: getattr(self, name) for name in names}

    @_ArraySetting
    def box(self, box: Any) -> Optional[np.ndarray]:
        """Periodic cell (3, 3), row i is cell vector i, length; bond vectors are then minimum images. None: no cell.

        May be set to three sides (3,), or to one number for a cube. A side or row of zeros: not periodic along it.
        Changing the array that is returned changes nothing: set the box again.
        """
        box = matrix(box, "box", sides=True)
        ask(library.hol_chains_set_box(self._handle, address(box)))
        return box

    @_ArraySetting
    def reference_box(self, box: Any) -> Optional[np.ndarray]:
        """Cell of r_ref in `project_positions`, where a barostat deforms it in between. None: the same as `box`."""
        box = matrix(box, "reference_box", sides=True)
        ask(library.hol_chains_set_reference_box(self._handle, address(box)))
        return box

    @_ArraySetting
    def box_rate(self, rate: Any) -> Optional[np.ndarray]:
        """Rate L (3, 3), 1/time, at which the cell changes and atoms with it: r' = v + L r. None: it does not."""
        rate = matrix(rate, "box_rate")
        ask(library.hol_chains_set_box_rate(self._handle, address(rate)))
        return rate

    @_ArraySetting
    def active(self, active: Any) -> Optional[np.ndarray]:
        """Molecules that take part, (n_molecules,) of bool; the data of others are neither read nor written. None: all."""
        if active is not None:
            given = np.array(active)
            if given.shape != (self.n_molecules,):
                raise ArgumentError(f"active has the shape {given.shape}; it must be ({self.n_molecules},)")
            if given.dtype.kind not in "biu" or not np.isin(given, (0, 1)).all():
                raise TypeError(f"active must be True or False for each molecule, not {given.tolist()!r:.60}")
            active = given.astype(bool)
        ask(library.hol_chains_set_active(self._handle, address(active)))
        return active

    @property
    def threads(self) -> int:
        """Number of threads that a call may use, 1 by default."""
        return library.hol_chains_threads(self._handle)

    @threads.setter
    def threads(self, count: int) -> None:
        count = integer(count, "threads", 32)
        ask(library.hol_chains_set_threads(self._handle, count))

    @property
    def keep_outcomes(self) -> bool:
        """Whether calls keep a status and a number of iterations for each molecule, for `outcomes`. False by default: many small
        molecules take several times as long with it."""
        return bool(library.hol_chains_outcomes(self._handle))

    @keep_outcomes.setter
    def keep_outcomes(self, keep: bool) -> None:
        keep = boolean(keep, "keep_outcomes")
        ask(library.hol_chains_set_outcomes(self._handle, keep))

    @property
    def find_bodies(self) -> bool:
        """Whether distances that depend on each other become rigid bodies when they are added (default), or are refused."""
        return library.hol_chains_bodies(self._handle) == 0

    @find_bodies.setter
    def find_bodies(self, find: bool) -> None:
        find = boolean(find, "find_bodies")
        ask(library.hol_chains_set_bodies(self._handle, 0 if find else 1))

    @property
    def tolerance(self) -> float:
        """`project_positions` is done with a molecule when |d.d - a^2| / a^2 is at most this. 0 (default): the rounding."""
        return library.hol_chains_tolerance(self._handle)

    @tolerance.setter
    def tolerance(self, tolerance: float) -> None:
        tolerance = number(tolerance, "tolerance")
        ask(library.hol_chains_set_tolerance(self._handle, tolerance))

    @property
    def max_iterations(self) -> int:
        """Bound on the iterations of `project_positions` for a molecule, 50 by default."""
        return library.hol_chains_max_iterations(self._handle)

    @max_iterations.setter
    def max_iterations(self, count: int) -> None:
        count = integer(count, "max_iterations", 32)
        ask(library.hol_chains_set_max_iterations(self._handle, count))

    @property
    def length_tolerance(self) -> float:
        """By which part of them lengths of rigid groups may be adjusted, so that they are those of places in space: 1e-3 by
        default, at most 0.01; for what is added later."""
        return library.hol_chains_length_tolerance(self._handle)

    @length_tolerance.setter
    def length_tolerance(self, tolerance: float) -> None:
        tolerance = number(tolerance, "length_tolerance")
        ask(library.hol_chains_set_length_tolerance(self._handle, tolerance))

    @property
    def memory_limit(self) -> int:
        """Bound on the memory that the set takes, in bytes: a molecule of so many cycles that it needs more is refused when
        it is added. 0 (default): a quarter of the machine's memory."""
        return library.hol_chains_memory_limit(self._handle)

    @memory_limit.setter
    def memory_limit(self, limit: int) -> None:
        limit = integer(limit, "memory_limit")
        ask(library.hol_chains_set_memory_limit(self._handle, limit))

    @property
    def checks(self) -> str:
        """When `project_positions` compares positions with lengths, so that a wrong unit, order or cell is an error:
        "at start" (default: in the first call and after changes), "never" (a crude start), "always".
        """
        return _WHEN[library.hol_chains_checks(self._handle)]

    @checks.setter
    def checks(self, when: str) -> None:
        if when not in _WHEN:
            raise ArgumentError(f"checks is {when!r}; it must be one of {', '.join(map(repr, _WHEN))}")
        ask(library.hol_chains_set_checks(self._handle, _WHEN.index(when)))
