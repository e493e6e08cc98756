"""Tensions of chains: one that hangs with a weight at its end, one that is whirled, and one that is pulled at a temperature."""

import sys

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

# Brownian, pulled by a force F at the end. Rods alone are no freely jointed chain: rho ~ sqrt(det Z) exp(F x/kT). The metric
# force takes the determinant away, and leaves Langevin's function. Both begin with chains that are drawn from exp(F x/kT).
F, kT, dt, friction, rods = 3.0, 1.0, 0.001, 1.0, 4
copies, warm, steps = (400, 3000, 1000) if "--quick" in sys.argv else (1000, 4000, 3000)
rng = np.random.default_rng(2)


def freely_jointed(n):
    cosine = 1 + kT / F * np.log(rng.uniform(np.exp(-2 * F / kT), 1, (n, rods)))
    angle, sine = rng.uniform(0, 2 * np.pi, (n, rods)), np.sqrt(1 - cosine**2)
    rod = np.stack([cosine, sine * np.cos(angle), sine * np.sin(angle)], axis=2)
    return np.concatenate([np.zeros((n, 1, 3)), np.cumsum(rod, axis=1)], axis=1).reshape(-1, 3)


def chains_of(n):
    masses = np.full(n * (rods + 1), friction)
    masses[:: rods + 1] = np.inf  # held on purpose
    chains = hol.Molecules(masses)
    chains.add_molecules(n, rods + 1, [(k, k + 1) for k in range(rods)], 1.0)
    return chains


def extension(r):
    return (r[rods :: rods + 1, 0] - r[:: rods + 1, 0]) / rods


drawn = freely_jointed(100000)
weight = np.exp(0.5 * chains_of(100000).metric(drawn, kT).log_det_z)
langevin = 1 / np.tanh(F / kT) - kT / F
of_rods = langevin + ((weight / weight.mean() - 1) * extension(drawn)).mean()

chains, start = chains_of(copies), freely_jointed(copies)
mobile = np.arange(len(start)) % (rods + 1) > 0
runs = {"jointed": start.copy(), "rods": start.copy()}
mean = {name: np.zeros(copies) for name in runs}  # of each chain: none knows of another one
for step in range(-warm, steps):
    noise = np.sqrt(2 * kT * dt / friction) * rng.normal(size=(mobile.sum(), 3))  # the same for both
    for name, r in runs.items():
        f = chains.metric(r, kT).forces if name == "jointed" else np.zeros_like(r)
        f[rods :: rods + 1, 0] += F
        before = r.copy()
        r[mobile] += dt / friction * f[mobile] + noise
        chains.project_positions(before, r, np.sqrt(dt))
        if step >= 0:
            mean[name] += extension(r) / steps


def show(what, each, theory):
    error = each.std() / np.sqrt(copies)
    print(f"pulled: {what} {each.mean():.4f} +- {error:.4f}, theory {theory:.4f}")
    assert abs(each.mean() - theory) < 4 * error, what
    return error


show("mean extension per bond, freely jointed by the metric force,", mean["jointed"], langevin)
show("of rods without it", mean["rods"], of_rods)
error = show("the difference, of the same noise,", mean["jointed"] - mean["rods"], langevin - of_rods)
assert error < 0.0025 and langevin - of_rods > 0.01
