"""The molecules of constraints of ASE, with the masses, held atoms and cell that the atoms have at the moment."""

from __future__ import annotations

import itertools
import warnings
from typing import Any, List, Optional

import numpy as np
from ase.geometry import find_mic  # type: ignore
from scipy.sparse import coo_matrix  # type: ignore
from scipy.sparse.csgraph import breadth_first_order, connected_components  # type: ignore

from ._ase_bonds import Kept
from .errors import ArgumentError, LengthsError, LengthsWarning
from .molecules import Molecules


class MoleculesOfAtoms:
    """`moving` has the masses of the atoms, `equal` equal ones; None if nothing that is bonded can move."""

    def __init__(self, kept: Kept, masses: np.ndarray, held: np.ndarray):
        self.kept, self.masses, self.held = kept, masses, held
        self._cell: Optional[np.ndarray] = None
        self._narrow, self._half = False, np.inf
        self._order: Optional[tuple] = None
        self.longest = max([0.0, *kept.lengths, *(_extent(place) for place in kept.places)])
        is_held = np.zeros(len(masses), dtype=bool)
        is_held[held] = True
        self.is_empty = bool(is_held[kept.atoms()].all())
        self.moving: Optional[Molecules] = None
        self.equal: Optional[Molecules] = None
        if not self.is_empty:
            self.moving = self._made(masses, is_held)
            self.equal = self._made(np.ones(len(masses)), is_held)

    def _made(self, masses: np.ndarray, is_held: np.ndarray) -> Molecules:
        molecules = Molecules(masses, fixed=is_held)
        kept, n = self.kept, len(masses)
        free = [k for k, body in enumerate(kept.bodies) if not is_held[body].all()]
        for k in free:
            if is_held[kept.bodies[k]].any():
                atom = kept.bodies[k][is_held[kept.bodies[k]]][0]
                raise ArgumentError(f"atom {atom} is held by FixAtoms, and is one of a rigid body that is not held as a whole")
        joined = [kept.pairs] + [np.stack([body[:-1], body[1:]], axis=1) for body in kept.bodies]
        i, j = np.concatenate(joined).T
        movable = ~(is_held[i] | is_held[j])  # molecules end at held atoms
        _, part = connected_components(coo_matrix((np.ones(movable.sum()), (i[movable], j[movable])), shape=(n, n)), directed=False)
        of_bodies = np.zeros(n, dtype=bool)
        for k in free:
            of_bodies[part[kept.bodies[k]]] = True
        at_bodies = (of_bodies[part[kept.pairs]] & ~is_held[kept.pairs]).any(axis=1)
        molecules.add(kept.pairs[~at_bodies], kept.lengths[~at_bodies])
        if free:
            molecules.add_rigid([kept.bodies[k] for k in free], [kept.places[k] for k in free], kept.pairs[at_bodies],
                                kept.lengths[at_bodies])
        molecules.checks = "never"  # what is off is moved, as ASE's own constraint does
        return molecules

    def set_masses(self, masses: np.ndarray) -> None:
        if self.moving is not None and not np.array_equal(masses, self.masses):
            self.moving.set_masses(masses)
            self.masses = masses

    def set_cell(self, atoms: Any) -> None:
        cell = np.where(np.reshape(atoms.pbc, (3, 1)), atoms.cell.array, 0.0)
        if self.moving is None or self.equal is None or self._cell is not None and np.array_equal(cell, self._cell):
            return
        steepest = np.linalg.norm(np.linalg.pinv(cell), axis=0).max()  # one over the least distance of two faces
        self._narrow, self._half = bool(2.0001 * self.longest * steepest > 1), 0.5 / steepest if steepest > 0 else np.inf
        for molecules in (self.moving, self.equal):
            molecules.box = None if self._narrow or not cell.any() else cell
        self._cell = cell

    def whole(self, atoms: Any) -> np.ndarray:
        """The positions, or in a cell that is too narrow for some bond images of them with all molecules in one piece."""
        if not self._narrow:
            return atoms.positions
        if self._order is None:
            self._order = self._tree(len(atoms))
        r, (of, length, levels) = atoms.positions.copy(), self._order
        for level in levels:
            r[level] = r[of[level]] + self._images(atoms, atoms.positions[level] - atoms.positions[of[level]], length[level])
        pairs = self.kept.pairs
        if len(pairs):
            d = r[pairs[:, 1]] - r[pairs[:, 0]]
            bonded = np.linalg.norm(self._images(atoms, d, self.kept.lengths), axis=1)
            open_ = np.abs(np.linalg.norm(d, axis=1) - bonded) > 1e-6 * self.longest
            if open_.any():
                i, j = pairs[open_][0]
                raise ArgumentError(f"a bond is longer than half the cell, and the bond of atoms {i} and {j} closes a ring through "
                                    "its faces: which images are bonded can't be told")
        return r

    def _images(self, atoms: Any, d: np.ndarray, lengths: np.ndarray) -> np.ndarray:
        """Nearest images; of bonds longer than half the cell those that come nearest to their lengths."""
        d = find_mic(d, atoms.cell, atoms.pbc)[0]
        long = np.flatnonzero(lengths > self._half)
        if len(long):
            cells = np.array(list(itertools.product(*[(0, -1, 1) if periodic else (0,) for periodic in atoms.pbc])))
            every = d[long, None] + cells @ atoms.cell.array
            off = np.abs(np.linalg.norm(every, axis=2) - lengths[long, None])
            d[long] = every[np.arange(len(long)), off.argmin(axis=1)]
        return d

    def _tree(self, n: int) -> tuple:
        """Each atom hangs on another one that comes before it: on which, at what distance, and the levels."""
        joined = [self.kept.pairs] + [np.stack([np.full(len(body) - 1, body[0]), body[1:]], axis=1) for body in self.kept.bodies]
        i, j = np.concatenate(joined).T
        graph = coo_matrix((np.ones(len(i)), (i, j)), shape=(n, n)).tocsr()
        apart = [self.kept.lengths] + [np.linalg.norm(place[1:] - place[0], axis=1) for place in self.kept.places]
        between = {frozenset(pair): length for pair, length in zip(zip(i.tolist(), j.tolist()), np.concatenate(apart))}
        of, depth = np.full(n, -1), np.full(n, -1)
        for root in np.unique(i):
            if depth[root] >= 0:
                continue
            order, before = breadth_first_order(graph, root, directed=False)
            of[order], depth[root] = before[order], 0
            for atom in order[1:]:
                depth[atom] = depth[of[atom]] + 1
        length = np.array([between.get(frozenset((atom, of[atom])), 0.0) for atom in range(n)])
        return of, length, [np.flatnonzero(depth == level) for level in range(1, depth.max() + 1)]

    def look(self, atoms: Any, measured: bool) -> None:
        """At first use: warns of what is likely a mistake."""
        message = None
        if self.moving is None:
            return
        if measured:
            message = cut_bonds_differ(atoms, self.kept.as_pairs())
        else:
            try:
                self.moving.check(self.whole(atoms))
            except LengthsError as error:
                message = f"{error} (they are moved nevertheless; Constraint.impose(atoms) does it at once)"
        if message:
            warnings.warn(LengthsWarning(message), stacklevel=5)


