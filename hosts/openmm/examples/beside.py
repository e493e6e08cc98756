"""A peptide at constant energy, in water or alone: OpenMM's own constraints at two tolerances beside holonomic's.

    beside.py [--steps N] [--platform CPU|Reference|OpenCL] [--precision mixed] [--step FEMTOSECONDS] [--vacuum]

All bonds and the angles of hydrogens are rigid. Prints drift of the energy, largest error of a bond, and time per step, of all of it and
of the constraints alone (positions and velocities once, from a trial displacement).
"""

import argparse
import copy
import time

import numpy as np
import openmm as mm
from openmm import app, unit

from holonomic_openmm import add_holonomic
from peptide import peptide, worst_bond


def run(base, start, velocities, platform, tolerance, holonomic, options):
    system = copy.deepcopy(base)
    if holonomic:
        add_holonomic(system)
    integrator = mm.VerletIntegrator(options.step * unit.femtosecond)
    integrator.setConstraintTolerance(tolerance)
    properties = {"CPU": {"Threads": "1"}, "OpenCL": {"Precision": options.precision}}
    context = mm.Context(system, integrator, platform, properties.get(platform.getName(), {}))
    context.setPositions(start)
    context.applyConstraints(1e-10)
    context.setVelocities(velocities)
    context.applyVelocityConstraints(1e-10)
    energies, errors = [], []
    clock = time.process_time()
    sampling = 0.0
    for _ in range(options.samples):
        integrator.step(options.steps // options.samples)
        before = time.process_time()
        state = context.getState(getEnergy=True, getPositions=True)
        energies.append((state.getKineticEnergy() + state.getPotentialEnergy())._value)
        errors.append(worst_bond(system, state.getPositions(asNumpy=True)._value))
        sampling += time.process_time() - before
    per_step = (time.process_time() - clock - sampling) / options.steps
    times = np.arange(1, options.samples + 1) * options.steps * options.step * 1e-6 / options.samples  # ns
    freedom = 3 * system.getNumParticles() - system.getNumConstraints() - 3
    drift = np.polyfit(times, energies, 1)[0] / (0.0083144626 * 300 * freedom)
    return drift, np.std(energies - np.polyval(np.polyfit(times, energies, 1), times)), max(errors), per_step, \
        constraints_alone(context, start)


def constraints_alone(context, start):
    rng = np.random.default_rng(1)
    r = context.getState(getPositions=True).getPositions(asNumpy=True)._value
    least = np.inf
    for _ in range(5):
        context.setPositions(r + 2e-4 * rng.normal(size=r.shape))
        clock = time.process_time()
        context.applyConstraints(context.getIntegrator().getConstraintTolerance())
        least = min(least, time.process_time() - clock)
    context.setPositions(r)
    return least


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--steps", type=int, default=4000)
    parser.add_argument("--samples", type=int, default=40)
    parser.add_argument("--step", type=float, default=2.0)
    parser.add_argument("--platform", default="CPU")
    parser.add_argument("--precision", default="mixed")
    parser.add_argument("--vacuum", action="store_true")
    options = parser.parse_args()
    platform = mm.Platform.getPlatformByName(options.platform)
    forcefield = app.ForceField("amber14-all.xml", "amber14/tip3p.xml")
    modeller = peptide(forcefield, None if options.vacuum else 0.9)
    system = forcefield.createSystem(modeller.topology, nonbondedMethod=app.NoCutoff if options.vacuum else app.PME,
                                     nonbondedCutoff=0.8 * unit.nanometer,
                                     constraints=app.HAngles, rigidWater=True, removeCMMotion=False)
    print(f"{system.getNumParticles()} particles, {system.getNumConstraints()} constraints, {options.step} fs, "
          f"{options.steps} steps on {options.platform}")
    integrator = mm.LangevinMiddleIntegrator(300, 5, 0.002)
    integrator.setConstraintTolerance(1e-6)
    context = mm.Context(system, integrator, platform)
    context.setPositions(modeller.positions)
    mm.LocalEnergyMinimizer.minimize(context, 10, 200)
    context.setVelocitiesToTemperature(300, 1)
    integrator.step(1000)
    state = context.getState(getPositions=True, getVelocities=True)
    start, velocities = state.getPositions(asNumpy=True), state.getVelocities(asNumpy=True)
    del context
    print(f"{'constraints':24s}{'drift, kT/ns per':>18s}{'rms about it':>14s}{'worst bond':>12s}{'ms per':>9s}{'of con-':>9s}")
    print(f"{'':24s}{'degree of freedom':>18s}{'kJ/mol':>14s}{'':>12s}{'step':>9s}{'straints':>9s}")
    for name, tolerance, holonomic in (("OpenMM, 1e-5", 1e-5, False), ("OpenMM, 1e-8", 1e-8, False), ("holonomic", 1e-5, True)):
        drift, rms, error, per_step, alone = run(system, start, velocities, platform, tolerance, holonomic, options)
        print(f"{name:24s}{drift:18.2g}{rms:14.3g}{error:12.2g}{1e3 * per_step:9.3f}{1e3 * alone:9.3f}")


if __name__ == "__main__":
    main()
