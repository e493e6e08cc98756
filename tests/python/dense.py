"""An independent solution: the constraint matrix written out and solved by numpy, in the words of docs/theory.md."""

import numpy as np


def random_molecule(rng, n, shape="tree"):
    """Positions (n, 3), bonds and masses of one molecule: a random tree, with one more bond for a ring."""
    bonds = [(int(rng.integers(max(0, i - 3), i)), i) for i in range(1, n)]
    if shape == "chain":
        bonds = [(i - 1, i) for i in range(1, n)]
    if shape == "ring":
        bonds = [(i - 1, i) for i in range(1, n)] + [(n - 1, 0)]
    r = np.zeros((n, 3))
    for i, j in bonds[: n - 1]:
        step = rng.normal(size=3)
        r[j] = r[i] + step / np.linalg.norm(step) * rng.uniform(0.8, 1.5)
    return r, np.array(bonds), rng.uniform(1, 4, n)


def bond_vectors(r, bonds, box=None):
    d = r[bonds[:, 1]] - r[bonds[:, 0]]
    if box is not None:  # nearest image of all that are close
        images = np.array([(i, j, k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1)])
        fractions = np.linalg.solve(np.transpose(box), d.T).T
        d = d - np.round(fractions) @ box
        all_images = d[:, None, :] + (images @ box)[None, :, :]
        d = all_images[np.arange(len(d)), np.argmin((all_images**2).sum(2), axis=1)]
    return d


def gradients(d, bonds, n):
    """(n_bonds, 3 n): the gradient of sigma_k = d_k.d_k - a_k^2."""
    rows = np.zeros((len(bonds), n, d.shape[1]))
    for k, (i, j) in enumerate(bonds):
        rows[k, j] += 2 * d[k]
        rows[k, i] -= 2 * d[k]
    return rows.reshape(len(bonds), -1)


def inverse_masses(masses, columns=3):
    masses = np.asarray(masses, float)
    return np.repeat(np.divide(1, masses, out=np.zeros_like(masses), where=masses > 0), columns)


def matrix(r, bonds, masses, box=None):
    """Z."""
    rows = gradients(bond_vectors(r, bonds, box), bonds, len(r))
    return rows * inverse_masses(masses, r.shape[1]) @ rows.T


def forces(r, v, f, bonds, masses, box=None):
    """Multipliers and constraint forces at an instant."""
    d = bond_vectors(r, bonds, box)
    rows, w = gradients(d, bonds, len(r)), inverse_masses(masses, r.shape[1])
    u = v[bonds[:, 1]] - v[bonds[:, 0]]
    rhs = rows @ (w * f.ravel()) + 2 * (u * u).sum(1)
    multipliers = np.linalg.solve(rows * w @ rows.T, rhs)
    return multipliers, -(multipliers @ rows).reshape(r.shape)


def velocities(r, v, bonds, masses):
    rows, w = gradients(bond_vectors(r, bonds), bonds, len(r)), inverse_masses(masses, r.shape[1])
    multipliers = np.linalg.solve(rows * w @ rows.T, rows @ v.ravel())
    return v - (w * (multipliers @ rows)).reshape(v.shape)


def positions(r_ref, r, dt, bonds, lengths, masses):
    """Positions on the constraints and multipliers, by Newton's method with the whole Jacobian."""
    rows, w = gradients(bond_vectors(r_ref, bonds), bonds, len(r)), inverse_masses(masses)
    multipliers = np.zeros(len(bonds))
    for _ in range(60):
        now = r - dt**2 * (w * (multipliers @ rows)).reshape(r.shape)
        d = bond_vectors(now, bonds)
        sigma = (d * d).sum(1) - lengths**2
        jacobian = dt**2 * gradients(d, bonds, len(r)) * w @ rows.T
        multipliers = multipliers + np.linalg.solve(jacobian, sigma)
    return now, multipliers
