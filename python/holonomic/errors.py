"""What goes wrong, as exceptions: each has the library's message, and says where it happened."""

from __future__ import annotations

import re
from ctypes import byref, c_int64
from typing import NoReturn, Optional

from ._library import library


class Error(Exception):
    """Base of all errors of the library.

    status    number of the status, as hol_status in holonomic.h
    molecule  number of the first bad molecule, or None where it does not apply; likewise
    bond      the bond within the molecule (`Molecules.molecule(i).bonds` has its place in the arrays per bond); of a bond
              that was refused when it was to be added, its number in the list of that call
    atom      the atom
    n_bad     how many molecules were bad; 0 for a wrong argument

    All are counted from 0. After a wrong argument nothing has been written. After bad data (NotFiniteError,
    DegenerateError, NoConvergenceError, LengthsError) the arrays of the bad molecules are as they were, and those of all
    other molecules are complete.
    """

    status: int = 0
    molecule: Optional[int] = None
    bond: Optional[int] = None
    atom: Optional[int] = None
    n_bad: int = 0


class ArgumentError(Error, ValueError):
    """A size, mass, length or option is out of its range, or an array does not fit."""


class NumberError(Error, IndexError):
    """An atom, bond or molecule number is out of range."""


class SharedAtomError(Error, ValueError):
    """An atom that can move belongs to a molecule of an earlier call already."""


class OutOfMemoryError(Error, MemoryError):
    """Out of memory."""


class NotFiniteError(Error, ArithmeticError):
    """An infinity or NaN in the data of a molecule, or an overflow or underflow."""


class DegenerateError(Error, ArithmeticError):
    """A bond of length zero, or bonds that are not independent of each other in these positions."""


class NoConvergenceError(Error, ArithmeticError):
    """The bond lengths can't be reached from these positions."""


class NotDefiniteError(Error, ArithmeticError):
    """The tridiagonal matrix is not positive definite."""


class LengthsError(Error, ValueError):
    """Positions do not fit the bonds' lengths (`Molecules.checks`)."""


class UnsupportedError(Error, NotImplementedError):
    """It is not implemented for such molecules."""


class StateError(Error, RuntimeError):
    """Not at this time: something has to be called before, or may not be any more."""


class LengthsWarning(UserWarning):
    """Positions fit the bonds' lengths so badly, or in such a way, that a mistake is likely."""


class MasslessWarning(UserWarning):
    """A bond with an atom of mass 0, which it holds in space, looks as if it was meant for a massless site."""


class ReferenceWarning(UserWarning):
    """The reference of a step is the very array that is projected: it has not the positions before the drift."""


_CLASSES = {1: ArgumentError, 2: ArgumentError, 3: NumberError, 4: SharedAtomError, 5: OutOfMemoryError,
            6: NotFiniteError, 7: DegenerateError, 8: NoConvergenceError, 9: NotDefiniteError, 11: LengthsError,
            12: UnsupportedError, 13: StateError}


# Names of C that a message may have in it, where those of Python are not what is left without "hol_", "chains_" and "set_".
_NAMES = {"hol_chains_add": "add_chain", "hol_chains_add_bonds": "add", "hol_chains_add_block": "add_chains",
          "hol_chains_create": "Molecules", "hol_chains_bonds": "molecule", "hol_chains_atoms": "molecule",
          "hol_chains_set_lengths": "set_lengths", "hol_chains_set_masses": "set_masses", "hol_chains_set_labels": "set_labels",
          "hol_chains_set_outcomes": "keep_outcomes", "hol_inverse_create": "inverse"}
_NAME = re.compile(r"\bhol_\w+")


def _name(found: re.Match) -> str:
    name = re.sub("_view$", "", found[0])
    return _NAMES.get(name) or re.sub("^hol_(chains_|inverse_|tridiagonal_)?(set_)?", "", name)


def _in_words_of_python(message: str) -> str:
    message = _NAME.sub(_name, message).replace("another handle's", "another object's")
    message = message.replace("some views have z and some have not", "some arrays are (n, 3) and some (n, 2)")
    return re.sub(r"(?<!of )\b1 (bond|molecule|atom|chain)s\b", r"1 \1", message)


def fail(status: int, when_added: bool = False) -> NoReturn:
    """Raises the exception of this thread's last failing call."""
    places = [c_int64() for _ in range(4)]
    library.hol_error_location(*(byref(place) for place in places))
    message = _in_words_of_python(library.hol_error_message().decode(errors="replace"))
    of = ArgumentError if when_added and status == 7 else _CLASSES.get(status, Error)
    error = of(message)
    error.status = status
    chain, bond, atom, error.n_bad = (place.value for place in places)
    error.molecule, error.bond, error.atom = (None if place < 0 else place for place in (chain, bond, atom))
    raise error


def ask(status: int) -> None:
    if status:
        fail(status)


def ask_to_add(status: int) -> None:
    """Bonds that can't be are a wrong argument where they are added, and not bad data."""
    if status:
        fail(status, when_added=True)
