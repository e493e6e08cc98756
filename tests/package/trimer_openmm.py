"""A trimer with three rigid distances in OpenMM, with the plugin as it is installed: prints the worst error of a distance."""

import numpy as np
import openmm as mm
from holonomic_openmm import add_holonomic
from openmm import unit

system = mm.System()
for mass in 16, 1, 1:
    system.addParticle(mass)
bonds = [(0, 1, 0.1), (0, 2, 0.1), (1, 2, 0.16)]
for bond in bonds:
    system.addConstraint(*bond)
add_holonomic(system)
context = mm.Context(system, mm.LangevinMiddleIntegrator(300, 1, 0.002), mm.Platform.getPlatformByName("Reference"))
context.setPositions([(0, 0, 0), (0.1, 0.01, 0), (-0.05, 0.09, 0)])
context.applyConstraints(1e-5)
context.setVelocitiesToTemperature(300, 1)
context.getIntegrator().step(100)
r = context.getState(getPositions=True).getPositions(asNumpy=True).value_in_unit(unit.nanometer)
error = max(abs(np.linalg.norm(r[j] - r[i]) / a - 1) for i, j, a in bonds)
print(f"worst distance: {error:.1e}")
raise SystemExit(not error < 1e-14)
