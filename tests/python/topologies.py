"""Molecules by bonds and angles, and the distances that a topology file has of them."""

import itertools

import numpy as np

MASS = {"H": 1.008, "C": 12.011, "N": 14.007, "O": 15.999, "F": 18.998, "P": 30.974, "Xe": 131.29}


class Molecule:
    """Atoms one after the other, each bonded to one before; lengths in nm, angles in degrees."""

    def __init__(self, *elements_at_places):
        self.places, self.elements, self.bonds, self.flat = [], [], [], []
        for element, place in elements_at_places:
            self.put(element, place)

    def put(self, element, place, bonded=()):
        self.elements.append(element)
        self.places.append(np.array(place, dtype=float))
        self.bonds += [(j, len(self.places) - 1) for j in bonded]
        return len(self.places) - 1

    def add(self, element, j, length, k=None, angle=0.0, towards=None, torsion=0.0):
        """At this length from j, angle with k, torsion against the atom `towards`."""
        if k is None:
            return self.put(element, self.places[j] + [length, 0, 0], [j])
        u = self.places[k] - self.places[j]
        u = u / np.linalg.norm(u)
        side = np.array([0.31, 1, 0.2]) if towards is None else self.places[towards] - self.places[k]
        side = side - (side @ u) * u
        side = side / np.linalg.norm(side)
        angle, torsion = np.radians([angle, torsion])
        across = np.cos(torsion) * side + np.sin(torsion) * np.cross(u, side)
        return self.put(element, self.places[j] + length * (np.cos(angle) * u + np.sin(angle) * across), [j])

    def methyl(self, c, k, towards=None, torsion=60.0):
        for third in range(3):
            self.add("H", c, 0.1090, k, 110.2, towards, torsion + 120 * third)

    @property
    def masses(self):
        return np.array([MASS[element] for element in self.elements])

    def distances(self):
        """Pairs of all bonds and angles, and their lengths."""
        near = [[] for _ in self.places]
        for i, j in self.bonds:
            near[i].append(j)
            near[j].append(i)
        pairs = {tuple(sorted(pair)) for pair in self.bonds}
        pairs |= {tuple(sorted(pair)) for partners in near for pair in itertools.combinations(partners, 2)}
        pairs = np.array(sorted(pairs))
        x = np.array(self.places)
        return pairs, np.linalg.norm(x[pairs[:, 1]] - x[pairs[:, 0]], axis=1)

    def groups(self):
        """Atoms that turn as one: each with all that are bonded to it, and flat rings with what is at them."""
        near = [{i} for i in range(len(self.places))]
        for i, j in self.bonds:
            near[i].add(j)
            near[j].add(i)
        return [sorted(group) for group in near if len(group) > 2] + self.flat


def ring(elements, radius=0.1395, hydrogens=0.2480, bare=()):
    molecule = Molecule()
    corner = [(np.cos(np.pi / 3 * k), np.sin(np.pi / 3 * k), 0) for k in range(6)]
    for k, element in enumerate(elements):
        molecule.put(element, radius * np.array(corner[k]), [k - 1] if k else [])
    molecule.bonds.append((5, 0))
    for k, element in enumerate(elements):
        if element == "C" and k not in bare:
            molecule.put("H", hydrogens * np.array(corner[k]), [k])
    return molecule


def propyne():
    m = Molecule(("C", (0, 0, 0)))
    m.add("C", 0, 0.1459)
    m.add("C", 1, 0.1207, 0, 180)
    m.add("H", 2, 0.1060, 1, 180)
    m.methyl(0, 1)
    return m


def formamide():
    m = Molecule(("C", (0, 0, 0)))
    n, o = m.add("N", 0, 0.1352), m.add("O", 0, 0.1219, 1, 124.7)
    m.add("H", 0, 0.1098, n, 112.7, o, 180)
    m.add("H", n, 0.1002, 0, 118.5, o, 0)
    m.add("H", n, 0.1002, 0, 120.0, o, 180)
    return m


def isobutene():
    m = Molecule(("C", (0, 0, 0)))
    m.add("C", 0, 0.1342)
    m.add("C", 0, 0.1508, 1, 122.2)
    m.add("C", 0, 0.1508, 1, 122.2, 2, 180)
    m.add("H", 1, 0.1095, 0, 121.0, 2, 0)
    m.add("H", 1, 0.1095, 0, 121.0, 2, 180)
    m.methyl(2, 0, 1, 0)
    m.methyl(3, 0, 1, 0)
    return m


def nitrobenzene():
    m = ring("CCCCCC", bare=(0,))
    n = m.put("N", (0.1395 + 0.1478, 0, 0), [0])
    m.flat.append(list(range(n + 1)))
    m.add("O", n, 0.1225, 0, 117.7, 1, 25)
    m.add("O", n, 0.1225, 0, 117.7, 1, 205)
    return m


def naphthalene():
    side = 0.1400
    far, half = side * np.sqrt(3) / 2, side / 2
    m = Molecule(("C", (0, half, 0)), ("C", (0, -half, 0)))
    m.bonds.append((0, 1))
    for sign in (1, -1):
        first = len(m.places)
        for k, (x, y) in enumerate(((far, side), (2 * far, half), (2 * far, -half), (far, -side))):
            m.put("C", (sign * x, y, 0), [first + k - 1] if k else [0])
        m.bonds.append((first + 3, 1))
    for k in range(2, 10):
        out = m.places[k] - [far if k < 6 else -far, 0, 0]
        m.put("H", m.places[k] + 0.1085 * out / np.linalg.norm(out), [k])
    m.flat.append(list(range(18)))
    return m


def pentafluoride():
    m = Molecule(("P", (0, 0, 0)))
    for place in ((0, 0, 0.1577), (0, 0, -0.1577)):
        m.put("F", place, [0])
    for k in range(3):
        m.put("F", 0.1534 * np.array([np.cos(2 * np.pi / 3 * k), np.sin(2 * np.pi / 3 * k), 0]), [0])
    return m


def tetrafluoride():
    m = Molecule(("Xe", (0, 0, 0)))
    for place in ((1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0)):
        m.put("F", 0.1953 * np.array(place), [0])
    return m


ALL = (propyne, formamide, isobutene, nitrobenzene, naphthalene, pentafluoride, tetrafluoride)
