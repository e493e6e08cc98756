"""The constraint for ASE as its users take it: in place of FixBondLengths, beside other constraints, by what the atoms are."""

import copy
import pickle
import unittest
import warnings

import numpy as np
from ase import Atoms, units
from ase.build import bulk, molecule
from ase.calculators.calculator import Calculator
from ase.constraints import FixAtoms, FixCartesian, FixLinearTriatomic, dict2constraint
from ase.constraints import FixBondLengths as OfASE
from ase.md.nptberendsen import NPTBerendsen
from ase.md.verlet import VelocityVerlet

import holonomic as hol
from holonomic.ase import Constraint, FixBondLength, FixBondLengths


class Nothing(Calculator):
    """No forces."""

    implemented_properties = ["energy", "forces", "stress"]

    def calculate(self, atoms=None, properties=("energy",), system_changes=()):
        super().calculate(atoms, properties, system_changes)
        self.results = {"energy": 0.0, "forces": np.zeros((len(self.atoms), 3)), "stress": np.zeros(6)}


def lengths_of(atoms, pairs):
    return np.array([atoms.get_distance(int(i), int(j), mic=True) for i, j in pairs])


def shaken(atoms, size=0.05, seed=0):
    return atoms.positions + size * np.random.default_rng(seed).normal(size=(len(atoms), 3))


def waters(n=27, edge=9.3, seed=0):
    """Rigid waters of one shape in a cube, at random, cut by its faces."""
    rng = np.random.default_rng(seed)
    side = round(n ** (1 / 3))
    water = np.array([(0, 0, 0), (0.9572, 0, 0), (-0.239987, 0.926627, 0)])
    places = [edge / side * np.array(p) for p in np.ndindex(side, side, side)]
    positions = []
    for place in places:
        q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        positions += list(place + water @ q)
    return Atoms("OH2" * n, positions=positions, cell=[edge] * 3, pbc=True)


