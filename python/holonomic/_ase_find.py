"""Bonds of atoms of ASE, by their distances: which hydrogens are bonded to what, and what is a water."""

from __future__ import annotations

from typing import Any, Dict, List, Tuple

import numpy as np
from ase.data import covalent_radii  # type: ignore
from ase.neighborlist import neighbor_list  # type: ignore

from .errors import ArgumentError

_STRETCHED = 1.25  # times the sum of the radii: farther apart they are not bonded


def bonds_to_hydrogen(atoms: Any) -> List[Tuple[int, int]]:
    """The bond of each hydrogen with the nearest atom that it can be bonded to, (that, hydrogen)."""
    hydrogens = np.flatnonzero(atoms.numbers == 1)
    if len(hydrogens) == 0:
        raise ArgumentError("there is no hydrogen")
    radii = covalent_radii[atoms.numbers] * _STRETCHED
    i, j, d = neighbor_list("ijd", atoms, radii.tolist())
    nearest: Dict[int, tuple] = {}
    for a, b, distance in zip(i.tolist(), j.tolist(), d.tolist()):
        # Another hydrogen only where nothing else is near: H2.
        rank = (bool(atoms.numbers[b] == 1), distance)
        if atoms.numbers[a] == 1 and a != b and (a not in nearest or rank < nearest[a][1]):
            nearest[a] = (b, rank)
    alone = [int(h) for h in hydrogens if h not in nearest]
    if alone:
        raise ArgumentError(f"atom {alone[0]}, a hydrogen, has no atom near enough for a bond ({len(alone)} such): give the bonds")
    pairs = {(b, a) if atoms.numbers[b] != 1 else (min(a, b), max(a, b)) for a, (b, _) in nearest.items()}
    return sorted(pairs)


def waters(atoms: Any) -> np.ndarray:
    """(n, 3): oxygen and its two hydrogens of each water."""
    bonded: Dict[int, List[int]] = {}
    for heavy, hydrogen in bonds_to_hydrogen(atoms):
        bonded.setdefault(heavy, []).append(hydrogen)
    radii = covalent_radii[atoms.numbers] * _STRETCHED
    radii[atoms.numbers == 1] = 0  # neighbours of oxygens that are no hydrogens
    radii[atoms.numbers == 0] = 0  # nor sites
    in_more = set(neighbor_list("i", atoms, radii.tolist()).tolist())
    found = [(o, *h) for o, h in sorted(bonded.items()) if atoms.numbers[o] == 8 and len(h) == 2 and o not in in_more]
    if not found:
        raise ArgumentError("there is no water: no oxygen with two hydrogens and nothing else")
    return np.array(found)
