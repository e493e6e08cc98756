"""A helix of any residues as a .pdb, for gmx pdb2gmx: a protein's bonds where no structure can be had."""
import math

LYSOZYME = ("KVFGRCELAAAMKRHGLDNYRGYSLGNWVCAAKFESNFNTQATNRNTDGSTDYGILQINSRWWCNDGRTPGSRNLCNIPCSALLSSDITASVNCAKKIVSDGNGMNAWVA"
            "WRNRCKGTDVQAWIRGCRL")  # of hen's egg-white; as a helix, without its bridges of sulphur
NAMES = dict(zip("ACDEFGHIKLMNPQRSTVWY", "ALA CYS ASP GLU PHE GLY HIS ILE LYS LEU MET ASN PRO GLN ARG SER THR VAL TRP TYR".split()))
# Side chains behind CB: an atom, the three before it, length, angle and dihedral.
SIDE_CHAINS = {"A": "", "G": "", "C": "SG N CA CB 1.81 114 180", "S": "OG N CA CB 1.42 111 180",
               "T": "OG1 N CA CB 1.43 110 180; CG2 N CA CB 1.52 110 -60", "V": "CG1 N CA CB 1.53 110 180; CG2 N CA CB 1.53 110 -60",
               "L": "CG N CA CB 1.53 116 180; CD1 CA CB CG 1.53 110 180; CD2 CA CB CG 1.53 110 60",
               "I": "CG1 N CA CB 1.53 110 180; CG2 N CA CB 1.53 110 -60; CD1 CA CB CG1 1.53 114 180",
               "M": "CG N CA CB 1.53 114 180; SD CA CB CG 1.80 113 180; CE CB CG SD 1.79 101 180",
               "D": "CG N CA CB 1.52 113 180; OD1 CA CB CG 1.25 118 90; OD2 CA CB CG 1.25 118 -90",
               "N": "CG N CA CB 1.52 113 180; OD1 CA CB CG 1.23 121 90; ND2 CA CB CG 1.33 116 -90",
               "E": "CG N CA CB 1.53 114 180; CD CA CB CG 1.52 113 180; OE1 CB CG CD 1.25 118 90; OE2 CB CG CD 1.25 118 -90",
               "Q": "CG N CA CB 1.53 114 180; CD CA CB CG 1.52 113 180; OE1 CB CG CD 1.23 121 90; NE2 CB CG CD 1.33 116 -90",
               "K": "CG N CA CB 1.53 114 180; CD CA CB CG 1.52 111 180; CE CB CG CD 1.52 111 180; NZ CG CD CE 1.49 112 180",
               "R": "CG N CA CB 1.53 114 180; CD CA CB CG 1.52 111 180; NE CB CG CD 1.46 112 180; CZ CG CD NE 1.33 124 180; "
                    "NH1 CD NE CZ 1.33 120 0; NH2 CD NE CZ 1.33 120 180",
               "H": "CG N CA CB 1.50 114 180; ND1 CA CB CG 1.38 122 90; CD2 CA CB CG 1.36 131 -90; CE1 CB CG ND1 1.32 109 180; "
                    "NE2 CB CG CD2 1.37 107 180",
               "F": "CG N CA CB 1.51 114 180; CD1 CA CB CG 1.39 120 90; CD2 CA CB CG 1.39 120 -90; CE1 CB CG CD1 1.39 120 180; "
                    "CE2 CB CG CD2 1.39 120 180; CZ CG CD1 CE1 1.39 120 0",
               "W": "CG N CA CB 1.50 114 180; CD1 CA CB CG 1.37 127 90; CD2 CA CB CG 1.43 127 -90; NE1 CB CG CD1 1.37 110 180; "
                    "CE2 CB CG CD2 1.41 107 180; CE3 CB CG CD2 1.40 134 0; CZ2 CG CD2 CE2 1.39 122 180; "
                    "CZ3 CG CD2 CE3 1.38 119 180; CH2 CD2 CE2 CZ2 1.37 117 0",
               "P": "CG N CA CB 1.49 104 30; CD CA CB CG 1.50 106 -35"}
SIDE_CHAINS["Y"] = SIDE_CHAINS["F"] + "; OH CD1 CE1 CZ 1.37 120 180"


def place(a, b, c, length, angle, dihedral):
    """The point at `length` from c, with the angle bc. and the dihedral abc. (degrees)."""
    angle, dihedral = math.radians(180 - angle), math.radians(dihedral)
    bc = unit([c[k] - b[k] for k in range(3)])
    n = unit(cross([b[k] - a[k] for k in range(3)], bc))
    m = cross(n, bc)
    x, y, z = (length * math.cos(angle), length * math.cos(dihedral) * math.sin(angle),
               length * math.sin(dihedral) * math.sin(angle))
    return [c[k] + x * bc[k] + y * m[k] + z * n[k] for k in range(3)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    n = math.sqrt(sum(v * v for v in a))
    return [v / n for v in a]


def side_chain(residue, atoms):
    """The atoms behind CB, by name."""
    for words in filter(None, SIDE_CHAINS[residue].split("; ")):
        name, a, b, c, *numbers = words.split()
        atoms[name] = place(atoms[a], atoms[b], atoms[c], *map(float, numbers))


def write(path, sequence, phi=-57, psi=-47):
    """sequence: letters of residues."""
    lines, serial = [], 0
    n, ca = [0, 0, 0], [1.458, 0, 0]
    c = place([0, 1, 0], n, ca, 1.525, 111, phi)
    for number, residue in enumerate(sequence, 1):
        following = place(n, ca, c, 1.329, 116.6, psi)
        atoms = {"N": n, "CA": ca, "C": c, "O": place(n, ca, c, 1.231, 120.1, psi + 180)}
        if residue != "G":
            atoms["CB"] = place(c, n, ca, 1.53, 110, -122.6)
        side_chain(residue, atoms)
        if number == len(sequence):
            atoms["OXT"] = following
        for name, p in atoms.items():
            serial += 1
            lines.append(f"ATOM  {serial:5d}  {name:<3s} {NAMES[residue]} A{number:4d}    " + "".join(f"{v:8.3f}" for v in p)
                         + "  1.00  0.00")
        previous, n, ca = c, following, place(ca, c, following, 1.458, 121.7, 180)
        c = place(previous, n, ca, 1.525, 111, phi)
    path.write_text("\n".join(lines) + "\nTER\nEND\n")
