"""Settings of a set of molecules: cell, checks, threads, when to stop."""

from __future__ import annotations

from typing import Any, Optional

import numpy as np

from ._arrays import address, matrix
from ._library import library
from .errors import ArgumentError, ask

_WHEN = ("never", "at start", "always")


class Settings:
    """The part of Molecules that is set. Settings must not be changed while another thread is in a call."""

    _box: Optional[np.ndarray] = None
    _reference_box: Optional[np.ndarray] = None
    _box_rate: Optional[np.ndarray] = None
    _threads = 1
    _tolerance = 0.0
    _max_iterations = 50
    _length_tolerance = 1e-3
    _checks = "at start"
    _memory_limit = 0
    _keep_outcomes = False
    _active: Optional[np.ndarray] = None

    @property
    def box(self) -> Optional[np.ndarray]:
        """Periodic cell (3, 3), row i is cell vector i, length; bond vectors are then minimum images. None: no cell.

        May be set to three sides (3,), or to one number for a cube. A side or row of zeros: not periodic along it.
        Changing the array that is returned changes nothing: set the box again.
        """
        return _copy(self._box)

    @box.setter
    def box(self, box: Any) -> None:
        box = matrix(box, "box")
        ask(library.hol_chains_set_box(self._handle, address(box)))
        self._box = box

    @property
    def reference_box(self) -> Optional[np.ndarray]:
        """Cell of r_ref in `project_positions`, where a barostat deforms it in between. None: the same as `box`."""
        return _copy(self._reference_box)

    @reference_box.setter
    def reference_box(self, box: Any) -> None:
        box = matrix(box, "reference_box")
        ask(library.hol_chains_set_reference_box(self._handle, address(box)))
        self._reference_box = box

    @property
    def box_rate(self) -> Optional[np.ndarray]:
        """Rate L (3, 3), 1/time, at which the cell changes and atoms with it: r' = v + L r. None: it does not."""
        return _copy(self._box_rate)

    @box_rate.setter
    def box_rate(self, rate: Any) -> None:
        rate = matrix(rate, "box_rate")
        ask(library.hol_chains_set_box_rate(self._handle, address(rate)))
        self._box_rate = rate

    @property
    def threads(self) -> int:
        """Number of threads that a call may use, 1 by default."""
        return self._threads

    @threads.setter
    def threads(self, count: int) -> None:
        ask(library.hol_chains_set_threads(self._handle, count))
        self._threads = count

    @property
    def keep_outcomes(self) -> bool:
        """Whether calls keep a status and a number of iterations for each molecule, for `outcomes`. False by default: many small
        molecules take several times as long with it."""
        return self._keep_outcomes

    @keep_outcomes.setter
    def keep_outcomes(self, keep: bool) -> None:
        ask(library.hol_chains_set_outcomes(self._handle, bool(keep)))
        self._keep_outcomes = bool(keep)

    @property
    def tolerance(self) -> float:
        """`project_positions` is done with a molecule when |d.d - a^2| / a^2 is at most this. 0 (default): the rounding."""
        return self._tolerance

    @tolerance.setter
    def tolerance(self, tolerance: float) -> None:
        ask(library.hol_chains_set_tolerance(self._handle, tolerance))
        self._tolerance = tolerance

    @property
    def max_iterations(self) -> int:
        """Bound on the iterations of `project_positions` for a molecule, 50 by default."""
        return self._max_iterations

    @max_iterations.setter
    def max_iterations(self, count: int) -> None:
        ask(library.hol_chains_set_max_iterations(self._handle, count))
        self._max_iterations = count

    @property
    def length_tolerance(self) -> float:
        """By which part of them lengths of rigid groups may be adjusted, so that they are those of places in space: 1e-3 by
        default, at most 0.01; for what is added later."""
        return self._length_tolerance

    @length_tolerance.setter
    def length_tolerance(self, tolerance: float) -> None:
        ask(library.hol_chains_set_length_tolerance(self._handle, tolerance))
        self._length_tolerance = tolerance

    @property
    def memory_limit(self) -> int:
        """Bound on the memory that the set takes, in bytes: a molecule of so many cycles that it needs more is refused when
        it is added. 0 (default): a quarter of the machine's memory."""
        return self._memory_limit

    @memory_limit.setter
    def memory_limit(self, limit: int) -> None:
        ask(library.hol_chains_set_memory_limit(self._handle, limit))
        self._memory_limit = limit

    @property
    def checks(self) -> str:
        """When `project_positions` compares positions with lengths, so that a wrong unit, order or cell is an error:
        "at start" (default: in the first call and after changes), "never" (a crude start), "always".
        """
        return self._checks

    @checks.setter
    def checks(self, when: str) -> None:
        if when not in _WHEN:
            raise ArgumentError(f"checks is {when!r}; it must be one of {', '.join(map(repr, _WHEN))}")
        ask(library.hol_chains_set_checks(self._handle, _WHEN.index(when)))
        self._checks = when

    @property
    def active(self) -> Optional[np.ndarray]:
        """Molecules that take part, (n_molecules,) of bool; the data of others are neither read nor written. None: all."""
        return _copy(self._active)

    @active.setter
    def active(self, active: Any) -> None:
        if active is not None:
            active = np.array(active, dtype=bool)
            if active.shape != (self.n_molecules,):
                raise ArgumentError(f"active has the shape {active.shape}; it must be ({self.n_molecules},)")
        ask(library.hol_chains_set_active(self._handle, address(active)))
        self._active = active


def _copy(array: Optional[np.ndarray]) -> Optional[np.ndarray]:
    return None if array is None else array.copy()
