"""Which bonds and bodies a constraint of ASE keeps: as they are given, renumbered, repeated, and in words."""

from __future__ import annotations

from typing import Any, List

import numpy as np
from ase.geometry import find_mic  # type: ignore

from .errors import ArgumentError, NumberError


class Kept:
    """pairs (n, 2), their lengths or None until they are known; bodies, lists of atoms, their places or None until then."""

    def __init__(self, pairs: np.ndarray, lengths: Any, bodies: List[np.ndarray], places: Any):
        self.pairs, self.lengths, self.bodies, self.places = pairs, lengths, bodies, places

    def atoms(self) -> np.ndarray:
        return np.unique(np.concatenate([self.pairs.ravel(), *self.bodies]))

    def count_from_start(self, n: int) -> None:
        """Numbers below 0 count from the end of the atoms."""
        everything = np.concatenate([self.pairs.ravel(), *self.bodies])
        if len(everything) and not (everything.min() >= -n and everything.max() < n):
            bad = everything[(everything < -n) | (everything >= n)][0]
            raise NumberError(f"atom {bad} is outside 0 .. {n - 1}")
        if len(everything) and everything.min() < 0:
            self.pairs = self.pairs % n
            self.bodies = [body % n for body in self.bodies]

    def measure(self, atoms: Any) -> bool:
        """Takes what is not known from the positions; says whether it took lengths."""
        self.count_from_start(len(atoms))
        if self.places is None:
            self.places = [find_mic(atoms.positions[body] - atoms.positions[body[0]], atoms.cell, atoms.pbc)[0]
                           for body in self.bodies]
        if self.lengths is not None:
            return False
        self.lengths = np.zeros(0)
        if len(self.pairs):
            self.lengths = find_mic(atoms.positions[self.pairs[:, 1]] - atoms.positions[self.pairs[:, 0]], atoms.cell,
                                    atoms.pbc)[1]
        return True

    def straighten(self, i: int, j: int, k: int) -> None:
        """Three atoms whose distances say that they are on a line become a body: as bonds they depend on each other."""
        sizes = []
        for pair in ((i, j), (j, k), (i, k)):
            same = (np.sort(self.pairs, axis=1) == sorted(pair)).all(axis=1)
            if not same.any():
                return
            sizes.append(self.lengths[same][0])
        if sizes[2] < (sizes[0] + sizes[1]) * (1 - 1e-5):  # more than half a degree from it
            return
        place = np.zeros((3, 3))
        place[1:, 0] = sizes[0], sizes[0] + sizes[1]
        keep = ~np.isin(self.pairs, (i, j, k)).all(axis=1)
        self.pairs, self.lengths = self.pairs[keep], self.lengths[keep]
        self.bodies, self.places = self.bodies + [np.array([i, j, k])], self.places + [place]

    def of_selection(self, new: np.ndarray) -> "Kept":
        """Those whose atoms are all selected: new[i] is the number that atom i gets, or -1. None left: an IndexError."""
        self.count_from_start(len(new))
        pairs = new[self.pairs]
        whole = (pairs != -1).all(axis=1)
        bodies = [k for k, body in enumerate(self.bodies) if (new[body] != -1).all()]
        if not whole.any() and not bodies:
            raise IndexError("Constraint not part of slice")
        return Kept(pairs[whole], None if self.lengths is None else self.lengths[whole], [new[self.bodies[k]] for k in bodies],
                    None if self.places is None else [self.places[k] for k in bodies])

    def repeated(self, copies: int, n: int) -> "Kept":
        self.count_from_start(n)
        return Kept(np.concatenate([self.pairs + k * n for k in range(copies)]),
                    None if self.lengths is None else np.tile(self.lengths, copies),
                    [body + k * n for k in range(copies) for body in self.bodies],
                    None if self.places is None else list(self.places) * copies)

    def copy(self) -> "Kept":
        return Kept(self.pairs.copy(), None if self.lengths is None else self.lengths.copy(), list(self.bodies),
                    None if self.places is None else list(self.places))

    def as_pairs(self) -> "Kept":
        """Bodies as distances, for files: each atom's from three of its body."""
        pairs, lengths = [self.pairs], [self.lengths]
        for k, body in enumerate(self.bodies):
            inner = np.array([(i, j) for j in range(len(body)) for i in range(min(j, 3))])
            pairs.append(body[inner])
            if self.places is not None:
                lengths.append(np.linalg.norm(self.places[k][inner[:, 0]] - self.places[k][inner[:, 1]], axis=1))
        known = self.lengths is not None and (self.places is not None or not self.bodies)
        return Kept(np.concatenate(pairs), np.concatenate(lengths) if known else None, [], None)

    def __repr__(self) -> str:
        parts = [] if len(self.pairs) == 0 else [_short(self.pairs.tolist())]
        if self.lengths is not None and len(self.lengths):
            parts.append("lengths=" + _short([float(f"{length:.6g}") for length in self.lengths]))
        if self.bodies:
            parts.append("bodies=" + _short([body.tolist() for body in self.bodies]))
        return ", ".join(parts)


def _short(values: list) -> str:
    shown = ", ".join(map(str, values[:4]))
    return f"[{shown}]" if len(values) <= 4 else f"[{shown}, .. {len(values) - 4} more]"


def together(parts: List[Kept]) -> Kept:
    """All of several, each bond once."""
    pairs = np.concatenate([part.pairs for part in parts])
    lengths = np.concatenate([part.lengths for part in parts])
    bodies = [body for part in parts for body in part.bodies]
    places = [place for part in parts for place in part.places]
    twice = pairs[:, 0] == pairs[:, 1]
    if twice.any():
        raise ArgumentError(f"bond {np.flatnonzero(twice)[0]} joins atom {pairs[twice][0, 0]} to itself")
    impossible = ~(lengths > 0) | ~np.isfinite(lengths)
    if impossible.any():
        k = np.flatnonzero(impossible)[0]
        raise ArgumentError(f"the bond of atoms {pairs[k, 0]} and {pairs[k, 1]} has the length {lengths[k]:g}; it must be positive")
    _, first, which = np.unique(np.sort(pairs, axis=1), axis=0, return_index=True, return_inverse=True)
    of_first = lengths[first][which.ravel()]
    other = np.abs(lengths - of_first) > 1e-9 * of_first
    if other.any():
        k = np.flatnonzero(other)[0]
        raise ArgumentError(f"the bond of atoms {pairs[k, 0]} and {pairs[k, 1]} is given twice, with the lengths {of_first[k]:.9g} "
                            f"and {lengths[k]:.9g}")
    keep = np.zeros(len(pairs), dtype=bool)
    keep[first] = True
    for body in bodies:
        keep &= ~np.isin(pairs, body).all(axis=1)
    return Kept(pairs[keep], lengths[keep], bodies, places)
