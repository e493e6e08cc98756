"""Partition functions of chains."""

from __future__ import annotations

from ctypes import byref, c_double
from typing import NamedTuple, Optional

from ._arrays import address, integer, numbers
from ._library import library
from ._types import Floats
from .errors import ask


class PartitionFunction(NamedTuple):
    """log_he      ln < det Z~^(-1/2) >
    log_rigid   ln < det Z~^(+1/2) >: the rigid chain's partition function over that of the freely jointed chain
    log_volume  sum of ln sqrt(x_n)
    """

    log_he: float
    log_rigid: float
    log_volume: float


def partition_function(n_bonds: int, masses: Optional[Floats] = None) -> PartitionFunction:
    """Means of powers of the metric determinant over all conformations of a freely jointed chain of n_bonds bonds.

    masses  (n_bonds+1,), any unit; 0: held fixed. None: all equal
    """
    n_bonds = integer(n_bonds, "n_bonds")
    if masses is not None:
        masses = numbers(masses, n_bonds + 1, "masses", "atom")
    found = [c_double() for _ in range(3)]
    ask(library.hol_partition_function(n_bonds, address(masses), *(byref(value) for value in found)))
    return PartitionFunction(*(value.value for value in found))
