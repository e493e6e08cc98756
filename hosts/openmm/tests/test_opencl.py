"""The platform OpenCL, in three precisions: all molecules in one System, all integrators, and the platform Reference beside it.

Any OpenCL device will do, pocl on a CPU too. Ends with 77, and the reason, where there is none. HOLONOMIC_OPENMM_DEVICE=CUDA, or HIP, tests
that platform instead.
"""

import copy
import os
import subprocess
import sys
import unittest

os.environ.setdefault("POCL_MAX_PTHREAD_COUNT", "1")  # on busy processors, threads of pocl wait for each other most of the time

import numpy as np
import openmm as mm
from openmm import unit

from holonomic_openmm import add_holonomic, load
from test_openmm import system_of
from test_scenes import INTEGRATORS, charged, energies, positions, velocities, worst

DEVICE = os.environ.get("HOLONOMIC_OPENMM_DEVICE", "OpenCL")

# And the error of bonds: they end at coordinates of at most 1 nm, half a unit of the last place off, and the shortest is of 0.06 nm.
PRECISIONS = {"double": 1e-14, "mixed": 1e-13, "single": 4e-6}


def random_graph(rng, n, rings):
    """A tree of n atoms and a few bonds more."""
    bonds = {(int(rng.integers(i)), i) for i in range(1, n)}
    while len(bonds) < n - 1 + rings:
        i, j = sorted(int(k) for k in rng.choice(n, 2, replace=False))
        bonds.add((i, j))
    return sorted(bonds)


class Scene:
    """Molecules of all kinds on springs to where they begin, a few of each, one after the other."""

    def __init__(self):
        rng = np.random.default_rng(20)
        self.masses, self.r, self.bonds, self.sites, self.still = [], [], [], [], []
        for _ in range(3):
            self.add([16, 1, 1, 0], [(0, 0, 0), (0.0957, 0, 0), (-0.024, 0.0927, 0), (0.008, 0.01, 0)], [(0, 1), (0, 2), (1, 2)])
            self.sites.append(len(self.masses) - 1)
        for order in ((0, 1, 2, 3), (3, 0, 2, 1)):  # a methyl group, its carbon first or last
            corners = np.array([(0, 0, 0), (0.063, 0.063, 0.063), (0.063, -0.063, -0.063), (-0.063, 0.063, -0.063)])
            self.add(np.array([12, 1, 1, 1])[list(order)], corners[list(order)],
                     [(order.index(0), order.index(k)) for k in (1, 2, 3)])
        self.add([0, 0], [(0.2, 0, 0), (0, 0.2, 0)], [(0, 1)])
        self.still = [len(self.masses) - 2, len(self.masses) - 1]
        self.add([14, 1], [(0, 0, 0), (0.1, 0, 0)], [(0, 1)])
        self.add([72, 72, 72, 600], [(0, 0, 0), (0.28, 0.04, -0.07), (-0.19, 0.10, 0.10), (0.03, 0.23, -0.13)],
                 [(0, 1), (0, 2), (1, 2), (1, 3), (2, 3)])  # the cholesterol of Martini: two triangles with one edge
        self.add([5, 1, 1, 1], [(0, 0, 0), (0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.1)], [(i, j) for i in range(4) for j in range(i)])
        self.add([12] * 9, np.cumsum([(0.126 * (k > 0), 0.044 * (-1) ** k, 0) for k in range(9)], axis=0),
                 [(k, k + 1) for k in range(8)])
        self.add([16, 12, 16], [(-0.116, 0, 0), (0, 0, 0), (0.116, 0, 0)], [(0, 1), (1, 2), (0, 2)])  # straight: for the host
        for n, rings in ((12, 0), (20, 2), (8, 3)):
            self.add(rng.uniform(1, 16, n), rng.normal(0, 0.1, (n, 3)), random_graph(rng, n, rings))
        self.begin(rng)

    def begin(self, rng):
        self.r = np.array(self.r)
        self.v = rng.normal(size=self.r.shape) * (np.array(self.masses) > 0)[:, None] * 0.3

    def add(self, masses, r, bonds):
        first = len(self.masses)
        self.masses += [float(mass) for mass in masses]
        self.r += [tuple(np.array(place, float)) for place in r]
        self.bonds += [(first + i, first + j, float(np.linalg.norm(np.subtract(r[i], r[j])))) for i, j in bonds]

    def system(self):
        system = mm.System()
        for mass in self.masses:
            system.addParticle(mass)
        for bond in self.bonds:
            system.addConstraint(*bond)
        for site in self.sites:
            system.setVirtualSite(site, mm.ThreeParticleAverageSite(site - 3, site - 2, site - 1, 0.8, 0.1, 0.1))
        spring = mm.CustomExternalForce("400*((x-x0)^2+1.5*(y-y0)^2+0.5*(z-z0)^2)")
        for name in ("x0", "y0", "z0"):
            spring.addPerParticleParameter(name)
        rng = np.random.default_rng(21)
        for i, place in enumerate(self.r):
            spring.addParticle(i, np.float32(place + 0.05 * rng.normal(size=3)).astype(float))  # kept in floats by devices
        system.addForce(spring)
        add_holonomic(system)
        return system

    def moving(self):
        return [bond for bond in self.bonds if self.masses[bond[0]] > 0]


