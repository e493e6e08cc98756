"""CO2: three atoms on a line are a rigid body, whose rotation has a closed form; and the same through ASE."""

import numpy as np
from ase import Atoms, units
from ase.calculators.lj import LennardJones
from ase.md.verlet import VelocityVerlet

import holonomic as hol
from holonomic.ase import Constraint

BOND = 1.16
masses = np.array([15.9994, 12.011, 15.9994])
co2 = hol.Molecules(masses)
co2.add_rigid([[0, 1, 2]], [[(-BOND, 0, 0), (0, 0, 0), (BOND, 0, 0)]])
assert co2.degrees_of_freedom() == 5

# Free rotation: after a turn it is where it was.
r = BOND * np.array([(-1.0, 0, 0), (0, 0, 0), (1, 0, 0)])
omega, steps = 2 * np.pi, 2000
v = np.cross((0, 0, omega), r)
start, dt = r.copy(), 1 / steps
for _ in range(steps):
    before = r.copy()
    r += dt * v
    co2.project_positions(before, r, dt, v)
    co2.project_velocities(r, v)
inertia = 2 * masses[0] * BOND**2
spin = (masses[:, None] * np.cross(r, v)).sum(axis=0)[2]
print(f"free rotation: off by {np.abs(r - start).max():.1e} after a turn of {steps} steps, angular momentum off by "
      f"{abs(spin / (inertia * omega) - 1):.1e}; straight to {np.abs(r.mean(axis=0)).max():.0e}")
assert np.abs(r - start).max() < 2e-5 and abs(spin / (inertia * omega) - 1) < 1e-11

# Two bonds and an angle of 180 degrees are the same body, given by the distances.
bonds = hol.Molecules(masses)
bonds.add([(0, 1), (1, 2), (0, 2)], [BOND, BOND, 2 * BOND])
assert bonds.degrees_of_freedom() == 5

# Through ASE: eight molecules that attract each other.
atoms = Atoms()
for k in range(8):
    u = np.random.default_rng(k).normal(size=3)
    u *= BOND / np.linalg.norm(u)
    at = 4.5 * np.array([k // 4, k // 2 % 2, k % 2])
    atoms += Atoms("OCO", positions=[at - u, at, at + u])
pairs = [(3 * k + i, 3 * k + 1) for k in range(8) for i in (0, 2)]
atoms.set_constraint(Constraint(pairs, angles=[(3 * k, 3 * k + 1, 3 * k + 2) for k in range(8)]))
atoms.calc = LennardJones(sigma=3.0, epsilon=0.005, rc=12.0)
assert atoms.constraints[0].get_removed_dof(atoms) == 8 * 4
run = VelocityVerlet(atoms, 2 * units.fs)
total = []
for _ in range(150):
    run.run(1)
    total.append(atoms.get_total_energy())
angles = [atoms.get_angle(3 * k, 3 * k + 1, 3 * k + 2) for k in range(8)]
print(f"through ASE: energy {total[0]:.5f} to {total[-1]:.5f} eV, kinetic {atoms.get_kinetic_energy():.4f}; angles from {min(angles):.6f}")
assert np.ptp(total) < 0.02 * atoms.get_kinetic_energy() and min(angles) > 179.9999
