"""All bonds and angles of molecules with the decimals of a topology file, against singular values of what they hold."""

import unittest

import numpy as np

import holonomic as hol
import topologies


def with_decimals(exact, how, rng):
    """Three to five decimals, all of them or beside lengths of full digits or of other decimals, or as floats."""
    decimals = {"three": 3, "four": 4, "five": 5}.get(how, 4)
    lengths = np.round(exact, decimals)
    if how == "one is full":
        k = rng.integers(len(exact))
        lengths[k] = exact[k]
    elif how == "half are full":
        full = rng.random(len(exact)) < 0.5
        lengths[full] = exact[full]
    elif how == "floats":
        lengths = lengths.astype(np.float32).astype(float)
    return lengths


def gradients(x, pairs, groups):
    """Of the distances, and of the relations of groups on a line and in a plane."""
    rows = []
    for i, j in pairs:
        row = np.zeros_like(x)
        row[j] = (x[j] - x[i]) / np.linalg.norm(x[j] - x[i])
        row[i] = -row[j]
        rows.append(row.ravel())
    for group in groups:
        y = x[group] - x[group].mean(axis=0)
        _, size, axes = np.linalg.svd(y)
        rank = (size > 2e-3 * size[0]).sum()
        if rank == 3 or len(group) <= rank + 1:
            continue
        spanned = np.vstack([np.ones(len(group)), axes[:rank] @ y.T])
        for c in np.linalg.svd(spanned)[2][rank + 1:]:
            for k in range(3):
                row = np.zeros_like(x)
                row[group, k] = c
                rows.append(row.ravel())
    return np.array(rows)


class Topologies(unittest.TestCase):
    def check(self, molecule, lengths, pairs, rng):
        n = len(molecule.masses)
        molecules = hol.Molecules(molecule.masses)
        molecules.add(pairs, lengths)
        r = np.array(molecule.places) @ np.linalg.qr(rng.normal(size=(3, 3)))[0].T + 0.3
        molecules.impose(r)
        a = gradients(r, pairs, molecule.groups())
        size = np.linalg.svd(a)[1]
        self.assertEqual(molecules.degrees_of_freedom(), 3 * n - (size > 1e-6 * size[0]).sum())
        w = np.repeat(1 / molecule.masses, 3)
        inverse = np.linalg.pinv(a * np.sqrt(w), rcond=1e-7)
        v, f = rng.normal(size=(2, n, 3))
        wanted = v.ravel() - np.sqrt(w) * (inverse @ (a @ v.ravel()))
        molecules.project_velocities(r, v)
        self.assertLess(np.abs(v.ravel() - wanted).max(), 1e-9 * np.abs(wanted).max())
        rates = np.zeros(len(a))
        for k, (i, j) in enumerate(pairs):
            rates[k] = -((v[j] - v[i]) ** 2).sum() / np.linalg.norm(r[j] - r[i])
        wanted = (inverse @ (rates - a @ (w * f.ravel()))) / np.sqrt(w)
        found = molecules.forces(r, v, f).forces.ravel()
        self.assertLess(np.abs(found - wanted).max(), 1e-9 * np.abs(wanted).max())
        dt = 0.002 / np.abs(v).max()
        moved = r + dt * v
        molecules.project_positions(r, moved, dt)
        self.assertLess(molecules.violation(moved).length, 1e-12)

    def test_all_bonds_and_angles_with_the_decimals_of_a_file(self):
        rng = np.random.default_rng(7)
        for make in topologies.ALL:
            molecule = make()
            pairs, exact = molecule.distances()
            for how in ("three", "four", "five", "one is full", "half are full", "floats"):
                with self.subTest(make.__name__, lengths=how):
                    self.check(molecule, with_decimals(exact, how, rng), pairs, rng)


if __name__ == "__main__":
    unittest.main()