class LargeScene(Scene):
    """Molecules for a block of threads: in local memory, and larger ones; trees and rings, chains that wind, water beside them."""

    def __init__(self):
        rng = np.random.default_rng(26)
        self.masses, self.r, self.bonds, self.sites, self.still, self.grown = [], [], [], [], [], []
        self.add([16, 1, 1], [(0, 0, 0), (0.0957, 0, 0), (-0.024, 0.0927, 0)], [(0, 1), (0, 2), (1, 2)])
        self.add([0, 0], [(0.2, 0, 0), (0, 0.2, 0)], [(0, 1)])
        self.still = [3, 4]
        for n, rings in ((250, 0), (250, 8), (500, 12)):
            self.grow(rng, n, rings)
        for _ in range(2):  # of one kind
            steps = rng.normal(size=(320, 3))
            steps *= 0.15 / np.linalg.norm(steps, axis=1)[:, None]
            self.add([14] * 320, np.cumsum(steps, axis=0), [(k, k + 1) for k in range(319)])
        self.begin(rng)

    def grow(self, rng, n, rings):
        """A molecule as they are: up to four bonds at an atom, hydrogens, rings of five to seven atoms."""
        r, bonds, free = [np.zeros(3)], [], {0: 4}
        for i in range(1, n):
            j = int(rng.choice(list(free)[-6:]))
            step = rng.normal(size=3)
            r.append(r[j] + rng.uniform(0.1, 0.16) * step / np.linalg.norm(step))
            bonds.append((j, i))
            free[i] = 4 if len(free) < 6 or rng.random() < 0.5 else 1
            for atom in (i, j):
                free[atom] -= 1
                if free[atom] == 0:
                    del free[atom]
        while len(bonds) < n - 1 + rings:
            i = int(rng.integers(n - 7))
            if (i, i + 6) not in bonds and np.linalg.norm(r[i + 6] - r[i]) > 0.1:
                bonds.append((i, i + 6))
        self.grown.append((len(self.masses), n))
        self.add(rng.choice([1.0, 12.0, 14.0, 16.0], n), r, bonds)


SCENE, LARGE = Scene(), LargeScene()


