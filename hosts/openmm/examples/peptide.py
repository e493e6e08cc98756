"""Acetyl - alanine - N-methylamide in water, built from nothing: a Modeller with all its atoms."""

import numpy as np
from openmm import Vec3, app, unit

# Heavy atoms: name, residue, and where it stands (nm), a stretched conformation with all bonds near 0.13 to 0.15 nm.
_ATOMS = [("CH3", 0, (0.0, 0.0, 0.0)), ("C", 0, (0.142, 0.052, 0.0)), ("O", 0, (0.155, 0.174, 0.0)),
          ("N", 1, (0.247, -0.029, 0.0)), ("CA", 1, (0.383, 0.022, 0.0)), ("C", 1, (0.482, -0.094, 0.0)),
          ("O", 1, (0.443, -0.210, 0.0)), ("CB", 1, (0.405, 0.107, 0.125)),
          ("N", 2, (0.611, -0.062, 0.0)), ("C", 2, (0.714, -0.165, 0.0))]
_RESIDUES = ("ACE", "ALA", "NME")
_BONDS = [(0, 1), (1, 2), (1, 3), (3, 4), (4, 5), (5, 6), (4, 7), (5, 8), (8, 9)]


def peptide(forcefield, padding=0.9):
    """Topology and positions, with hydrogens and TIP3P water; without water if padding is None."""
    topology = app.Topology()
    chain = topology.addChain()
    residues = [topology.addResidue(name, chain) for name in _RESIDUES]
    atoms = [topology.addAtom(name, app.Element.getBySymbol(name[0]), residues[residue]) for name, residue, _ in _ATOMS]
    for i, j in _BONDS:
        topology.addBond(atoms[i], atoms[j])
    positions = [Vec3(*place) for _, _, place in _ATOMS] * unit.nanometer
    modeller = app.Modeller(topology, positions)
    modeller.addHydrogens(forcefield)
    if padding is not None:
        modeller.addSolvent(forcefield, padding=padding * unit.nanometer)
    return modeller


def worst_bond(system, positions):
    """Largest relative error of a constrained distance."""
    worst = 0.0
    for k in range(system.getNumConstraints()):
        i, j, length = system.getConstraintParameters(k)
        worst = max(worst, abs(np.linalg.norm(positions[i] - positions[j]) / length._value - 1))
    return worst
