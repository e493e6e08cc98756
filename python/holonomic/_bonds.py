"""Which atoms are joined by rigid bonds: what is added, and what is there."""

from __future__ import annotations

import copy
import warnings
import weakref
from ctypes import byref, c_double, c_void_p
from typing import Any, List, Optional, Tuple

import numpy as np

from ._added import Added
from ._arrays import KnownViews, PackedArrays, address, integer, integers, numbers
from ._library import library
from ._types import Bodies, Floats, Integers, Pairs, Places
from .errors import ArgumentError, MasslessWarning, NumberError, ask, ask_to_add


def _again(of: Any, masses: np.ndarray, fixed: Optional[np.ndarray], added: Added, lengths: Optional[np.ndarray],
           settings: dict, labels: Optional[tuple]) -> "Bonds":
    """A copy: a set of its own, made as the other was."""
    from .molecules import Molecules

    molecules = of.__new__(of)
    Molecules.__init__(molecules, masses, fixed)
    molecules.memory_limit = settings["memory_limit"]  # what is added has to fit
    molecules.length_tolerance = settings["length_tolerance"]  # and rigid groups are adjusted as they were
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MasslessWarning)
        added.repeat(molecules)
    if lengths is not None:
        molecules.set_lengths(lengths)
    for name, value in settings.items():
        setattr(molecules, name, value)
    if labels is not None:
        molecules.set_labels(*labels)
    return molecules


_HELD = ("atom {} has mass 0, and its bonds hold it in space, and its molecule with it. A massless site, as M of TIP4P, is an "
         "atom of a body: add_rigid")