def box_of_molecules():
    """Waters, chains, CO2 (for the host) and pairs of mirror images: OpenMM sorts molecules by their places in space every 250 steps."""
    rng = np.random.default_rng(22)
    corners = np.array([(0, 0, 0), (0.15, 0, 0), (0, 0.14, 0), (0, 0, 0.13), (0.05, 0.06, 0.16)])
    molecules = [([16, 1, 1], np.array([(0, 0, 0), (0.1, 0, 0), (-0.033, 0.094, 0)]), [(0, 1), (0, 2), (1, 2)]),
                 ([14] * 5, np.array([(0.12 * k, 0.05 * (k % 2), 0) for k in range(5)]), [(0, 1), (1, 2), (2, 3), (3, 4)]),
                 ([16, 12, 16], np.array([(-0.116, 0, 0), (0, 0, 0), (0.116, 0, 0)]), [(0, 1), (1, 2), (0, 2)]),
                 ([12] * 5, corners, [(i, j) for i in range(5) for j in range(i)]),
                 ([12] * 5, corners * (1, 1, -1), [(i, j) for i in range(5) for j in range(i)])]
    masses, r, bonds = [], [], []
    for k, corner in enumerate(rng.permutation([(x, y, z) for x in range(6) for y in range(6) for z in range(6)])):
        mass, places, pairs = molecules[k % 5]
        first = len(r)
        r += list(0.8 * corner + places)
        masses += mass
        bonds += [(first + i, first + j, float(np.linalg.norm(places[i] - places[j]))) for i, j in pairs]
    system = charged(masses, [0.0] * len(masses))
    force = system.getForce(0)
    for i in range(len(masses)):
        force.setParticleParameters(i, 0, 0.2, 0.3)
    force.createExceptionsFromBonds([(i, j) for i, j, _ in bonds], 0, 0)
    force.setNonbondedMethod(mm.NonbondedForce.CutoffPeriodic)
    force.setCutoffDistance(0.9)
    system.setDefaultPeriodicBoxVectors((4.8, 0, 0), (0, 4.8, 0), (0, 0, 4.8))
    for bond in bonds:
        system.addConstraint(*bond)
    add_holonomic(system)
    return system, np.array(r), rng.normal(size=(len(r), 3)), bonds


def context_of(system, integrator, precision, r, v=None):
    """On the device in a precision; with None on the platform Reference."""
    integrator.setConstraintTolerance(0.01)  # not looked at
    name = DEVICE if precision else "Reference"
    context = mm.Context(system, integrator, mm.Platform.getPlatformByName(name), {"Precision": precision} if precision else {})
    context.setPositions(r)
    context.applyConstraints(1e-3)
    if v is not None:
        context.setVelocities(v)
        context.applyVelocityConstraints(1e-3)
    context.computeVirtualSites()
    return context


