"""Mass points in place of a rigid body that is given by its inertia tensor."""

from __future__ import annotations

from ctypes import byref, c_int64
from typing import Optional, Tuple

import numpy as np

from ._arrays import address, numbers, real
from ._library import library
from ._types import Floats
from .errors import ask


def equimomental_points(
    mass: float, inertia: Floats, centre: Optional[Floats] = None
) -> Tuple[np.ndarray, np.ndarray]:
    """Masses (n,) and places (n, 3) of two to four equal points with this mass, centre and inertia tensor.

    inertia  (3, 3), about the centre: moments on the diagonal, products with the minus sign beside it
    centre   (3,), in the frame of the places. None: the origin

    Two for a linear body, three for a flat one. What the body carries are massless sites of it: atoms of mass 0, given
    to add_rigid with these points.
    """
