# SPDX-License-Identifier: GPL-2.0-only
"""Tests of case.py: trajectories beside those of fix rattle and shake, on any number of ranks, in any box; energy and pressure."""
import os

from lammps import (INPUTS, at_most, below, check, command, drift, exact, lammps, largest, last_frame, near, read,
                    run, same, scene, steady)

SLOW = {"data": "data", "rigid": "holonomic", "dt": 0.003}


def beads(ranks=1, **variables):
    return run("beads", ranks, **{**SLOW, **variables})


def rattle_is_right():
    """Whether fix rattle of this LAMMPS is right across the boundary of the box. In the releases of 2025 and 2026 it leaves a
    velocity along the bonds there."""
    output = lammps("rattle_boundary")
    return output.ended and largest(output.numbers("d.v of the dimer inside")) < 1e-8


def agree(**variables):
    """The trajectory of fix rattle at 1e-13; where that is wrong the positions of fix shake, which are the same, by the
    potential energy: 1e-8 of it are 1e-11 of the total energy."""
    reference, columns, tolerance = ("rattle", ("TotEng", "Temp"), 1e-11) if rattle_is_right() else ("shake", ("PotEng",), 1e-8)
    print("the reference is fix", reference)
    theirs, ours = (run("beads", data="data", rigid=rigid, wide=3.5, **variables) for rigid in (reference, "holonomic"))
    for column in columns:
        same(tolerance, column, theirs, ours)
    below(1e-13, ours, "f_rigid[1]")
    return ours


def rattle(name, light=1.0, dt=0.005):
    scene(f"{name} 500")
    agree(more="a 1" if name == "waters" else " ", light=light, dt=dt)


def ranks(chains, bonds, dt, steps=500):
    """The same trajectory on 1 to 4 ranks."""
    scene(f"melt {chains} {bonds}")
    on = [beads(n, dt=dt, steps=steps) for n in (1, 2, 3, 4)]
    for output in on[1:]:
        same(1e-12, "TotEng", on[0], output)
    same(1e-10, "Press", on[0], on[3])
    check(any(x > 0 for x in on[3].column("f_rigid[5]")), "no molecule was divided among ranks")
    below(1e-13, on[3], "f_rigid[1]")


def divided(words, *variables):
    """The same, where the molecules are divided on 2, 3 and 4 ranks."""
    scene(words)
    more = {"steps": 50, "every": 10, "norm": "no", "more": "divide 100", **dict(zip(variables[::2], variables[1::2]))}
    on = [beads(n, **more) for n in (1, 2, 3, 4)]
    for output in on[1:]:
        check(not output.find(" 0 molecules divided"), "not divided")
        same(1e-12, "TotEng", on[0], output)
        same(1e-12, "Econserve", on[0], output)
    same(1e-9, "Press", on[0], on[3])
    exact(on[3])


def nve():
    """Energy holds."""
    scene("melt 16 32")
    output = beads(steps=10000, every=500, before="run 0", later="run 2000")
    # Per bead and unit of time; 1.5 units between rows.
    check(len(output.rows) == 21, "rows are missing")
    at_most(2e-5, drift(output.column("TotEng"), 5) / 1.5, "drift")
    exact(output)


