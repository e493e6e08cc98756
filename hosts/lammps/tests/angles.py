# SPDX-License-Identifier: GPL-2.0-only
"""Molecules held by all bonds and all angles, and bodies that share an atom: scenes for LAMMPS, and their trajectory by SHAKE.

    make     writes data, coefficients.lmp and bodies.txt: N^3 molecules on a lattice, turned at random; angles in degrees, rounded
             to so many decimals
    check    the first molecule of the dump's first step, tied by springs K to where data has it, goes on to the last step by
             velocity Verlet with SHAKE, constraint after constraint until nothing moves, and by RATTLE: how far the dump is from
             there, and how far it came

Python's own arithmetic, and nothing of the library. An atom in the plane of its three neighbours, or on the line of its two, is
held where these are, r_0 = sum c_k r_k, as its distances do not say it to first order.
"""
import math
import random
import sys

# An atom: the one it is bonded to, what is around it (l: on a line, f: in a plane, t: a tetrahedron, e: nothing), its element.
# Hydrogens take the places that are left.
MOLECULES = {
    "ethane": [(-1, "t", "C"), (0, "t", "C")],
    "propane": [(-1, "t", "C"), (0, "t", "C"), (1, "t", "C")],
    "hexane": [(-1, "t", "C")] + [(k, "t", "C") for k in range(5)],
    "guanidinium": [(-1, "f", "C"), (0, "f", "N"), (0, "f", "N"), (0, "f", "N")],
    "acetamide": [(-1, "f", "C"), (0, "e", "O"), (0, "t", "C"), (0, "f", "N"), (3, "t", "C")],
    "acetonitrile": [(-1, "t", "C"), (0, "l", "C"), (1, "e", "N")],
    "nitrate": [(-1, "f", "N"), (0, "e", "O"), (0, "e", "O"), (0, "e", "O")],
}
MASSES = {"C": 12.0, "N": 14.0, "O": 16.0, "H": 1.0}


def add(a, b, factor=1.0):
    return [x + factor * y for x, y in zip(a, b)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3] for k in range(3)]


def unit(a):
    return [x / math.sqrt(dot(a, a)) for x in a]


def directions(around, u):
    """Those beside the direction u."""
    v = unit(cross(u, [1, 0, 0] if abs(u[0]) < 0.8 else [0, 1, 0]))
    w = cross(u, v)
    cosine, n = {"l": (-1, 1), "f": (-0.5, 2), "t": (-1 / 3, 3), "e": (0, 0)}[around]
    sine = math.sqrt(1 - cosine * cosine)
    turns = [2 * math.pi * k / n for k in range(n)]
    return [[cosine * u[x] + sine * (math.cos(t) * v[x] + math.sin(t) * w[x]) for x in range(3)] for t in turns]


def grow(atoms):
    """Places, elements and bonds."""
    r, elements, bonds, free = [], [], [], []
    axis = [0.6, 0.0, 0.8]
    for i, (parent, around, element) in enumerate(atoms):
        if parent < 0:
            r.append([0.0, 0.0, 0.0])
            free.append([axis] + directions(around, axis))
        else:
            way = free[parent].pop(0)
            r.append(add(r[parent], way, 1.3 + 0.07 * (i % 4)))
            free.append(directions(around, [-x for x in way]))
            bonds.append((parent, i))
        elements.append(element)
    for i in range(len(atoms)):
        for way in free[i]:
            bonds.append((i, len(r)))
            r.append(add(r[i], way, 1.09))
            elements.append("H")
    return r, elements, bonds


def joined():
    """Two pyramids with a common corner, atom 3: places, elements and bodies."""
    corners = [[0, 0, 0], [1.0, 0.2, 0], [0.1, 1.1, 0], [0, 0.1, 0.9]]
    r = [corners[k] for k in (1, 2, 3)] + [[0.0, 0.0, 0.0]] + [[-x for x in corners[k]] for k in (1, 2, 3)]
    return r, ["C", "N", "O", "C", "H", "O", "N"], [[0, 1, 2, 3], [3, 4, 5, 6]]


def between(r, a, b, c):
    u, v = unit(add(r[a], r[b], -1)), unit(add(r[c], r[b], -1))
    return math.degrees(math.atan2(math.sqrt(dot(cross(u, v), cross(u, v))), dot(u, v)))


