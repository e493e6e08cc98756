"""Rigid bonds and bodies in ASE: a constraint for molecular dynamics and for minimisation.

    from holonomic.ase import Constraint
    atoms.set_constraint(Constraint(bonds))                      # any bonds; lengths from the positions
    atoms.set_constraint(Constraint(bonds, angles=[(1, 0, 2)]))  # rigid water: the angle at atom 0, too
    atoms.set_constraint(Constraint.waters(atoms))               # all of them; Constraint.hydrogens(atoms), .rigid(..)
    from holonomic.ase import FixBondLengths, FixBondLength      # in place of those of ase.constraints, with their arguments

Positions, momenta and forces are right to their rounding after each call, without iterations over the bonds.
"""

from __future__ import annotations

from typing import Any, Optional, Tuple

import numpy as np
from ase.constraints import FixAtoms, FixConstraint  # type: ignore

from . import _ase_find as find
from ._ase_bonds import Kept, together
from ._ase_set import MoleculesOfAtoms, group_of, look_at_others
from ._types import Bodies, Floats, Pairs
from .errors import ArgumentError, LengthsError, NoConvergenceError
from .molecules import Molecules


class Constraint(FixConstraint):  # type: ignore
    """Keeps the lengths of bonds, and the shapes of rigid bodies.

    Constraint(bonds=(), lengths=None, angles=(), bodies=())

    bonds    (n, 2) integers, the two atoms of each bond, in any order; numbers below 0 count from the end
    lengths  (n,), or one number, or None: as they are in the atoms at the first use
    angles   (m, 3) integers, atoms i, j, k: the distance of i and k is kept, too; where the bonds ij and jk are, this is the
             angle at j. Lengths, if given, have theirs after those of the bonds: (n + m,). At 180 degrees (to half of one)
             the three are a body
    bodies   lists of atoms; each list is held as one rigid body, as it is in the atoms at the first use

    Cells and what is periodic are those of the atoms at each call. Atoms of a FixAtoms beside it are held, whichever of the
    two comes first in the list. Constraints that share an atom act as one. Momenta are projected with the masses of the atoms;
    forces, which matter in a minimisation alone, as if all masses were equal, so that what is left of them is the gradient
    along the constraints. `atoms.get_stress()` has the part of the constraints in it.

    Arguments by the names of FixBondLengths (pairs, bondlengths; tolerance and iterations are not needed) do as well.
    """

    def __init__(self, bonds: Pairs = (), lengths: Optional[Floats] = None, angles: Pairs = (), bodies: Bodies = (), *,
                 pairs: Optional[Pairs] = None, bondlengths: Optional[Floats] = None, tolerance: Optional[float] = None,
                 iterations: Optional[int] = None):
        joined = _columns(bonds if pairs is None else pairs, 2, "bonds")
        self._angles = _columns(angles, 3, "angles")
        joined = np.concatenate([joined, self._angles[:, [0, 2]]])
        own_bodies = [_atoms_of(body) for body in bodies]
        if len(joined) == 0 and not own_bodies:
            raise ArgumentError("there is nothing to keep: no bonds and no bodies")
        lengths = bondlengths if lengths is None else lengths
        if lengths is not None:
            lengths = np.asarray(lengths, dtype=float)
            if lengths.shape not in ((), (len(joined),)):
                raise ArgumentError(f"lengths has the shape {lengths.shape}; it must be ({len(joined)},), one for each bond and "
                                    "angle")
            lengths = np.array(np.broadcast_to(lengths, (len(joined),)))
        self._set_kept(Kept(joined, lengths, own_bodies, None))

    @classmethod
    def hydrogens(cls, atoms: Any, waters: bool = False) -> "Constraint":
        """The bonds of all hydrogens, each with the atom next to it; with `waters`, waters are rigid, too."""
        bonds = find.bonds_to_hydrogen(atoms)
        if waters:
            bonds = bonds + find.waters(atoms)[:, 1:].tolist()
        return cls(bonds)

    @classmethod
    def waters(cls, atoms: Any, lengths: Optional[Tuple[float, float]] = None) -> "Constraint":
        """All waters, rigid, in the shapes that they have; or with these lengths (OH, HH)."""
        oxygen, first, second = find.waters(atoms).T
        n = len(oxygen)
        bonds = np.concatenate([np.stack(pair, axis=1) for pair in ((oxygen, first), (oxygen, second), (first, second))])
        return cls(bonds, None if lengths is None else np.repeat([lengths[0], lengths[0], lengths[1]], n))

    @classmethod
    def rigid(cls, *bodies: Any) -> "Constraint":
        """Rigid bodies: `rigid([0, 1, 2], [3, 4, 5, 6])`, or one list of them."""
        if len(bodies) == 1 and len(bodies[0]) and np.ndim(bodies[0][0]):
            bodies = tuple(bodies[0])
        return cls(bodies=bodies)

    def _set_kept(self, kept: Kept) -> None:
        self._kept = kept
        self.constraint_forces: Optional[np.ndarray] = None
        self._set: Optional[MoleculesOfAtoms] = None
        self._of_set: tuple = ()  # the constraints that are in it, and
        self._parts: tuple = ()  # what each kept then

    @property
    def pairs(self) -> np.ndarray:
        """The two atoms of every bond and angle."""
        return self._kept.pairs

    @property
    def lengths(self) -> Optional[np.ndarray]:
        """Their lengths, or None until they are known."""
        return self._kept.lengths

    bondlengths = lengths

    # ------------------------------------------------------------------------------------------------- what ASE calls
    def adjust_positions(self, atoms: Any, new: np.ndarray) -> None:
        """Moves new positions onto the constraints, from those of the atoms."""
        found = self._prepare(atoms)
        new[found.held] = atoms.positions[found.held]
        if found.moving is None:
            return
        reference = found.whole(atoms)
        shift = None if reference is atoms.positions else reference - atoms.positions
        if shift is not None:
            new += shift
        try:
            found.moving.project_positions(reference, new, 1.0)
        except (LengthsError, NoConvergenceError) as error:
            if error.n_bad and not np.allclose(new, reference, rtol=0, atol=0.5 * found.longest):
                error.args = (f"{error}. Atoms were moved by up to {np.abs(new - reference).max():.3g} A in this step: forces or "
                              "time step are too large",)
            raise
        finally:
            if shift is not None:
                new -= shift

    def adjust_momenta(self, atoms: Any, momenta: np.ndarray) -> None:
        """Takes out of the momenta what would change a length."""
        found = self._prepare(atoms)
        if found.moving is not None:
            found.moving.forces(found.whole(atoms), None, momenta, out=momenta, add=True)
        momenta[found.held] = 0

    def adjust_forces(self, atoms: Any, forces: np.ndarray) -> None:
        """Takes out of the forces what would change a length; `constraint_forces` has it afterwards."""
        found = self._prepare(atoms)
        self.constraint_forces = np.zeros_like(forces)
        if found.equal is not None:
            found.equal.forces(found.whole(atoms), None, forces, out=self.constraint_forces)
        self.constraint_forces[found.held] = 0
        forces += self.constraint_forces

    def adjust_stress(self, atoms: Any, stress: np.ndarray) -> None:
        """Adds the part of the constraint forces: minus their virial over the volume. With momenta, of the forces that turn
        molecules, too."""
        found = self._prepare(atoms)
        if found.moving is None or self._of_set[0] is not self:
            return
        velocities = atoms.get_velocities() if atoms.has("momenta") else None
        forces = atoms.get_forces(apply_constraint=False)
        virial = found.moving.forces(found.whole(atoms), velocities, forces).virial
        virial = (virial + virial.T) / 2
        stress -= virial[[0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1]] / atoms.get_volume()

    def get_removed_dof(self, atoms: Any) -> int:
        """Degrees of freedom that the constraints take: one a bond, but none between two held atoms; of a rigid body all
        but its own. Temperatures that ASE gives count them. Of constraints that act as one, the first has those of all."""
        found = self._prepare(atoms)
        if found.moving is None or self._of_set[0] is not self:
            return 0
        return 3 * (len(atoms) - len(found.held)) - found.moving.degrees_of_freedom()

    def get_indices(self) -> np.ndarray:
        """The atoms that have bonds or belong to a body."""
        return self._kept.atoms()

    def todict(self) -> dict:
        """As ASE's own FixBondLengths of the same bonds and lengths, so that files can be read without this package."""
        kept = self._kept.as_pairs()
        return {"name": "FixBondLengths",
                "kwargs": {"pairs": kept.pairs.tolist(),
                           "bondlengths": None if kept.lengths is None else kept.lengths.tolist()}}

    def copy(self) -> "Constraint":
        return self._with(self._kept.copy(), self._angles)

    def index_shuffle(self, atoms: Any, ind: Any) -> None:
        """Keeps the bonds and bodies whose atoms are all in a selection."""
        kept = np.arange(len(atoms))[ind]
        self._select(kept, len(atoms))

    def delete_atoms(self, indices: Any, natoms: int) -> Optional["Constraint"]:
        """What is left without some atoms; None if that is nothing."""
        try:
            self._select(np.setdiff1d(np.arange(natoms), np.arange(natoms)[indices]), natoms)
        except IndexError:
            return None
        return self

    def _select(self, kept: np.ndarray, n: int) -> None:
        new = np.full(n, -1)
        new[kept] = np.arange(len(kept))
        angles = new[self._angles % n]
        self._set_kept(self._kept.of_selection(new))
        self._angles = angles[(angles != -1).all(axis=1)]

    def repeat(self, m: Any, n: int) -> "Constraint":
        """For m copies of n atoms."""
        copies = int(np.prod(np.broadcast_to(m, 3)))
        angles = np.concatenate([self._angles % n + k * n for k in range(copies)])
        return self._with(self._kept.repeated(copies, n), angles)

    def __repr__(self) -> str:
        return f"Constraint({self._kept})"

    # ------------------------------------------------------------------------------------------------------- more
    def impose(self, atoms: Any) -> None:
        """Moves the atoms onto the constraints from positions that may be crude, and their momenta."""
        found = self._prepare(atoms, look=False)
        if found.moving is None:
            return
        reference = found.whole(atoms)
        whole = reference.copy()
        found.moving.impose(whole)
        atoms.positions += whole - reference
        if atoms.has("momenta"):
            atoms.set_momenta(atoms.get_momenta())

    def molecules(self, atoms: Any) -> Molecules:
        """The molecules as the library sees them, with masses and cell of the atoms: for tensions, virials, violations."""
        found = self._prepare(atoms)
        if found.moving is None:
            raise ArgumentError("all atoms of these bonds are held")
        return found.moving

    def _prepare(self, atoms: Any, look: bool = True) -> MoleculesOfAtoms:
        """The molecules with masses, held atoms and cell as they are now, of all constraints that share atoms with this one."""
        held = np.zeros(len(atoms), dtype=bool)
        ours = []
        for constraint in atoms.constraints:
            if isinstance(constraint, FixAtoms):
                held[constraint.index] = True
            elif isinstance(constraint, Constraint):
                constraint._kept.count_from_start(len(atoms))
                ours.append(constraint)
        held = np.flatnonzero(held)
        group = group_of(self, ours) if len(ours) > 1 else [self]
        parts = [constraint._kept for constraint in group]
        masses = atoms.get_masses()
        found = self._set
        if (found is not None and len(parts) == len(self._parts) and all(a is b for a, b in zip(parts, self._parts))
                and np.array_equal(held, found.held) and len(masses) == len(found.masses)):
            found.set_masses(masses)
            found.set_cell(atoms)
            return found
        others = [constraint for constraint in atoms.constraints if not isinstance(constraint, Constraint)]
        look_at_others(np.concatenate([part.atoms() for part in parts]), others)
        measured = [constraint._measure(atoms) for constraint in group]
        is_first = found is None
        found = MoleculesOfAtoms(together(parts), masses, held)
        found.set_cell(atoms)
        self._set, self._of_set, self._parts = found, tuple(group), tuple(parts)
        if is_first and look:
            found.look(atoms, any(measured))
        return found

    def _measure(self, atoms: Any) -> bool:
        """Takes lengths and places from the positions where they were not given. Angles of 180 degrees become bodies."""
        kept = self._kept
        took = kept.measure(atoms)
        for angle in (self._angles % len(atoms)).tolist():
            kept.straighten(*angle)
        self._angles = self._angles[:0]
        return took

    @classmethod
    def _with(cls, kept: Kept, angles: np.ndarray) -> "Constraint":
        new = cls.__new__(cls)
        new._angles = angles.copy()
        new._set_kept(kept)
        return new

    def __getstate__(self) -> dict:
        return {"kept": self._kept, "angles": self._angles}

    def __setstate__(self, state: dict) -> None:
        self._angles = state["angles"]
        self._set_kept(state["kept"])