class Steps(unittest.TestCase):
    def test_of_every_integrator_keep_the_constraints(self):
        for precision, bound in PRECISIONS.items():
            for name, integrator in INTEGRATORS.items():
                with self.subTest(precision=precision, integrator=name):
                    context = context_of(SCENE.system(), integrator(), precision, SCENE.r, SCENE.v)
                    context.getIntegrator().step(40)
                    r = positions(context)
                    self.assertLess(worst(r, SCENE.moving()), bound)
                    self.assertGreater(np.abs(r - SCENE.r).max(), 1e-3)
                    np.testing.assert_allclose(r[SCENE.still], SCENE.r[SCENE.still], atol=1e-8)
                    for site in SCENE.sites:
                        np.testing.assert_allclose(r[site], np.dot([0.8, 0.1, 0.1], r[site - 3:site]), atol=1e-7)

    def test_are_those_of_the_platform_reference(self):
        ends = {}
        for precision in (None, *PRECISIONS):
            context = context_of(SCENE.system(), mm.VerletIntegrator(0.001), precision, SCENE.r, SCENE.v)
            context.getIntegrator().step(100)
            ends[precision] = positions(context), velocities(context)
        # Velocities are displacements over 0.001 ps. Of 100 roundings ten remain, as they come by chance; forces of mixed are in floats.
        for precision, bound in ("double", 1e-11), ("mixed", 1e-7), ("single", 1e-5):
            np.testing.assert_allclose(ends[precision][0], ends[None][0], atol=bound)
            np.testing.assert_allclose(ends[precision][1], ends[None][1], atol=100 * bound)

    def test_have_equal_bits_with_any_number_of_threads(self):
        def bits(threads):
            return subprocess.run([sys.executable, "-W", "ignore", __file__, "bits"], env={**os.environ, "POCL_MAX_PTHREAD_COUNT": threads},
                                  stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, check=True).stderr.split()  # to stdout OpenMM warns of pocl
        once = bits("1")
        self.assertEqual([len(one) for one in once], [2 * 2 * 3 * 8 * len(scene.r) for scene in (SCENE, LARGE) for _ in PRECISIONS])
        self.assertEqual(once, bits("4"))

    def test_conserve_the_energy_as_on_the_platform_reference(self):
        reference = energies(context_of(SCENE.system(), mm.VerletIntegrator(0.001), None, SCENE.r, SCENE.v), 60, 50)
        for precision, rounding in ("double", 1e-9), ("mixed", 1e-6), ("single", 2e-4):  # 3000 of floats
            found = energies(context_of(SCENE.system(), mm.VerletIntegrator(0.001), precision, SCENE.r, SCENE.v), 60, 50)
            scale = np.abs(reference).max()
            self.assertLess(np.std(found), 1.05 * np.std(reference) + rounding * scale)
            self.assertLess(abs(np.polyfit(range(60), found - reference, 1)[0]) * 60, rounding * scale)

    def test_velocities_are_made_tangent(self):
        for precision, bound in ("double", 1e-15), ("mixed", 1e-15), ("single", 1e-7):
            context = context_of(SCENE.system(), mm.VerletIntegrator(0.001), precision, SCENE.r, SCENE.v)
            r, v = positions(context), velocities(context)
            for i, j, _ in SCENE.moving():
                self.assertLess(abs((r[i] - r[j]) @ (v[i] - v[j])), bound)

    def test_with_atoms_that_change_places(self):
        system, r, v, bonds = box_of_molecules()
        ends = []
        for precision in (None, "double"):
            context = context_of(copy.deepcopy(system), mm.VerletIntegrator(0.001), precision, r, v)
            context.getIntegrator().step(300)
            ends.append(positions(context))
        self.assertLess(worst(ends[1], bonds), 1e-13)
        np.testing.assert_allclose(ends[0], ends[1], atol=1e-5)  # sums of forces have 32 bits behind the point


