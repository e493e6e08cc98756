"""Molecules with rigid bonds: the calls of a time step."""

from __future__ import annotations

import warnings
from ctypes import addressof, byref, c_double, c_int64
from typing import Any, NoReturn, Optional, Tuple

import numpy as np

from ._arrays import NotPacked, address, dimensions, number, numbers, output, view_of
from ._library import bare, library
from ._settings import Settings
from ._types import Array, Floats, Integers
from .device import DevicePlan, make_plan
from .errors import ArgumentError, ReferenceWarning, ask, fail
from .factors import Factors
from .inverse import Inverse
from .results import Forces, Impulse, Metric, Outcomes, Reactions, Report, Violation, counted

_BOXES = ("box", "reference")
_forces, _forces_view = bare("hol_forces"), bare("hol_forces_view")
_positions, _positions_view = bare("hol_project_positions"), bare("hol_project_positions_view")
_velocities, _velocities_view = bare("hol_project_velocities"), bare("hol_project_velocities_view")
_along_view = bare("hol_project_positions_along_view")


class Molecules(Settings):
    """Any number of molecules of rigid bonds over the caller's arrays of atoms.

    Molecules(masses)           masses (n_atoms,); 0: the atom is held fixed
    Molecules(masses, fixed)    fixed: which atoms are held, by their numbers or (n_atoms,) of bool, whatever their masses;
                                bonds with any other atom of mass 0 are refused then. A massless site belongs to a body.

    Atoms, bonds and molecules are counted from 0. Arrays per atom are (n_atoms, 3), or (n_atoms, 2) in two dimensions, of
    float64 or float32 with any strides: the library works on them where they stand. Inputs of other types are converted.
    Arrays per bond are (n_bonds,) float64, in the order in which the bonds were given. Units are your own; any consistent
    set does.

    Errors are exceptions (`holonomic.Error`) with the molecule, bond and atom at fault. After an error about the data of some
    molecules, all others are complete, and the arrays of the bad ones are as they were.

    A copy (copy, deepcopy, pickle) is a set of its own.

    One object may be used by any number of threads at once, each with arrays of its own, while none changes it. Calls
    let other threads of Python run.
    """

    __slots__ = ()

    def __init__(self, masses: Floats, fixed: Optional[Integers] = None):
        super().__init__(masses, fixed)

    def forces(self, r: Floats, v: Array = None, f: Array = None, *, out: Optional[np.ndarray] = None, add: bool = False) -> Forces:
        """Constraint forces that keep every bond's length constant at this instant: one factorization, no tolerance.

        r    positions (n_atoms, 3), length
        v    velocities, or None: at rest
        f    applied forces, or None: none
        out  array for the constraint forces, instead of one of the result's own; may be f itself
        add  adds them to what is in `out`, instead of replacing it

        Returns lambda_, tensions, virial and forces.
        """
        if v is r:
            _same(r)
        n = self._n_bonds
        memory = self._outputs()
        pointer = self._packed.pointer
        try:
            status = _forces(self._handle, pointer(r), pointer(v), pointer(f), memory, byref(memory, 8 * n),
                             byref(memory, 16 * n + 72) if out is None else pointer(out), 1 if add else 0,
                             byref(memory, 16 * n))
        except NotPacked:
            return self._forces_of_views(r, v, f, out, add)
        if status:
            fail(status)
        return Forces(memory, n, out)

    def _forces_of_views(self, r: Any, v: Any, f: Any, out: Any, add: bool) -> Forces:
        n, memory, view = self._n_bonds, self._outputs(), self._view
        r_view = view(r, "r")
        g_view, columns = self._forces_into(memory, r, out)
        ask(_forces_view(self._handle, r_view, view(v, "v"), view(f, "f"), memory, byref(memory, 8 * n), g_view, int(add),
                         byref(memory, 16 * n)))
        return Forces(memory, n, out, True, columns)

    def _forces_into(self, memory: Any, r: Any, out: Any) -> Tuple[Any, int]:
        """A view of `out`, or of the result's own memory."""
        columns = dimensions(r)
        if out is None:
            start = 2 * self._n_bonds + 9
            own = np.frombuffer(memory)[start : start + columns * self._n_atoms].reshape(self._n_atoms, columns)
            return self._view(own, "out", True), columns
        return self._view(out, "out", True), columns

    def _view(self, array: Any, name: str, is_output: bool = False) -> Any:
        return self._views.view(array, name, is_output)

    def spread_forces(self, r: Floats, f: np.ndarray) -> Forces:
        """Adds to f, in place, the constraint forces at rest: afterwards f / m is right for a kick, and forces on massless
        sites have gone to the atoms of their bodies. What `project_positions` and `project_velocities` make of the kick is
        the same with them. Returns what was added."""
        return self.forces(r, None, f, out=f, add=True)

    def solve(self, r: Floats, rhs: Floats, *, out: Optional[np.ndarray] = None, add: bool = False) -> Forces:
        """Multipliers of any right-hand side: Z lambda = rhs, with the matrix Z that `forces` solves.

        r         positions (n_atoms, 3)
        rhs       (n_bonds,)
        out, add  as in `forces`

        With forces f + G, sigma_k'' = (its value without G) - rhs_k. Returns lambda_, virial and forces.
        """
        rhs = numbers(rhs, self._n_bonds, "rhs", "bond")
        n, memory = self._n_bonds, self._outputs()
        r_view = self._view(r, "r")
        g_view, columns = self._forces_into(memory, r, out)
        start = addressof(memory)
        ask(library.hol_solve_view(self._handle, r_view, address(rhs), start, g_view, int(add), start + 16 * n))
        return Forces(memory, n, out, False, columns)

    def project_positions(self, r_ref: Floats, r: np.ndarray, dt: float, v: Optional[np.ndarray] = None, *,
                          lambda_: Optional[np.ndarray] = None, guess: bool = False, multipliers: bool = False,
                          virial: bool = False) -> Report:
        """Puts positions back on the constraints, in place (SHAKE; the first half of RATTLE), to their rounding.

        r_ref        positions before the drift (n_atoms, 3); may be r itself. Molecules may be wrapped
        r            positions after the drift; changed by dt^2 w G, with G along the bonds of r_ref
        dt           time of the drift
        v            velocities, or None; changed by dt w G
        lambda_      array (n_bonds,) for the multipliers
        guess        lambda_ holds a first guess, the multipliers of the last step
        multipliers  the report has multipliers, in an array of their own
        virial       the report has the virial

        Returns a report. The constraint force over a leap-frog step is that of the multipliers; in velocity Verlet it is
        twice that.
        """
        if v is not None and (v is r or v is r_ref):
            _same(r)
        if guess and lambda_ is None:
            _no_guess()
        report = Report()
        wanted = None
        if multipliers or virial or lambda_ is not None:
            lambda_, wanted = self._wanted(lambda_, multipliers or guess, virial)
            report.lambda_ = lambda_
            report.virial = wanted
        pointer = self._packed.pointer
        try:
            status = _positions(self._handle, pointer(r_ref), pointer(r), pointer(v), c_double(dt), _data(lambda_),
                                1 if guess else 0, _data(wanted), byref(report))
        except NotPacked:
            status = _positions_view(self._handle, self._view(r_ref, "r_ref"), self._view(r, "r", True),
                                     self._view(v, "v", True), c_double(dt), _data(lambda_), int(guess), _data(wanted),
                                     byref(report))
        if status:
            fail(status)
        if r_ref is r and v is not None and report.n_corrected:
            _moved_with_it()
        return report

    def project_positions_along(self, b: Floats, r: np.ndarray, dt: float, v: Optional[np.ndarray] = None, *,
                                lambda_: Optional[np.ndarray] = None, guess: bool = False, multipliers: bool = False,
                                virial: bool = False) -> Report:
        """`project_positions` with the bond vectors of the reference, b (n_bonds, 3), in place of its positions.

        b_k leads from the first atom of bond k, as it was given, to the second.
        """
        if v is not None and v is r:
            _same(r)
        if guess and lambda_ is None:
            _no_guess()
        report = Report()
        lambda_, wanted = self._wanted(lambda_, multipliers or guess, virial)
        report.lambda_, report.virial = lambda_, wanted
        ask(_along_view(self._handle, view_of(b, self._n_bonds, "b", "bonds"), self._view(r, "r", True),
                        self._view(v, "v", True), c_double(dt), _data(lambda_), int(guess), _data(wanted), byref(report)))
        return report

    def _wanted(self, lambda_: Any, multipliers: bool, virial: bool) -> Tuple[Optional[np.ndarray], Optional[np.ndarray]]:
        if lambda_ is not None:
            lambda_ = output(lambda_, (self._n_bonds,), "lambda_")
        elif multipliers:
            lambda_ = np.zeros(self._n_bonds)
        return lambda_, np.zeros((3, 3)) if virial else None

    def project_velocities(self, r: Floats, v: np.ndarray, *, multipliers: bool = False, virial: bool = False) -> Impulse:
        """Projects velocities onto the constraints, in place (the second half of RATTLE): d_k.(v_j - v_i) = 0.

        r            positions (n_atoms, 3)
        v            velocities; the change is the one of least kinetic energy
        multipliers  the multipliers of the impulse are wanted
        virial       the virial of the impulse is wanted

        Returns (lambda_, virial), None for what was not wanted.
        """
        if v is r:
            _same(r)
        lambda_, wanted = self._wanted(None, multipliers, virial) if multipliers or virial else (None, None)
        pointer = self._packed.pointer
        try:
            status = _velocities(self._handle, pointer(r), pointer(v), _data(lambda_), _data(wanted))
        except NotPacked:
            status = _velocities_view(self._handle, self._view(r, "r"), self._view(v, "v", True), _data(lambda_),
                                      _data(wanted))
        if status:
            fail(status)
        return Impulse(lambda_, wanted)

    def reactions(self, r: Floats, lambda_: Floats, *, box: str = "box") -> Reactions:
        """What given multipliers do: tensions, forces or impulses on atoms, virials of bonds.

        r        positions with which the multipliers were found (of `project_positions`: r_ref)
        lambda_  (n_bonds,)
        box      "box", or "reference" for the reference_box
        """
        n = self._n_bonds
        lambda_ = numbers(lambda_, n, "lambda_", "bond")
        r_view = self._view(r, "r")
        found = Reactions(np.zeros(n), np.zeros((self._n_atoms, dimensions(r))), np.zeros((n, 6)), np.zeros((3, 3)))
        ask(library.hol_reactions_view(self._handle, r_view, _box(box), address(lambda_), address(found.tensions),
                                       self._view(found.forces, "g"), 0, address(found.bond_virial), address(found.virial)))
        return found

    def violation(self, r: Floats, v: Array = None) -> Violation:
        """Largest violation of the constraints by positions r (n_atoms, 3) and velocities v."""
        if v is not None and v is r:
            _same(r)
        worst = Violation()
        ask(library.hol_violation_view(self._handle, self._view(r, "r"), self._view(v, "v"), byref(worst)))
        return worst

    def residuals(self, r: Floats, v: Array = None) -> Tuple[np.ndarray, np.ndarray]:
        """What is left of each constraint: (d.d - a^2) / a^2 and d.(v_j - v_i + L d), each (n_bonds,)."""
        if v is not None and v is r:
            _same(r)
        length, rate = np.zeros(self._n_bonds), np.zeros(self._n_bonds)
        ask(library.hol_residuals_view(self._handle, self._view(r, "r"), self._view(v, "v"), address(length), address(rate)))
        return length, rate

    def impose(self, r: np.ndarray) -> Report:
        """Moves positions r (n_atoms, 3) that lie anywhere onto the constraints, in place: a model built by hand, another
        force field's lengths, bodies too. By steps of Newton's method in which no bond changes by more than a third;
        `project_positions` with r_ref = r does it only where bonds are off by a third or less."""
        report = Report()
        ask(library.hol_impose_view(self._handle, self._view(r, "r", True), byref(report)))
        return report

    def outcomes(self) -> Outcomes:
        """What this thread's last call has done with each molecule, if `keep_outcomes` was True then: where an Error names
        the first bad molecule, this names all. After a call that failed, set `keep_outcomes` and make it once more."""
        found = Outcomes(np.zeros(self.n_molecules, np.int32), np.zeros(self.n_molecules, np.int32))
        ask(library.hol_outcomes(self._handle, address(found.status), address(found.iterations)))
        return found

    def check(self, r: Floats, *, box: str = "box") -> None:
        """Raises LengthsError if a bond of r is off by more than a tenth of its length, or longer than half the box; or if
        the bonds that a face of the box cuts are off, and the others not: the box is not that of r then."""
        ask(library.hol_chains_check_view(self._handle, self._view(r, "r"), _box(box)))

    def reference_error(self) -> Tuple[float, Optional[int], Optional[int]]:
        """Error, molecule and bond of the reference of the last call that compared it with the lengths."""
        error, molecule, bond = c_double(), c_int64(), c_int64()
        ask(library.hol_reference_error(self._handle, byref(error), byref(molecule), byref(bond)))
        none = molecule.value < 0
        return error.value, None if none else molecule.value, None if none else bond.value

    def metric(self, r: Floats, kT: float = 0.0) -> Metric:
        """Metric determinant of the molecules, and the Fixman potential and its forces at the thermal energy kT."""
        kT = number(kT, "kT")
        r_view = self._view(r, "r")
        n, energy = self.n_molecules, c_double()
        log_det, log_det_z, force = np.zeros(n), np.zeros(n), np.zeros((self._n_atoms, dimensions(r)))
        ask(library.hol_metric_view(self._handle, r_view, kT, address(log_det), address(log_det_z), byref(energy),
                                    self._view(force, "force"), 0))
        return Metric(log_det, log_det_z, energy.value, force)

    def inverse(self, molecule: int, r: Floats) -> Inverse:
        """The inverse of the matrix Z of one molecule at positions r (n_atoms, 3), element by element or whole."""
        return Inverse(self._handle, molecule, self._view(r, "r"), self._n_atoms)

    def factors(self, r: Floats) -> Factors:
        """The factors of all molecules at positions r (n_atoms, 3), for any number of right-hand sides."""
        return Factors(self, r)

    def device_plan(self, precision: str, max_entries: int = -1) -> DevicePlan:
        """What kernels need to solve the constraints of all molecules on a GPU, in "single", "mixed" or "double" precision.

        Molecules with more than max_entries entries above the diagonal of their eliminated matrix take a work-group each, not a
        work-item; below 0: 70, as suits GPUs.
        """
        return make_plan(self._handle, precision, max_entries)

    def __repr__(self) -> str:
        return (f"<holonomic.Molecules: {counted(self.n_molecules, 'molecule')} with {counted(self._n_bonds, 'bond')}, "
                f"of {counted(self._n_atoms, 'atom')}>")


def _same(r: Any) -> NoReturn:
    if r is None:
        raise TypeError("r is None: positions are needed")
    raise ArgumentError("v is the array that was given for the positions")


def _moved_with_it() -> None:
    warnings.warn(ReferenceWarning("r_ref is r itself, whose bonds the step has changed: r_ref must have the positions before the "
                                   "drift (before = r.copy())"), stacklevel=3)


def _no_guess() -> NoReturn:
    raise ArgumentError("guess is True, and lambda_, which holds the guess, was not given")


def _data(array: Optional[np.ndarray]) -> Any:
    return None if array is None else array.ctypes


def _box(box: str) -> int:
    if box not in _BOXES:
        raise ArgumentError(f"box is {box!r}; it must be 'box' or 'reference'")
    return _BOXES.index(box)
