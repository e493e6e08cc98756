"""All bonds and angles as a topology has them, with rounded lengths: straight, flat and rigid groups, alone and sharing atoms."""

import itertools
import unittest

import numpy as np
import openmm as mm
from test_scenes import PLATFORMS, charged, context_of, positions, velocities

CORNERS = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) / np.sqrt(3)


def carbon_dioxide():
    return [16, 12, 16], [(-0.1162, 0, 0), (0, 0, 0), (0.1162, 0, 0)], [(0, 1), (1, 2)]


def nitrate():
    angles = 2 * np.pi / 3 * np.arange(3)
    return [14, 16, 16, 16], [(0, 0, 0)] + [(0.1256 * np.cos(a), 0.1256 * np.sin(a), 0) for a in angles], [(0, 1), (0, 2), (0, 3)]


def acetonitrile():
    r = [np.zeros(3), 0.1458 * CORNERS[0], (0.1458 + 0.1157) * CORNERS[0]] + [0.1087 * corner for corner in CORNERS[1:]]
    return [12, 12, 14, 1, 1, 1], r, [(0, 1), (1, 2), (0, 3), (0, 4), (0, 5)]


def ethane():
    r = [np.zeros(3), 0.1529 * CORNERS[0]] + [0.109 * corner for corner in CORNERS[1:]]
    r += [r[1] - 0.109 * corner for corner in CORNERS[1:]]
    return [12, 12, 1, 1, 1, 1, 1, 1], r, [(0, 1), (0, 2), (0, 3), (0, 4), (1, 5), (1, 6), (1, 7)]


def distances(r, bonds, decimals):
    """Of all bonds and angles."""
    near = {i: [j for bond in bonds for j in bond if i in bond and j != i] for i in range(len(r))}
    pairs = {tuple(sorted(bond)) for bond in bonds}
    pairs |= {tuple(sorted(pair)) for partners in near.values() for pair in itertools.combinations(partners, 2)}
    return [(i, j, round(float(np.linalg.norm(np.subtract(r[i], r[j]))), decimals)) for i, j in sorted(pairs)]


class Topologies(unittest.TestCase):
    def test_all_bonds_and_angles(self):
        for platform in PLATFORMS:
            for make in (carbon_dioxide, nitrate, acetonitrile, ethane):
                for decimals in (3, 4, 5):
                    with self.subTest(platform=platform, molecule=make.__name__, decimals=decimals):
                        self.check(platform, make, decimals)

    def check(self, platform, make, decimals):
        masses, r, bonds = make()
        kept = distances(r, bonds, decimals)
        r = np.array(r, dtype=float) @ np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0].T
        system = charged(masses, [0.0] * len(masses))
        system.removeForce(0)
        spring = mm.CustomExternalForce("5*(x-0.1)^2+3*y^2+4*z^2+x*y")
        for i in range(len(masses)):
            spring.addParticle(i, [])
        system.addForce(spring)
        context = context_of(system, kept, r, mm.VerletIntegrator(0.001), platform)
        context.applyConstraints(1e-8)
        start = positions(context)
        context.setVelocities(np.random.default_rng(4).uniform(-0.5, 0.5, r.shape))
        context.applyVelocityConstraints(1e-8)
        energies = []
        for _ in range(10):
            context.getIntegrator().step(50)
            x, v, state = positions(context), velocities(context), context.getState(getEnergy=True)
            energies.append((state.getKineticEnergy() + state.getPotentialEnergy())._value)
            for i, j, length in kept:
                now, before = np.linalg.norm(x[i] - x[j]), np.linalg.norm(start[i] - start[j])
                self.assertLess(abs(now - before), 1e-13)
                self.assertLess(abs(now - length), 3 * 10.0**-decimals)  # implied ones have the errors of the others
        self.assertLess(np.ptp(energies), 0.01)


if __name__ == "__main__":
    unittest.main()