class Contexts(unittest.TestCase):
    def test_crude_positions_are_brought_onto_the_constraints(self):
        noise = np.random.default_rng(23).normal(size=SCENE.r.shape)
        for precision, bound in PRECISIONS.items():
            for off in (0.02, 0.12):  # from the second, a bond's length, the library must help
                context = context_of(SCENE.system(), mm.VerletIntegrator(0.001), precision, SCENE.r + off * noise)
                self.assertLess(worst(positions(context), SCENE.moving()), 2 * bound)

    def test_crude_positions_of_atoms_that_have_changed_places(self):
        system, r, v, bonds = box_of_molecules()
        context = context_of(system, mm.VerletIntegrator(0.001), "double", r, v)
        context.getIntegrator().step(300)
        r = positions(context)
        context.setPositions(r + 0.12 * np.random.default_rng(23).normal(size=r.shape))  # the library must help
        context.applyConstraints(1e-3)
        self.assertLess(worst(positions(context), bonds), 1e-13)

    def test_a_minimisation_ends_on_the_constraints(self):
        for precision, bound in PRECISIONS.items():
            context = context_of(SCENE.system(), mm.VerletIntegrator(0.001), precision, SCENE.r)
            before = context.getState(getEnergy=True).getPotentialEnergy()
            context.getIntegrator().setConstraintTolerance(1e-6)  # with a loose one the minimiser leaves out the projection
            mm.LocalEnergyMinimizer.minimize(context, 10, 50)
            self.assertLess(context.getState(getEnergy=True).getPotentialEnergy(), before)
            self.assertLess(worst(positions(context), SCENE.moving()), bound)

    def test_a_molecule_whose_matrix_is_dense_is_solved_on_the_host(self):
        rng = np.random.default_rng(24)
        bonds = [(0, i) for i in range(1, 131)]  # a star
        r = np.zeros((131, 3))
        r[1:] = rng.normal(size=(130, 3))
        r[1:] *= 0.15 / np.linalg.norm(r[1:], axis=1)[:, None]
        for precision, bound in ("mixed", 1e-12), ("single", 2e-5):
            system = system_of(r, bonds, rng.uniform(1, 16, 131), True)
            context = context_of(system, mm.VerletIntegrator(0.001), precision, r, rng.normal(size=r.shape))
            context.getIntegrator().step(20)
            self.assertLess(worst(positions(context), [(i, j, 0.15) for i, j in bonds]), bound)
            self.assertGreater(np.abs(positions(context) - r).max(), 1e-2)

    def test_made_again_and_from_a_copy(self):
        integrator = mm.VerletIntegrator(0.001)
        context = context_of(copy.deepcopy(SCENE.system()), integrator, "mixed", SCENE.r, SCENE.v)
        integrator.step(5)
        context.reinitialize(preserveState=True)
        integrator.step(5)
        self.assertLess(worst(positions(context), SCENE.moving()), PRECISIONS["mixed"])

    def test_without_the_force_are_openmms_own(self):
        system = SCENE.system()
        system.removeForce(1)
        integrator = mm.VerletIntegrator(0.001)
        context = mm.Context(system, integrator, mm.Platform.getPlatformByName(DEVICE), {"Precision": "double"})
        context.setPositions(SCENE.r + 1e-3 * np.random.default_rng(25).normal(size=SCENE.r.shape))
        context.applyConstraints(1e-4)
        bonds = [bond for bond in SCENE.moving() if SCENE.masses[bond[0]] == 16]
        self.assertLess(worst(positions(context), bonds), 1e-3)


def dense_step(masses, bonds, r, v, dt):
    """Velocities of one molecule made tangent, and places after a step with them, by dense matrices."""
    w = 1 / np.array(masses)
    pairs, lengths = np.array([bond[:2] for bond in bonds]), np.array([bond[2] for bond in bonds])
    incidence = np.zeros((len(pairs), len(w)))
    incidence[range(len(pairs)), pairs[:, 0]] = 1
    incidence[range(len(pairs)), pairs[:, 1]] = -1
    coupled = incidence * w @ incidence.T
    s = incidence @ r

    def pushed(x, rows, off):
        return x - w[:, None] * (incidence.T @ (np.linalg.solve(coupled * (rows @ s.T), off)[:, None] * s))

    for _ in range(2):
        v = pushed(v, s, np.einsum("ij,ij->i", s, incidence @ v))
    after = r + dt * v
    for _ in range(6):
        d = incidence @ after
        after = pushed(after, d, (np.einsum("ij,ij->i", d, d) - lengths ** 2) / 2)
    return v, after


