"""Rigid water: constant energy, then constant pressure. 64 molecules of SPC/E with forces that go to zero at a cutoff.

Units: Angstrom, ps, atomic mass units; so energies are in amu A^2/ps^2 (1 kJ/mol is 100 of them).
"""

import sys

import numpy as np

import holonomic as hol

N, KT = 64, 0.00831446 * 300 * 100
CHARGE, COULOMB = np.array([-0.8476, 0.4238, 0.4238]), 1389.35458 * 100
EPSILON, SIGMA, CUTOFF = 0.650 * 100, 3.166, 6.0
MASSES = np.tile([15.9994, 1.008, 1.008], N)
CHARGES = np.tile(CHARGE, N)
PAIRS = np.array([(i, j) for i in range(3 * N) for j in range(i) if i // 3 != j // 3])
QQ = COULOMB * CHARGES[PAIRS[:, 0]] * CHARGES[PAIRS[:, 1]]
IS_OO = (PAIRS % 3 == 0).all(axis=1)
OH, HH = 1.0, 2 * np.sin(0.5 * np.radians(109.47))

water = hol.Molecules(MASSES)
water.add_molecules(N, 3, [(0, 1), (0, 2), (1, 2)], [OH, OH, HH])


def forces(r, side):
    """Energy, forces, and the trace of their virial; energy and force of a pair are 0 at the cutoff."""
    d = r[PAIRS[:, 0]] - r[PAIRS[:, 1]]
    d -= side * np.rint(d / side)
    near = np.einsum("ij,ij->i", d, d) < CUTOFF**2
    d, qq, oo, pairs = d[near], QQ[near], IS_OO[near], PAIRS[near]
    s = np.linalg.norm(d, axis=1)
    energy = qq * (1 / s - 1 / CUTOFF + (s - CUTOFF) / CUTOFF**2)
    f = qq * (1 / s**2 - 1 / CUTOFF**2)

    def lj(s):
        x = (SIGMA / s) ** 6
        return 4 * EPSILON * (x * x - x), 24 * EPSILON * (2 * x * x - x) / s

    at_cutoff, slope = lj(CUTOFF)
    u, g = lj(s[oo])
    energy[oo] += u - at_cutoff + slope * (s[oo] - CUTOFF)
    f[oo] += g - slope
    vector = (f / s)[:, None] * d
    result = np.zeros_like(r)
    for c in range(3):
        result[:, c] = np.bincount(pairs[:, 0], vector[:, c], len(r)) - np.bincount(pairs[:, 1], vector[:, c], len(r))
    return energy.sum(), result, (f * s).sum()


def start(side, rng):
    n = round(N ** (1 / 3))
    shape = np.array([(0, 0, 0), (OH, 0, 0), (OH * np.cos(np.radians(109.47)), OH * np.sin(np.radians(109.47)), 0)])
    r = []
    for k in range(N):
        q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        r.append(np.array([k // n**2, k // n % n, k % n]) * side / n + shape @ q)
    r = np.concatenate(r)
    v = rng.normal(size=r.shape) * np.sqrt(KT / MASSES)[:, None]
    water.box = side
    water.project_positions(r.copy(), r, 1)  # the angle has five digits only
    water.project_velocities(r, v)
    return r, v


def kinetic(v):
    return 0.5 * (MASSES[:, None] * v * v).sum()


def main(quick):
    rng = np.random.default_rng(1)
    side, dt, w = 12.42, 0.002, 1 / MASSES[:, None]
    freedoms = water.degrees_of_freedom() - 3
    assert freedoms == 6 * N - 3
    r, v = start(side, rng)
    energy, f, _ = forces(r, side)

    def step():
        nonlocal r, v, energy, f
        v += 0.5 * dt * w * f
        before = r.copy()
        r += dt * v
        water.project_positions(before, r, dt, v)
        energy, f, virial = forces(r, side)
        v += 0.5 * dt * w * f
        water.project_velocities(r, v)
        return virial

    for k in range(100 if quick else 600):  # to 300 K
        step()
        v *= np.sqrt(1 + 0.05 * (freedoms * KT / (2 * kinetic(v)) - 1))
        v -= (MASSES[:, None] * v).sum(axis=0) / MASSES.sum()

    # Constant energy
    total = []
    for k in range(50 if quick else 500):
        step()
        total.append(energy + kinetic(v))
    error = water.violation(r, v)
    print(f"constant energy, 2 fs: total {np.mean(total) / 100:.3f} kJ/mol, rms {np.std(total) / 100:.3f}; distances off by "
          f"{error.length:.1e}, rates by {error.rate:.1e}")
    assert np.std(total) < 0.02 * kinetic(v) and error.length < 1e-13

    # Constant pressure, 1 bar, by stochastic cell rescaling (Bernetti and Bussi 2020): docs/recipes.md, Barostats
    target, compressibility, tau = 6.022e-2, 4.5e-5 / 6.022e-2, 0.5
    volumes, pressures = [], []
    for k in range(40 if quick else 1500):
        virial = step()
        virial += np.trace(water.forces(r, v, f).virial)  # of the bonds: without it the pressure is nonsense
        volume = side**3
        pressure = (2 * kinetic(v) + virial) / (3 * volume)
        e = dt / tau * compressibility * (pressure - target) + rng.normal() * np.sqrt(
            2 * dt / tau * compressibility * KT / volume)
        s = np.exp(e / 3)
        before = r.copy()
        water.reference_box = side
        r *= s
        side *= s
        v /= s
        water.box = side
        water.project_positions(before, r, dt)
        water.reference_box = None
        water.project_velocities(r, v)
        energy, f, _ = forces(r, side)
        v *= np.sqrt(1 + 0.01 * (freedoms * KT / (2 * kinetic(v)) - 1))
        pressures.append(pressure)
        volumes.append(side**3)
    half = len(volumes) // 2
    density = MASSES.sum() / np.mean(volumes[half:]) * 1.66054
    print(f"constant pressure: density {density:.3f} g/cm3, pressure {np.mean(pressures[half:]) / 6.022e-2:.0f} bar "
          f"(an instant's scatters by {np.std(pressures) / 6.022e-2:.0f}); distances off by {water.violation(r, v).length:.1e}")
    assert 0.7 < density < 1.4 and water.violation(r, v).length < 1e-13


main("--quick" in sys.argv)