class Bonds:
    """The part of Molecules that knows what is bonded."""

    __slots__ = ("_handle", "_destroy", "_n_atoms", "_n_bonds", "_packed", "_views", "_outputs", "_masses", "_fixed", "_added",
                 "_lengths", "_labels", "__weakref__")

    def __init__(self, masses: Floats, fixed: Optional[Integers] = None):
        masses = np.array(numbers(masses, None, "masses", "atom"))
        self._fixed: Optional[np.ndarray] = None
        if fixed is not None:
            self._fixed = _mask(fixed, len(masses))
            masses[self._fixed] = 0
        handle = c_void_p()
        of_library = self._to_hold(masses)
        ask(library.hol_chains_create(len(masses), address(of_library), byref(handle)))
        self._handle = handle
        self._n_atoms = len(masses)
        self._destroy = weakref.finalize(self, library.hol_chains_destroy, handle)
        self._packed, self._views = PackedArrays((self._n_atoms, 3)), KnownViews(self._n_atoms)
        self._masses, self._added = masses, Added()
        self._lengths: Optional[np.ndarray] = None  # if they were set after they were added
        self._labels: Optional[tuple] = None
        self._grown()

    def _settings(self) -> dict:
        return {}

    def __copy__(self) -> Bonds:
        """A set of its own, which shares what is known of the shapes of the molecules."""
        other = self.__class__.__new__(self.__class__)
        for part in type(self).__mro__:
            for name in part.__dict__.get("__slots__", ()):
                if name != "__weakref__" and hasattr(self, name):
                    setattr(other, name, getattr(self, name))  # arrays are replaced by setters, never written to
        handle = c_void_p()
        ask(library.hol_chains_copy(self._handle, byref(handle)))
        other._handle, other._destroy = handle, weakref.finalize(other, library.hol_chains_destroy, handle)
        other._packed, other._views = PackedArrays((self._n_atoms, 3)), KnownViews(self._n_atoms)
        other._added = self._added.copy()
        if hasattr(self, "__dict__"):
            other.__dict__.update(self.__dict__)
        return other

    def __deepcopy__(self, memo: dict) -> Bonds:
        other = self.__copy__()
        if hasattr(self, "__dict__"):
            other.__dict__.update(copy.deepcopy(self.__dict__, memo))
        return other

    def __reduce__(self) -> tuple:
        """For pickle: a set of its own of the same molecules and settings."""
        return (_again, (type(self), self._masses, self._fixed, self._added, self._lengths, self._settings(),
                         self._labels), getattr(self, "__dict__", None) or None)

    def _grown(self) -> None:
        """After bonds were added: memory for the outputs of `forces` in one piece, [lambda, tensions, virial, forces]."""
        self._n_bonds = n = library.hol_chains_n_bonds(self._handle)
        self._outputs = c_double * (2 * n + 9 + 3 * self._n_atoms)

    def _noted(self, method: str, *arguments: Any) -> None:
        """After a call that added something."""
        self._added.note(method, *arguments)
        if self._lengths is not None:
            self._lengths = np.concatenate([self._lengths, self._added.lengths()[len(self._lengths):]])
        self._grown()

    # ------------------------------------------------------------------------------------------------------- adding
    def add(self, bonds: Pairs, lengths: Floats, images: Optional[Integers] = None) -> None:
        """Adds rigid bonds of any molecules, in any order.

        bonds    (n, 2) integers, the two atoms of each bond, counted from 0
        lengths  (n,) lengths, or one number for all
        images   (n, 3) integers, by how many cell vectors the second atom of each bond is moved: its vector is
                 r[j] - r[i] + image @ box, and may be longer than half the box. None: nearest images

        The library finds the molecules that they form. All bonds of a molecule are given in one call; an atom of mass 0 may
        occur in any number of calls. Arrays per bond have the bonds in the order in which they were given.
        """
        bonds = self._pairs(bonds)
        lengths = numbers(lengths, len(bonds), "lengths", "bond")
        if len(bonds) == 0:
            return
        self._refuse_massless(bonds)
        if images is None:
            ask_to_add(library.hol_chains_add_bonds(self._handle, len(bonds), address(bonds), address(lengths)))
        else:
            images = self._images_of(images, len(bonds))
            ask_to_add(library.hol_chains_add_bonds_with_images(self._handle, len(bonds), address(bonds), address(lengths),
                                                                address(images)))
        self._noted("add", bonds, lengths, images)
        self._warn_of_massless(bonds)

    @staticmethod
    def _images_of(images: Integers, n_bonds: int) -> np.ndarray:
        images = integers(images, "images")
        if images.shape != (n_bonds, 3):
            raise ArgumentError(f"images has the shape {images.shape}; it must be ({n_bonds}, 3), for {n_bonds} bonds")
        return images

    @property
    def images(self) -> np.ndarray:
        """Images of the bonds (n_bonds, 3) as they were told, in cell vectors; 0 of bonds that were added without. Set them
        where atoms are moved by cell vectors between two calls."""
        found = np.zeros((self._n_bonds, 3), np.int64)
        ask(library.hol_chains_images(self._handle, address(found)))
        return found

    @images.setter
    def images(self, images: Integers) -> None:
        ask(library.hol_chains_set_images(self._handle, address(self._images_of(images, self._n_bonds))))

    def add_molecules(self, n_molecules: int, n_atoms: int, bonds: Pairs, lengths: Floats, first_atom: int = 0) -> None:
        """Adds the same bonds for n_molecules molecules of n_atoms consecutive atoms each.

        bonds       (n, 2) integers, numbers within the molecule, counted from 0
        lengths     (n,) lengths, or one number for all
        first_atom  the first atom of the first molecule

        Atoms without a bond (virtual sites) are allowed. 1000 rigid waters:
        ``add_molecules(1000, 3, [(0, 1), (0, 2), (1, 2)], [oh, oh, hh])``.
        """
        bonds = self._pairs(bonds)
        lengths = numbers(lengths, len(bonds), "lengths", "bond")
        n_molecules, n_atoms = integer(n_molecules, "n_molecules"), integer(n_atoms, "n_atoms")
        first_atom = integer(first_atom, "first_atom")
        if len(bonds) == 0:
            return
        self._refuse_massless(bonds + first_atom)
        ask_to_add(library.hol_chains_add_molecules(self._handle, n_molecules, n_atoms, first_atom, len(bonds), address(bonds),
                                                    address(lengths)))
        self._noted("add_molecules", n_molecules, n_atoms, bonds, lengths, first_atom)
        self._warn_of_massless(bonds + first_atom)

    def add_chain(self, atoms: Integers, lengths: Floats) -> None:
        """Adds one linear chain by its atoms in order along it: (n+1,) integers; lengths (n,), or one number."""
        atoms = integers(atoms, "atoms")
        if atoms.ndim != 1 or len(atoms) < 2:
            raise ArgumentError(f"atoms has the shape {atoms.shape}; it must be (n,), the atoms along a chain, at least two")
        lengths = numbers(lengths, len(atoms) - 1, "lengths", "bond")
        ask_to_add(library.hol_chains_add(self._handle, len(lengths), address(atoms), address(lengths)))
        self._noted("add_chain", atoms, lengths)

    def add_chains(self, n_chains: int, n_bonds: int, lengths: Floats, first_atom: int = 0) -> None:
        """Adds n_chains linear chains of n_bonds bonds over consecutive atoms; lengths (n_bonds,), or one number."""
        n_chains, n_bonds = integer(n_chains, "n_chains"), integer(n_bonds, "n_bonds")
        first_atom = integer(first_atom, "first_atom")
        if n_bonds < 1:
            raise ArgumentError(f"n_bonds is {n_bonds}; it must be at least 1")
        lengths = numbers(lengths, n_bonds, "lengths", "bond")
        ask_to_add(library.hol_chains_add_block(self._handle, n_chains, n_bonds, first_atom, address(lengths)))
        self._noted("add_chains", n_chains, n_bonds, lengths, first_atom)

    def add_rigid(self, bodies: Bodies, places: Places, bonds: Pairs = (), lengths: Floats = ()) -> None:
        """Adds rigid bodies, any number of atoms held as one whole each, and bonds at them.

        bodies   the atoms of each body, a list of lists; in a body an atom of mass 0 is a massless site, which may be out of
                 the plane of the others (TIP5P)
        places   reference coordinates of these atoms, an array (n, 3) for each body, in any frame: what it looks like
        bonds    (n, 2) integers, bonds of bodies with other atoms, and between other atoms of these molecules
        lengths  (n,) lengths, or one number for all

        docs/rigid.md. What holds a body together has no multipliers.
        """
        sizes, atoms, where = self._bodies(bodies, places)
        bonds, lengths = self._at_bodies(bonds, lengths)
        ask_to_add(library.hol_chains_add_rigid(self._handle, len(sizes), address(sizes), address(atoms), address(where),
                                                len(bonds), address(bonds), address(lengths)))
        self._noted("add_rigid", *_apart(sizes, atoms, where), bonds, lengths)
        self._warn_of_massless(bonds, True)

    def add_rigid_molecules(self, n_molecules: int, n_atoms: int, bodies: Bodies, places: Places,
                            bonds: Pairs = (), lengths: Floats = (), first_atom: int = 0) -> None:
        """Adds the same bodies and bonds for n_molecules molecules of n_atoms consecutive atoms each; numbers of atoms are
        those within the molecule. 1000 CO2: ``add_rigid_molecules(1000, 3, [[0, 1, 2]], [[(-d, 0, 0), (0, 0, 0), (d, 0, 0)]])``.
        """
        sizes, atoms, where = self._bodies(bodies, places)
        bonds, lengths = self._at_bodies(bonds, lengths)
        n_molecules, n_atoms = integer(n_molecules, "n_molecules"), integer(n_atoms, "n_atoms")
        first_atom = integer(first_atom, "first_atom")
        ask_to_add(library.hol_chains_add_rigid_molecules(
            self._handle, n_molecules, n_atoms, first_atom, len(sizes), address(sizes), address(atoms), address(where),
            len(bonds), address(bonds), address(lengths)))
        self._noted("add_rigid_molecules", n_molecules, n_atoms, *_apart(sizes, atoms, where), bonds, lengths, first_atom)
        self._warn_of_massless(bonds + first_atom, True)

    def add_linear(self, atoms: Bodies, coefficients: Any, bonds: Pairs = (), lengths: Floats = ()) -> None:
        """Adds linear relations among atoms, sum_i c_i r_i = 0, and bonds of the molecules in which these are.

        atoms         the atoms of each relation, a list of lists; an atom of mass 0 is a massless site, one of
                      infinite mass is where `r` has it
        coefficients  those of each relation, a list of lists; they add up to 0
        bonds         (n, 2) integers, bonds of these molecules
        lengths       (n,) lengths, or one number for all

        A site in the middle of two atoms: ``add_linear([[0, 1, 2]], [[0.5, 0.5, -1]])``; two atoms that are one point:
        ``add_linear([[0, 1]], [[1, -1]])``. docs/rigid.md.
        """
        groups, numbers_of, sizes, all_atoms, c = self._relations(atoms, coefficients)
        bonds, lengths = self._at_bodies(bonds, lengths)
        ask_to_add(library.hol_chains_add_linear(self._handle, len(sizes), address(sizes), address(all_atoms), address(c),
                                                 len(bonds), address(bonds), address(lengths)))
        self._noted("add_linear", groups, numbers_of, bonds, lengths)

    def add_linear_molecules(self, n_molecules: int, n_atoms: int, atoms: Bodies, coefficients: Any, bonds: Pairs = (),
                             lengths: Floats = (), first_atom: int = 0) -> None:
        """Adds the same relations and bonds for n_molecules molecules of n_atoms consecutive atoms each; numbers of atoms are
        those within the molecule.
        """
        groups, numbers_of, sizes, all_atoms, c = self._relations(atoms, coefficients)
        bonds, lengths = self._at_bodies(bonds, lengths)
        n_molecules, n_atoms = integer(n_molecules, "n_molecules"), integer(n_atoms, "n_atoms")
        first_atom = integer(first_atom, "first_atom")
        ask_to_add(library.hol_chains_add_linear_molecules(
            self._handle, n_molecules, n_atoms, first_atom, len(sizes), address(sizes), address(all_atoms), address(c),
            len(bonds), address(bonds), address(lengths)))
        self._noted("add_linear_molecules", n_molecules, n_atoms, groups, numbers_of, bonds, lengths, first_atom)

    @staticmethod
    def _relations(atoms: Any, coefficients: Any) -> Tuple[list, list, np.ndarray, np.ndarray, np.ndarray]:
        groups = [integers(group, "atoms") for group in atoms]
        numbers_of = [numbers(c, len(group), "coefficients", "atom") for c, group in zip(coefficients, groups)]
        if not groups or len(groups) != len(coefficients):
            raise ArgumentError(f"there are atoms of {len(groups)} relations and coefficients of {len(coefficients)}")
        sizes = np.array([len(group) for group in groups], np.int64)
        return groups, numbers_of, sizes, np.concatenate(groups), np.concatenate(numbers_of)

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

    def _refuse_massless(self, bonds: np.ndarray) -> None:
        """Where it is said what is fixed, other atoms of mass 0 are sites: they have no bonds."""
        if self._fixed is None:
            return
        inside = bonds[((bonds >= 0) & (bonds < self._n_atoms)).all(axis=1)]  # the library refuses the others
        sites = inside[(self._masses[inside] == 0) & ~self._fixed[inside]]
        if len(sites):
            raise ArgumentError(_HELD.format(sites[0]) + "; or name it in `fixed`")

    def _warn_of_massless(self, bonds: np.ndarray, at_bodies: bool = False) -> None:
        """Of bonds that have been added, and hold a molecule in space where that is hardly meant. What is rigid is a body, or has
        three bonds at such an atom: tethered chains, added one by one, are not looked for in the whole set each time."""
        massless = self._masses[bonds] == 0
        if self._fixed is not None or not massless.any():
            return
        atoms, n_bonds = np.unique(bonds, return_counts=True)
        if not at_bodies and not np.isin(bonds[massless[:, ::-1]], atoms[n_bonds >= 3]).any():
            return
        bonded = bonds[massless]
        sites = bonded[self.held_sites()[bonded]]
        if len(sites):
            what = _HELD.format(sites.min())
            warnings.warn(MasslessWarning(f"{what}. If it is to be held, say so: Molecules(masses, fixed=[{sites.min()}])"),
                          stacklevel=3)

    def held_sites(self) -> np.ndarray:
        """Which atoms of mass 0 are bonded to something rigid, (n_atoms,) of bool: they hold it in space. A massless site, as M
        of TIP4P, is an atom of a body (`add_rigid`)."""
        held = np.empty(self._n_atoms, np.uint8)
        ask(library.hol_chains_held_sites(self._handle, address(held)))
        return held.astype(bool)

    def _at_bodies(self, bonds: Any, lengths: Any) -> Tuple[np.ndarray, np.ndarray]:
        bonds = self._pairs(bonds)
        return bonds, numbers(lengths, len(bonds), "lengths", "bond")

    @staticmethod
    def _pairs(bonds: Any) -> np.ndarray:
        bonds = integers(bonds, "bonds")
        if bonds.size == 0:
            bonds = bonds.reshape(0, 2)
        if bonds.ndim != 2 or bonds.shape[1] != 2:
            raise ArgumentError(f"bonds has the shape {bonds.shape}; it must be (n, 2), the two atoms of each bond")
        return bonds

    def set_lengths(self, lengths: Floats) -> None:
        """New lengths (n_bonds,) for all bonds, or one number."""
        lengths = numbers(lengths, self._n_bonds, "lengths", "bond")
        ask(library.hol_chains_set_lengths(self._handle, address(lengths)))
        self._lengths = np.array(lengths)

    def set_masses(self, masses: Floats) -> None:
        """New masses (n_atoms,). What is held fixed (mass 0) stays so, and what can move."""
        masses = np.array(numbers(masses, self._n_atoms, "masses", "atom"))
        if self._fixed is not None:
            masses[self._fixed] = 0
        of_library = self._to_hold(masses)
        ask(library.hol_chains_set_masses(self._handle, address(of_library)))
        self._masses = masses

    def _to_hold(self, masses: np.ndarray) -> np.ndarray:
        """What is fixed has an infinite mass for the library: it is held on purpose, and is no massless site."""
        return masses if self._fixed is None else np.where(self._fixed, np.inf, masses)


def _mask(fixed: Any, n_atoms: int) -> np.ndarray:
    """One bool an atom, from that or from numbers of atoms."""
    given = np.asarray(fixed)
    if given.dtype == bool:
        if given.shape != (n_atoms,):
            raise ArgumentError(f"fixed has the shape {given.shape}; it must be ({n_atoms},), or numbers of atoms")
        return given.copy()
    mask = np.zeros(n_atoms, dtype=bool)
    atoms = integers(given, "fixed")
    if atoms.size and not (atoms.min() >= 0 and atoms.max() < n_atoms):
        raise NumberError(f"fixed has atom {atoms[(atoms < 0) | (atoms >= n_atoms)].ravel()[0]}, outside 0 .. {n_atoms - 1}")
    mask[atoms] = True
    return mask


def _apart(sizes: np.ndarray, atoms: np.ndarray, where: np.ndarray) -> Tuple[List[np.ndarray], List[np.ndarray]]:
    """Bodies and places again, one array a body."""
    ends = np.cumsum(sizes)[:-1]
    return np.split(atoms, ends), np.split(where, ends)
