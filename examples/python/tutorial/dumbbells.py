"""Rigid dumbbells in Brownian motion and shear: their viscosity beside theory. The virial alone is not the stress."""

import sys

import numpy as np

import holonomic as hol

N, KT, ZETA, X, DT = 3000, 1.0, 12.0, 0.3, 0.005  # the time of rotation, zeta a^2/(12 kT), is 1; X the rate of shear
dumbbells = hol.Molecules(np.full(2 * N, ZETA))  # frictions in place of masses
dumbbells.add_molecules(N, 2, [(0, 1)], 1.0)
rng = np.random.default_rng(5)


def driven(u):
    return 3 * u[:, 1] * (u[:, 0] / X + u[:, 1])


u = rng.normal(size=(N, 3))
u /= np.linalg.norm(u, axis=1)[:, None]
r = np.stack([0 * u, u], axis=1).reshape(-1, 3)
steps, warm = (900, 900) if "--quick" in sys.argv else (4000, 1200)
virial, kinetic, known = np.zeros(N), np.zeros(N), np.zeros(N)  # of each dumbbell: none knows of another one
for step in range(-warm, steps):
    if step == 0:
        first = driven(r[1::2] - r[::2])
    before, u = r.copy(), r[1::2] - r[::2]
    kick = np.sqrt(2 * KT * DT / ZETA) * rng.normal(size=r.shape)
    r += kick
    r[:, 0] += DT * X * before[:, 1]
    impulse = dumbbells.project_positions(before, r, np.sqrt(DT), multipliers=True, virial=True)
    if step < 0:
        continue
    xy = u[:, 0] * u[:, 1]
    of_bonds = -2 * impulse.lambda_ * xy
    np.testing.assert_allclose(of_bonds.sum(), impulse.virial[0, 1], rtol=1e-9)
    # Noise along the bonds is a part of the multipliers, whose mean is 0; that across them turns them: it dies out in the
    # time of rotation, and so does what it does to `driven`.
    d = kick[1::2] - kick[::2]
    along = np.einsum("ij,ij->i", d, u)
    d -= along[:, None] * u
    virial -= (of_bonds + 0.5 * ZETA / DT * along * xy) / (X * steps)
    kinetic += KT * xy / (X * steps)
    known += 3 * (d[:, 1] * (u[:, 0] / X + u[:, 1]) + u[:, 1] * (d[:, 0] / X + d[:, 1]))
known = (known - driven(r[1::2] - r[::2]) + first) / (steps * DT)
each = {"viscosity": virial + kinetic - known, "virial": virial - 2 / 3 * known, "kinetic part": kinetic - known / 3}
mean = {name: values.mean() for name, values in each.items()}
error = {name: values.std() / np.sqrt(N) for name, values in each.items()}
series, exact = 1 - 18 / 35 * X**2 + 1326 / 1925 * X**4, {"viscosity": 0.958641, "virial": 0.775974, "kinetic part": 0.182667}
print(f"in units of n kT lambda, at x = {X}: " + ", ".join(f"{name} {mean[name]:.4f} +- {error[name]:.4f}" for name in each)
      + f"; theory {exact['viscosity']}, its series {series:.4f}")
for name in each:  # four errors, and what steps of DT turn too far
    assert abs(mean[name] - exact[name]) < 4 * error[name] + 0.0025 and error[name] < 0.006, name
