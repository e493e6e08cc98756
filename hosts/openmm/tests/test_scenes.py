"""Scenes of OpenMM's own tests of constraints: chains, clusters, massless particles, virtual sites, minimisation, Drude particles."""

import itertools
import math
import unittest

import numpy as np
import openmm as mm
from openmm import unit

from holonomic_openmm import add_holonomic

mm.Platform.loadPluginsFromDirectory(mm.Platform.getDefaultPluginsDirectory())
NAMES = [mm.Platform.getPlatform(i).getName() for i in range(mm.Platform.getNumPlatforms())]
PLATFORMS = [name for name in ("Reference", "CPU") if name in NAMES]  # test_scenes_opencl.py has others: "OpenCL mixed"
ROOT2 = math.sqrt(2)


def custom():
    integrator = mm.CustomIntegrator(0.001)
    integrator.addPerDofVariable("x1", 0)
    integrator.addUpdateContextState()
    integrator.addComputePerDof("v", "v+0.5*dt*f/m")
    integrator.addComputePerDof("x", "x+dt*v")
    integrator.addComputePerDof("x1", "x")
    integrator.addConstrainPositions()
    integrator.addComputePerDof("v", "v+0.5*dt*f/m+(x-x1)/dt")
    integrator.addConstrainVelocities()
    return integrator


INTEGRATORS = {
    "verlet": lambda: mm.VerletIntegrator(0.001),
    "variable verlet": lambda: mm.VariableVerletIntegrator(1e-5),
    "langevin": lambda: mm.LangevinIntegrator(100, 2, 0.001),
    "langevin middle": lambda: mm.LangevinMiddleIntegrator(100, 2, 0.001),
    "variable langevin": lambda: mm.VariableLangevinIntegrator(100, 2, 1e-5),
    "brownian": lambda: mm.BrownianIntegrator(100, 20, 0.0005),
    "nose-hoover": lambda: mm.NoseHooverIntegrator(100, 5, 0.001),
    "custom": custom,
}


def charged(masses, charges):
    system = mm.System()
    force = mm.NonbondedForce()
    for mass, charge in zip(masses, charges):
        system.addParticle(mass)
        force.addParticle(charge, 0.5, 5.0 if mass else 0.0)
    system.addForce(force)
    return system


def chain():
    n = 8
    system = charged([5.0 if i % 2 else 10.0 for i in range(n)], [0.2 if i % 2 else -0.2 for i in range(n)])
    constraints = [(i, i + 1, 1.0) for i in range(n - 1)]
    r = np.zeros((n, 3))
    for i in range(1, n):
        r[i] = r[i - 1] + ((0.8, 0.6, 0), (0.8, -0.36, 0.48))[i % 2]
    return system, constraints, r


def cluster():
    """A tetrahedral group and two more, whose distances close cycles."""
    system = charged([1.0 if i else 5.0 for i in range(7)], [0.1 * (-1) ** i for i in range(7)])
    constraints = [(0, 1, 1.0), (0, 2, 1.0), (0, 3, 1.0), (0, 4, 1.0), (1, 5, 1.0), (1, 6, 1.0), (2, 3, ROOT2), (2, 4, ROOT2),
                   (3, 4, ROOT2), (5, 6, ROOT2)]
    r = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (-1, 0, 0), (1, 1, 0), (1, 0, -1)], float)
    return system, constraints, r


