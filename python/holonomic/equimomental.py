"""Mass points in place of a rigid body that is given by its inertia tensor."""

from __future__ import annotations

from ctypes import byref, c_int64
from typing import Optional, Tuple

import numpy as np

from ._arrays import address, matrix, number, numbers
from ._library import library
from ._types import Floats
from .errors import ArgumentError, ask


def equimomental_points(
    mass: float, inertia: Floats, centre: Optional[Floats] = None
) -> Tuple[np.ndarray, np.ndarray]:
    """Masses (n,) and places (n, 3) of two to four equal points with this mass, centre and inertia tensor.

    inertia  (3, 3), about the centre: moments on the diagonal, products with the minus sign beside it; or (3,), the
             moments alone
    centre   (3,), in the frame of the places. None: the origin

    Two for a linear body, three for a flat one. What the body carries are massless sites of it: atoms of mass 0, given
    to add_rigid with these points.
    """
    tensor, middle = matrix(inertia, "inertia"), None if centre is None else numbers(centre, 3, "centre", "axis")
    if tensor is None:
        raise ArgumentError("inertia is None; it must be (3, 3), or three principal moments along the axes")
    n, masses, places = c_int64(), np.empty(4), np.empty((4, 3))
    ask(library.hol_equimomental_points(number(mass, "mass"), address(middle), address(tensor), byref(n), address(masses),
                                        address(places)))
    return masses[:n.value], places[:n.value]
