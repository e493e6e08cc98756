"""OpenMM with its constraints solved by holonomic: all integrators, both platforms, and what OpenMM's own cannot."""

import copy
import unittest

import numpy as np
import openmm as mm
from openmm import unit

from holonomic_openmm import add_holonomic

mm.Platform.loadPluginsFromDirectory(mm.Platform.getDefaultPluginsDirectory())
PLATFORMS = [name for name in ("Reference", "CPU")
             if name in [mm.Platform.getPlatform(i).getName() for i in range(mm.Platform.getNumPlatforms())]]


def chain(rng, n=12, masses=None):
    """A zigzag chain with a side atom at every third, all bonds constrained, on weak springs to the origin."""
    r = np.zeros((n, 3))
    pairs = []
    for i in range(1, n):
        parent = i - 2 if i % 3 == 2 and i > 2 else i - 1
        step = rng.normal(size=3)
        r[i] = r[parent] + 0.15 * step / np.linalg.norm(step)
        pairs.append((parent, i))
    masses = rng.uniform(1, 16, n) if masses is None else masses
    return r, pairs, masses


def system_of(r, pairs, masses, holonomic):
    system = mm.System()
    for mass in masses:
        system.addParticle(mass)
    for i, j in pairs:
        system.addConstraint(int(i), int(j), float(np.linalg.norm(r[i] - r[j])))
    spring = mm.CustomExternalForce("200*(x*x+2*y*y+0.5*z*z)")
    for i in range(len(r)):
        spring.addParticle(i, [])
    system.addForce(spring)
    if holonomic:
        add_holonomic(system)
    return system


def positions(context):
    return context.getState(getPositions=True).getPositions(asNumpy=True).value_in_unit(unit.nanometer)


def velocities(context):
    return context.getState(getVelocities=True).getVelocities(asNumpy=True)._value


def error(context, pairs, r0):
    r = positions(context)
    return max(abs(np.linalg.norm(r[i] - r[j]) / np.linalg.norm(r0[i] - r0[j]) - 1) for i, j in pairs)


def started(system, integrator, r, v, platform="Reference"):
    context = mm.Context(system, integrator, mm.Platform.getPlatformByName(platform))
    context.setPositions(r)
    context.setVelocities(v)
    context.applyVelocityConstraints(1e-8)
    return context


class Trajectories(unittest.TestCase):
    def test_are_openmms_own_at_a_tight_tolerance(self):
        for platform in PLATFORMS:
            rng = np.random.default_rng(1)
            r, pairs, masses = chain(rng)
            v = rng.normal(size=r.shape)
            ends = []
            for holonomic in (False, True):
                integrator = mm.VerletIntegrator(0.001)
                integrator.setConstraintTolerance(1e-12)
                context = started(system_of(r, pairs, masses, holonomic), integrator, r, v, platform)
                integrator.step(100)
                ends.append((positions(context), velocities(context)))
            np.testing.assert_allclose(ends[0][0], ends[1][0], atol=1e-8)
            np.testing.assert_allclose(ends[0][1], ends[1][1], atol=1e-6)

    def test_of_every_integrator_keep_the_bonds(self):
        custom = mm.CustomIntegrator(0.001)
        custom.addPerDofVariable("x1", 0)
        custom.addComputePerDof("v", "v+0.5*dt*f/m")
        custom.addComputePerDof("x", "x+dt*v")
        custom.addComputePerDof("x1", "x")
        custom.addConstrainPositions()
        custom.addComputePerDof("v", "v+0.5*dt*f/m+(x-x1)/dt")
        custom.addConstrainVelocities()
        for integrator in (mm.VerletIntegrator(0.002), mm.LangevinIntegrator(300, 5, 0.002),
                           mm.LangevinMiddleIntegrator(300, 5, 0.002), mm.BrownianIntegrator(300, 100, 0.0005),
                           mm.VariableVerletIntegrator(1e-4), mm.VariableLangevinIntegrator(300, 5, 1e-4),
                           mm.NoseHooverIntegrator(300, 5, 0.001), custom):
            with self.subTest(integrator=type(integrator).__name__):
                rng = np.random.default_rng(2)
                r, pairs, masses = chain(rng)
                integrator.setConstraintTolerance(1e-4)  # not looked at
                context = started(system_of(r, pairs, masses, True), integrator, r, rng.normal(size=r.shape))
                integrator.step(100)
                self.assertGreater(abs(positions(context) - r).max(), 1e-3)
                self.assertLess(error(context, pairs, r), 1e-14)

    def test_velocities_are_made_tangent(self):
        rng = np.random.default_rng(3)
        r, pairs, masses = chain(rng)
        context = started(system_of(r, pairs, masses, True), mm.VerletIntegrator(0.001), r, rng.normal(size=r.shape))
        v = velocities(context)
        for i, j in pairs:
            self.assertLess(abs(np.dot(r[i] - r[j], v[i] - v[j])), 1e-15)

    def test_energy_is_conserved(self):
        rng = np.random.default_rng(4)
        r, pairs, masses = chain(rng)
        integrator = mm.VerletIntegrator(0.0005)
        context = started(system_of(r, pairs, masses, True), integrator, r, rng.normal(size=r.shape))
        energies = []
        for _ in range(200):
            integrator.step(20)
            state = context.getState(getEnergy=True)
            energies.append((state.getKineticEnergy() + state.getPotentialEnergy())._value)
        self.assertLess(np.std(energies), 2e-3 * abs(np.mean(energies)))


