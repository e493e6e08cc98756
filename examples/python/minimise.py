"""Minimisation with rigid bonds: projected gradient, FIRE and L-BFGS on a chain that hangs between two fixed points.

    minimise.py

All three need the same of the library: the force along the constraints, f + G with G of `forces` at rest; a way back after a
move, `project_positions` with the positions before it; and, for what is remembered of earlier steps, `project_velocities`, which
takes from any vector what the bonds forbid. Masses are 1 here, so that all of these mean the same distance. The energy at the end is
compared with the exact one. examples/recipes/minimise.c is the same in C.
"""

import sys

import numpy as np

import holonomic as hol

BONDS, SPAN = 20, 14.0
mass = np.ones(BONDS + 1)
mass[[0, -1]] = 0  # held fixed
free = mass > 0
weight = np.array([0, 0, -1.0])
molecules = hol.Molecules(mass)
molecules.add([(k, k + 1) for k in range(BONDS)], lengths=1.0)


def energy(r):
    return r[free, 2].sum()


def force(r):
    """Along the constraints."""
    f = np.where(free[:, None], weight, 0)
    return np.where(free[:, None], f + molecules.forces(r, None, f).forces, 0)


def moved(r, by, v=None, dt=1.0):
    """r + by, back on the constraints; None where no lengths can be reached from there, and a shorter step is due."""
    to = r + by
    try:
        molecules.project_positions(r, to, dt, v)
    except (hol.NoConvergenceError, hol.LengthsError):
        return None
    return to


def start():
    """Two straight halves."""
    x = np.arange(BONDS + 1) * SPAN / BONDS
    depth = np.sqrt(1 - (SPAN / BONDS) ** 2)
    return np.column_stack([x, 0 * x, -depth * np.minimum(np.arange(BONDS + 1), np.arange(BONDS, -1, -1))])


def projected_gradient(r):
    steps, step = 0, 0.01
    while np.linalg.norm(f := force(r)) > 1e-6 and step > 1e-12:
        to = moved(r, step * f)
        if to is not None and energy(to) < energy(r):
            r, step = to, 1.1 * step
        else:
            step *= 0.5
        steps += 1
    return r, steps


def fire(r):
    """Bitzek et al. 2006: molecular dynamics that turns velocities downhill."""
    v, dt, mixing, downhill, steps = np.zeros_like(r), 0.05, 0.1, 0, 0
    while np.linalg.norm(f := force(r)) > 1e-7:
        if np.vdot(f, v) > 0:
            v = (1 - mixing) * v + mixing * np.linalg.norm(v) / np.linalg.norm(f) * f
            downhill += 1
            if downhill > 5:
                dt, mixing = min(1.1 * dt, 0.5), 0.99 * mixing
        else:
            v, dt, mixing, downhill = np.zeros_like(r), 0.5 * dt, 0.1, 0
        v += dt * f
        to = moved(r, dt * v, v, dt)
        steps += 1
        if to is None:  # too long a step: from rest, with a shorter one
            v, dt = np.zeros_like(r), 0.5 * dt
            continue
        r = to
        molecules.project_velocities(r, v)
    return r, steps


def lbfgs(r, memory=8):
    """Nocedal 1980. Steps and changes of the gradient of earlier points are projected where they are used."""
    pairs, f, steps = [], force(r), 0
    while np.linalg.norm(f) > 1e-7:
        p, factors = f.copy(), []
        for s, y in reversed(pairs):
            factors.append(np.vdot(s, p) / np.vdot(s, y))
            p -= factors[-1] * y
        p *= np.vdot(*pairs[-1]) / np.vdot(pairs[-1][1], pairs[-1][1]) if pairs else 0.1
        for (s, y), factor in zip(pairs, reversed(factors)):
            p += (factor - np.vdot(y, p) / np.vdot(s, y)) * s
        molecules.project_velocities(r, p)
        step, slope = 1.0, np.vdot(p, f)
        while step > 1e-6 and ((to := moved(r, step * p)) is None or energy(to) > energy(r) - 1e-4 * step * slope):
            step *= 0.5
        steps += 1
        if slope <= 0 or step <= 1e-6:
            if not pairs:
                break
            pairs = []  # what was remembered misleads: from the gradient again
            continue
        f_to = force(to)
        pairs = pairs[1 - memory:] + [(to - r, f)]
        for s, y in pairs:
            molecules.project_velocities(to, s)
            molecules.project_velocities(to, y)
        pairs[-1] = (pairs[-1][0], pairs[-1][1] - f_to)
        pairs = [(s, y) for s, y in pairs if np.vdot(s, y) > 1e-10 * np.linalg.norm(s) * np.linalg.norm(y)]
        r, f = to, f_to
    return r, steps


def exact_energy():
    """Horizontal tension H: the slope of bond k is (k - (BONDS - 1)/2) / H, and all bonds together span the gap."""
    up = np.arange(BONDS) - 0.5 * (BONDS - 1)
    low, high = 1e-3, 1e3
    for _ in range(200):
        H = 0.5 * (low + high)
        low, high = (H, high) if (H / np.hypot(H, up)).sum() < SPAN else (low, H)
    return np.cumsum((up / np.hypot(low, up))[:-1]).sum()


exact, wrong = exact_energy(), 0
for way in projected_gradient, fire, lbfgs:
    r, steps = way(start())
    off = abs(energy(r) - exact)
    print(f"{way.__name__}: {steps} steps, energy {energy(r):.12f}, off by {off:.1e}, bonds by {molecules.violation(r).length:.1e}")
    wrong += not (off < 1e-11 and molecules.violation(r).length < 1e-13)
sys.exit(wrong)
