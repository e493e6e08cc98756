"""Flat and straight groups that share atoms, and atoms that are one point, against singular values of all rows."""

import itertools
import pickle
import unittest

import numpy as np

import holonomic as hol


def about(axis, angle):
    axis = axis / np.linalg.norm(axis)
    k = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


def with_angles(bonds):
    """All bonds, and the distances that hold their angles."""
    partners = {}
    for a, b in bonds:
        partners.setdefault(a, []).append(b)
        partners.setdefault(b, []).append(a)
    ends = {tuple(sorted(pair)) for its in partners.values() for pair in itertools.combinations(its, 2)}
    return sorted(ends | {tuple(sorted(bond)) for bond in bonds})


def grow(bonds, length, angles, torsions):
    """Positions from bonds, each to an atom that is there: (parent, length, grandparent, angle, third, torsion)."""
    r = []
    for parent, a, grand, angle, third, torsion in bonds:
        if parent is None:
            r.append(np.zeros(3))
        elif grand is None:
            r.append(r[parent] + [a, 0, 0])
        else:
            u = r[grand] - r[parent]
            u /= np.linalg.norm(u)
            w = np.array([0.0, 1, 0]) if third is None else r[third] - r[grand]
            w = w - u * (u @ w)
            w /= np.linalg.norm(w)
            w = about(u, -np.radians(torsion)) @ w
            r.append(r[parent] + a * (np.cos(np.radians(angle)) * u + np.sin(np.radians(angle)) * w))
    return np.array(r)


# Atoms one after the other: parent, length, the atom before it, angle, one more, torsion. Masses, and groups that are
# flat or straight whatever the torsions are.
def ethylene(rng):
    t = rng.uniform(0, 360)
    z = [(None, 0, None, 0, None, 0), (0, 1.33, None, 0, None, 0), (0, 1.09, 1, 121.3, None, 0),
         (0, 1.09, 1, 121.3, 2, 180), (1, 1.09, 0, 121.3, 2, t), (1, 1.09, 0, 121.3, 2, t + 180)]
    bonds = [(0, 1), (0, 2), (0, 3), (1, 4), (1, 5)]
    return z, [12.0, 12, 1, 1, 1, 1], bonds, [(0, 1, 2, 3), (1, 0, 4, 5)], 7


def guanidinium(rng):
    z = [(None, 0, None, 0, None, 0), (0, 1.33, None, 0, None, 0), (0, 1.33, 1, 120, None, 0), (0, 1.33, 1, 120, 2, 180)]
    bonds, groups, masses = [(0, 1), (0, 2), (0, 3)], [(0, 1, 2, 3)], [12.0, 14, 14, 14]
    for k in (1, 2, 3):
        t, n = rng.uniform(0, 360), len(z)
        z += [(k, 1.01, 0, 120, k % 3 + 1, t), (k, 1.01, 0, 120, k % 3 + 1, t + 180)]
        bonds += [(k, n), (k, n + 1)]
        groups.append((k, 0, n, n + 1))
        masses += [1.0, 1.0]
    return z, masses, bonds, groups, 9


def acetamide(rng):
    """N-methylacetamide: CH3 - CO - NH - CH3, with peptide's two flat groups."""
    w, s, t = rng.uniform(0, 360, 3)
    z = [(None, 0, None, 0, None, 0), (0, 1.34, None, 0, None, 0),  # C, N
         (0, 1.23, 1, 123, None, 0), (0, 1.51, 1, 116, 2, 180),  # O, CH3
         (1, 1.01, 0, 119, 2, w), (1, 1.46, 0, 122, 2, w + 180)]  # H, CH3
    for carbon, before, third, turn in ((3, 0, 1, s), (5, 1, 0, t)):
        z += [(carbon, 1.09, before, 109.5, third, turn + a) for a in (0, 120, 240)]
    bonds = [(0, 1), (0, 2), (0, 3), (1, 4), (1, 5)] + [(3, k) for k in (6, 7, 8)] + [(5, k) for k in (9, 10, 11)]
    return z, [12.0, 14, 16, 12, 1, 12] + [1.0] * 6, bonds, [(0, 1, 2, 3), (1, 0, 4, 5)], 9