def npt(words, pressure, style):
    """The barostat reaches its pressure, and its conserved quantity holds: of so few trimers it takes a random walk, some 4e-4."""
    scene(words)
    output = beads(dt=0.0025, steps=32000, every=20, norm="no", later="run 6000",
                   motion=f"npt temp 1.0 1.0 0.5 {style} {pressure} {pressure} 2.0")
    near(0.02, output.mean("Press") / float(pressure), 1, "mean pressure over the target")
    conserved = output.column("Econserve")
    check(len(conserved) > 201, "rows are missing")
    atoms = next(int(line.split()[0]) for line in read("data").splitlines() if line.endswith(" atoms"))
    at_most(2e-3, drift(conserved, len(conserved) // 2) / (0.05 * atoms), "drift of the conserved quantity per bead and unit of time")


def bent(angle):
    """A rigid angle close to straight."""
    scene(f"bent 64 {angle}")
    output = beads(more="a 1", angle=angle, dt=0.002, steps=2000)
    steady(2e-4, output, 21)
    below(1e-12, output, "f_rigid[1]")


def preload(library, stock):
    """The stock lmp with LD_PRELOAD gives the same numbers."""
    scene("melt 16 32")
    own = beads()
    os.environ["LD_PRELOAD"] = library
    variables = [word for key, value in SLOW.items() for word in ("-var", key, str(value))]
    same(1e-14, "TotEng", own, command([stock, "-in", f"{INPUTS}/beads.lmp", "-log", "none", *variables]))


def flat():
    """In two dimensions: the trajectory of fix rattle, and the same on four ranks; nothing leaves the plane."""
    plane = {"first": "dimension 2", "before": "fix plane all enforce2d", "dt": 0.003}
    scene("sheet 200 3")
    agree(**plane)
    scene("sheet 40 32")
    on = {}
    for n in (1, 4):
        on[n] = beads(n, **plane, after="write_dump all custom end id x y z vx vy vz modify format float %.17g")
        end = last_frame("end")
        check(len(end) == 1280 and all(row[3] == row[6] == 0 for row in end), "atoms have left the plane")
    same(1e-12, "TotEng", on[1], on[4])
    below(1e-13, on[4], "f_rigid[1]")


def layouts():
    """However LAMMPS keeps its bonds and cuts its box, the trajectory is the same."""
    scene("melt 40 32")
    plain = beads(steps=300)
    for n, layout in ((2, {"first": "newton off"}), (3, {"first": "comm_style tiled", "later": "balance 1.0 rcb"}),
                      (4, {"first": "processors 1 1 4"})):
        same(1e-12, "TotEng", plain, beads(n, steps=300, **layout))


def selectors():
    """The selectors of fix rattle: bonds of atom types, of masses, of a group; the same trajectories as with it."""
    scene("stars 216")
    for select in ("t 2", "t 1", "m 0.5", "m 7.0 t 2", "b 1"):
        check(agree(select=select, light=0.5, dt=0.002, steps=200).find("216 molecules, 864 atoms, 648 rigid"), f"{select}: not all bonds")
    # Of one group only: the others keep their bond style.
    half = agree(light=0.5, dt=0.001, steps=200, before="group half molecule <= 100", whose="half")
    check(half.find("100 molecules, 400 atoms, 300 rigid"), "not those of the group")


def unfix():
    """Without the fix the bond style acts again, with the energy that it had before."""
    scene("melt 8 16")
    short = {"rigid": "none", "steps": 50, "dt": 0.001, "every": 10}
    same(1e-14, "TotEng", beads(**short), beads(**short, before="fix first all holonomic b 1", later="unfix first"))


def fixed():
    """Atoms that are held fixed stay where they are, and their chains hang on them."""
    scene("melt 8 16")
    output = beads(2, steps=1000, before=f"include {INPUTS}/held.lmp", more="fixed held", later=f"include {INPUTS}/hold.lmp")
    below(1e-13, output, "f_rigid[1]", "v_far")
    steady(2e-3, output, 11)


def triclinic():
    """A triclinic box gives the trajectory of the same molecules; a box that shears keeps the bonds."""
    scene("melt 16 32")
    tilt = "change_box all triclinic"
    same(1e-12, "TotEng", beads(steps=300), beads(2, steps=300, before=tilt))
    shear = {}
    for remap, style in (("v", "nvt/sllod"), ("x", "nvt")):
        shear[remap] = beads(2, steps=3000, before=tilt, motion=f"{style} temp 1.0 1.0 0.5",
                             later=f"fix d all deform 1 xy erate 0.05 remap {remap} flip yes")
        exact(shear[remap], rates=1e-12)
    # A fluid that is sheared resists: both pictures of the motion give the same stress, within their noise.
    near(0.35, shear["v"].mean("Pxy"), shear["x"].mean("Pxy"), "mean shear stress, remap v and x")


def langevin():
    """Degrees of freedom, groups, Langevin dynamics: the temperature of a bath is reached."""
    scene("waters 216")
    bath = beads(steps=10000, every=50, more="a 1", before="fix bath all langevin 1.0 1.0 0.5 4711", later="run 2000")
    near(0.02, bath.mean("Temp"), 1, "mean temperature")
    below(1e-13, bath, "f_rigid[1]")
