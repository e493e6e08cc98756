"""Rigid dumbbells in Brownian motion and shear: their viscosity beside the series. The virial alone is not the stress."""

import sys

import numpy as np

import holonomic as hol

N, KT, ZETA, X, DT = 3000, 1.0, 12.0, 0.3, 0.005  # the time of rotation, zeta a^2/(12 kT), is 1; X the rate of shear
dumbbells = hol.Molecules(np.full(2 * N, ZETA))  # frictions in place of masses
dumbbells.add_molecules(N, 2, [(0, 1)], 1.0)
mirror = np.array([1.0, -1.0, 1.0])
rng = np.random.default_rng(5)


def mirrored(half):
    """The second half of the dumbbells has the first one's numbers, mirrored in y: without flow its shear stress cancels."""
    return np.concatenate([half, half * mirror])


u = rng.normal(size=(N // 2, 3))
u /= np.linalg.norm(u, axis=1)[:, None]
r = mirrored(np.stack([0 * u, u], axis=1).reshape(-1, 3))
steps, warm = (900, 900) if "--quick" in sys.argv else (4000, 1200)
virial = kinetic = 0.0
for step in range(-warm, steps):
    d = r[1::2] - r[::2]
    xi = mirrored(rng.normal(size=(N, 3)))
    kick = np.sqrt(2 * KT * DT / ZETA) * xi
    known = -0.5 * ZETA / DT * np.sum(np.einsum("ij,ij->i", kick[1::2] - kick[::2], d) * d[:, 0] * d[:, 1])  # mean 0: noise
    before = r.copy()
    r = r + kick
    r[:, 0] += DT * X * before[:, 1]
    impulse = dumbbells.project_positions(before, r, np.sqrt(DT), virial=True)
    if step >= 0:
        virial -= (impulse.virial[0, 1] - known) / (N * X * steps)
        kinetic += KT * np.mean(d[:, 0] * d[:, 1]) / (X * steps)
series = 1 - 18 / 35 * X**2 + 1326 / 1925 * X**4
print(f"viscosity/(n kT lambda) at x = {X}: virial {virial:.3f} + kinetic part {kinetic:.3f} = {virial + kinetic:.3f}, series {series:.3f}")
assert abs(virial + kinetic - series) < 0.04 and virial < 0.85
