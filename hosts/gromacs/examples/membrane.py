"""A bilayer of DPPC and cholesterol in water, by Martini 2. The numbers are those of its publications: levels and beads, Marrink
et al. 2007 (J. Phys. Chem. B 111, 7812); cholesterol with virtual sites, Melo et al. 2015 (Front. Mol. Biosci. 2, 9)."""
import math
import random

import scenes as s

EPSILON = dict(O=5.6, I=5.0, II=4.5, III=4.0, IV=3.5, V=3.1, VI=2.7, VII=2.3, VIII=2.0, IX=2.0)  # kJ/mol
LEVELS = {
    "P4": dict(P4="I", P1="II", Na="III", C3="VI", C1="VIII", Qa="O", Q0="O"),
    "P1": dict(P1="II", Na="II", C3="IV", C1="VI", Qa="I", Q0="III"),
    "Na": dict(Na="III", C3="VI", C1="VI", Qa="III", Q0="III"),
    "C3": dict(C3="IV", C1="IV", Qa="VII", Q0="VII"),
    "C1": dict(C1="IV", Qa="IX", Q0="IX"),
    "Qa": dict(Qa="I", Q0="II"),
    "Q0": dict(Q0="IV"),
}
SMALL = ("SP1", "SC3", "SC1")  # of rings
FRAME = {(1, 3): 0.4904, (1, 4): 0.6019, (3, 4): 0.2719, (7, 3): 0.7237, (7, 4): 0.5376}
CHOLESTEROL = [("SP1", "ROH", 77.22), ("SC1", "R1", 0), ("SC3", "R2", 38.69), ("SC1", "R3", 159.65), ("SC1", "R4", 0),
               ("SC1", "R5", 0), ("SC1", "C1", 39.44), ("C1", "C2", 72.0)]
DPPC = ([("Q0", "NC3", 1), ("Qa", "PO4", -1), ("Na", "GL1", 0), ("Na", "GL2", 0)]
        + [("C1", f"C{k}{tail}", 0) for tail in "AB" for k in range(1, 5)])
SITES, SPACING, SHARE = 8, 0.9, 0.3  # of a leaflet: along each side, between lipids (nm), of cholesterol


def lennard_jones(a, b):
    small = a in SMALL and b in SMALL
    first, second = (name.lstrip("S") for name in (a, b))
    level = LEVELS[first].get(second) or LEVELS[second][first]
    sigma = 0.62 if level == "IX" else 0.43 if small else 0.47
    epsilon = EPSILON[level] * (0.75 if small else 1)
    return 4 * epsilon * sigma ** 6, 4 * epsilon * sigma ** 12


def topology(counts):
    types = list(LEVELS) + list(SMALL)
    lines = ["[ defaults ]", "1 1", "[ atomtypes ]"] + [f"{t} 72.0 0 A 0 0" for t in types] + ["[ nonbond_params ]"]
    for i, a in enumerate(types):
        lines += [f"{a} {b} 1 {c6:.6e} {c12:.6e}" for b in types[i:] for c6, c12 in [lennard_jones(a, b)]]
    lines += ["[ moleculetype ]", "DPPC 1", "[ atoms ]"]
    lines += [f"{k} {kind} 1 DPPC {name} {k} {charge}" for k, (kind, name, charge) in enumerate(DPPC, 1)]
    tails = [(3, 5), (5, 6), (6, 7), (7, 8), (4, 9), (9, 10), (10, 11), (11, 12)]
    lines += ["[ bonds ]", "3 4 1 0.37 1250"] + [f"{i} {j} 1 0.47 1250" for i, j in [(1, 2), (2, 3)] + tails]
    straight = [(2, 3, 5), (3, 5, 6), (5, 6, 7), (6, 7, 8), (4, 9, 10), (9, 10, 11), (10, 11, 12)]
    lines += ["[ angles ]", "2 3 4 2 120 25"] + [f"{i} {j} {k} 2 180 25" for i, j, k in straight]
    lines += ["[ moleculetype ]", "CHOL 1", "[ atoms ]"]
    lines += [f"{k} {kind} 1 CHOL {name} {k} 0 {mass}" for k, (kind, name, mass) in enumerate(CHOLESTEROL, 1)]
    lines += ["[ bonds ]", "7 8 1 0.425 1250", "[ constraints ]"] + [f"{i} {j} 1 {a}" for (i, j), a in FRAME.items()]
    lines += ["[ dihedrals ]", "1 3 4 7 2 -179.7 50", "[ angles ]", "4 7 8 2 180 25", "[ virtual_sites3 ]",
              "5 4 3 7 1 0.9613 0.6320", "2 3 1 4 4 0.5207 0.2882 -0.83824", "6 4 3 7 4 0.2287 0.4111 1.1531", "[ exclusions ]"]
    lines += [" ".join(str(j) for j in range(i, 8)) for i in range(1, 7)]
    lines += ["[ moleculetype ]", "W 1", "[ atoms ]", "1 P4 1 W W 1 0", "[ system ]", "membrane", "[ molecules ]"]
    return "\n".join(lines + [f"{name} {count}" for name, count in counts]) + "\n"