class InPlaceOfFixBondLengths(unittest.TestCase):
    def test_positions_beside_ase(self):
        warnings.simplefilter("ignore", hol.LengthsWarning)
        for make in (lambda c: c([[-3, -2], [-3, -1]]), lambda c: c([(0, 1), (1, 0), (0, 2)]),
                     lambda c: c(pairs=[(0, 1)], bondlengths=[1.0], tolerance=1e-10), lambda c: c([(0, 1)], 1e-13, [1.1])):
            ends = []
            for of in (OfASE, FixBondLengths):
                atoms = molecule("H2O")
                atoms.set_constraint(make(of))
                atoms.set_positions(shaken(atoms))
                ends.append(atoms.positions.copy())
            np.testing.assert_allclose(*ends, atol=1e-11)

    def test_names_of_arguments_are_taken_by_constraint_as_well(self):
        constraint = Constraint(pairs=[(0, 1)], bondlengths=[1.0], tolerance=1e-10)
        np.testing.assert_array_equal(constraint.bondlengths, [1.0])
        np.testing.assert_array_equal(FixBondLength(0, 2).pairs, [(0, 2)])

    def test_positions_that_were_written_over_are_a_start_like_any_other(self):
        ends = []
        for of in (OfASE, FixBondLengths):
            atoms = Atoms("X2", positions=[(0, 0, 0), (0, 0, 1)], constraint=of([(0, 1)]))
            atoms.set_positions([(0, 0, 0), (0, 0.1, 1)])
            atoms.positions[:] = [(1, 2, 3), (4, 5, 6)]
            atoms.set_positions([(1, 2, 3), (4, 5, 6.2)])
            ends.append(atoms.positions.copy())
            self.assertAlmostEqual(atoms.get_distance(0, 1), 1, 12)
        np.testing.assert_allclose(*ends, atol=1e-10)

    def test_given_lengths_that_do_not_fit_are_reached_with_a_warning(self):
        atoms = Atoms("N2", positions=[(0, 0, 0), (0, 0, 1)], constraint=Constraint([(0, 1)], 1.3))
        with self.assertWarnsRegex(hol.LengthsWarning, "1 long .* it should be 1.3"):
            atoms.set_positions(shaken(atoms))
        self.assertAlmostEqual(atoms.get_distance(0, 1), 1.3, 12)

    def test_a_bond_longer_than_half_the_cell(self):
        for atoms, pairs in ((bulk("Cu", cubic=True) * (2, 2, 2), [(0, 3)]), (bulk("Cu") * (2, 2, 2), [(0, 1)]),
                             (Atoms("ArNeHe", positions=[(0, 0, 0), (2.7, 2.7, 0), (5.3, 5.3, 0.4)], cell=[7.22] * 3, pbc=True),
                              [(0, 1), (1, 2)])):
            if len(pairs) == 1:
                atoms.set_distance(*pairs[0], 3.8295 if len(atoms) > 8 else 3.06, mic=True)
            lengths = lengths_of(atoms, pairs)
            for wrap in (False, True):
                ends = []
                for of in (OfASE, FixBondLengths):
                    of_kind = atoms.copy()
                    if wrap:
                        of_kind.positions += 3.3
                        of_kind.wrap()
                    of_kind.set_constraint(of(pairs))
                    of_kind.set_positions(shaken(of_kind))
                    momenta = np.random.default_rng(1).normal(size=(len(of_kind), 3))
                    of_kind.set_momenta(momenta)
                    ends.append((of_kind.positions.copy(), of_kind.get_momenta()))
                np.testing.assert_allclose(lengths_of(of_kind, pairs), lengths, atol=1e-12)
                np.testing.assert_allclose(ends[0][0], ends[1][0], atol=1e-10)
                np.testing.assert_allclose(ends[0][1], ends[1][1], atol=1e-10)

    def test_a_ring_through_the_faces_with_such_a_bond_is_an_error(self):
        atoms = Atoms("He3", positions=[(0, 0, 0), (2, 2.6, 0), (4, 0, 0)], cell=[6, 5, 5], pbc=True)
        atoms.set_constraint(Constraint([(0, 1), (1, 2), (2, 0)]))
        with self.assertRaisesRegex(ValueError, "closes a ring"):
            atoms.set_positions(shaken(atoms))

    def test_numbers_that_are_no_atoms(self):
        for pairs in ([(0, 3)], [(0, -4)]):
            atoms = molecule("H2O")
            atoms.set_constraint(Constraint(pairs))
            with self.assertRaisesRegex(IndexError, str(pairs[0][1])):
                atoms.set_positions(shaken(atoms))
        with self.assertRaises(TypeError):
            Constraint([(0.0, 1.0)])
        atoms.set_constraint(Constraint([(1, 1)]))
        with self.assertRaisesRegex(ValueError, "itself"):
            atoms.set_positions(shaken(atoms))

    def test_a_bond_given_twice_with_two_lengths(self):
        atoms = molecule("H2O")
        atoms.set_constraint(Constraint([(0, 1), (1, 0)], [1.0, 1.1]))
        with self.assertRaisesRegex(ValueError, "atoms 1 and 0 is given twice"):
            atoms.set_positions(shaken(atoms))


