"""Atoms of mass 0 are held in space. Who bonds one to a rigid molecule has most often meant a massless site of it."""

from __future__ import annotations

from typing import Dict, List, Set

import numpy as np


def held_rigid_atoms(bonds: np.ndarray, masses: np.ndarray) -> List[int]:
    """The atoms of mass 0 that are bonded to an atom of a triangle of bonds."""
    massless = masses[bonds] == 0
    of_massless = massless.any(axis=1) & ~massless.all(axis=1)
    if not of_massless.any():
        return []
    near = np.unique(bonds[of_massless])
    once = np.unique(bonds[np.isin(bonds, near).any(axis=1)])
    neighbours: Dict[int, Set[int]] = {}
    for i, j in bonds[np.isin(bonds, once).all(axis=1)].tolist():
        neighbours.setdefault(i, set()).add(j)
        neighbours.setdefault(j, set()).add(i)
    in_triangle = {i for i in near.tolist() if any(neighbours[i] & neighbours[j] for j in neighbours[i])}
    held = {i if masses[i] == 0 else j for i, j in bonds[of_massless].tolist()
            if (j if masses[i] == 0 else i) in in_triangle}
    return sorted(held)
