"""What was added to a set of molecules, call by call: for copies of the set, and for questions about its bonds."""

from __future__ import annotations

from typing import Any, Callable, Dict, List, Tuple

import numpy as np


def _repeated(bonds: np.ndarray, n_molecules: int, n_atoms: int, first_atom: int) -> np.ndarray:
    starts = first_atom + n_atoms * np.arange(n_molecules)
    return (bonds[None] + starts[:, None, None]).reshape(-1, 2)


# The bonds and their lengths of each method of Molecules that adds some, from its arguments.
_BONDS: Dict[str, Callable[..., Tuple[np.ndarray, np.ndarray]]] = {
    "add": lambda bonds, lengths, images=None: (bonds, lengths),
    "add_molecules": lambda n, n_atoms, bonds, lengths, first: (_repeated(bonds, n, n_atoms, first), np.tile(lengths, n)),
    "add_chain": lambda atoms, lengths: (np.stack([atoms[:-1], atoms[1:]], axis=1), lengths),
    "add_chains": lambda n, n_bonds, lengths, first: (
        _repeated(np.arange(n_bonds)[:, None] + np.arange(2), n, n_bonds + 1, first), np.tile(lengths, n)),
    "add_linear": lambda atoms, coefficients, bonds, lengths: (bonds, lengths),
    "add_linear_molecules": lambda n, n_atoms, atoms, coefficients, bonds, lengths, first: (
        _repeated(bonds, n, n_atoms, first), np.tile(lengths, n)),
    "add_rigid": lambda bodies, places, bonds, lengths: (bonds, lengths),
    "add_rigid_molecules": lambda n, n_atoms, bodies, places, bonds, lengths, first: (
        _repeated(bonds, n, n_atoms, first), np.tile(lengths, n)),
}


class Added:
    """The calls, with arguments of their own."""

    __slots__ = ("_calls",)

    def __init__(self) -> None:
        self._calls: List[Tuple[str, tuple]] = []

    def note(self, method: str, *arguments: Any) -> None:
        self._calls.append((method, tuple(np.array(a) if isinstance(a, np.ndarray) else a for a in arguments)))

    def copy(self) -> Added:
        other = Added()
        other._calls = list(self._calls)
        return other

    def repeat(self, molecules: Any) -> None:
        """Makes the same calls for another set."""
        for method, arguments in self._calls:
            getattr(molecules, method)(*arguments)

    def bonds(self) -> np.ndarray:
        """The two atoms of every bond (n_bonds, 2)."""
        return np.concatenate([np.zeros((0, 2), np.int64)] + [_BONDS[method](*given)[0] for method, given in self._calls])

    def lengths(self) -> np.ndarray:
        """The lengths with which they were added (n_bonds,)."""
        return np.concatenate([np.zeros(0)] + [_BONDS[method](*given)[1] for method, given in self._calls])