def propyne_chain(rng):
    """CH2Cl - C = C - CH2Cl by all angles: two straight groups on one line, and tetrahedral ends."""
    s, t = rng.uniform(0, 360, 2)
    z = [(None, 0, None, 0, None, 0), (0, 1.46, None, 0, None, 0), (1, 1.2, 0, 180, None, 0), (2, 1.46, 1, 180, None, 0)]
    for carbon, before, third, turn in ((0, 1, None, s), (3, 2, None, t)):
        z += [(carbon, a, before, 110, third, turn + b) for a, b in ((1.09, 0), (1.09, 120), (1.78, 240))]
    bonds = [(0, 1), (1, 2), (2, 3)] + [(0, k) for k in (4, 5, 6)] + [(3, k) for k in (7, 8, 9)]
    return z, [12.0] * 4 + [1.0, 1, 35, 1, 1, 35], bonds, [(0, 1, 2), (1, 2, 3)], 7


def formanilide_part(rng):
    """Allene-like: two flat groups at the ends of a straight one."""
    t = rng.uniform(0, 360)
    z = [(None, 0, None, 0, None, 0), (0, 1.31, None, 0, None, 0), (1, 1.31, 0, 180, None, 0)]
    z += [(0, 1.08, 1, 120.9, None, 0), (0, 1.08, 1, 120.9, None, 180), (2, 1.08, 1, 120.9, None, t), (2, 1.08, 1, 120.9, None, t + 180)]
    bonds = [(0, 1), (1, 2), (0, 3), (0, 4), (2, 5), (2, 6)]
    return z, [12.0] * 3 + [1.0] * 4, bonds, [(0, 1, 2), (0, 1, 3, 4), (2, 1, 5, 6)], 7


def relations(r, groups):
    """Rows of sum c_i r_i = 0 that hold the last atoms of each group by the first ones."""
    rows = []
    for group in groups:
        n = 2 if np.linalg.matrix_rank(r[list(group)] - r[group[0]], tol=1e-6) == 1 else 3
        for k in group[n:]:
            base = list(group[:n])
            A = np.r_[r[base].T, np.ones((1, n))]
            c, *_ = np.linalg.lstsq(A, np.r_[r[k], 1], rcond=None)
            row = np.zeros(len(r))
            row[k] = -1
            row[base] += c
            rows.append(row)
    return rows


def axes_of(r, masses, pairs, rows, extra=()):
    """Orthonormal rows of all constraints, by singular values, in mass-weighted coordinates."""
    n, all_rows = len(masses), []
    for i, j in pairs:
        row = np.zeros((n, 3))
        row[j] = r[j] - r[i]
        row[i] = -row[j]
        all_rows.append(row.ravel())
    for c in rows:
        for x in range(3):
            row = np.zeros((n, 3))
            row[:, x] = c
            all_rows.append(row.ravel())
    root = np.sqrt(np.repeat(masses, 3))
    _, sizes, axes = np.linalg.svd(np.array(all_rows) / root)
    return axes[: (sizes > 1e-9 * sizes[0]).sum()], root