class Molecules(unittest.TestCase):
    # Three beads close together and a heavy one, two triangles that share an edge, as cholesterol has them in Martini.
    R = np.array([(0, 0, 0), (0.28, 0.04, -0.07), (-0.19, 0.10, 0.10), (0.03, 0.23, -0.13)])
    PAIRS = [(0, 1), (0, 2), (1, 2), (1, 3), (2, 3)]
    MASSES = [72.0, 72.0, 72.0, 600.0]

    def test_two_triangles_for_which_ccma_does_not_converge(self):
        rng = np.random.default_rng(5)
        v = rng.normal(size=(4, 3)) * np.sqrt(2.5 / np.array(self.MASSES))[:, None]
        errors = []
        for holonomic in (False, True):
            integrator = mm.VerletIntegrator(0.02)
            context = started(system_of(self.R, self.PAIRS, self.MASSES, holonomic), integrator, self.R, v)
            integrator.step(1 if not holonomic else 500)
            errors.append(error(context, self.PAIRS, self.R))
        self.assertFalse(errors[0] < 1)  # what makes it worth a test
        self.assertLess(errors[1], 1e-14)

    def test_water_with_a_virtual_site_beside_a_chain(self):
        rng = np.random.default_rng(6)
        r, pairs, masses = chain(rng)
        water = np.array([(0, 0, 0), (0.09572, 0, 0), (-0.023999, 0.092663, 0)]) + 2
        site = 0.786646558 * water[0] + 0.106676721 * (water[1] + water[2])
        all_r = np.concatenate([r, water, [site]])
        first = len(r)
        all_pairs = pairs + [(first, first + 1), (first, first + 2), (first + 1, first + 2)]
        system = system_of(all_r, all_pairs, list(masses) + [16.0, 1.0, 1.0, 0.0], True)
        system.setVirtualSite(first + 3, mm.ThreeParticleAverageSite(first, first + 1, first + 2, 0.786646558, 0.106676721,
                                                                     0.106676721))
        integrator = mm.LangevinMiddleIntegrator(300, 1, 0.001)
        context = started(system, integrator, all_r, np.zeros_like(all_r))
        integrator.step(200)
        self.assertLess(error(context, all_pairs, all_r), 1e-14)
        now = positions(context)[first:]
        np.testing.assert_allclose(now[3], 0.786646558 * now[0] + 0.106676721 * (now[1] + now[2]), atol=1e-12)

    def test_particles_without_mass_stay(self):
        rng = np.random.default_rng(7)
        r, pairs, masses = chain(rng)
        held = np.array([(1.0, 1, 1), (1.1, 1, 1)])
        all_r = np.concatenate([r, held])
        system = system_of(all_r, pairs + [(12, 13)], list(masses) + [0.0, 0.0], True)
        integrator = mm.VerletIntegrator(0.002)
        context = started(system, integrator, all_r, np.concatenate([rng.normal(size=r.shape), np.zeros((2, 3))]))
        integrator.step(50)
        np.testing.assert_array_equal(positions(context)[12:], held)
        self.assertLess(error(context, pairs, r), 1e-14)

    def test_constraints_that_depend_on_each_other_are_rigid_bodies(self):
        rng = np.random.default_rng(8)
        five = rng.normal(size=(5, 3))  # ten distances between five particles, which have nine freedoms
        line = np.array([(0, 0, 0), (0.1, 0, 0), (0.2, 0, 0.0)])  # three distances on a line
        for r in five, line:
            pairs = [(i, j) for i in range(len(r)) for j in range(i)]
            for platform in PLATFORMS:
                integrator = mm.VerletIntegrator(0.001)
                context = started(system_of(r, pairs, [1.0] * len(r), True), integrator, r,
                                  rng.normal(size=r.shape), platform)
                integrator.step(50)
                self.assertGreater(np.abs(positions(context) - r).max(), 1e-3)
                self.assertLess(error(context, pairs, r), 1e-14)

    def test_constraints_that_fit_no_places_are_refused(self):
        r = np.random.default_rng(8).normal(size=(5, 3))
        pairs = [(i, j) for i in range(5) for j in range(i)]
        system = system_of(r, pairs, [1.0] * 5, True)
        system.setConstraintParameters(3, *pairs[3], 1.1 * float(np.linalg.norm(r[pairs[3][0]] - r[pairs[3][1]])))
        with self.assertRaisesRegex(mm.OpenMMException, "holonomic.*bond"):
            mm.Context(system, mm.VerletIntegrator(0.001), mm.Platform.getPlatformByName("Reference"))


