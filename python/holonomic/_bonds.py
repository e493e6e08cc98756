"""Which atoms are joined by rigid bonds: what is added, and what is there."""

from __future__ import annotations

import weakref
from ctypes import byref, c_double, c_int, c_int64, c_void_p
from typing import Any, NamedTuple, Optional, Tuple

import numpy as np

from ._arrays import KnownViews, PackedArrays, address, integers, numbers
from ._library import library
from .errors import ArgumentError, ask

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


class Bonds:
    """The part of Molecules that knows what is bonded."""

    def __init__(self, masses: Any):
        masses = numbers(masses, None, "masses", "atom")
        handle = c_void_p()
        ask(library.hol_chains_create(len(masses), address(masses), byref(handle)))
        self._handle = handle
        self._n_atoms = len(masses)
        self._destroy = weakref.finalize(self, library.hol_chains_destroy, handle)
        self._packed, self._views = PackedArrays((self._n_atoms, 3)), KnownViews(self._n_atoms)
        self._grown()

    def _grown(self) -> None:
        """After bonds were added: memory for the outputs of `forces` in one piece, [lambda, tensions, virial, forces]."""
        self._n_bonds = n = library.hol_chains_n_bonds(self._handle)
        self._outputs = c_double * (2 * n + 9 + 3 * self._n_atoms)

    # ------------------------------------------------------------------------------------------------------- adding
    def add(self, bonds: Any, lengths: Any) -> None:
        """Adds rigid bonds of any molecules, in any order.

        bonds    (n, 2) integers, the two atoms of each bond, counted from 0
        lengths  (n,) lengths, or one number for all

        The library finds the molecules that they form. All bonds of a molecule are given in one call; an atom of mass 0 may
        occur in any number of calls. Arrays per bond have the bonds in the order in which they were given.
        """
        bonds = self._pairs(bonds)
        lengths = numbers(lengths, len(bonds), "lengths", "bond")
        ask(library.hol_chains_add_bonds(self._handle, len(bonds), address(bonds), address(lengths)))
        self._grown()

    def add_molecules(self, n_molecules: int, n_atoms: int, bonds: Any, lengths: Any, first_atom: int = 0) -> None:
        """Adds the same bonds for n_molecules molecules of n_atoms consecutive atoms each.

        bonds       (n, 2) integers, numbers within the molecule, counted from 0
        lengths     (n,) lengths, or one number for all
        first_atom  the first atom of the first molecule

        Atoms without a bond (virtual sites) are allowed. 1000 rigid waters:
        ``add_molecules(1000, 3, [(0, 1), (0, 2), (1, 2)], [oh, oh, hh])``.
        """
        bonds = self._pairs(bonds)
        lengths = numbers(lengths, len(bonds), "lengths", "bond")
        ask(library.hol_chains_add_molecules(self._handle, n_molecules, n_atoms, first_atom, len(bonds), address(bonds),
                                             address(lengths)))
        self._grown()

    def add_chain(self, atoms: Any, lengths: Any) -> None:
        """Adds one linear chain by its atoms in order along it: (n+1,) integers; lengths (n,), or one number."""
        atoms = integers(atoms, "atoms")
        if atoms.ndim != 1 or len(atoms) < 2:
            raise ArgumentError(f"atoms has the shape {atoms.shape}; it must be (n,), the atoms along a chain, at least two")
        lengths = numbers(lengths, len(atoms) - 1, "lengths", "bond")
        ask(library.hol_chains_add(self._handle, len(lengths), address(atoms), address(lengths)))
        self._grown()

    def add_chains(self, n_chains: int, n_bonds: int, lengths: Any, first_atom: int = 0) -> None:
        """Adds n_chains linear chains of n_bonds bonds over consecutive atoms; lengths (n_bonds,), or one number."""
        if n_bonds < 1:
            raise ArgumentError(f"n_bonds = {n_bonds} must be at least 1")
        lengths = numbers(lengths, n_bonds, "lengths", "bond")
        ask(library.hol_chains_add_block(self._handle, n_chains, n_bonds, first_atom, address(lengths)))
        self._grown()

    def add_rigid(self, bodies: Any, places: Any, bonds: Any = (), lengths: Any = ()) -> None:
        """Adds rigid bodies, any number of atoms held as one whole each, and bonds at them.

        bodies   the atoms of each body, a list of lists; in a body an atom of mass 0 is a massless site
        places   reference coordinates of these atoms, an array (n, 3) for each body, in any frame: what it looks like
        bonds    (n, 2) integers, bonds of bodies with other atoms, and between other atoms of these molecules
        lengths  (n,) lengths, or one number for all

        docs/rigid.md. What holds a body together has no multipliers.
        """
        sizes, atoms, where = self._bodies(bodies, places)
        bonds, lengths = self._at_bodies(bonds, lengths)
        ask(library.hol_chains_add_rigid(self._handle, len(sizes), address(sizes), address(atoms), address(where), len(bonds),
                                         address(bonds), address(lengths)))
        self._grown()

    def add_rigid_molecules(self, n_molecules: int, n_atoms: int, bodies: Any, places: Any, bonds: Any = (),
                            lengths: Any = (), first_atom: int = 0) -> None:
        """Adds the same bodies and bonds for n_molecules molecules of n_atoms consecutive atoms each; numbers of atoms are
        those within the molecule. 1000 CO2: ``add_rigid_molecules(1000, 3, [[0, 1, 2]], [[(-d, 0, 0), (0, 0, 0), (d, 0, 0)]])``.
        """
        sizes, atoms, where = self._bodies(bodies, places)
        bonds, lengths = self._at_bodies(bonds, lengths)
        ask(library.hol_chains_add_rigid_molecules(self._handle, n_molecules, n_atoms, first_atom, len(sizes), address(sizes),
                                                   address(atoms), address(where), len(bonds), address(bonds),
                                                   address(lengths)))
        self._grown()

    @staticmethod
    def _bodies(bodies: Any, places: Any) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
        atoms = [integers(body, "bodies") for body in bodies]
        where = [np.asarray(place, dtype=np.float64) for place in places]
        if len(atoms) != len(where) or not atoms:
            raise ArgumentError(f"there are {len(atoms)} bodies and places of {len(where)}; it must be as many, at least one")
        for body, place in zip(atoms, where):
            if body.ndim != 1 or place.shape != (len(body), 3):
                raise ArgumentError(f"places of a body have the shape {place.shape}; its atoms have {body.shape}, and it must be "
                                    "(n, 3) and (n,)")
        sizes = np.array([len(body) for body in atoms], dtype=np.int64)
        return sizes, np.concatenate(atoms), np.ascontiguousarray(np.concatenate(where))

    def _at_bodies(self, bonds: Any, lengths: Any) -> Tuple[np.ndarray, np.ndarray]:
        bonds = np.zeros((0, 2), np.int64) if len(bonds) == 0 else self._pairs(bonds)
        return bonds, numbers(lengths, len(bonds), "lengths", "bond")

    @staticmethod
    def _pairs(bonds: Any) -> np.ndarray:
        bonds = integers(bonds, "bonds")
        if bonds.ndim != 2 or bonds.shape[1] != 2:
            raise ArgumentError(f"bonds has the shape {bonds.shape}; it must be (n, 2), the two atoms of each bond")
        return bonds

    def set_lengths(self, lengths: Any) -> None:
        """New lengths (n_bonds,) for all bonds, or one number."""
        lengths = numbers(lengths, self._n_bonds, "lengths", "bond")
        ask(library.hol_chains_set_lengths(self._handle, address(lengths)))

    def set_masses(self, masses: Any) -> None:
        """New masses (n_atoms,). What is held fixed (mass 0) stays so, and what can move."""
        masses = numbers(masses, self._n_atoms, "masses", "atom")
        ask(library.hol_chains_set_masses(self._handle, address(masses)))

    # ------------------------------------------------------------------------------------------------- what is there
    @property
    def n_atoms(self) -> int:
        """Number of atoms."""
        return self._n_atoms

    @property
    def n_bonds(self) -> int:
        """Number of bonds."""
        return self._n_bonds

    @property
    def n_molecules(self) -> int:
        """Number of molecules that the bonds form."""
        return library.hol_chains_n_chains(self._handle)

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

    def degrees_of_freedom(self, dimensions: int = 3) -> int:
        """Those of all atoms that can move, less one for each bond. A conserved total momentum is not subtracted."""
        count = library.hol_chains_degrees_of_freedom(self._handle, dimensions)
        if count < 0:
            raise ArgumentError(f"dimensions is {dimensions}; it must be 2 or 3")
        return count

    def set_labels(self, atoms: Optional[Any] = None, molecules: Optional[Any] = None) -> None:
        """Numbers by which you know atoms (n_atoms,) and molecules (n_molecules,): error messages show them."""
        lists = []
        for labels, count, name in ((atoms, self._n_atoms, "atoms"), (molecules, self.n_molecules, "molecules")):
            labels = None if labels is None else integers(labels, name)
            if labels is not None and labels.shape != (count,):
                raise ArgumentError(f"{name} has the shape {labels.shape}; it must be ({count},)")
            lists.append(labels)
        ask(library.hol_chains_set_labels(self._handle, *(address(labels) for labels in lists)))
