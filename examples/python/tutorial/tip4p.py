"""TIP4P: a rigid body of O, H, H and the massless M, whose force goes to the others; with a thermostat (g-BAOAB)."""

import sys

import numpy as np

import holonomic as hol

N, KT, FRICTION, DT = 50, 2.4943, 2.0, 0.004  # waters that don't see each other; kJ/mol, ps; A: forces / 100
OH, OM, HALF = 0.9572, 0.1546, np.radians(52.26)
SHAPE = np.array([(0, 0, 0), (OH * np.cos(HALF), OH * np.sin(HALF), 0), (OH * np.cos(HALF), -OH * np.sin(HALF), 0), (OM, 0, 0)])
MASSES = np.tile([15.9994, 1.008, 1.008, 0], N)
W = np.divide(1, MASSES, out=np.zeros(4 * N), where=MASSES > 0)[:, None] * 100

water = hol.Molecules(MASSES / 100)  # kJ/mol, A and ps then fit
water.add_rigid_molecules(N, 4, [[0, 1, 2, 3]], [SHAPE])
assert water.degrees_of_freedom() == 6 * N


def force(r):
    """A spring at each M, and a field that turns the dipoles; added: what M's force does to O and H."""
    f = np.zeros_like(r)
    f[3::4] = -3 * (r[3::4] - HOME)
    f[1::4, 2] += 2
    f[2::4, 2] += 2
    f[3::4, 2] -= 4
    energy = 1.5 * ((r[3::4] - HOME) ** 2).sum() - 2 * (r[1::4, 2] + r[2::4, 2] - 2 * r[3::4, 2]).sum()
    water.spread_forces(r, f)
    return energy, f


rng = np.random.default_rng(4)
HOME = 10.0 * np.arange(N)[:, None] * (1, 0, 0)
r = (HOME[:, None] + SHAPE - SHAPE[3]).reshape(-1, 3)
v = rng.normal(size=r.shape) * np.sqrt(KT * W)
water.project_velocities(r, v)
energy, f = force(r)


def kinetic():
    return 0.5 * (np.where(W > 0, v * v / np.where(W > 0, W, 1), 0)).sum()


def half_kick():
    global v
    v += 0.5 * DT * W * f
    water.project_velocities(r, v)


def half_drift():
    global r
    before = r.copy()
    r += 0.5 * DT * v
    water.project_positions(before, r, 0.5 * DT, v)
    water.project_velocities(r, v)


# Without the bath: the energy holds, for M's force is not lost.
total = []
for _ in range(300):
    v += 0.5 * DT * W * f
    before = r.copy()
    r += DT * v
    water.project_positions(before, r, DT, v)
    energy, f = force(r)
    half_kick()
    total.append(energy + kinetic())
print(f"constant energy: {np.mean(total):.2f} kJ/mol, rms {np.std(total):.4f}")
assert np.std(total) < 2e-3 * kinetic()

c = np.exp(-FRICTION * DT)
kinetics, potentials = [], []
steps = 1500 if "--quick" in sys.argv else 6000
for step in range(steps):
    half_kick()
    half_drift()
    v = c * v + np.sqrt((1 - c * c) * KT * W) * rng.normal(size=r.shape)
    water.project_velocities(r, v)
    half_drift()
    energy, f = force(r)
    half_kick()
    if step >= steps // 5:
        kinetics.append(kinetic())
        potentials.append(1.5 * ((r[3::4] - HOME) ** 2).sum())
temperature = 2 * np.mean(kinetics) / (6 * N) / 0.00831446
spring = np.mean(potentials) / (1.5 * N * KT)
print(f"with the bath: {temperature:.1f} K of 300; the springs' energy is {spring:.3f} of 3/2 kT each; sites where they belong to "
      f"{water.violation(r, v).length:.1e}")
assert abs(temperature - 300) < 9 and abs(spring - 1) < 0.1 and water.violation(r, v).length < 1e-13
