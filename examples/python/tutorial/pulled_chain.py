"""Tensions of chains: one that hangs with a weight at its end, one that is whirled, and one that is pulled at a temperature."""

import numpy as np

import holonomic as hol

N = 20
masses = np.ones(N + 1)
masses[0] = np.inf  # held fixed
chain = hol.Molecules(masses)
chain.add([(k, k + 1) for k in range(N)], 1.0)

# At rest under its weight and a force at its end: each bond bears what hangs below it.
r = np.zeros((N + 1, 3))
r[:, 2] = -np.arange(N + 1)
f = np.zeros_like(r)
f[:, 2] = -9.81
f[-1, 2] -= 50
tensions = chain.forces(r, None, f).tensions
expected = 50 + 9.81 * np.arange(N, 0, -1)
print("hanging: tensions", " ".join(f"{t:.2f}" for t in tensions[::5]), "..")
np.testing.assert_allclose(tensions, expected, rtol=1e-13)

# Whirled about its end at a rate: m omega^2 times the sum of the radii outside.
v = np.zeros_like(r)
v[:, 0] = 3.0 * r[:, 2]
tensions = chain.forces(r, v).tensions
print("whirled: tensions", " ".join(f"{t:.1f}" for t in tensions[::5]), "..")
np.testing.assert_allclose(tensions, [9 * sum(range(k, N + 1)) for k in range(1, N + 1)], rtol=1e-12)

# Brownian, pulled by a force F at the end, with the metric force so that it is freely jointed: Langevin's function.
F, kT, dt, copies = 3.0, 1.0, 0.001, 300
rods, friction = 4, 1.0
masses = np.full(copies * (rods + 1), friction)
masses[:: rods + 1] = np.inf
chains = hol.Molecules(masses)
chains.add_molecules(copies, rods + 1, [(k, k + 1) for k in range(rods)], 1.0)
rng = np.random.default_rng(2)
r = np.tile(np.arange(rods + 1.0)[:, None] * (1, 0, 0), (copies, 1))
mobile = np.isfinite(masses)
extension = []
for step in range(9000):
    f = chains.metric(r, kT).forces.copy()
    f[rods :: rods + 1, 0] += F
    before = r.copy()
    r[mobile] += dt / friction * f[mobile] + np.sqrt(2 * kT * dt / friction) * rng.normal(size=(mobile.sum(), 3))
    chains.project_positions(before, r, np.sqrt(dt))
    if step > 4000:
        extension.append((r[rods :: rods + 1, 0] - r[:: rods + 1, 0]).mean() / rods)
langevin = 1 / np.tanh(F / kT) - kT / F
print(f"pulled: mean extension per bond {np.mean(extension):.4f}, of freely jointed chains {langevin:.4f}")
assert abs(np.mean(extension) - langevin) < 0.02