class BesideOthers(unittest.TestCase):
    def test_fix_atoms_that_holds_all_that_is_bonded(self):
        for bodies in (False, True):
            atoms = molecule("H2O") + Atoms("He", positions=[(0, 0, 5)])
            atoms.set_constraint([FixAtoms([0, 1, -2]), Constraint(bodies=[[0, 1, 2]]) if bodies else Constraint([(0, 1), (0, 2)])])
            before = atoms.positions.copy()
            atoms.set_positions(shaken(atoms))
            atoms.set_momenta(np.ones((4, 3)))
            np.testing.assert_array_equal(atoms.positions[:3], before[:3])
            np.testing.assert_array_equal(atoms.get_momenta(), [(0, 0, 0)] * 3 + [(1, 1, 1)])
            self.assertEqual(sum(c.get_removed_dof(atoms) for c in atoms.constraints), 9)

    def test_all_atoms_held(self):
        atoms = molecule("H2O")
        atoms.calc = Nothing()
        atoms.set_constraint([Constraint([(0, 1), (0, 2)]), FixAtoms([0, 1, 2])])
        before = atoms.positions.copy()
        atoms.set_positions(shaken(atoms))
        np.testing.assert_array_equal(atoms.positions, before)
        np.testing.assert_array_equal(atoms.get_forces(), 0)

    def test_a_body_that_is_held_in_part_is_refused(self):
        atoms = molecule("H2O")
        atoms.set_constraint([FixAtoms([0]), Constraint.rigid([0, 1, 2])])
        with self.assertRaisesRegex(ValueError, "atom 0 is held"):
            atoms.set_positions(shaken(atoms))

    def test_two_that_share_an_atom_act_as_one(self):
        one = molecule("CH4")
        pairs = [(0, k) for k in range(1, 5)]
        one.set_constraint(Constraint(pairs))
        two = one.copy()
        two.set_constraint([Constraint(pairs[:1]), Constraint(pairs[1:3]), FixAtoms([]), Constraint(pairs[3:])])
        lengths = lengths_of(one, pairs)
        for atoms in (one, two):
            atoms.calc = Nothing()
            atoms.set_positions(shaken(atoms))
            atoms.set_momenta(np.random.default_rng(2).normal(size=(5, 3)))
            np.testing.assert_allclose(lengths_of(atoms, pairs), lengths, atol=1e-13)
            self.assertEqual(sum(c.get_removed_dof(atoms) for c in atoms.constraints), 4)
        np.testing.assert_allclose(one.positions, two.positions, atol=1e-13)
        np.testing.assert_allclose(one.get_momenta(), two.get_momenta(), atol=1e-13)

    def test_their_stress_is_counted_once(self):
        stresses = []
        for split in (False, True):
            atoms = molecule("CH4", cell=[8, 8, 8], pbc=True)
            atoms.calc = Nothing()
            atoms.set_momenta(np.random.default_rng(2).normal(size=(5, 3)))
            pairs = [(0, k) for k in range(1, 5)]
            atoms.set_constraint([Constraint(pairs[:1]), Constraint(pairs[1:])] if split else Constraint(pairs))
            atoms.set_momenta(atoms.get_momenta())
            stresses.append(atoms.get_stress())
        np.testing.assert_allclose(*stresses, rtol=1e-12)
        self.assertGreater(abs(stresses[0]).max(), 1e-6)

    def test_two_that_share_no_atom_stay_apart(self):
        atoms = molecule("H2O") + Atoms("N2", positions=[(0, 0, 5), (0, 0, 6)])
        parts = [Constraint([(0, 1)]), Constraint([(3, 4)])]
        atoms.set_constraint(parts)
        self.assertEqual([c.get_removed_dof(atoms) for c in parts], [1, 1])
        self.assertEqual(parts[0].molecules(atoms).n_bonds, 1)

    def test_other_constraints_of_lengths_at_the_same_atoms_are_refused(self):
        for other in (OfASE([(0, 1)]), FixLinearTriatomic([(1, 0, 2)])):
            atoms = molecule("H2O")
            atoms.set_constraint([other, Constraint([(0, 2)])])
            with self.assertRaisesRegex(ValueError, "share atom 0"):
                atoms.set_momenta(np.ones((3, 3)))

    def test_those_that_move_atoms_afterwards_are_warned_of(self):
        atoms = molecule("H2O")
        atoms.set_constraint([Constraint([(0, 2)]), FixCartesian(0)])
        with self.assertWarnsRegex(UserWarning, "FixCartesian .* share atom 0"):
            atoms.set_positions(shaken(atoms))