def _extent(place: np.ndarray) -> float:
    return float(np.linalg.norm(place[:, None] - place[None], axis=2).max())


def cut_bonds_differ(atoms: Any, kept: Kept) -> Optional[str]:
    """Lengths that were taken from positions: those of bonds that a face of the cell cuts beside others of the same elements."""
    if not atoms.pbc.any() or len(kept.pairs) < 4:
        return None
    i, j = kept.pairs.T
    straight = np.linalg.norm(atoms.positions[j] - atoms.positions[i], axis=1)
    cut = straight > 1.001 * kept.lengths + 1e-9
    kinds = np.sort(atoms.numbers[kept.pairs], axis=1)
    for kind in np.unique(kinds[cut], axis=0):
        same = (kinds == kind).all(axis=1)
        inside, across = kept.lengths[same & ~cut], kept.lengths[same & cut]
        if len(inside) < 3:
            continue
        off = np.sqrt(np.mean((across - inside.mean()) ** 2))
        if off > 4 * inside.std() + 1e-3 * inside.mean():
            return (f"bonds that a face of the cell cuts are {across.min():.4g} to {across.max():.4g} long, others of the same elements "
                    f"{inside.min():.4g} to {inside.max():.4g}: this is hardly the cell of these positions")
    return None


def group_of(constraint: Any, constraints: List[Any]) -> List[Any]:
    """The constraint, and those that share atoms with it or with one of these, in their order."""
    if not any(other is constraint for other in constraints):
        return [constraint]
    indices = [set(other.get_indices().tolist()) for other in constraints]
    group = {next(k for k, other in enumerate(constraints) if other is constraint)}
    while True:
        shared = set().union(*(indices[k] for k in group))
        more = {k for k, own in enumerate(indices) if k not in group and own & shared}
        if not more:
            return [constraints[k] for k in sorted(group)]
        group |= more


# Constraints of ASE that move atoms after this one, each on its own; those that keep lengths can't hold together with it.
_MOVE_ATOMS = ("FixCartesian", "FixedPlane", "FixedLine", "FixScaled", "FixedMode")
_KEEP_LENGTHS = ("FixBondLengths", "FixLinearTriatomic", "FixInternals")


def look_at_others(own: np.ndarray, constraints: List[Any]) -> None:
    """Refuses, or warns of, constraints of other classes that do something to the same atoms."""
    for other in constraints:
        name = type(other).__name__
        if name not in _MOVE_ATOMS + _KEEP_LENGTHS or not hasattr(other, "get_indices"):
            continue
        shared = np.intersect1d(other.get_indices(), own)
        if len(shared) == 0:
            continue
        if name in _KEEP_LENGTHS:
            raise ArgumentError(f"{name} and Constraint share atom {shared[0]}, and each would break what the other keeps: put the "
                                "bonds of both into one Constraint")
        warnings.warn(f"{name} and Constraint share atom {shared[0]}: what {name} does to it is not known to the bonds, which are "
                      "off by it", stacklevel=5)