class Contexts(unittest.TestCase):
    def test_crude_positions_are_brought_onto_the_constraints(self):
        rng = np.random.default_rng(10)
        r, pairs, masses = chain(rng)
        context = started(system_of(r, pairs, masses, True), mm.VerletIntegrator(0.001), r, 0 * r)
        for off in (0.02, 0.15):  # the second is a bond's length: no projection comes home from there
            context.setPositions(r + off * rng.normal(size=r.shape))
            self.assertGreater(error(context, pairs, r), 0.05)
            context.applyConstraints(1e-3)
            self.assertLess(error(context, pairs, r), 1e-14)

    def test_a_minimisation_ends_on_the_constraints(self):
        rng = np.random.default_rng(11)
        r, pairs, masses = chain(rng)
        context = started(system_of(r, pairs, masses, True), mm.VerletIntegrator(0.001), r, 0 * r)
        before = context.getState(getEnergy=True).getPotentialEnergy()._value
        mm.LocalEnergyMinimizer.minimize(context, 1.0)
        self.assertLess(context.getState(getEnergy=True).getPotentialEnergy()._value, before)
        self.assertLess(error(context, pairs, r), 1e-14)

    def test_made_again_and_from_a_copy(self):
        rng = np.random.default_rng(12)
        r, pairs, masses = chain(rng)
        system = copy.deepcopy(system_of(r, pairs, masses, True))
        self.assertEqual(system.getNumForces(), 2)
        integrator = mm.VerletIntegrator(0.001)
        context = started(system, integrator, r, rng.normal(size=r.shape))
        integrator.step(5)
        context.reinitialize(preserveState=True)
        integrator.step(5)
        self.assertLess(error(context, pairs, r), 1e-14)


if __name__ == "__main__":
    unittest.main()