class WhatAtomsAre(unittest.TestCase):
    def test_waters(self):
        atoms = waters()
        constraint = Constraint.waters(atoms)
        self.assertEqual(len(constraint.pairs), 81)
        atoms.set_constraint(constraint)
        self.assertEqual(constraint.molecules(atoms).n_of_shape("triangle"), 27)
        self.assertEqual(3 * 81 - constraint.get_removed_dof(atoms), 6 * 27)
        before = lengths_of(atoms, constraint.pairs)
        atoms.set_positions(shaken(atoms))
        np.testing.assert_allclose(lengths_of(atoms, constraint.pairs), before, atol=1e-13)
        given = Constraint.waters(atoms, (0.96, 1.52))
        atoms.set_constraint(given)
        given.impose(atoms)
        np.testing.assert_allclose(lengths_of(atoms, given.pairs), [0.96] * 54 + [1.52] * 27, atol=1e-13)
        with self.assertRaisesRegex(ValueError, "no water"):
            Constraint.waters(molecule("CH3OH"))
        with self.assertRaisesRegex(ValueError, "no water"):
            Constraint.waters(molecule("H2O2"))

    def test_hydrogens(self):
        self.assertEqual(sorted(map(tuple, Constraint.hydrogens(molecule("CH3CH2OH")).pairs.tolist())),
                         [(0, 3), (1, 6), (1, 7), (2, 4), (2, 5), (2, 8)] if molecule("CH3CH2OH").numbers[1] == 8 else
                         sorted((int(np.argmin(d)), h) for h, d in _heavy_distances(molecule("CH3CH2OH"))))
        np.testing.assert_array_equal(Constraint.hydrogens(molecule("H2")).pairs, [(0, 1)])
        both = molecule("CH3OH") + Atoms("OH2", positions=molecule("H2O").positions + (0, 0, 6))
        self.assertEqual(len(Constraint.hydrogens(both).pairs), 6)
        self.assertEqual(len(Constraint.hydrogens(both, waters=True).pairs), 7)
        with self.assertRaisesRegex(ValueError, "atom 0"):
            Constraint.hydrogens(Atoms("HAr", positions=[(0, 0, 0), (0, 0, 4)]))
        with self.assertRaisesRegex(ValueError, "no hydrogen"):
            Constraint.hydrogens(molecule("CO2"))

    def test_bodies(self):
        atoms = molecule("C6H6")
        atoms.calc = Nothing()
        atoms.set_momenta(np.random.default_rng(3).normal(size=(12, 3)))
        constraint = Constraint.rigid(range(12))
        atoms.set_constraint(constraint)
        atoms.set_momenta(atoms.get_momenta())
        self.assertEqual(36 - constraint.get_removed_dof(atoms), 6)
        before, energy = atoms.get_all_distances(), atoms.get_kinetic_energy()
        VelocityVerlet(atoms, 0.5 * units.fs, logfile=None).run(50)
        np.testing.assert_allclose(atoms.get_all_distances(), before, atol=1e-11)
        self.assertAlmostEqual(atoms.get_kinetic_energy() / energy, 1, 4)
        self.assertEqual(len(Constraint.rigid([[0, 1], [2, 3]]).todict()["kwargs"]["pairs"]), 2)

    def test_co2_by_its_bonds_and_angle(self):
        for positions in (None, [(0, 0, 0), (0.3, 1.1, -0.2), (0.6, 2.2, -0.4)]):
            atoms = molecule("CO2") if positions is None else Atoms("OCO", positions=positions)
            c = int(np.flatnonzero(atoms.numbers == 6)[0])
            o = [k for k in range(3) if k != c]
            constraint = Constraint([(o[0], c), (c, o[1])], angles=[(o[0], c, o[1])])
            atoms.calc = Nothing()
            atoms.set_momenta(np.random.default_rng(3).normal(size=(3, 3)))
            atoms.set_constraint(constraint)
            atoms.set_momenta(atoms.get_momenta())
            self.assertEqual(9 - constraint.get_removed_dof(atoms), 5)
            before = atoms.get_all_distances()
            VelocityVerlet(atoms, 1 * units.fs, logfile=None).run(20)
            np.testing.assert_allclose(atoms.get_all_distances(), before, atol=1e-12)
            self.assertAlmostEqual(atoms.get_angle(o[0], c, o[1]), 180, 4)

    def test_lengths_that_a_wrong_cell_has_made_are_warned_of(self):
        atoms = waters()
        atoms.wrap()
        right = Constraint.waters(atoms)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            atoms.set_constraint(right)
            atoms.set_positions(shaken(atoms))
        for bodies in (False, True):
            atoms = waters()
            atoms.wrap()
            atoms.set_cell([9.4] * 3)
            atoms.set_constraint(Constraint.rigid(np.arange(81).reshape(27, 3).tolist()) if bodies else Constraint.waters(atoms))
            with self.assertWarnsRegex(hol.LengthsWarning, "face of the cell cuts"):
                atoms.set_positions(shaken(atoms))

    def test_lengths_that_can_not_be(self):
        for length in (-1.0, 0.0, np.nan):
            atoms = waters(8, 6.2)
            atoms.set_constraint(Constraint([(0, 1), (3, 4)], [0.97, length]))
            with self.assertRaisesRegex(ValueError, "bond of atoms 3 and 4 has the length"):
                atoms.set_positions(shaken(atoms))

    def test_a_step_that_explodes_says_so(self):
        atoms = waters(8, 6.2)
        atoms.set_constraint(Constraint.waters(atoms))
        before = atoms.positions.copy()
        new = before.copy()
        new[4] += (40, 0, 0)
        with self.assertRaisesRegex(hol.Error, "forces or time step"):
            atoms.set_positions(new)


