"""A helix of alanines as a .pdb, for gmx pdb2gmx: a protein's bonds where no structure can be had."""
import math


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


def write(path, residues, phi=-57, psi=-47):
    lines, serial = [], 0
    n, ca = [0, 0, 0], [1.458, 0, 0]
    c = place([0, 1, 0], n, ca, 1.525, 111, phi)
    for number in range(1, residues + 1):
        following = place(n, ca, c, 1.329, 116.6, psi)
        atoms = [("N", n), ("CA", ca), ("CB", place(c, n, ca, 1.53, 110, -122.6)), ("C", c),
                 ("O", place(n, ca, c, 1.231, 120.1, psi + 180))]
        if number == residues:
            atoms.append(("OXT", following))
        for name, p in atoms:
            serial += 1
            lines.append(f"ATOM  {serial:5d}  {name:<3s} ALA A{number:4d}    " + "".join(f"{v:8.3f}" for v in p)
                         + "  1.00  0.00")
        n, ca, c = following, place(ca, c, following, 1.458, 121.7, 180), None
        previous = atoms[3][1]
        c = place(previous, n, ca, 1.525, 111, phi)
    path.write_text("\n".join(lines) + "\nTER\nEND\n")
