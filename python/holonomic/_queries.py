"""Questions about a set of molecules: what the library has found in the bonds."""

from __future__ import annotations

from ctypes import byref, c_double, c_int, c_int64
from typing import NamedTuple, Optional, Tuple

import numpy as np

from ._arrays import address, integer, integers
from ._bonds import Bonds
from ._library import library
from ._types import Integers
from .errors import ArgumentError, ask

ROLES = ("own", "body", "implied", "fixed")
SHAPES = ("chain", "tree", "ring", "triangle", "other", "rigid")


class Molecule(NamedTuple):
    """One molecule as the library sees it.

    shape  "chain", "tree", "ring", "triangle", "other", or "rigid": with rigid bodies
    atoms  its atoms, along a linear chain, ascending otherwise
    bonds  its bonds by their places in the arrays per bond, in the order in which errors count them
    """

    shape: str
    atoms: np.ndarray
    bonds: np.ndarray


class Queries(Bonds):
    """The part of Molecules that is asked."""

    __slots__ = ()

    @property
    def n_atoms(self) -> int:
        """Number of atoms."""
        return self._n_atoms

    @property
    def n_bonds(self) -> int:
        """Number of bonds."""
        return self._n_bonds

    @property
    def masses(self) -> np.ndarray:
        """Masses (n_atoms,), 0 of what is held fixed; a copy."""
        return self._masses.copy()

    @property
    def bonds(self) -> np.ndarray:
        """The two atoms of every bond (n_bonds, 2), in the order in which they were given; a copy."""
        return self._added.bonds()

    @property
    def lengths(self) -> np.ndarray:
        """The length of every bond (n_bonds,); a copy."""
        return self._added.lengths() if self._lengths is None else self._lengths.copy()

    @property
    def n_molecules(self) -> int:
        """Number of molecules that the bonds form."""
        return library.hol_chains_n_molecules(self._handle)

    @property
    def n_kinds(self) -> int:
        """Number of different kinds of molecules (shape, masses and lengths)."""
        return library.hol_chains_n_kinds(self._handle)

    @property
    def adjustment(self) -> Tuple[float, Optional[int]]:
        """By which part of it the length of a rigid group was adjusted that was adjusted most, and the number of its bond:
        no places in space have quite the lengths of a file's decimals. (0.0, None) if none was."""
        largest, bond = c_double(), c_int64()
        ask(library.hol_chains_adjustment(self._handle, byref(largest), byref(bond)))
        return largest.value, None if bond.value < 0 else bond.value

    def implied(self) -> np.ndarray:
        """Which distances others imply, (n_bonds,) of bool: they are in no equation, and their multipliers are 0."""
        implied = np.empty(self._n_bonds, np.uint8)
        ask(library.hol_chains_implied(self._handle, address(implied)))
        return implied.astype(bool)

    @property
    def memory(self) -> int:
        """Memory that the set of molecules occupies in the library, in bytes."""
        return library.hol_chains_memory(self._handle)

    def n_of_shape(self, shape: str) -> int:
        """Number of molecules of a shape: "chain", "tree", "ring", "triangle", "other" or "rigid"."""
        if shape not in SHAPES:
            raise ArgumentError(f"shape is {shape!r}; it must be one of {', '.join(SHAPES)}")
        return library.hol_chains_n_of_shape(self._handle, SHAPES.index(shape))

    def molecule(self, number: int) -> Molecule:
        """Shape, atoms and bonds of one molecule."""
        shape, n_atoms, n_bonds = c_int(), c_int64(), c_int64()
        number = integer(number, "number")
        ask(library.hol_chains_molecule(self._handle, number, byref(shape), byref(n_atoms), byref(n_bonds)))
        atoms, bonds = np.empty(n_atoms.value, np.int64), np.empty(n_bonds.value, np.int64)
        ask(library.hol_chains_atoms(self._handle, number, address(atoms)))
        ask(library.hol_chains_bonds(self._handle, number, address(bonds)))
        return Molecule(SHAPES[shape.value], atoms, bonds)

    def molecules_of_bonds(self) -> np.ndarray:
        """The molecule of every bond, (n_bonds,); -1 for a bond between two fixed atoms."""
        molecules = np.empty(self._n_bonds, np.int64)
        ask(library.hol_chains_molecules_of_bonds(self._handle, address(molecules)))
        return molecules

    def roles(self) -> Tuple[np.ndarray, np.ndarray]:
        """What became of every bond, (n_bonds,): "own": a constraint with a multiplier of its own; "body": held by a rigid
        body; "implied": a consequence of others; "fixed": between two fixed atoms. And how many freedoms each molecule's
        constraints remove, (n_molecules,)."""
        roles, removed = np.empty(self._n_bonds, np.intc), np.empty(self.n_molecules, np.int64)
        ask(library.hol_chains_roles(self._handle, address(roles), address(removed)))
        return np.array(ROLES)[roles], removed

    def degrees_of_freedom(self, dimensions: int = 3) -> int:
        """Those of all atoms that can move, less one for each bond. A conserved total momentum is not subtracted."""
        count = library.hol_chains_degrees_of_freedom(self._handle, integer(dimensions, "dimensions", 32))
        if count < 0:
            raise ArgumentError(f"dimensions is {dimensions}; it must be 2 or 3")
        return count

    @property
    def labels(self) -> Tuple[np.ndarray, np.ndarray]:
        """The labels of atoms (n_atoms,) and molecules (n_molecules,); of what has none its number."""
        atoms, molecules = np.zeros(self._n_atoms, np.int64), np.zeros(self.n_molecules, np.int64)
        ask(library.hol_chains_labels(self._handle, address(atoms), address(molecules)))
        return atoms, molecules

    def set_labels(self, atoms: Optional[Integers] = None, molecules: Optional[Integers] = None) -> None:
        """Numbers by which you know atoms (n_atoms,) and molecules (n_molecules,): error messages show them."""
        lists = []
        for labels, count, name in ((atoms, self._n_atoms, "atoms"), (molecules, self.n_molecules, "molecules")):
            labels = None if labels is None else integers(labels, name)
            if labels is not None and labels.shape != (count,):
                raise ArgumentError(f"{name} has the shape {labels.shape}; it must be ({count},)")
            lists.append(labels)
        ask(library.hol_chains_set_labels(self._handle, *(address(labels) for labels in lists)))
        self._labels = tuple(None if labels is None else np.array(labels) for labels in lists)