def _heavy_distances(atoms):
    heavy = np.where(atoms.numbers > 1, 0, np.inf)
    d = atoms.get_all_distances() + heavy[None]
    return [(h, d[h]) for h in np.flatnonzero(atoms.numbers == 1)]


class Pressure(unittest.TestCase):
    def test_of_rigid_molecules_in_free_flight_is_that_of_their_centres(self):
        # The trace of the virial of a rigid molecule is its centre's: u.u' = 0.
        rng = np.random.default_rng(0)
        for shape, bodies in (("N2", False), ("N2", True), ("H2O", False), ("H2O", True), ("CO2", True)):
            one = molecule(shape)
            n, k, edge = 20, len(one), 25.0
            atoms = Atoms(cell=[edge] * 3, pbc=True)
            for _ in range(n):
                q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
                atoms += Atoms(one.symbols, positions=one.positions @ q + rng.uniform(0, edge, 3))
            atoms.wrap()
            atoms.calc = Nothing()
            groups = np.arange(n * k).reshape(n, k)
            pairs = [(g[i], g[j]) for g in groups for j in range(k) for i in range(j)]
            atoms.set_constraint(Constraint.rigid(groups.tolist()) if bodies else Constraint(pairs))
            atoms.set_momenta(rng.normal(size=(n * k, 3)))
            p = atoms.get_momenta().reshape(n, k, 3).sum(1)
            masses = atoms.get_masses().reshape(n, k).sum(1)
            wanted = (p**2).sum(1) @ (1 / masses) / (3 * edge**3)
            stress = atoms.get_stress(include_ideal_gas=True)
            self.assertAlmostEqual(-stress[:3].mean() / wanted, 1, 10, shape)

    def test_at_rest_is_the_derivative_of_the_energy(self):
        # A spring between the ends of an angle of rigid bonds, in a cell: E of the cell that is stretched, bonds kept.
        class Spring(Calculator):
            implemented_properties = ["energy", "forces", "stress"]

            def calculate(self, atoms=None, properties=("energy",), system_changes=()):
                super().calculate(atoms, properties, system_changes)
                d = self.atoms.get_distance(0, 2, mic=True, vector=True)
                f = np.zeros((3, 3))
                f[0], f[2] = 2.0 * d, -2.0 * d
                w = np.outer(d, d) * 2.0 / self.atoms.get_volume()
                self.results = {"energy": d @ d, "forces": f, "stress": w[[0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1]]}

        def strained(strain):
            atoms = Atoms("OCN", positions=[(0, 0, 0), (1, 0.2, 0.1), (1.3, 1.1, -0.2)], cell=[9, 9, 9], pbc=True)
            lengths = lengths_of(atoms, [(0, 1), (1, 2)])
            constraint = Constraint([(0, 1), (1, 2)], lengths)
            atoms.set_constraint(constraint)
            atoms.calc = Spring()
            atoms.set_cell(atoms.cell.array @ (np.eye(3) + strain), scale_atoms=True)
            atoms.set_positions(atoms.positions)
            return atoms

        stress = strained(np.zeros((3, 3))).get_stress()
        h = 1e-5
        for place, (a, b) in enumerate([(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]):
            strain = np.zeros((3, 3))
            strain[a, b] += h / 2
            strain[b, a] += h / 2
            rise = (strained(strain).get_potential_energy() - strained(-strain).get_potential_energy()) / (2 * h)
            self.assertAlmostEqual(stress[place] * 9**3, rise, 5)

    def test_berendsen_comes_to_its_pressure(self):
        rng = np.random.default_rng(4)
        n, edge, pressure = 30, 20.0, 2e-4
        atoms = Atoms("N" * (2 * n), positions=np.repeat(rng.uniform(0, edge, (n, 3)), 2, axis=0), cell=[edge] * 3, pbc=True)
        atoms.positions[1::2, 0] += 1.1
        atoms.calc = Nothing()
        constraint = Constraint(np.arange(2 * n).reshape(n, 2))
        atoms.set_constraint(constraint)
        atoms.set_momenta(rng.normal(size=(2 * n, 3)))
        md = NPTBerendsen(atoms, timestep=0.5 * units.fs, temperature_K=300, taut=50 * units.fs, pressure_au=pressure,
                          taup=50 * units.fs, compressibility_au=6e3, logfile=None)
        md.run(700)
        p = atoms.get_momenta().reshape(n, 2, 3).sum(1)
        of_centres = (p**2).sum() / 28.014 / (3 * atoms.get_volume())
        self.assertAlmostEqual(of_centres / pressure, 1, 2)


class Bookkeeping(unittest.TestCase):
    def test_repr(self):
        self.assertEqual(repr(Constraint([(0, 1)], 1.0)), "Constraint([[0, 1]], lengths=[1.0])")
        self.assertEqual(repr(Constraint.rigid([0, 1, 2])), "Constraint(bodies=[[0, 1, 2]])")
        self.assertLess(len(repr(Constraint(np.arange(600).reshape(300, 2)))), 120)

    def test_copies_keep_everything(self):
        atoms = molecule("C2H6")
        constraint = Constraint([(0, 1)], angles=[(0, 1, 2)], bodies=[[-1, -2, -3]])
        for other in (constraint.copy(), copy.deepcopy(constraint), pickle.loads(pickle.dumps(constraint)), copy.copy(constraint)):
            self.assertEqual(repr(other), repr(constraint))
        atoms.set_constraint(constraint)
        atoms.set_positions(shaken(atoms))
        for other in (constraint.copy(), copy.deepcopy(constraint), pickle.loads(pickle.dumps(constraint))):
            np.testing.assert_array_equal(other.lengths, constraint.lengths)
            again = molecule("C2H6")
            again.set_constraint(other)
            again.set_positions(shaken(again, seed=5))
            self.assertAlmostEqual(again.get_distance(0, 1), constraint.lengths[0], 12)

    def test_selections_deletions_and_repetitions(self):
        atoms = molecule("C2H6", cell=[9, 9, 9], pbc=True)
        atoms.set_constraint(Constraint([(0, -1), (1, 2)], bodies=[[3, 4, 5]]))
        part = atoms[[7, 0, 3, 4, 5]].constraints[0]
        np.testing.assert_array_equal(part.pairs, [(1, 0)])
        np.testing.assert_array_equal(part._kept.bodies, [(2, 3, 4)])
        twice = atoms.repeat((1, 2, 1))
        np.testing.assert_array_equal(twice.constraints[0].pairs, [(0, 7), (1, 2), (8, 15), (9, 10)])
        rest = atoms.constraints[0].delete_atoms([0], 8)
        np.testing.assert_array_equal(rest.pairs, [(0, 1)])
        self.assertIsNone(rest.delete_atoms([0, -4], 7))

    def test_what_files_have_of_a_body_keeps_it(self):
        atoms = molecule("CH4")
        constraint = Constraint.rigid(range(5))
        atoms.set_constraint(constraint)
        atoms.set_positions(atoms.positions)
        before = atoms.get_all_distances()
        atoms.set_constraint(dict2constraint(constraint.todict()))
        self.assertIsInstance(atoms.constraints[0], OfASE)
        atoms.set_positions(shaken(atoms, 0.01))
        np.testing.assert_allclose(atoms.get_all_distances(), before, atol=1e-9)


if __name__ == "__main__":
    unittest.main()