def waters():
    """27 rigid waters on weak springs."""
    system = charged([16.0, 1.0, 1.0] * 27, [-0.834, 0.417, 0.417] * 27)
    force, spring = system.getForce(0), mm.CustomExternalForce("20*(x*x+y*y+z*z)")
    water = np.array([(0, 0, 0), (0.09572, 0, 0), (-0.0239987, 0.0926627, 0)])
    rng, constraints, r = np.random.default_rng(6), [], []
    for first in range(0, 81, 3):
        force.setParticleParameters(first, -0.834, 0.315, 0.636)
        for other in (1, 2):
            force.setParticleParameters(first + other, 0.417, 1, 0)
        for i, j, length in (0, 1, 0.09572), (0, 2, 0.09572), (1, 2, 0.15139):
            force.addException(first + i, first + j, 0, 1, 0)
            constraints.append((first + i, first + j, length))
        spring.addParticle(first, [])
        place = np.array([first // 27, first // 9 % 3, first // 3 % 3]) * 0.31
        r += list(place + water @ np.linalg.qr(rng.normal(size=(3, 3)))[0])
    system.addForce(spring)
    return system, constraints, np.array(r)


def energies(context, samples, steps):
    found = []
    for _ in range(samples):
        context.getIntegrator().step(steps)
        state = context.getState(getEnergy=True)
        found.append((state.getKineticEnergy() + state.getPotentialEnergy())._value)
    return np.array(found)


def rounding(platform):
    """Bound of an error of bonds of 1 nm between coordinates of some nanometers."""
    return 4e-6 if platform.endswith("single") else 1e-13


def context_of(system, constraints, r, integrator, platform, velocities=None, holonomic=True):
    for i, j, length in constraints:
        system.addConstraint(i, j, length)
    if holonomic:
        add_holonomic(system)
    name, *precision = platform.split()
    context = mm.Context(system, integrator, mm.Platform.getPlatformByName(name), {"Precision": word for word in precision})
    context.setPositions(r)
    if velocities is not None:
        context.setVelocities(velocities)
        context.applyVelocityConstraints(1e-8)
    return context


def positions(context):
    return context.getState(getPositions=True).getPositions(asNumpy=True).value_in_unit(unit.nanometer)


def velocities(context):
    return context.getState(getVelocities=True).getVelocities(asNumpy=True)._value


def energy(context):
    return context.getState(getEnergy=True).getPotentialEnergy()._value


def free_force(context, constraints):
    """The root mean square of what is left of the forces when the part that constraints take up, by least squares, is gone."""
    r, force = positions(context), context.getState(getForces=True).getForces(asNumpy=True)._value
    gradients = np.zeros((len(constraints), len(r), 3))
    for k, (i, j, _) in enumerate(constraints):
        gradients[k, i], gradients[k, j] = r[i] - r[j], r[j] - r[i]
    gradients = gradients.reshape(len(constraints), -1).T
    left = force.ravel() - gradients @ np.linalg.lstsq(gradients, force.ravel(), rcond=None)[0]
    return np.sqrt(np.mean(left**2))


def worst(r, constraints):
    return max(abs(np.linalg.norm(r[i] - r[j]) / length - 1) for i, j, length in constraints)


class Scenes(unittest.TestCase):
    def test_chains_and_clusters_with_every_integrator(self):
        for platform in PLATFORMS:
            for make in (chain, cluster):
                for name, integrator in INTEGRATORS.items():
                    with self.subTest(platform=platform, scene=make.__name__, integrator=name):
                        system, constraints, r = make()
                        start = np.random.default_rng(1).uniform(-0.5, 0.5, r.shape)
                        context = context_of(system, constraints, r, integrator(), platform, start)
                        for _ in range(10):
                            context.getIntegrator().step(20)
                            self.assertLess(worst(positions(context), constraints), rounding(platform))
                        self.assertGreater(np.abs(positions(context) - r).max(), 1e-3)

    def test_energy_of_chains_and_clusters(self):
        for platform in PLATFORMS:
            for make in (chain, cluster):
                with self.subTest(platform=platform, scene=make.__name__):
                    system, constraints, r = make()
                    start = np.random.default_rng(1).uniform(-0.5, 0.5, r.shape)
                    context = context_of(system, constraints, r, mm.VerletIntegrator(0.001), platform, start)
                    self.assertLess(np.ptp(energies(context, 50, 20)), 0.01)

    def test_energy_of_waters_does_not_drift(self):
        for platform in PLATFORMS:
            with self.subTest(platform=platform):
                system, constraints, r = waters()
                context = context_of(system, constraints, r, mm.VerletIntegrator(0.001), platform, np.zeros(r.shape))
                context.setVelocitiesToTemperature(300, 3)
                found = energies(context, 100, 40)
                slope, at_first = np.polyfit(range(100), found, 1)
                # In kJ/mol; on the platform CPU 0.08 and 0.07, by the length of the step.
                self.assertLess(abs(100 * slope), 0.16)
                self.assertLess(np.std(found - slope * np.arange(100) - at_first), 0.14)

    def test_temperature_of_waters(self):
        for platform in PLATFORMS:
            with self.subTest(platform=platform):
                system, constraints, r = waters()
                integrator = mm.LangevinMiddleIntegrator(300, 20, 0.002)
                integrator.setRandomNumberSeed(4)
                context = context_of(system, constraints, r, integrator, platform)
                integrator.step(500)
                kinetic = []
                for _ in range(300):
                    integrator.step(10)
                    kinetic.append(context.getState(getEnergy=True).getKineticEnergy()._value)
                # Six freedoms a water; 300 samples, of which half count, scatter by 0.11 each.
                self.assertAlmostEqual(np.mean(kinetic) / (27 * 3 * 0.0083144626 * 300), 1, delta=0.05)

    def test_velocities_on_the_constraints(self):
        for platform in PLATFORMS:
            for make in (chain, cluster):
                system, constraints, r = make()
                start = np.random.default_rng(2).uniform(-0.5, 0.5, r.shape)
                context = context_of(system, constraints, r, custom(), platform, start)
                context.getIntegrator().step(50)
                r, v = positions(context), velocities(context)
                for i, j, length in constraints:
                    self.assertLess(abs((r[i] - r[j]) @ (v[i] - v[j])), rounding(platform))

    def test_a_constraint_of_a_massless_particle_with_one_that_has_mass_is_refused(self):
        for platform in PLATFORMS:
            with self.assertRaises(mm.OpenMMException):
                context_of(charged([0.0, 1.0], [0, 0]), [(0, 1, 1.5)], [(-1, 0, 0), (1, 0, 0)], mm.VerletIntegrator(0.01), platform)

    def test_massless_particles_alone(self):
        for platform in PLATFORMS:
            for name, integrator in INTEGRATORS.items():
                if name.startswith("variable"):
                    continue  # their error of a step is over the masses
                with self.subTest(platform=platform, integrator=name):
                    r = np.array([(-1.0, 0, 0), (1.0, 0, 0)])
                    context = context_of(charged([0.0, 0.0], [0.2, -0.2]), [(0, 1, 1.5)], r, integrator(), platform,
                                         np.zeros((2, 3)))
                    context.getIntegrator().step(2)
                    np.testing.assert_array_equal(positions(context), r)
                    np.testing.assert_array_equal(velocities(context), 0)
                    context.applyConstraints(1e-6)
                    context.applyVelocityConstraints(1e-6)
                    np.testing.assert_array_equal(positions(context), r)

    def test_massless_pairs_beside_molecules(self):
        for platform in PLATFORMS:
            for name, integrator in INTEGRATORS.items():
                if name.startswith("variable") and platform not in ("Reference", "CPU"):
                    continue  # with OpenMM's own constraints, too, the first step is infinite there
                with self.subTest(platform=platform, integrator=name):
                    system = charged([0.0, 0.0, 2.0, 3.0], [0.2, -0.2, 0.1, -0.1])
                    r = np.array([(-2.0, 0, 0), (2.0, 0, 0), (0, 0, 0), (0, 1.0, 0)])
                    start = np.zeros((4, 3))
                    start[3] = (0.5, 0, 0)
                    context = context_of(system, [(0, 1, 1.5), (2, 3, 1.0)], r, integrator(), platform, start)
                    context.getIntegrator().step(100)
                    np.testing.assert_array_equal(positions(context)[:2], r[:2])
                    self.assertLess(worst(positions(context), [(2, 3, 1.0)]), rounding(platform))
                    self.assertGreater(np.abs(positions(context)[2:] - r[2:]).max(), 1e-4)

    def test_virtual_sites(self):
        for platform in PLATFORMS:
            for name, integrator in INTEGRATORS.items():
                with self.subTest(platform=platform, integrator=name):
                    system = charged([16.0, 1.0, 1.0, 0.0], [0.0, 0.5, 0.5, -1.0])
                    force = system.getForce(0)
                    for i in range(4):
                        for j in range(i):
                            force.addException(i, j, 0, 1, 0)
                    system.setVirtualSite(3, mm.ThreeParticleAverageSite(0, 1, 2, 0.786646558, 0.106676721, 0.106676721))
                    pull = mm.CustomExternalForce("3*x*x-2*y")
                    pull.addParticle(3, [])
                    system.addForce(pull)
                    r = np.array([(0, 0, 0), (0.9572, 0, 0), (-0.2399872, 0.9266272, 0), (0, 0, 0)])
                    constraints = [(0, 1, 0.9572), (0, 2, 0.9572), (1, 2, np.linalg.norm(r[1] - r[2]))]
                    context = context_of(system, constraints, r, integrator(), platform, np.zeros((4, 3)))
                    context.computeVirtualSites()
                    context.getIntegrator().step(100)
                    now = positions(context)
                    self.assertLess(worst(now, constraints), rounding(platform))
                    site = 0.786646558 * now[0] + 0.106676721 * (now[1] + now[2])
                    # OpenMM places the site: in mixed precision by weights in single.
                    bound = 1e-6 if platform.endswith("mixed") else 10 * rounding(platform)
                    np.testing.assert_allclose(now[3], site, atol=bound)

    def test_minimisation(self):
        for platform in PLATFORMS:
            for make in (chain, cluster):
                with self.subTest(platform=platform, scene=make.__name__):
                    system, constraints, r = make()
                    context = context_of(system, constraints, r, mm.VerletIntegrator(0.001), platform)
                    before, slope = energy(context), free_force(context, constraints)
                    mm.LocalEnergyMinimizer.minimize(context, 0.1)
                    self.assertLess(energy(context), before - 1e-3)
                    self.assertLess(free_force(context, constraints), 0.5 * slope)
                    self.assertLess(worst(positions(context), constraints), rounding(platform))
                    if platform != "Reference":
                        continue  # forces of float: one more rounding leads to another minimum, with OpenMM's own constraints as well
                    # The minimum of OpenMM's own constraints, up to what the minimiser leaves.
                    system, constraints, r = make()
                    own = context_of(system, constraints, r, mm.VerletIntegrator(0.001), platform, holonomic=False)
                    mm.LocalEnergyMinimizer.minimize(own, 0.1)
                    self.assertAlmostEqual(energy(context), energy(own), delta=0.02 * (before - energy(context)))

    @unittest.skipUnless(hasattr(mm, "DrudeForce"), "this OpenMM has no Drude particles")
    def test_drude_water(self):
        makers = lambda: mm.DrudeLangevinIntegrator(300, 20, 1, 20, 0.0005), lambda: mm.DrudeSCFIntegrator(0.0005)
        for platform, make in itertools.product(PLATFORMS, makers):
            system = mm.System()
            nonbonded, drude = mm.NonbondedForce(), mm.DrudeForce()
            r, constraints = [], []
            for m in range(8):
                first = 5 * m
                for mass in (15.6, 0.4, 1.0, 1.0, 0.0):
                    system.addParticle(mass)
                for charge in (1.71636, -1.71636, 0.55733, 0.55733, -1.11466):
                    nonbonded.addParticle(charge, 0.318395 if charge == 1.71636 else 1, 0.21094 * 4.184 if charge == 1.71636 else 0)
                for i in range(5):
                    for j in range(i):
                        nonbonded.addException(first + i, first + j, 0, 1, 0)
                drude.addParticle(first + 1, first, -1, -1, -1, -1.71636, 0.001042542, 1, 1)
                system.setVirtualSite(first + 4, mm.ThreeParticleAverageSite(first, first + 2, first + 3, 0.786646558,
                                                                             0.106676721, 0.106676721))
                constraints += [(first, first + 2, 0.09572), (first, first + 3, 0.09572), (first + 2, first + 3, 0.15139)]
                at = np.array([m // 4, m // 2 % 2, m % 2]) * 0.4
                r += [at, at, at + (0.09572, 0, 0), at + (-0.023999, 0.092663, 0), at]
            system.addForce(nonbonded)
            system.addForce(drude)
            context = context_of(system, constraints, np.array(r), make(), platform)
            context.applyConstraints(1e-6)
            context.computeVirtualSites()
            context.setVelocitiesToTemperature(300, 1)
            context.getIntegrator().step(100)
            self.assertLess(worst(positions(context), constraints), rounding(platform))
            self.assertGreater(np.abs(positions(context) - r).max(), 1e-3)


if __name__ == "__main__":
    unittest.main()
