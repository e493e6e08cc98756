"""GROMACS with LINCS of high order beside GROMACS with this library: the same program, input and seeds."""
import math
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import unittest

import gromacs as g
import scenes as s

sys.path.append(str(g.HERE.parent / "examples"))
import membrane  # noqa: E402

FREE = ["Kinetic-En.", "Pressure", "Vir-XX", "Vir-XY", "Pres-ZZ"]
ALL = FREE + ["Potential"]
ORDERS = dict(lincs_order=40, lincs_iter=14)
BAR = 16.6054  # of kJ/mol/nm^3
BUTANES = [(s.alkane(4), 8), (s.water(), 19)]


class Case(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="holonomic-gromacs-"))
        self.addCleanup(shutil.rmtree, self.folder)

    def scene(self, molecules, spacing, gmx=g.DOUBLE, index=None, **options):
        s.write(self.folder, molecules, spacing, **{**ORDERS, **options})
        arguments = []
        if index:
            (self.folder / "index.ndx").write_text(index)
            arguments = ["-n", "index.ndx"]
        g.grompp(self.folder, gmx, *arguments)

    def both(self, terms, *arguments, gmx=g.DOUBLE, threads=1):
        g.mdrun(self.folder, holonomic=False, name="lincs", gmx=gmx)
        g.mdrun(self.folder, *arguments, name="exact", gmx=gmx, threads=threads)
        return (g.energies(self.folder, terms, gmx, "lincs"), g.energies(self.folder, terms, gmx, "exact"))

    def assert_same(self, pair, tolerance=1e-8, skip=()):
        lincs, exact = pair
        self.assertEqual(set(lincs), set(exact))
        for term in set(lincs) - set(skip):
            scale = max(abs(v) for v in lincs[term]) or 1
            for a, b in zip(lincs[term], exact[term]):
                self.assertLessEqual(abs(a - b), tolerance * scale, f"{term}: {a} {b}")

    def restart(self, n_steps, gmx):
        """Energies of a run in one, and of the second part of the same in two."""
        half = str(n_steps // 2)
        g.mdrun(self.folder, "-reprod", gmx=gmx, name="whole")
        g.mdrun(self.folder, "-reprod", "-nsteps", half, gmx=gmx, name="part")
        g.mdrun(self.folder, "-reprod", "-cpi", "part.cpt", "-nsteps", half, "-noappend", gmx=gmx, name="part")
        return [g.energies(self.folder, ALL, gmx, name) for name in ("whole", "part.part0002")]

    def worst_length(self, molecules, bonds_of, name="exact"):
        """Of all frames: the largest relative error of a length, and of d.v against |d| |v|."""
        worst = rate = 0
        for x, v in g.frames(self.folder / f"{name}.trr"):
            first = 0
            for molecule, count in molecules:
                for _ in range(count):
                    for i, j, length in bonds_of(molecule):
                        p, q = x[first + i - 1], x[first + j - 1]
                        d = [b - a for a, b in zip(p, q)]
                        d = [a - self.side * round(a / self.side) for a in d]
                        worst = max(worst, abs(math.hypot(*d) / length - 1))
                        if v:
                            u = [b - a for a, b in zip(v[first + i - 1], v[first + j - 1])]
                            rate = max(rate, abs(sum(a * b for a, b in zip(d, u))) / length)
                    first += len(molecule.atoms)
        return worst, rate

    @property
    def side(self):
        return float((self.folder / "conf.gro").read_text().split()[-1])


def constraints_of(molecule):
    return [(i, j, lengths[0]) for i, j, *lengths in molecule.constraints]


def bonds_of(molecule):
    return [(i, j, length) for i, j, length, _ in molecule.bonds]


def triangle():
    """A rigid body of three unlike atoms."""
    places = [(0, 0, 0), (0.3, 0, 0), (0.1, 0.25, 0)]
    sides = [(i, j, math.dist(places[i - 1], places[j - 1])) for i, j in ((1, 2), (2, 3), (1, 3))]
    return s.Molecule("TRI", [("C", "A", 40.0), ("C", "B", 55.0), ("C", "D", 72.0)], places, constraints=sides)


class Integrators(Case):
    def test_energies_and_virials_are_those_of_lincs_where_that_converges(self):
        for integrator in ("md", "md-vv", "sd", "bd"):
            for constraints in ("h-bonds", "all-bonds"):
                with self.subTest(integrator=integrator, constraints=constraints):
                    self.scene(BUTANES, 0.9, integrator=integrator, constraints=constraints, tc_grps="system", tau_t=1,
                               ref_t=300, bd_fric=1000)
                    self.assert_same(self.both(ALL))

    def test_constraints_in_the_topology_alone(self):
        self.scene([(s.chain(6), 27)], 1.0, dt=0.004)
        self.assert_same(self.both(ALL))

    def test_minimisation(self):
        for integrator in ("steep", "cg"):
            with self.subTest(integrator=integrator):
                self.scene(BUTANES, 0.9, integrator=integrator, constraints="all-bonds", emtol=1, emstep=0.002,
                           lincs_order=300)
                self.assert_same(self.both(["Potential", "Pressure"]), 1e-6)

    def test_pressure_coupling(self):
        # x is scaled before the step, and the virial is taken with bonds as they are then: docs/porting.md.
        for barostat, thermostat in (("berendsen", "v-rescale"), ("c-rescale", "v-rescale"),
                                     ("parrinello-rahman", "nose-hoover")):
            with self.subTest(barostat=barostat):
                self.scene(BUTANES, 0.9, constraints="all-bonds", pcoupl=barostat, tcoupl=thermostat, tc_grps="system",
                           tau_t=0.5, ref_t=300, tau_p=1, ref_p=1, compressibility=4e-5, nstpcouple=1, nsttcouple=1)
                self.assert_same(self.both(ALL), 1e-3)

    def test_single_precision(self):
        self.scene(BUTANES, 0.9, gmx=g.MIXED, constraints="all-bonds", nsteps=10)
        self.assert_same(self.both(ALL, gmx=g.MIXED), 5e-3)
        rmsd = g.energies(self.folder, ["Constr.-rmsd"], g.MIXED, "exact")["Constr. rmsd"]
        self.assertLess(max(rmsd), 2e-6)  # coordinates of 2 nm in bonds of 0.1 nm

    def test_a_box_that_is_no_cuboid(self):
        s.write(self.folder, BUTANES, 0.9, constraints="all-bonds", **ORDERS)
        lines = (self.folder / "conf.gro").read_text().splitlines()
        side = self.side
        lines[-1] = " ".join(f"{v:.5f}" for v in (side, side, side, 0, 0, 0.3 * side, 0, 0.3 * side, -0.2 * side))
        (self.folder / "conf.gro").write_text("\n".join(lines) + "\n")
        g.grompp(self.folder)
        self.assert_same(self.both(ALL))

    def test_flat_cell_with_walls(self):
        self.scene(BUTANES, 0.9, constraints="all-bonds", pbc="xy", nwall=2, wall_atomtype="C C", wall_type="9-3", wall_density="1 1")
        self.assert_same(self.both(ALL))


class Accuracy(Case):
    def test_lengths_and_velocities_are_exact(self):
        for integrator in ("md", "md-vv"):
            with self.subTest(integrator=integrator):
                molecules = [(s.cholesterol(), 27)]
                self.scene(molecules, 1.3, integrator=integrator, dt=0.02, nsteps=50, nstxout=10, nstvout=10)
                g.mdrun(self.folder, name="exact")
                worst, rate = self.worst_length(molecules, constraints_of)
                self.assertLess(worst, 1e-13)  # rounding of coordinates of 4 nm
                if integrator == "md-vv":
                    self.assertLess(rate, 1e-12)

    def test_frames_of_cholesterol_keep_their_energy(self):
        molecules = [(s.cholesterol(), 64)]
        drift = {}
        for name, order in (("lincs", dict(lincs_order=4, lincs_iter=1)), ("exact", {})):
            self.scene(molecules, 1.3, interacting=False, dt=0.02, nsteps=1000, nstenergy=100, **order)
            g.mdrun(self.folder, holonomic=name == "exact", name=name)
            energy = g.energies(self.folder, ["Total-Energy"], g.DOUBLE, name)["Total Energy"]
            drift[name] = energy[-1] / energy[0] - 1
        self.assertLess(drift["lincs"], -5e-3)
        self.assertLess(abs(drift["exact"]), 1e-4)  # what the leapfrog's energy fluctuates by

    def pressure_of_centres(self, v, masses):
        total = 0
        for first in range(0, len(v), len(masses)):
            p = [sum(m * v[first + i][a] for i, m in enumerate(masses)) for a in range(3)]
            total += sum(c * c for c in p) / sum(masses)
        return total / (3 * self.side ** 3) * BAR

    def test_pressure_of_free_molecules_is_that_of_their_centres(self):
        # sum m v^2 + sum r.G over a rigid body that turns freely is 0; the leapfrog's kinetic energy is right to dt^2.
        molecules = [(triangle(), 27)]
        self.scene(molecules, 1.3, interacting=False, dt=0.0005, nsteps=20, nstvout=1, nstxout=1)
        g.mdrun(self.folder, name="exact")
        pressure = g.energies(self.folder, ["Pressure"], g.DOUBLE, "exact")["Pressure"]
        frames = g.frames(self.folder / "exact.trr")
        masses = [atom[2] for atom in molecules[0][0].atoms]
        for k in range(5, 15):
            # v of frame k is that half a step before; GROMACS takes the mean of the two kinetic energies
            wanted = 0.5 * sum(self.pressure_of_centres(frames[n][1], masses) for n in (k, k + 1))
            self.assertAlmostEqual(pressure[k] / wanted, 1, delta=2e-3)

    def test_virial_is_that_of_a_change_of_volume(self):
        # Of rigid bodies, constraints and inner kinetic energy are sum R.F of the centres: -3 V dU/dV, as these are scaled.
        molecules = [(triangle(), 125)]
        self.scene(molecules, 0.55, dt=0.0005, nsteps=60, nstvout=1, nstxout=1)
        g.mdrun(self.folder, name="exact")
        pressure = g.energies(self.folder, ["Pressure"], g.DOUBLE, "exact")["Pressure"]
        frames, masses = g.frames(self.folder / "exact.trr"), [atom[2] for atom in molecules[0][0].atoms]
        for k in (20, 40, 59):
            moving = 0.5 * sum(self.pressure_of_centres(frames[n][1], masses) for n in (k, k + 1))
            h = 1e-4
            low, high = (self.potential_of_scaled(frames[k][0], masses, scale) for scale in (1 - h, 1 + h))
            slope = -(high - low) / (2 * h) / (3 * self.side ** 3) * BAR
            self.assertGreater(abs(slope), 0.3 * moving)
            self.assertAlmostEqual(pressure[k], moving + slope, delta=4e-3 * (moving + abs(slope)))

    def potential_of_scaled(self, x, masses, scale):
        """All molecules as they are, their centres and the box scaled."""
        original = (self.folder / "conf.gro").read_text().splitlines()
        lines, side = original[:2], self.side
        for first in range(0, len(x), len(masses)):
            whole = [x[first]]
            for atom in x[first + 1:first + len(masses)]:
                whole.append([c - side * round((c - d) / side) for c, d in zip(atom, x[first])])
            centre = [sum(m * p[a] for m, p in zip(masses, whole)) / sum(masses) for a in range(3)]
            for p in whole:
                lines.append(original[len(lines)][:20] + "".join(f"{c + (scale - 1) * d:19.14f}" for c, d in zip(p, centre)))
        lines.append(" ".join(f"{scale * side:.14f}" for _ in range(3)))
        (self.folder / "scaled.gro").write_text("\n".join(lines) + "\n")
        g.grompp(self.folder, g.DOUBLE, "-c", "scaled.gro", "-o", "scaled.tpr")
        g.mdrun(self.folder, "scaled.tpr", "-rerun", "scaled.gro", name="scaled", holonomic=False)
        return g.energies(self.folder, ["Potential"], g.DOUBLE, "scaled")["Potential"][0]

    def test_what_lincs_does_not_converge_for(self):
        molecules = [(s.alkane(4), 8)]
        self.scene(molecules, 1.2, constraints="h-angles", nsteps=100, nstxout=50)
        g.mdrun(self.folder, name="exact")
        energy = g.energies(self.folder, ["Total-Energy"], g.DOUBLE, "exact")["Total Energy"]
        self.assertLess(max(abs(e - energy[0]) for e in energy), 0.05 * abs(energy[0]))
        self.assertLess(self.worst_length(molecules, bonds_of)[0], 1e-13)

    def test_nearly_straight_chains(self):
        molecules = [(s.chain(50, bend=math.radians(4)), 8)]
        self.scene(molecules, 8.0, interacting=False, dt=0.005, nsteps=100, nstxout=50)
        g.mdrun(self.folder, name="exact")
        energy = g.energies(self.folder, ["Total-Energy"], g.DOUBLE, "exact")["Total Energy"]
        self.assertLess(max(abs(e / energy[0] - 1) for e in energy), 5e-2)
        self.assertLess(self.worst_length(molecules, constraints_of)[0], 1e-12)


class Special(Case):
    def frozen(self, dimensions):
        n = len(BUTANES[0][0].atoms)
        listed = " ".join(str(k * n + j) for k in range(8) for j in (1, 2, 7))
        index = "[ System ]\n" + " ".join(str(i + 1) for i in range(8 * n)) + f"\n[ F ]\n{listed}\n"
        self.scene(BUTANES[:1], 1.3, constraints="all-bonds", freezegrps="F", freezedim=dimensions, index=index,
                   nstxout=20, nstvout=20)

    def test_frozen_atoms(self):
        self.frozen("Y Y Y")
        pair = self.both(["Kinetic-En.", "Potential"])
        self.assert_same(pair, 1e-7)
        frames = g.frames(self.folder / "exact.trr")
        for k in range(8):
            for j in (0, 1, 6):
                atom = k * len(BUTANES[0][0].atoms) + j
                self.assertEqual(frames[0][0][atom], frames[-1][0][atom])
        # LINCS has 1e18 bar there: bonds between two frozen atoms pull without end
        pressure = g.energies(self.folder, ["Pressure"], g.DOUBLE, "exact")["Pressure"]
        self.assertLess(max(abs(p) for p in pressure), 1e4)

    def test_atoms_frozen_in_one_dimension(self):
        self.frozen("Y N N")
        self.assert_same(self.both(["Kinetic-En.", "Potential"]))

    def perturbed(self, **options):
        a = s.alkane(3)
        molecule = s.Molecule("PER", [(kind, name, m, 1.3 * m) for kind, name, m in a.atoms], a.places, angles=a.angles,
                              constraints=[(i, j, length, 1.05 * length) for i, j, length, _ in a.bonds])
        self.scene([(molecule, 8)], 1.3, free_energy="yes", nstdhdl=1, tc_grps="system", tau_t=1, ref_t=300, **options)
        return self.both(ALL + ["dVremain/dl"])

    def test_free_energy_with_lengths_and_masses(self):
        for integrator in ("md", "sd", "md-vv"):
            with self.subTest(integrator=integrator):
                self.assert_same(self.perturbed(init_lambda=0.5, integrator=integrator))

    def test_slow_growth(self):
        self.assert_same(self.perturbed(init_lambda=0.2, delta_lambda=1e-4), 1e-3)

    def test_pulling_with_a_constraint(self):
        n = len(BUTANES[0][0].atoms)
        index = ("[ System ]\n" + " ".join(str(i + 1) for i in range(27 * n)) + "\n[ A ]\n"
                 + " ".join(str(i + 1) for i in range(n)) + "\n[ B ]\n" + " ".join(str(n + i + 1) for i in range(n)) + "\n")
        self.scene([(s.alkane(4), 27)], 1.3, constraints="all-bonds", index=index, pull="yes", pull_ngroups=2, pull_ncoords=1,
                   pull_group1_name="A", pull_group2_name="B", pull_coord1_type="constraint",
                   pull_coord1_geometry="distance", pull_coord1_groups="1 2", pull_coord1_rate=0.1, pull_coord1_start="yes")
        self.assert_same(self.both(ALL))

    def test_flexible_constraints(self):
        atoms = [("C", "A", 12.0), ("C", "B", 14.0), ("H", "D", 2.0)]
        molecule = s.Molecule("FLX", atoms, [(0, 0, 0), (0.15, 0, 0), (0.18, 0.1, 0)], bonds=[(1, 3, 0.2, 2e4)],
                              constraints=[(1, 2, 0.15), (2, 3, 0.0)],
                              extra="[ bonds ]\n2 3 6 0.1044 20000\n")
        self.scene([(molecule, 8)], 1.3, dt=0.001, fcstep=0.001, niter=20)
        self.assert_same(self.both(ALL), 1e-6)

    def test_virtual_sites_stay_gromacs_own(self):
        half = s.alkane(3)
        places = half.places + [(0.0, 0.0, 0.05)]
        molecule = s.Molecule("VST", half.atoms + [("MW", "MW", 0.0)], places, bonds=half.bonds, angles=half.angles,
                              extra=f"[ virtual_sites2 ]\n{len(places)} 1 5 1 0.4\n")
        self.scene([(molecule, 8)], 1.3, constraints="all-bonds")
        self.assert_same(self.both(ALL))

    def test_a_restart_loses_nothing(self):
        for gmx in (g.DOUBLE, g.MIXED):
            with self.subTest(gmx=gmx):
                self.scene([(s.cholesterol(), 32), (s.alkane(4), 32)], 1.0, gmx=gmx, constraints="all-bonds", nsteps=400,
                           nstenergy=100, tcoupl="v-rescale", tc_grps="System", tau_t=1, ref_t=300)
                whole, part = self.restart(400, gmx)
                for term in set(whole) - {"time"}:
                    self.assertEqual(whole[term][-1], part[term][-1], term)
                self.assertEqual((self.folder / "whole.gro").read_text().splitlines()[1:],
                                 (self.folder / "part.part0002.gro").read_text().splitlines()[1:])

    def test_essential_dynamics_move_what_is_constrained(self):
        self.scene([(s.alkane(4), 8)], 1.2, constraints="all-bonds", nstxout=1)
        g.mdrun(self.folder, name="without")
        g.call(["gmx_d", "-quiet", "covar", "-s", "topol.tpr", "-f", "without.trr", "-last", "3"], self.folder, "0\n0\n")
        g.call(["gmx_d", "-quiet", "make_edi", "-s", "topol.tpr", "-linfix", "1", "-linstep", "0.0002", "-o", "sam.edi"],
               self.folder, "0\n0\n")
        g.mdrun(self.folder, "-ei", "sam.edi", holonomic=False, name="lincs")
        g.mdrun(self.folder, "-ei", "sam.edi", name="exact")
        lincs, exact, without = (g.energies(self.folder, ALL, g.DOUBLE, name) for name in ("lincs", "exact", "without"))
        self.assert_same((lincs, exact), skip=("Pressure", "Vir-XX", "Vir-XY", "Pres-ZZ"))
        # it leaves bonds that are not of their lengths: the virial is that of the bonds as they are
        self.assert_same((lincs, exact), 2e-3)
        self.assertGreater(abs(without["Kinetic En."][-1] / exact["Kinetic En."][-1] - 1), 0.1)

    def test_rerun(self):
        self.scene(BUTANES, 0.9, constraints="all-bonds", nstxout=5)
        g.mdrun(self.folder, name="run")
        g.mdrun(self.folder, "-rerun", "run.trr", holonomic=False, name="lincs")
        g.mdrun(self.folder, "-rerun", "run.trr", name="exact")
        self.assert_same((g.energies(self.folder, ["Potential"], g.DOUBLE, "lincs"),
                          g.energies(self.folder, ["Potential"], g.DOUBLE, "exact")))


class Ranks(Case):
    MOLECULES = [(s.alkane(4), 64), (s.water(), 61)]

    def test_two_ranks_with_molecules_whole(self):
        self.scene(self.MOLECULES, 1.0, constraints="h-bonds", nsteps=60)
        pair = self.both(ALL, "-ntmpi", "2")
        self.assert_same(pair)
        rmsd = g.energies(self.folder, ["Constr.-rmsd"], g.DOUBLE, "exact")["Constr. rmsd"]
        self.assertLess(max(rmsd), 1e-9)

    def test_the_sum_of_deviations_is_that_of_all_ranks(self):
        self.scene(self.MOLECULES, 1.0, gmx=g.MIXED, constraints="h-bonds", nsteps=10)
        for ranks in ("1", "2"):
            g.mdrun(self.folder, "-ntmpi", ranks, gmx=g.MIXED, name=f"on{ranks}")
        one, two = (g.energies(self.folder, ["Constr.-rmsd"], g.MIXED, f"on{ranks}")["Constr. rmsd"] for ranks in "12")
        self.assertGreater(min(two), 1e-8)
        for a, b in zip(one[1:], two[1:]):
            self.assertAlmostEqual(a / b, 1, delta=0.5)

    def test_threads(self):
        molecules = [(s.chain(100), 125)]
        self.scene(molecules, 16.0, interacting=False, dt=0.002, nsteps=5)
        self.assert_same(self.both(FREE, threads=2), 1e-6)
        g.mdrun(self.folder, name="one")
        one, two = (g.energies(self.folder, FREE, g.DOUBLE, name) for name in ("one", "exact"))
        for a, b in zip(one["Kinetic En."], two["Kinetic En."]):
            self.assertAlmostEqual(a / b, 1, delta=1e-13)  # GROMACS sums by thread

    def test_cholesterol_on_one_two_and_four_ranks(self):
        self.scene([(s.cholesterol(), 125)], 1.3, dt=0.02, nsteps=25, nstenergy=25)
        for ranks in ("1", "2", "4"):
            with self.subTest(ranks=ranks):
                g.mdrun(self.folder, "-ntmpi", ranks, "-dlb", "no", holonomic=False, name="lincs")
                g.mdrun(self.folder, "-ntmpi", ranks, "-dlb", "no", name="exact")
                self.assert_same(tuple(g.energies(self.folder, ALL, g.DOUBLE, name) for name in ("lincs", "exact")))

    def test_molecules_that_domains_cut(self):
        """Each rank solves those of which it has an atom, and counts its part of the sums."""
        for integrator, ranks in (("md", "2"), ("md-vv", "2"), ("md", "4")):
            with self.subTest(integrator=integrator, ranks=ranks):
                self.scene([(s.alkane(4), 125)], 1.0, integrator=integrator, constraints="all-bonds", nsteps=8, nstlist=4)
                g.mdrun(self.folder, name="one")
                g.mdrun(self.folder, "-ntmpi", ranks, name="exact")
                self.assert_same(tuple(g.energies(self.folder, ALL, g.DOUBLE, name) for name in ("one", "exact")))

    def test_free_energy_of_molecules_that_domains_cut(self):
        a = s.alkane(3)
        molecule = s.Molecule("PER", [(kind, name, m, 1.3 * m) for kind, name, m in a.atoms], a.places, angles=a.angles,
                              constraints=[(i, j, length, 1.05 * length) for i, j, length, _ in a.bonds])
        self.scene([(molecule, 125)], 1.0, free_energy="yes", nstdhdl=1, init_lambda=0.5, nstlist=5, nsteps=6)
        # On as many ranks: the virial that GROMACS 2025 writes there is another one than on one, with LINCS as well.
        for ranks in ("1", "2"):
            with self.subTest(ranks=ranks):
                g.mdrun(self.folder, "-ntmpi", ranks, holonomic=False, name="lincs")
                g.mdrun(self.folder, "-ntmpi", ranks, name="exact")
                self.assert_same(tuple(g.energies(self.folder, ALL + ["dVremain/dl"], g.DOUBLE, name)
                                       for name in ("lincs", "exact")))

    def test_a_membrane_on_one_two_and_four_ranks(self):
        """Its cholesterol, with virtual sites and a tail, is no update group."""
        membrane.write(self.folder)
        quiet = dict(coulombtype="reaction-field", epsilon_rf=0, epsilon_r=15, lincs_order=4)
        s.write_mdp(self.folder, **quiet, integrator="steep", nsteps=30, emtol=100, gen_vel="no")
        g.grompp(self.folder)
        g.mdrun(self.folder, name="relaxed")
        s.write_mdp(self.folder, **quiet, nsteps=8, dt=0.01, nstlist=4)
        g.grompp(self.folder, g.DOUBLE, "-c", "relaxed.gro")
        g.mdrun(self.folder, name="one")
        for ranks in ("2", "4"):
            with self.subTest(ranks=ranks):
                g.mdrun(self.folder, "-ntmpi", ranks, name="exact")
                # velocities of the start differ by a relative 1e-7 between ranks, with LINCS by as much
                self.assert_same(tuple(g.energies(self.folder, ALL, g.DOUBLE, name) for name in ("one", "exact")), 2e-6,
                                 skip=("Pressure", "Pres-ZZ", "Vir-XY"))  # small differences of large numbers

    def test_molecules_that_reach_too_far_are_refused(self):
        self.scene([(s.chain(30), 27)], 3.0, nsteps=2, lincs_order=4)
        for ranks in ("2", "4"):
            with self.subTest(ranks=ranks), self.assertRaisesRegex(g.Failed, r"mdrun\s+-ntmpi\s+1\s+-ntomp\s+N"):
                g.mdrun(self.folder, "-ntmpi", ranks, name="exact")
        g.mdrun(self.folder, "-ntmpi", "1", name="exact", threads=2)

    @unittest.skipUnless(g.has("gmx_mpi_d") and g.has("mpirun"), "no MPI build of GROMACS")
    def test_mpi(self):
        self.scene(self.MOLECULES, 1.0, constraints="h-bonds", nsteps=20)
        g.mdrun(self.folder, holonomic=False, name="lincs")
        g.call([*g.MPIRUN[:-1], "2", g.WRAPPER, "-quiet", "mdrun", "-s", "topol.tpr", "-deffnm", "exact", "-ntomp", "1",
                "-pin", "off"], self.folder, environment={"GMX": "gmx_mpi_d"})
        self.assert_same((g.energies(self.folder, ALL, g.DOUBLE, "lincs"), g.energies(self.folder, ALL, g.DOUBLE, "exact")))


class Words(Case):
    def test_the_log_says_what_was_taken_over(self):
        self.scene(BUTANES, 0.9, constraints="h-bonds", nsteps=2)
        said = g.mdrun(self.folder, name="exact")
        for text in (said, (self.folder / "exact.log").read_text()):
            self.assertRegex(text, r"Constraints by holonomic \S+ \(\S+\) in place of LINCS, in GROMACS 20\d\d")
            self.assertRegex(text, r"Taken over: .*gmx::constrain_lincs")

    def test_each_build_of_gromacs_has_the_functions(self):
        for gmx in ("gmx", "gmx_d", "gmx_mpi", "gmx_mpi_d"):
            if g.has(gmx) and (g.has("mpirun") or "mpi" not in gmx):
                with self.subTest(gmx=gmx):
                    self.assertIn("GROMACS version", g.call([*(g.MPIRUN if "mpi" in gmx else []), g.WRAPPER, "--version"],
                                                            self.folder, environment={"GMX": gmx}))

    def test_another_precision_is_told_and_nothing_is_run(self):
        objects = [p for p in pathlib.Path(g.os.environ.get("HOLONOMIC_GROMACS", g.HERE)).glob("libholonomic_gromacs.so")]
        self.assertTrue(objects, "no libholonomic_gromacs.so where HOLONOMIC_GROMACS says")
        done = subprocess.run(["gmx_d", "--version"], env={**g.os.environ, "LD_PRELOAD": str(objects[0])}, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        self.assertEqual(done.returncode, 1)
        self.assertIn("gmx::constrain_lincs", done.stdout)
        self.assertNotIn("GROMACS version", done.stdout)

    def test_programs_without_gromacs_are_left_alone(self):
        objects = pathlib.Path(g.os.environ.get("HOLONOMIC_GROMACS", g.HERE)) / "libholonomic_gromacs.so"
        done = subprocess.run(["true"], env={**g.os.environ, "LD_PRELOAD": str(objects)}, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        self.assertEqual((done.returncode, done.stdout), (0, ""))

    def test_update_on_a_device_is_refused(self):
        with self.assertRaisesRegex(g.Failed, "-update cpu"):
            g.call([g.WRAPPER, "mdrun", "-update", "gpu"], self.folder)

    def test_all_angles_of_an_alkane_are_held(self):
        """More distances than freedoms, of which no force field's are quite those of places in space."""
        self.scene([(s.alkane(4), 8)], 1.2, constraints="all-angles")
        g.mdrun(self.folder, name="exact")
        rmsd = g.energies(self.folder, ["Constr.-rmsd"], name="exact")["Constr. rmsd"]
        self.assertLess(max(rmsd), 1e-3)  # of the topology's lengths, which have been adjusted by less

    def exploding(self, **options):
        self.scene([(s.chain(6), 27)], 0.8, dt=0.05, nsteps=200, lincs_warnangle=30, gen_temp=3000, **options)

    def test_turned_bonds_are_counted_until_it_is_enough(self):
        self.exploding()
        with self.assertRaisesRegex(g.Failed, r"Too many LINCS warnings \(\d+\)") as failed:
            g.mdrun(self.folder, name="exact", environment={"GMX_MAXCONSTRWARN": "5"})
        self.assertRegex(str(failed.exception), r"CONSTRAINT WARNING\nrelative constraint deviation: rms")
        self.assertRegex(str(failed.exception), r"bonds that rotated more than 30 degrees:")

    def test_atoms_of_another_rank_have_their_numbers_of_the_topology(self):
        self.scene([(s.cholesterol(), 125)], 1.2, dt=0.02, nsteps=3, lincs_warnangle=2)
        said = {}
        for ranks in ("1", "2"):
            said[ranks] = g.mdrun(self.folder, "-ntmpi", ranks, name="exact", environment={"GMX_MAXCONSTRWARN": "9999"})
        told = {ranks: sorted(set(re.findall(r"^ +(\d+) +(\d+) +[\d.]+ +[\d.]+ +[\d.]+ +0.2719$", text, re.M)))
                for ranks, text in said.items()}
        self.assertGreater(len(told["1"]), 5)
        self.assertEqual(told["1"], told["2"])

    def test_a_crude_start_is_moved(self):
        molecule = s.chain(6)
        molecule.places = [(1.25 * x, 1.25 * y, z) for x, y, z in molecule.places]
        self.scene([(molecule, 8)], 1.5, nsteps=2, nstxout=1)
        self.assertIn("Molecules were moved onto their lengths", g.mdrun(self.folder, name="exact"))
        self.assertLess(self.worst_length([(molecule, 8)], constraints_of)[0], 1e-13)

    def test_what_cannot_be_solved_is_told_and_dumped(self):
        molecule = s.chain(6)
        molecule.places = [(7 * x, 7 * y, z) for x, y, z in molecule.places]
        self.scene([(molecule, 8)], 8.0, nsteps=2, interacting=False, continuation="yes", gen_vel="no")
        said = g.mdrun(self.folder, name="exact", environment={"GMX_SUPPRESS_DUMP": None})
        self.assertRegex(said, r"molecules? could not be solved: hol_project_positions: .*atom")
        self.assertIn("Constraint error in algorithm Lincs", (self.folder / "exact.log").read_text())


@unittest.skipUnless(g.os.environ.get("HOLONOMIC_GROMACS_LONG"), "HOLONOMIC_GROMACS_LONG is not set")
class Long(Case):
    def test_a_restart_of_a_membrane_loses_nothing(self):
        """1e5 steps of DPPC and cholesterol."""
        membrane.write(self.folder)
        quiet = dict(coulombtype="reaction-field", epsilon_r=15, epsilon_rf=0, rcoulomb=1.1, rvdw=1.1, rlist=1.3,
                     vdw_modifier="potential-shift", nstlist=20, nstenergy=1000, nstcalcenergy=100)
        s.write_mdp(self.folder, **{**quiet, "integrator": "steep", "nsteps": 200, "emtol": 100, "gen_vel": "no"})
        g.grompp(self.folder, g.MIXED)
        g.mdrun(self.folder, gmx=g.MIXED, name="relaxed")
        s.write_mdp(self.folder, **{**quiet, "dt": 0.02, "nsteps": 100000, "tcoupl": "v-rescale", "tc_grps": "System", "tau_t": 1,
                                    "ref_t": 323, "gen_temp": 323, "pcoupl": "c-rescale", "pcoupltype": "semiisotropic",
                                    "tau_p": 4, "ref_p": "1 1", "compressibility": "3e-4 3e-4"})
        g.grompp(self.folder, g.MIXED, "-c", "relaxed.gro")
        whole, part = self.restart(100000, g.MIXED)
        # GROMACS goes on with forces summed in another order, also with LINCS: equal at the restart, alike after it.
        at = whole["time"].index(part["time"][0])
        for term in set(whole) - {"time"}:
            self.assertAlmostEqual(whole[term][at], part[term][0], delta=1e-5 * max(abs(e) for e in whole[term]), msg=term)
        for term in ("Potential", "Kinetic En."):
            means = [statistics.fmean(values) for values in (whole[term][at:], part[term])]
            self.assertAlmostEqual(means[0] / means[1], 1, delta=5e-3, msg=term)
            print(term, *means)


if __name__ == "__main__":
    unittest.main()