def make(name, n, decimals):
    bodies = []
    if name == "joined":
        r, elements, bodies = joined()
        bonds = []
    else:
        r, elements, bonds = grow(MOLECULES[name])
    near = [sorted([b for a, b in bonds if a == i] + [a for a, b in bonds if b == i]) for i in range(len(r))]
    angles = [(a, i, b) for i in range(len(r)) for a in near[i] for b in near[i] if a < b]

    def types(values):
        kinds = sorted(set(values))
        return kinds, [kinds.index(v) + 1 for v in values]

    lengths, bond_types = types([f"{math.dist(r[a], r[b]):.12g}" for a, b in bonds])
    turns, angle_types = types([f"{between(r, *angle):.{decimals}f}" for angle in angles])
    kinds, atom_types = types(elements)
    middle = [sum(x[c] for x in r) / len(r) for c in range(3)]
    spacing = 2.2 * max(math.dist(x, middle) for x in r)
    chance = random.Random(4711)
    with open("data", "w") as out:
        m = n**3
        print(f"angles.py {name}\n\n{m * len(r)} atoms\n{len(kinds)} atom types", file=out)
        if bonds:
            print(f"{m * len(bonds)} bonds\n{m * len(angles)} angles\n{len(lengths)} bond types\n{len(turns)} angle types", file=out)
        for axis in "xyz":
            print(f"0 {n * spacing:.17g} {axis}lo {axis}hi", file=out)
        print("\nMasses\n", *[f"{k + 1} {MASSES[kind]}" for k, kind in enumerate(kinds)], "\nAtoms # molecular\n", sep="\n", file=out)
        for k in range(m):
            turn = [unit([chance.gauss(0, 1) for _ in range(3)])]
            turn.append(unit(cross(turn[0], [chance.gauss(0, 1) for _ in range(3)])))
            turn.append(cross(turn[0], turn[1]))
            at = [(x + 0.2) * spacing for x in (k % n, k // n % n, k // n // n)]
            for i, x in enumerate(r):
                place = [at[c] + dot(turn[c], add(x, middle, -1)) for c in range(3)]
                print(k * len(r) + i + 1, k + 1, atom_types[i], *[f"{x:.17g}" for x in place], file=out)
        for title, lists, kind in (("Bonds", bonds, bond_types), ("Angles", angles, angle_types)):
            if lists:
                print(f"\n{title}\n", file=out)
            for e in range(m * len(lists)):
                k, j = divmod(e, len(lists))
                print(e + 1, kind[j], *[k * len(r) + i + 1 for i in lists[j]], file=out)
    with open("coefficients.lmp", "w") as out:
        for k, length in enumerate(lengths):
            print(f"bond_coeff {k + 1} 100 {length}", file=out)
        for k, turn in enumerate(turns):
            print(f"angle_coeff {k + 1} 10 {turn}", file=out)
    with open("bodies.txt", "w") as out:
        for k in range(n**3):
            for b, body in enumerate(bodies):
                print(len(bodies) * k + b + 1, 1, *[k * len(r) + i + 1 for i in body], file=out)


def read_data():
    """Types, places, and pairs of the first molecule that are held; masses."""
    sections, title = {}, ""
    for line in open("data"):
        words = line.split("#")[0].split()
        if words and words[0].isalpha():
            title = words[0]
        elif words:
            sections.setdefault(title, []).append(words)
    masses = {int(w[0]): float(w[1]) for w in sections["Masses"]}
    atoms = {int(w[0]): (int(w[2]), [float(x) for x in w[3:6]]) for w in sections["Atoms"] if w[1] == "1"}
    pairs = set()
    for title in ("Bonds", "Angles"):
        for w in sections.get(title, []):
            if int(w[2]) in atoms:
                pairs.add((int(w[2]), int(w[-1])))
    for line in open("bodies.txt"):
        body = [int(w) for w in line.split()[2:]]
        if body[0] in atoms:
            pairs.update((a, b) for a in body for b in body if a < b)
    home = {a: x for a, (_, x) in atoms.items()}
    bonds = [(int(w[2]), int(w[3])) for w in sections.get("Bonds", []) if int(w[2]) in atoms]
    centres = flat_centres(home, bonds)
    outer = [(a, b) for a, b in pairs if not any(a == c and b in n or b == c and a in n for c, (n, _) in centres.items())]
    return {a: masses[t] for a, (t, _) in atoms.items()}, home, sorted(outer), centres


def flat_centres(home, bonds):
    """Atoms that neighbours hold in their plane or on their line: (neighbours, coefficients), by atom."""
    found = {}
    for centre in home:
        near = sorted({a + b - centre for a, b in bonds if centre in (a, b)})
        if len(near) not in (2, 3):
            continue
        d = [add(home[a], home[centre], -1) for a in near]
        if len(near) == 2:
            normal = cross(*d)
            parts = [math.sqrt(dot(d[1], d[1])), math.sqrt(dot(d[0], d[0]))]
        else:
            faces = [cross(d[(k + 1) % 3], d[(k + 2) % 3]) for k in range(3)]
            normal = [dot(d[0], faces[0])]
            parts = [math.copysign(math.sqrt(dot(face, face)), dot(face, faces[0])) for face in faces]
        if dot(normal, normal) < 1e-20:
            found[centre] = (near, [part / sum(parts) for part in parts])
    return found


def read_dump(name):
    """First and last step: number, atoms with places and velocities."""
    steps, atoms = [], None
    lines = iter(open(name))
    for line in lines:
        if line.startswith("ITEM: TIMESTEP"):
            atoms = {}
            steps.append((int(next(lines)), atoms))
        elif line.startswith("ITEM: ATOMS"):
            reading = True
            continue
        elif line.startswith("ITEM"):
            reading = False
        elif reading:
            words = line.split()
            atoms[int(words[0])] = [float(x) for x in words[1:7]]
    return steps[0], steps[-1]


def settle(centres, masses, x):
    """Puts the atoms' vectors onto r_0 = sum c_k r_k, one after the other; gives how far off the worst was."""
    worst = 0
    for centre, (near, parts) in centres.items():
        off = x[centre]
        for a, part in zip(near, parts):
            off = add(off, x[a], -part)
        push = 1 / (1 / masses[centre] + sum(part * part / masses[a] for a, part in zip(near, parts)))
        x[centre] = add(x[centre], off, -push / masses[centre])
        for a, part in zip(near, parts):
            x[a] = add(x[a], off, push * part / masses[a])
        worst = max(worst, math.sqrt(dot(off, off)))
    return worst


def sweep(pairs, masses, centres, x, work):
    """Constraint after constraint until nothing moves. work(a, b, weight) mends one pair and says by how much it was off."""
    weights = [1 / masses[a] + 1 / masses[b] for a, b in pairs]
    last = math.inf
    for _ in range(20000):
        worst = max(work(k, a, b, w) for k, ((a, b), w) in enumerate(zip(pairs, weights)))
        worst = max(worst, settle(centres, masses, x))
        # Where lists of distances depend on each other rounding moves to and fro.
        if worst < 1e-15 or (worst < 1e-13 and worst >= last):
            return
        last = worst
    sys.exit("SHAKE does not come to an end")


def check(dump, dt, strength):
    masses, home, pairs, centres = read_data()
    (start, first), (end, last) = read_dump(dump)
    r = {a: first[a][:3] for a in masses}
    v = {a: first[a][3:] for a in masses}
    squares = [math.dist(home[a], home[b]) ** 2 for a, b in pairs]

    def kick():
        for a in masses:
            v[a] = add(v[a], add(home[a], r[a], -1), 0.5 * dt * strength / masses[a])

    for _ in range(end - start):
        kick()
        ways = [add(r[b], r[a], -1) for a, b in pairs]
        before = dict(r)
        for a in masses:
            r[a] = add(r[a], v[a], dt)

        def place(k, a, b, weight):
            d = add(r[b], r[a], -1)
            off = dot(d, d) - squares[k]
            push = off / (2 * weight * dot(d, ways[k]))
            r[a] = add(r[a], ways[k], push / masses[a])
            r[b] = add(r[b], ways[k], -push / masses[b])
            return abs(off) / squares[k]

        sweep(pairs, masses, centres, r, place)
        for a in masses:
            v[a] = [(x - y) / dt for x, y in zip(r[a], before[a])]
        kick()

        def rate(k, a, b, weight):
            d = add(r[b], r[a], -1)
            off = dot(d, add(v[b], v[a], -1))
            push = off / (weight * squares[k])
            v[a] = add(v[a], d, push / masses[a])
            v[b] = add(v[b], d, -push / masses[b])
            return abs(off) / squares[k]

        sweep(pairs, masses, centres, v, rate)
    return (max(math.dist(r[a], last[a][:3]) for a in masses), max(math.dist(v[a], last[a][3:]) for a in masses),
            max(math.dist(first[a][:3], last[a][:3]) for a in masses))
