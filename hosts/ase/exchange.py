"""A plugin of pytest: the constraint of bonds that ASE has is holonomic's under the same names, whoever imports them."""

import ase.constraints

import holonomic.ase

ase.constraints.FixBondLengths = holonomic.ase.FixBondLengths
ase.constraints.FixBondLength = holonomic.ase.FixBondLength