class LargeMolecules(unittest.TestCase):
    def test_are_those_of_dense_matrices(self):
        """One step of 5 fs without forces: single places are of 3 nm, half a unit of the last place off."""
        for precision, bound in ("double", 2e-14), ("mixed", 5e-14), ("single", 2e-6):
            system = LARGE.system()
            system.removeForce(0)
            context = context_of(system, mm.VerletIntegrator(0.005), precision, LARGE.r, LARGE.v)
            r, before = positions(context), velocities(context)
            context.getIntegrator().step(1)
            found = positions(context)
            for first, n in LARGE.grown:
                here = slice(first, first + n)
                bonds = [(i - first, j - first, length) for i, j, length in LARGE.bonds if first <= i < first + n]
                tangent, after = dense_step(LARGE.masses[here], bonds, r[here], LARGE.v[here], 0.005)
                np.testing.assert_allclose(before[here], tangent, atol=20 * bound)
                np.testing.assert_allclose(found[here], after, atol=bound)
                self.assertGreater(np.abs(after - r[here] - 0.005 * tangent).max(), 1e-4)

    def test_of_integrators_keep_the_constraints(self):
        for precision, bound in ("double", 2e-14), ("mixed", 2e-13), ("single", 2e-5):  # coordinates reach 3 nm, and bonds have 0.1 or more
            for name in "verlet", "langevin middle", "custom":
                with self.subTest(precision=precision, integrator=name):
                    context = context_of(LARGE.system(), INTEGRATORS[name](), precision, LARGE.r, LARGE.v)
                    context.getIntegrator().step(40)
                    self.assertLess(worst(positions(context), LARGE.moving()), bound)
                    self.assertGreater(np.abs(positions(context) - LARGE.r).max(), 1e-3)
                    np.testing.assert_allclose(positions(context)[LARGE.still], LARGE.r[LARGE.still], atol=1e-8)

    def test_conserve_the_energy_as_on_the_platform_reference(self):
        reference = energies(context_of(LARGE.system(), mm.VerletIntegrator(0.001), None, LARGE.r, LARGE.v), 40, 25)
        for precision, rounding in ("double", 1e-9), ("mixed", 1e-6), ("single", 2e-4):
            found = energies(context_of(LARGE.system(), mm.VerletIntegrator(0.001), precision, LARGE.r, LARGE.v), 40, 25)
            scale = np.abs(reference).max()
            self.assertLess(np.std(found), 1.05 * np.std(reference) + rounding * scale)
            self.assertLess(abs(np.polyfit(range(40), found - reference, 1)[0]) * 40, rounding * scale)

    def test_crude_positions_are_brought_onto_the_constraints(self):
        crude = LARGE.r + 0.01 * np.random.default_rng(27).normal(size=LARGE.r.shape)
        context = context_of(LARGE.system(), mm.VerletIntegrator(0.001), "mixed", crude)
        self.assertLess(worst(positions(context), LARGE.moving()), 2e-13)

    def test_failures_name_the_first_atoms_and_the_step(self):
        integrator = mm.VerletIntegrator(0.001)
        context = context_of(LARGE.system(), integrator, "mixed", LARGE.r, LARGE.v)
        integrator.step(3)
        kick(context, 6)
        integrator.step(1)
        with self.assertRaisesRegex(mm.OpenMMException, r"atoms 5, 6, .* 24 and 230 more could not be solved in step 4: [^;]*$"):
            context.getState(getEnergy=True)
        context.setPositions(LARGE.r)
        context.setVelocities(LARGE.v)
        context.applyVelocityConstraints(1e-3)
        integrator.step(2)
        context.getState(getEnergy=True)


def kick(context, atom):
    """So that the next step is too long."""
    v = velocities(context)
    v[atom] += (0, 0, 900)
    context.setVelocities(v)


def kicked(precision, atom):
    """Before step 4."""
    integrator = mm.VerletIntegrator(0.001)
    context = context_of(SCENE.system(), integrator, precision, SCENE.r, SCENE.v)
    integrator.step(3)
    kick(context, atom)
    return context, integrator


