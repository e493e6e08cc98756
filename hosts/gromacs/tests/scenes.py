"""Small scenes for GROMACS, made from nothing: a topology, coordinates and run parameters, written into a folder."""
import math
import random

MDP = dict(
    integrator="md", dt=0.002, nsteps=20, nstlist=10, nstenergy=1, nstcalcenergy=1, nstlog=0, nstxout=0, nstvout=0,
    coulombtype="cutoff", rcoulomb=0.9, rvdw=0.9, coulomb_modifier="potential-shift", vdw_modifier="force-switch",
    rvdw_switch=0.7, verlet_buffer_tolerance=-1, rlist=1.1, tcoupl="no", pcoupl="no", comm_mode="linear", nstcomm=10,
    gen_vel="yes", gen_temp=300, gen_seed=7, constraints="none", constraint_algorithm="lincs", lincs_order=12,
    lincs_iter=8, lincs_warnangle=90, continuation="no", ld_seed=3)


class Molecule:
    """Atoms are (type, name, mass, mass in B), bonds (i, j, length, force constant), constraints (i, j, length A, B)."""

    def __init__(self, name, atoms, places, bonds=(), constraints=(), angles=(), extra=""):
        self.name, self.atoms, self.places, self.extra = name, atoms, places, extra
        self.bonds, self.constraints, self.angles = list(bonds), list(constraints), list(angles)

    def topology(self):
        lines = ["[ moleculetype ]", f"{self.name} 3", "[ atoms ]"]
        for i, (kind, name, mass, *mass_b) in enumerate(self.atoms, 1):
            b = f" {kind} 0 {mass_b[0]:.4f}" if mass_b else ""
            lines.append(f"{i} {kind} 1 {self.name} {name} {i} 0 {mass:.4f}{b}")
        lines.append("[ bonds ]")
        lines += [f"{i} {j} 1 {a:.8f} {k:.1f}" for i, j, a, k in self.bonds]
        lines.append("[ angles ]")
        lines += [f"{i} {j} {k} 1 {angle:.4f} {c:.1f}" for i, j, k, angle, c in self.angles]
        lines.append("[ constraints ]")
        lines += [f"{i} {j} 1 " + " ".join(f"{a:.8f}" for a in lengths) for i, j, *lengths in self.constraints]
        return "\n".join(lines) + "\n" + self.extra


def distance(p, q):
    return math.dist(p, q)


