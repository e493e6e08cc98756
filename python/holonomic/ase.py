"""Rigid bonds in ASE: a constraint for molecular dynamics and for minimisation.

    from holonomic.ase import Constraint
    atoms.set_constraint(Constraint(bonds))                      # any bonds; lengths from the positions
    atoms.set_constraint(Constraint(bonds, angles=[(1, 0, 2)]))  # rigid water: the angle at atom 0, too

In place of ase.constraints.FixBondLengths. Positions, momenta and forces are right to their rounding after each call, without
iterations over the bonds.
"""

from __future__ import annotations

from typing import Any, Optional

import numpy as np
from ase.constraints import FixAtoms, FixConstraint

from .errors import ArgumentError
from .molecules import Molecules


class Constraint(FixConstraint):
    """Keeps the lengths of bonds.

    Constraint(bonds, lengths=None, angles=())

    bonds    (n, 2) integers, the two atoms of each bond, in any order
    lengths  (n,), or None: as they are in the atoms at the first use
    angles   (m, 3) integers, atoms i, j, k: the distance of i and k is kept, too; where the bonds ij and jk are, this is the
             angle at j. Lengths, if given, have theirs after those of the bonds: (n + m,)

    Cells and what is periodic are those of the atoms at each call. Atoms of a FixAtoms beside it are held, whichever of the
    two comes first in the list. Momenta are projected with the masses of the atoms; forces, which matter in a minimisation
    alone, as if all masses were equal, so that what is left of them is the gradient along the constraints.
    """

    def __init__(self, bonds: Any, lengths: Optional[Any] = None, angles: Any = ()):
        bonds, angles = np.array(bonds, dtype=np.int64), np.array(angles, dtype=np.int64)
        if bonds.size == 0:
            bonds = bonds.reshape(0, 2)
        if angles.size:
            if angles.ndim != 2 or angles.shape[1] != 3:
                raise ArgumentError(f"angles has the shape {angles.shape}; it must be (m, 3)")
            bonds = np.concatenate([bonds, angles[:, [0, 2]]])
        if bonds.ndim != 2 or bonds.shape[1] != 2 or len(bonds) == 0:
            raise ArgumentError(f"bonds has the shape {bonds.shape}; it must be (n, 2), n at least 1")
        self.pairs = bonds
        self.lengths = None if lengths is None else np.array(np.broadcast_to(lengths, (len(bonds),)), dtype=float)
        self.constraint_forces: Optional[np.ndarray] = None
        self._molecules: Optional[Molecules] = None  # with the masses
        self._equal: Optional[Molecules] = None  # with equal masses
        self._masses = self._held = self._cell = None

    # ------------------------------------------------------------------------------------------------- what ASE calls
    def adjust_positions(self, atoms: Any, new: np.ndarray) -> None:
        """Moves new positions onto the constraints, from those of the atoms."""
        self._prepare(atoms)
        new[self._held] = atoms.positions[self._held]
        self._molecules.project_positions(atoms.positions, new, 1.0)

    def adjust_momenta(self, atoms: Any, momenta: np.ndarray) -> None:
        """Takes out of the momenta what would change a length."""
        self._prepare(atoms)
        self._molecules.forces(atoms.positions, None, momenta, out=momenta, add=True)
        momenta[self._held] = 0

    def adjust_forces(self, atoms: Any, forces: np.ndarray) -> None:
        """Takes out of the forces what would change a length; `constraint_forces` has it afterwards."""
        self._prepare(atoms)
        self.constraint_forces = self._equal.forces(atoms.positions, None, forces).forces
        self.constraint_forces[self._held] = 0
        forces += self.constraint_forces

    def get_removed_dof(self, atoms: Any) -> int:
        """Degrees of freedom that the constraints take: one a bond, but none between two held atoms; of a rigid body all
        but its own. Temperatures that ASE gives count them."""
        self._prepare(atoms)
        return 3 * int((self._masses > 0).sum()) - self._molecules.degrees_of_freedom()

    def get_indices(self) -> np.ndarray:
        """The atoms that have bonds."""
        return np.unique(self.pairs)

    def todict(self) -> dict:
        """As ASE's own FixBondLengths of the same bonds and lengths, so that files can be read without this package."""
        return {"name": "FixBondLengths",
                "kwargs": {"pairs": self.pairs.tolist(),
                           "bondlengths": None if self.lengths is None else self.lengths.tolist()}}

    def copy(self) -> "Constraint":
        return Constraint(self.pairs, self.lengths)

    def index_shuffle(self, atoms: Any, ind: Any) -> None:
        """Keeps the bonds both of whose atoms are in a selection."""
        new = np.full(len(atoms), -1)
        kept = np.arange(len(atoms))[ind]
        new[kept] = np.arange(len(kept))
        pairs = new[self.pairs]
        both = (pairs != -1).all(axis=1)
        if not both.any():
            raise IndexError("Constraint not part of slice")
        self.__init__(pairs[both], None if self.lengths is None else self.lengths[both])

    def repeat(self, m: Any, n: int) -> "Constraint":
        """For m copies of n atoms."""
        copies = int(np.prod(np.broadcast_to(m, 3)))
        pairs = np.concatenate([self.pairs + k * n for k in range(copies)])
        return Constraint(pairs, None if self.lengths is None else np.tile(self.lengths, copies))

    # ------------------------------------------------------------------------------------------------------- more
    def impose(self, atoms: Any) -> None:
        """Moves the atoms onto the constraints from positions that may be crude, and their momenta."""
        self._prepare(atoms)
        self._molecules.impose(atoms.positions)
        if atoms.has("momenta"):
            atoms.set_momenta(atoms.get_momenta())

    def molecules(self, atoms: Any) -> Molecules:
        """The molecules as the library sees them, with masses and cell of the atoms: for tensions, virials, violations."""
        self._prepare(atoms)
        return self._molecules

    def _prepare(self, atoms: Any) -> None:
        """The molecules with masses, held atoms and cell as they are now."""
        held = np.zeros(len(atoms), dtype=bool)
        for constraint in atoms.constraints:
            if isinstance(constraint, FixAtoms):
                held[constraint.index] = True
        held = np.flatnonzero(held)
        masses = atoms.get_masses()
        masses[held] = 0
        if self.lengths is None:
            self.lengths = np.array([atoms.get_distance(i, j, mic=True) for i, j in self.pairs])
        if self._molecules is None or not np.array_equal(held, self._held) or len(masses) != len(self._masses):
            self._molecules, self._equal = Molecules(masses), Molecules((masses > 0).astype(float))
            self._held, self._masses, self._cell = held, masses, None
            for molecules in (self._molecules, self._equal):
                molecules.add(self.pairs, self.lengths)
        elif not np.array_equal(masses, self._masses):
            self._molecules.set_masses(masses)
            self._masses = masses
        cell = np.where(np.reshape(atoms.pbc, (3, 1)), atoms.cell.array, 0.0)
        if self._cell is None or not np.array_equal(cell, self._cell):
            for molecules in (self._molecules, self._equal):
                molecules.box = cell if cell.any() else None
            self._cell = cell

    def __getstate__(self) -> dict:
        return {"pairs": self.pairs, "lengths": self.lengths}

    def __setstate__(self, state: dict) -> None:
        self.__init__(state["pairs"], state["lengths"])