def upright(places, top, bottom):
    """Turned so that the bottom is below the top, which is the origin."""
    up = unit([a - b for a, b in zip(places[top], places[bottom])])
    side = unit([0 if abs(up[0]) > abs(up[1]) else 1, 1 if abs(up[0]) > abs(up[1]) else 0, 0.1])
    first = unit([v - sum(a * b for a, b in zip(side, up)) * u for v, u in zip(side, up)])
    second = [up[1] * first[2] - up[2] * first[1], up[2] * first[0] - up[0] * first[2], up[0] * first[1] - up[1] * first[0]]
    return [[sum((p[k] - places[top][k]) * axis[k] for k in range(3)) for axis in (first, second, up)] for p in places]


def unit(v):
    length = math.hypot(*v)
    return [x / length for x in v]


def cholesterol():
    """Virtual sites anywhere in the frame: GROMACS places them."""
    frame = upright(s.cholesterol().places, 0, 3)
    centre = [sum(p[k] for p in frame) / 4 for k in range(3)]
    end = [frame[3][0], frame[3][1], frame[3][2] - 0.42]
    return [[p[0], p[1], p[2] + 1.7] for p in (frame[0], centre, frame[1], frame[2], centre, centre, frame[3], end)]


def lipid():
    tails = [(x, 0.0, 1.65 - 0.45 * k) for x in (-0.2, 0.2) for k in range(4)]
    return [(-0.2, 0.1, 2.95), (-0.2, 0.0, 2.5), (-0.2, 0.0, 2.08), (0.2, 0.0, 2.08)] + tails


def write(folder):
    """topol.top and conf.gro; returns the kinds of molecules in their order: name, count, masses, freedoms of one."""
    folder.mkdir(parents=True, exist_ok=True)
    chance, side, sterols, lipids = random.Random(5), SITES * SPACING, [], []
    for leaflet in (1, -1):
        sites = [(i, j) for i in range(SITES) for j in range(SITES)]
        chance.shuffle(sites)
        for k, (i, j) in enumerate(sites):
            is_sterol, angle = k < SHARE * len(sites), chance.uniform(0, 2 * math.pi)
            (sterols if is_sterol else lipids).append([
                ((i + 0.5) * SPACING + x * math.cos(angle) - y * math.sin(angle),
                 (j + 0.5) * SPACING + x * math.sin(angle) + y * math.cos(angle), leaflet * z)
                for x, y, z in (cholesterol() if is_sterol else lipid())])
    n, layers, first = math.floor(side / 0.55), 5, 3.4
    water = [[((i + 0.5) * side / n, (j + 0.5) * side / n, first + 0.5 * k)] for k in range(layers) for i in range(n) for j in range(n)]
    height = 2 * first + 0.5 * (layers - 1)
    kinds = [("DPPC", lipids, [name for _, name, _ in DPPC], [72.0] * 12, 36),
             ("CHOL", sterols, [name for _, name, _ in CHOLESTEROL], [mass for *_, mass in CHOLESTEROL], 3 * 5 - len(FRAME)),
             ("W", water, ["W"], [72.0], 3)]
    lines, residue, number = [], 0, 0
    for name, molecules, names, *_ in kinds:
        for molecule in molecules:
            residue += 1
            for atom, p in zip(names, molecule):
                number += 1
                lines.append(f"{residue % 100000:5d}{name:5s}{atom:>5s}{number % 100000:5d}" + "".join(f"{v:12.6f}" for v in p))
    (folder / "conf.gro").write_text("\n".join(["membrane", str(number)] + lines + [f"{side:.5f} {side:.5f} {height:.5f}"]) + "\n")
    (folder / "topol.top").write_text(topology([(name, len(molecules)) for name, molecules, *_ in kinds]))
    return [(name, len(molecules), masses, freedoms) for name, molecules, _, masses, freedoms in kinds]