class FixBondLengths(Constraint):
    """Constraint with the arguments of ase.constraints.FixBondLengths. tolerance and iterations are not needed."""

    def __init__(self, pairs: Pairs, tolerance: float = 1e-13, bondlengths: Optional[Floats] = None,
                 iterations: Optional[int] = None):
        super().__init__(pairs, bondlengths)


def FixBondLength(a1: int, a2: int) -> FixBondLengths:
    """Keeps the distance of two atoms."""
    return FixBondLengths([(a1, a2)])


def _columns(numbers: Any, columns: int, name: str) -> np.ndarray:
    a = np.array(numbers)
    if a.size == 0:
        return np.zeros((0, columns), np.int64)
    if a.ndim != 2 or a.shape[1] != columns:
        raise ArgumentError(f"{name} has the shape {a.shape}; it must be (n, {columns})")
    if not np.issubdtype(a.dtype, np.integer):
        raise TypeError(f"{name} must be integers, not {a.dtype}")
    return a.astype(np.int64)


def _atoms_of(body: Any) -> np.ndarray:
    a = np.array(body)
    if a.ndim != 1 or len(a) < 2 or not np.issubdtype(a.dtype, np.integer):
        raise ArgumentError(f"a body is {body!r}; it must be a list of at least two atoms")
    return a.astype(np.int64)