def rotation(chance):
    """A rotation at random, from a quaternion."""
    w, x, y, z = (chance.gauss(0, 1) for _ in range(4))
    n = math.sqrt(w * w + x * x + y * y + z * z)
    w, x, y, z = w / n, x / n, y / n, z / n
    return ((1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
            (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
            (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)))


def turn(matrix, p):
    return tuple(sum(row[k] * p[k] for k in range(3)) for row in matrix)


def write(folder, molecules, spacing, interacting=True, seed=1, turned=True, **mdp):
    """`molecules` is a list of (Molecule, count); they stand on a cubic grid, turned at random."""
    folder.mkdir(parents=True, exist_ok=True)
    c6, c12 = (0.0023, 2.0e-6) if interacting else (0, 0)
    light = (0.00013, 8.0e-9) if interacting else (0, 0)
    with open(folder / "topol.top", "w") as top:
        top.write("[ defaults ]\n1 1 no 1 1\n[ atomtypes ]\n"
                  f"C 6 12 0 A {c6} {c12}\nH 1 1 0 A {light[0]} {light[1]}\nMW 0 0 0 D 0 0\n")
        for molecule, _ in molecules:
            top.write(molecule.topology())
        top.write("[ system ]\nscene\n[ molecules ]\n")
        for molecule, count in molecules:
            top.write(f"{molecule.name} {count}\n")
    total = sum(count for _, count in molecules)
    side = math.ceil(total ** (1 / 3) - 1e-9)
    chance = random.Random(seed)
    lines, place, number = [], 0, 0
    for molecule, count in molecules:
        for _ in range(count):
            matrix = rotation(chance) if turned else ((1, 0, 0), (0, 1, 0), (0, 0, 1))
            centre = [sum(p[k] for p in molecule.places) / len(molecule.places) for k in range(3)]
            corner = (place % side, place // side % side, place // side ** 2)
            place += 1
            for (kind, name, *_), p in zip(molecule.atoms, molecule.places):
                number += 1
                q = turn(matrix, [p[k] - centre[k] for k in range(3)])
                q = [q[k] + (corner[k] + 0.5) * spacing for k in range(3)]
                lines.append(f"{place % 100000:5d}{molecule.name:5s}{name:>5s}{number % 100000:5d}"
                             + "".join(f"{v:15.10f}" for v in q))
    with open(folder / "conf.gro", "w") as gro:
        gro.write(f"scene\n{number}\n" + "\n".join(lines) + "\n")
        gro.write(" ".join(f"{side * spacing:.6f}" for _ in range(3)) + "\n")
    write_mdp(folder, **mdp)


def write_mdp(folder, **mdp):
    values = {**MDP, **mdp}
    with open(folder / "grompp.mdp", "w") as out:
        for key, value in values.items():
            out.write(f"{key.replace('_', '-')} = {value}\n")


def on_triangle(p, q, a, b, fold=0.0):
    """A point at distances a from p and b from q, in the plane z = 0 turned about pq by `fold`."""
    d = distance(p, q)
    along = (a * a - b * b + d * d) / (2 * d)
    off = math.sqrt(a * a - along * along)
    e = [(q[k] - p[k]) / d for k in range(3)]
    u = (-e[1], e[0], 0)
    v = (0, 0, 1)
    return tuple(p[k] + along * e[k] + off * (math.cos(fold) * u[k] + math.sin(fold) * v[k]) for k in range(3))


def cholesterol():
    """The frame of Martini 2's cholesterol: two triangles with a common edge (Melo et al. 2015)."""
    lengths = {(1, 2): 0.4904, (1, 3): 0.6019, (2, 3): 0.2719, (2, 4): 0.7237, (3, 4): 0.5376}
    b, c = (0, 0, 0), (lengths[2, 3], 0, 0)
    a = on_triangle(b, c, lengths[1, 2], lengths[1, 3])
    d = on_triangle(b, c, lengths[2, 4], lengths[3, 4], math.radians(170))
    atoms = [("C", f"C{k}", mass) for k, mass in enumerate((77.22, 38.69, 159.65, 39.44), 1)]
    return Molecule("CHOL", atoms, [a, b, c, d], constraints=[(i, j, a) for (i, j), a in lengths.items()])


def alkane(n, name="ALK"):
    """CH3-(CH2)n-2-CH3 with hydrogens, harmonic bonds and angles, all anti."""
    cc, ch, half = 0.1529, 0.109, math.radians(112.7) / 2
    atoms, places, bonds, angles = [], [], [], []
    carbons = []
    for k in range(n):
        z = 0.5 * cc * math.cos(half) * (1 if k % 2 else -1)
        carbons.append((k * cc * math.sin(half), 0, z))
    index, neighbours = {}, {}
    for k, c in enumerate(carbons):
        atoms.append(("C", f"C{k + 1}", 12.011))
        places.append(c)
        index[k] = len(atoms)
        sign = 1 if k % 2 else -1
        directions = [(0, math.sin(0.95), sign * math.cos(0.95)), (0, -math.sin(0.95), sign * math.cos(0.95))]
        if k in (0, n - 1):
            side = -1 if k == 0 else 1
            directions.append((side * math.sin(half), 0, -sign * math.cos(half)))
        for m, e in enumerate(directions):
            atoms.append(("H", f"H{k + 1}{'abc'[m]}", 1.008))
            places.append(tuple(c[a] + ch * e[a] for a in range(3)))
            bonds.append((index[k], len(atoms), ch, 284512.0))
    bonds += [(index[k], index[k + 1], cc, 224262.4) for k in range(n - 1)]
    for i, j, *_ in bonds:
        neighbours.setdefault(i, []).append(j)
        neighbours.setdefault(j, []).append(i)
    for j, around in neighbours.items():
        for x in range(len(around)):
            for y in range(x):
                angles.append((around[x], j, around[y], 109.5, 300.0))
    return Molecule(name, atoms, places, bonds=bonds, angles=angles)


def lipid(tail=15):
    """The groups of DPPC's hydrogens: two tails of CH2 from an ester on, a glycerol in the middle and a head that ends with
    N(CH3)3, stretched out; harmonic bonds and angles. To be minimised."""
    atoms, places, bonds, angles = [], [], [], []

    def add(name, mass, place, *to):
        atoms.append(("H" if name == "H" else "C", f"{name}{len(atoms) + 1}", mass))
        places.append(place)
        for other in to:
            bonds.append((other, len(atoms), 0.109 if name == "H" else 0.15, 284512.0 if name == "H" else 224262.4))
        return len(atoms)

    def hydrogens(heavy, *directions):
        for e in directions:
            add("H", 1.008, tuple(c + 0.109 * d / math.hypot(*e) for c, d in zip(places[heavy - 1], e)), heavy)

    last, middle = None, tail + 4  # tail, ester of two atoms without hydrogens, glycerol, and back
    for k in range(2 * middle - 1):
        up = 1 if k % 2 else -1
        off = abs(k - middle + 1)
        last = add("O" if off == 2 else "C", 15.999 if off == 2 else 12.011, (0.127 * k, 0, 0.042 * up), *([last] if last else []))
        if off not in (0, 2, 3):
            hydrogens(last, (0, 1, up), (0, -1, up), *([(-1 if k == 0 else 1, 0, -up)] if k in (0, 2 * middle - 2) else []))
        if off == 0:
            hydrogens(last, (0, -1, up))
            centre, side = last, up
    head = centre
    for k, (name, mass) in enumerate((("O", 15.999), ("P", 30.974), ("O", 15.999), ("C", 12.011), ("C", 12.011), ("N", 14.007))):
        x, y, z = places[centre - 1]
        head = add(name, mass, (x + 0.042 * (1 if k % 2 else -1), y + 0.06 + 0.127 * k, z + 0.08 * side), head)
        if name == "C":
            up = 1 if k % 2 else -1
            hydrogens(head, (up, 0, 1), (up, 0, -1))
    x, y, z = places[head - 1]
    for dx, dz in ((1, 0), (-0.5, 0.87), (-0.5, -0.87)):
        carbon = add("C", 12.011, (x + 0.14 * dx, y + 0.05, z + 0.14 * dz), head)
        hydrogens(carbon, (dx, 1, dz), (dx - dz, -0.3, dz + dx), (dx + dz, -0.3, dz - dx))
    neighbours = {}
    for i, j, *_ in bonds:
        neighbours.setdefault(i, []).append(j)
        neighbours.setdefault(j, []).append(i)
    for j, around in neighbours.items():
        angles += [(a, j, b, 109.5, 300.0) for n, a in enumerate(around) for b in around[:n]]
    return Molecule("LIP", atoms, places, bonds=bonds, angles=angles)


def chain(n_bonds, length=0.15, mass=14.0, bend=math.radians(60), name="CHN"):
    """A zigzag; `bend` near 0 is a nearly straight chain."""
    places = [(0.0, 0.0, 0.0)]
    for k in range(n_bonds):
        angle = (0.5 if k % 2 else -0.5) * bend
        p = places[-1]
        places.append((p[0] + length * math.cos(angle), p[1] + length * math.sin(angle), 0.0))
    atoms = [("C", f"C{k % 1000}", mass) for k in range(n_bonds + 1)]
    return Molecule(name, atoms, places, constraints=[(k, k + 1, length) for k in range(1, n_bonds + 1)])


def water():
    """Three atoms with SETTLE."""
    half = math.radians(104.52) / 2
    places = [(0, 0, 0), (0.09572 * math.sin(half), 0.09572 * math.cos(half), 0),
              (-0.09572 * math.sin(half), 0.09572 * math.cos(half), 0)]
    return Molecule("SOL", [("C", "OW", 15.999), ("H", "HW1", 1.008), ("H", "HW2", 1.008)], places,
                    extra="[ settles ]\n1 1 0.09572 0.15139\n[ exclusions ]\n1 2 3\n2 1 3\n3 1 2\n")