class Linear(unittest.TestCase):
    def check(self, molecules, r, masses, pairs, rows, freedoms, lengths=None):
        """Freedoms, forces, velocities, and steps that keep all."""
        masses = np.asarray(masses, float)
        axes, root = axes_of(r, masses, pairs, rows)
        self.assertEqual(3 * len(masses) - len(axes), freedoms)
        self.assertEqual(molecules.degrees_of_freedom(), freedoms)
        rng = np.random.default_rng(8)
        v, f = rng.normal(size=(2,) + r.shape)
        pulled = f.ravel() / root
        force = molecules.forces(r, np.zeros_like(r), f)
        np.testing.assert_allclose(force.forces.ravel(), -(axes.T @ (axes @ pulled)) * root, atol=1e-9)
        moving = v.ravel() * root
        molecules.project_velocities(r, v)
        np.testing.assert_allclose(v.ravel(), (moving - axes.T @ (axes @ moving)) / root, atol=1e-9)
        wanted = np.array([np.linalg.norm(r[j] - r[i]) for i, j in pairs])
        r = r.copy()
        for _ in range(20):
            moved = r + 0.002 * v
            molecules.project_positions(r, moved, 0.002, v)
            r = moved
            molecules.project_velocities(r, v)
        np.testing.assert_allclose([np.linalg.norm(r[j] - r[i]) for i, j in pairs], wanted, rtol=1e-11, atol=1e-12)
        for row in rows:
            np.testing.assert_allclose(row @ r, 0, atol=1e-11)
        self.assertLess(molecules.violation(r, v).length, 1e-11)

    def test_flat_and_straight_groups_that_share_atoms(self):
        rng = np.random.default_rng(7)
        for make in (ethylene, guanidinium, acetamide, propyne_chain, formanilide_part):
            for _ in range(3):
                z, masses, bonds, groups, freedoms = make(rng)
                r = grow(z, None, None, None) @ np.linalg.qr(rng.normal(size=(3, 3)))[0]
                order = rng.permutation(len(masses))
                place = np.argsort(order)
                pairs = [(int(place[i]), int(place[j])) for i, j in with_angles(bonds)]
                its = [tuple(int(place[k]) for k in group) for group in groups]
                r, its_masses = r[order], np.array(masses)[order]
                for decimals in (5, 12):
                    lengths = np.round([np.linalg.norm(r[j] - r[i]) for i, j in pairs], decimals)
                    molecules = hol.Molecules(its_masses)
                    with self.subTest(make=make.__name__, decimals=decimals):
                        molecules.add(pairs, lengths)
                        self.assertEqual(molecules.degrees_of_freedom(), freedoms)
                        start = r.copy()
                        molecules.impose(start)
                        np.testing.assert_allclose(start, r, atol=30 * 10.0**-decimals)
                        self.check(molecules, start, its_masses, pairs, relations(start, its), freedoms)

    def test_bodies_that_share_atoms(self):
        """Two tetrahedra with a common corner; two plates with a common edge; a chain of straight ones; all in one set."""
        rng = np.random.default_rng(9)
        corners = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
        square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1.2, 0], [0, 1.1, 0], [0.4, 0.5, 0]])
        cases = [
            # atoms of bodies, positions, freedoms, and how many atoms are the base of a body
            ([(0, 1, 2, 3), (0, 4, 5, 6)], np.r_[corners, -corners[1:] + 2 * corners[0]], 9),
            ([(0, 1, 2, 3, 4), (0, 1, 5, 6)], np.r_[square, square[2:4] @ about(np.array([1.0, 0, 0]), 1.0).T], 7),
            ([(0, 1, 2), (2, 3, 4), (4, 5, 6)],
             np.cumsum(np.r_[[[0, 0, 0]], np.repeat([[1.0, 0, 0], [0.3, 1, 0], [0.2, 0.1, 1]], 2, axis=0)], axis=0), 9),
        ]
        for bodies, r, freedoms in cases:
            r = r @ np.linalg.qr(rng.normal(size=(3, 3)))[0]
            masses = rng.uniform(1, 9, len(r))
            pairs = sorted({tuple(sorted(pair)) for body in bodies for pair in itertools.combinations(body, 2)})
            molecules = hol.Molecules(masses)
            molecules.add_rigid(bodies, [r[list(body)] for body in bodies])
            with self.subTest(bodies=bodies):
                rows = relations(r, [body for body in bodies if len(body) != 4 or bodies[0] != (0, 1, 2, 3)])
                self.check(molecules, r, masses, pairs, rows, freedoms)

    def test_a_bond_within_a_body_that_shares_an_atom(self):
        r = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0.2], [0, -1, 0.1]])
        bodies, places = [(0, 1, 2, 3), (0, 4, 5)], None
        places = [r[list(body)] for body in bodies]
        molecules = hol.Molecules(np.ones(6))
        molecules.add_rigid(bodies, places, [(0, 1)], [1.0])
        force = molecules.forces(r, None, np.arange(18.0).reshape(6, 3))
        self.assertEqual(force.lambda_[0], 0)
        np.testing.assert_allclose(force.forces.sum(axis=0), 0, atol=1e-13)
        other = hol.Molecules(np.ones(6))
        with self.assertRaisesRegex(hol.Error, "lies within a body"):
            other.add_rigid(bodies, places, [(0, 1)], [1.1])
        places[1] = places[1] * 2
        bodies[1] = (0, 1, 5)
        with self.assertRaisesRegex(hol.Error, "in two bodies"):
            other.add_rigid(bodies, places)

    def test_bonds_of_length_zero(self):
        """Two chains that have a point in common, and a triangle on it."""
        rng = np.random.default_rng(10)
        r = np.array([[0.0, 0, 0], [1, 0, 0], [1.5, 0.8, 0], [1.5, 0.8, 0], [2.4, 1, 0.3], [3, 0.2, 0.4], [2.0, 1.7, 0.3]])
        r = r @ np.linalg.qr(rng.normal(size=(3, 3)))[0]
        masses = rng.uniform(1, 9, 7)
        pairs = [(0, 1), (1, 2), (3, 4), (4, 5), (4, 6), (3, 6)]
        lengths = [np.linalg.norm(r[j] - r[i]) for i, j in pairs]
        row = np.array([0.0, 0, 1, -1, 0, 0, 0])
        molecules = hol.Molecules(masses)
        molecules.add(pairs[:2] + [(2, 3)] + pairs[2:], lengths[:2] + [0.0] + lengths[2:])
        self.assertEqual(molecules.implied().tolist(), [k == 2 for k in range(7)])
        self.check(molecules, r, masses, pairs, [row], 21 - 6 - 3)
        molecules.set_lengths(lengths[:2] + [0.0] + lengths[2:])
        with self.assertRaisesRegex(hol.Error, "held fixed"):
            hol.Molecules([1.0, 0.0]).add([(0, 1)], 0.0)

    def test_relations(self):
        """Centres of mass of two flexible groups, a site between two atoms, a massless one, and bonds."""
        rng = np.random.default_rng(11)
        masses = np.array([1.0, 2, 3, 1, 1, 2])
        r = rng.normal(size=(6, 3))
        row = np.r_[masses[:3] / 6, -masses[3:] / 4]
        r[3:] += r[:3].T @ row[:3] + r[3:].T @ row[3:]
        pairs = [(0, 1), (1, 2), (3, 4), (4, 5)]
        molecules = hol.Molecules(masses)
        molecules.add_linear([range(6)], [row], pairs, [np.linalg.norm(r[j] - r[i]) for i, j in pairs])
        self.check(molecules, r, masses, pairs, [row], 18 - 4 - 3)

        r = rng.normal(size=(4, 3))
        r[2] = 0.3 * r[0] + 0.7 * r[1]
        rows = [[0.3, 0.7, -1, 0]]
        molecules = hol.Molecules([1.0, 2, 5, 3])
        molecules.add_linear([[0, 1, 2]], [rows[0][:3]], [(0, 1), (2, 3)],
                             [np.linalg.norm(r[1] - r[0]), np.linalg.norm(r[3] - r[2])])
        self.check(molecules, r, [1.0, 2, 5, 3], [(0, 1), (2, 3)], np.array(rows), 12 - 2 - 3)

        # a massless site of three flexible atoms: its force goes to them
        site, f = np.array([0.2, 0.3, 0.5]), rng.normal(size=(4, 3))
        r = rng.normal(size=(4, 3))
        r[3] = site @ r[:3]
        molecules = hol.Molecules([1.0, 2, 3, 0])
        molecules.add_linear([[0, 1, 2, 3]], [[*site, -1]])
        np.testing.assert_allclose(molecules.forces(r, None, f).forces, np.r_[np.outer(site, f[3]), [-f[3]]], atol=1e-14)
        self.assertEqual(molecules.degrees_of_freedom(), 9)
        moved = r + rng.normal(size=r.shape)
        molecules.project_positions(r, moved, 1.0)
        np.testing.assert_allclose(site @ moved[:3], moved[3], atol=1e-14)

    def test_relations_that_cannot_be(self):
        molecules = hol.Molecules([1.0, 2, 3, 0, np.inf])
        for atoms, c, words in (([[0, 1]], [[1.0, 1.0]], "add up to 0"), ([[0, 1]], [[0.0, 0.0]], "but zeros"),
                                ([[0, 1]], [[np.nan, 0.0]], "not finite"), ([[0, 7]], [[1.0, -1.0]], "outside"),
                                ([[0, 1], [1, 0]], [[1.0, -1], [2, -2]], "follows from the others"),
                                ([[0, 4]], [[1.0, -1.0]], "nothing of it free"), ([[0]], [[0.0]], "fewer than two")):
            with self.assertRaisesRegex(hol.Error, words):
                molecules.add_linear(atoms, c)
        self.assertEqual(molecules.n_bonds, 0)
        molecules.add_linear([[0, 1]], [[1.0, -1.0]])
        with self.assertRaisesRegex(hol.Error, "earlier call"):
            molecules.add_linear([[1, 2]], [[1.0, -1.0]])

    def test_a_centre_that_is_held_and_driven(self):
        """The centre of mass of a chain at a fixed atom, which is then moved; a bond from a site to another fixed atom."""
        rng = np.random.default_rng(14)
        masses = np.array([1.0, 2, 3, 4, 5, np.inf, np.inf])
        c = masses[:4] / 10
        r = np.cumsum(rng.normal(size=(7, 3)), axis=0)
        r[5] = (c @ r[:4])
        r[4] = 0.3 * r[0] + 0.9 * r[1] - 0.2 * r[5]
        pairs = [(0, 1), (1, 2), (4, 6), (2, 4)]
        lengths = [np.linalg.norm(r[j] - r[i]) for i, j in pairs]
        molecules = hol.Molecules(masses)
        molecules.add_linear([[0, 1, 2, 3, 5], [0, 1, 5, 4]], [[*c, -1], [0.3, 0.9, -0.2, -1]], pairs, lengths)
        self.assertEqual(molecules.degrees_of_freedom(), 15 - 6 - 4)
        rows = np.zeros((10, 7, 3))
        for x in range(3):
            rows[x, [0, 1, 2, 3, 5], x] = [*c, -1]
            rows[3 + x, [0, 1, 5, 4], x] = [0.3, 0.9, -0.2, -1]
        for k, (i, j) in enumerate(pairs):
            rows[6 + k, j], rows[6 + k, i] = r[j] - r[i], r[i] - r[j]
        free, w = rows[:, :5].reshape(10, 15), np.repeat(1 / masses[:5], 3)
        def multipliers(rhs):
            return np.linalg.solve(free * w @ free.T, rhs)
        v, f = rng.normal(size=(2, 7, 3))
        # forces at rest; what holds the chain pulls the fixed atoms the other way
        t = multipliers(free * w @ f[:5].ravel())
        out = molecules.forces(r, np.zeros_like(r), f)
        np.testing.assert_allclose(out.forces, -(t @ rows.reshape(10, 21)).reshape(7, 3), atol=1e-12)
        np.testing.assert_allclose(out.forces.sum(0), 0, atol=1e-12)
        np.testing.assert_allclose(out.virial, r.T @ out.forces, atol=1e-11)
        # velocities follow those of fixed atoms
        t = multipliers(rows.reshape(10, 21) @ v.ravel())
        wanted = v.copy()
        wanted[:5] -= (w * (free.T @ t)).reshape(5, 3)
        molecules.project_velocities(r, v)
        np.testing.assert_allclose(v, wanted, atol=1e-12)
        # and so do positions
        moved = r + 0.01 * v
        molecules.project_positions(r, moved, 0.01, v)
        np.testing.assert_allclose(moved[5], (r + 0.01 * wanted)[5], atol=1e-14)
        np.testing.assert_allclose(c @ moved[:4], moved[5], atol=1e-14)
        np.testing.assert_allclose(0.3 * moved[0] + 0.9 * moved[1] - 0.2 * moved[5], moved[4], atol=1e-14)
        np.testing.assert_allclose([np.linalg.norm(moved[j] - moved[i]) for i, j in pairs], lengths, rtol=1e-14)
        along = ((moved - r - 0.01 * wanted)[:5].ravel() / w) @ np.linalg.pinv(free) @ free  # along the reference's rows
        np.testing.assert_allclose(along, (moved - r - 0.01 * wanted)[:5].ravel() / w, atol=1e-12)
        molecules.set_masses(np.array([2.0, 2, 3, 4, 5, np.inf, np.inf]))
        self.assertLess(np.abs(molecules.forces(r, None, f).forces.sum(0)).max(), 1e-12)

    def test_many_copies_are_as_one_by_one(self):
        rng = np.random.default_rng(15)
        masses = np.tile([1.0, 2, 0, np.inf], 3)
        masses[5] = 4.0  # one of another kind
        many, single = hol.Molecules(np.r_[1.0, masses]), hol.Molecules(np.r_[1.0, masses])
        relations, c, bonds = [[0, 1, 2], [0, 1, 3]], [[0.25, 0.75, -1], [2, -1, -1.0]], [(0, 1)]
        many.add_linear_molecules(3, 4, relations[:1], c[:1], bonds, [1.5], first_atom=1)
        for k in range(3):
            single.add_linear([[1 + 4 * k + i for i in relations[0]]], c[:1], [(1 + 4 * k, 2 + 4 * k)], [1.5])
        r, v, f = rng.normal(size=(3, 13, 3))
        for k in range(3):
            d = r[2 + 4 * k] - r[1 + 4 * k]
            r[2 + 4 * k] = r[1 + 4 * k] + 1.5 * d / np.linalg.norm(d)
            r[3 + 4 * k] = 0.25 * r[1 + 4 * k] + 0.75 * r[2 + 4 * k]
        for molecules in many, single, pickle.loads(pickle.dumps(many)):
            self.assertEqual((molecules.n_molecules, molecules.n_bonds), (3, 3))
            np.testing.assert_array_equal(molecules.forces(r, v, f).forces, many.forces(r, v, f).forces)
        held = hol.Molecules(np.r_[1.0, masses])
        held.add_linear_molecules(3, 4, relations[1:], c[1:], first_atom=1)
        self.assertEqual(held.degrees_of_freedom(), 3 + 3 * 3)
        with self.assertRaisesRegex(hol.Error, "reach outside"):
            held.add_linear_molecules(4, 4, relations[:1], c[:1])

    def test_fixed_atoms_that_leave_nothing_free(self):
        molecules = hol.Molecules([1.0, 1.0, np.inf, np.inf])
        for atoms, c, words in (([[0, 2]], [[1.0, -1.0]], "nothing of it free"), ([[2, 3]], [[1.0, -1.0]], "can move"),
                                ([[0, 1, 2], [0, 1, 3]], [[0.5, 0.5, -1]] * 2, "follows from the others")):
            with self.assertRaisesRegex(hol.Error, words):
                molecules.add_linear(atoms, c)
        self.assertEqual(molecules.n_molecules, 0)

    def test_copies_masses_and_boxes(self):
        rng = np.random.default_rng(12)
        z, masses, bonds, groups, freedoms = guanidinium(rng)
        r = grow(z, None, None, None)
        pairs = with_angles(bonds)
        lengths = [np.linalg.norm(r[j] - r[i]) for i, j in pairs]
        molecules = hol.Molecules(masses)
        molecules.add(pairs, np.round(lengths, 6))
        molecules.set_masses(np.array(masses) * 2)
        molecules.impose(r)
        again = pickle.loads(pickle.dumps(molecules))
        f = rng.normal(size=r.shape)
        np.testing.assert_array_equal(again.forces(r, None, f).forces, molecules.forces(r, None, f).forces)
        box = np.diag([4.2, 5, 6])  # smaller than the molecule, and cut by it
        molecules.box = box
        wrapped = r - np.floor(r / np.diag(box)) * np.diag(box)
        np.testing.assert_allclose(molecules.forces(wrapped, None, f).forces, again.forces(r, None, f).forces, atol=1e-12)
        with self.assertRaises(hol.Error):
            molecules.set_lengths(np.array(lengths) * 1.01)


if __name__ == "__main__":
    unittest.main()
