"""Whether bonds that a face of the box cuts fit worse than the others: then the box is not that of the positions."""

from __future__ import annotations

from typing import Optional

import numpy as np

_LEAST = 1e-3  # of a length: coordinates of three decimals are off by as much
_TIMES = 3


def cut_bonds_misfit(r: np.ndarray, bonds: np.ndarray, lengths: np.ndarray, box: np.ndarray) -> Optional[str]:
    """A message, or None. r (n_atoms, 3), a box (3, 3) with rows of zeros where it is not periodic."""
    d = r[bonds[:, 1]] - r[bonds[:, 0]]
    straight = np.linalg.norm(d, axis=1)
    image = minimum_images(d, box)
    length = np.linalg.norm(image, axis=1)
    cut = np.abs(d - image).max(axis=1) > 0.25 * straight
    inside = ~cut
    if not cut.any() or inside.sum() < 3:
        return None
    off = np.abs(length / lengths - 1)
    if not (off[cut].max() > max(_LEAST, _TIMES * off[inside].max())):
        return None
    k = int(np.flatnonzero(cut)[off[cut].argmax()])
    i, j = bonds[k]
    return (f"the bonds that a face of the box cuts are off by up to {100 * off[cut].max():.2g} % (bond {k}, atoms {i} and {j}: "
            f"{length[k]:.6g} long, it should be {lengths[k]:.6g}), the others by {100 * off[inside].max():.2g} %: this is hardly "
            "the box of these positions")


def minimum_images(d: np.ndarray, box: np.ndarray) -> np.ndarray:
    """Of vectors (n, 3), to the nearest image in a cell that is not very skew: good enough for a look."""
    periodic = box.any(axis=1)
    if not periodic.any():
        return d
    inverse = np.linalg.pinv(box)
    return d - np.rint(d @ inverse) @ box