class Failures(unittest.TestCase):
    def test_of_a_step_name_the_atoms_and_the_step(self):
        for precision in PRECISIONS:
            first = SCENE.bonds[6][0]  # the third water
            context, integrator = kicked(precision, first)
            integrator.step(1)
            with self.assertRaisesRegex(mm.OpenMMException, f"atoms {first}, {first + 1}, {first + 2} could not be solved in step 4"):
                context.getState(getEnergy=True)
            context.setPositions(SCENE.r)  # and it goes on
            context.setVelocities(SCENE.v)
            context.applyVelocityConstraints(1e-3)
            integrator.step(20)
            context.getState(getEnergy=True)
            self.assertLess(worst(positions(context), SCENE.moving()), PRECISIONS[precision])

    def test_are_told_within_sixteen_steps(self):
        context, integrator = kicked("mixed", SCENE.bonds[0][0])
        with self.assertRaisesRegex(mm.OpenMMException, "in step 4"):
            integrator.step(17)

    def test_of_a_step_are_told_by_the_next_call_that_waits(self):
        """And not forgotten for those that applyConstraints finds."""
        context, integrator = kicked("mixed", SCENE.bonds[0][0])
        integrator.step(1)
        crude = SCENE.r + 0.12 * np.random.default_rng(23).normal(size=SCENE.r.shape)
        context.setPositions(crude)
        with self.assertRaisesRegex(mm.OpenMMException, "atoms 0, 1, 2 could not be solved in step 4"):
            context.applyConstraints(1e-3)
        np.testing.assert_allclose(positions(context), crude, atol=1e-6)
        context.applyConstraints(1e-3)
        self.assertLess(worst(positions(context), SCENE.moving()), 2 * PRECISIONS["mixed"])

    def test_after_the_count_of_steps_was_set_back(self):
        integrator = mm.VerletIntegrator(0.001)
        context = context_of(SCENE.system(), integrator, "mixed", SCENE.r, SCENE.v)
        integrator.step(5)
        context.getState(getEnergy=True)
        context.setStepCount(4)
        kick(context, SCENE.bonds[0][0])
        integrator.step(1)
        with self.assertRaisesRegex(mm.OpenMMException, r"atoms 0, 1, 2 could not be solved in step 5: [^;]*$"):
            context.getState(getEnergy=True)

    def test_outside_of_a_step_are_told_at_once(self):
        context = context_of(SCENE.system(), mm.VerletIntegrator(0.001), "mixed", SCENE.r)
        r = SCENE.r.copy()
        r[SCENE.bonds[0][1]] = np.nan
        context.setPositions(r)
        with self.assertRaisesRegex(mm.OpenMMException, "holonomic.*finite"):
            context.applyConstraints(1e-3)

    def test_of_lengths_that_fit_no_places_are_told_when_the_context_is_made(self):
        system = SCENE.system()
        system.setConstraintParameters(0, 0, 1, 0.9)
        with self.assertRaisesRegex(mm.OpenMMException, "more than the two other sides of its triangle"):
            context_of(system, mm.VerletIntegrator(0.001), "mixed", SCENE.r)


def print_bits():
    for scene, precision in ((scene, precision) for scene in (SCENE, LARGE) for precision in PRECISIONS):
        context = context_of(scene.system(), mm.VerletIntegrator(0.001), precision, scene.r, scene.v)
        context.getIntegrator().step(100)
        print(np.array([positions(context), velocities(context)]).tobytes().hex(), file=sys.stderr)


def missing():
    """Why there is nothing to test, if there is."""
    mm.Platform.loadPluginsFromDirectory(mm.Platform.getDefaultPluginsDirectory())
    try:
        platform = mm.Platform.getPlatformByName(DEVICE)
    except mm.OpenMMException:
        return f"OpenMM has no platform {DEVICE} here (Debian, for OpenCL: libopenmm-plugins and pocl-opencl-icd)"
    system = mm.System()
    system.addParticle(1)
    try:
        mm.Context(system, mm.VerletIntegrator(0.001), platform)
    except mm.OpenMMException as error:
        return f"no device ({error}; Debian, for OpenCL: pocl-opencl-icd)"
    load()
    if not os.path.exists(os.path.join(os.path.dirname(os.environ["HOLONOMIC_OPENMM_PLUGIN"]), f"libOpenMMHolonomic{DEVICE}.so")):
        return f"the plugin was built without {DEVICE}"
    return None


if __name__ == "__main__":
    reason = missing()
    if reason:
        print(f"left out: {reason}")
        sys.exit(77)
    if sys.argv[1:] == ["bits"]:
        print_bits()
        sys.exit()
    unittest.main()
