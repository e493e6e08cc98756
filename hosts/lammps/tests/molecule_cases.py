# SPDX-License-Identifier: GPL-2.0-only
"""Tests of case.py: rigid molecules by a template, by all bonds and angles, by bodies that share an atom."""
import math
import os
import re

import angles as molecules
from lammps import (INPUTS, apart, at_most, below, check, exact, near, read, run, same, scene, steady, stops, write)


def fluid(molecule, ranks=1, **variables):
    return run("fluid", ranks, INPUTS=INPUTS, molecule=molecule, **variables)


def held_by(molecule, n=3, decimals=12):
    """Makes N^3 of these molecules; what holds them."""
    molecules.make(molecule, n, decimals)
    types = dict((word, int(n)) for n, word in re.findall(r"(\d+) (\w+) types", read("data")))
    if molecule == "joined":
        return "bodies bodies.txt"
    return " ".join(["b", *map(str, range(1, types["bond"] + 1)), "a", *map(str, range(1, types["angle"] + 1))])


def second_order(ours, theirs):
    """The trajectory of fix rigid/small, in whole and half steps, up to the second order of both integrators."""
    whole, half = (a.column("PotEng")[-1] - b.column("PotEng")[-1] for a, b in zip(ours, theirs))
    print(f"difference to fix rigid/small: {whole:.3g}, {half:.3g} in half steps")
    near(0.5, whole / half, 4, "ratio")


def freedoms(output, molecule_freedoms, n):
    near(1e-6, output.column("v_free")[0], n * int(molecule_freedoms) - 3, "degrees of freedom")


def parts_add_up(output, tolerance):
    """Virials per atom give the pressure."""
    check(len(output.rows) > 1, "rows are missing")
    at_most(tolerance, apart(output.column("v_p"), output.column("Press")), "pressure of atoms and of the box")


def bodies(molecule, spacing):
    """Rigid molecules by a template: energy and momentum hold, alone and with a barostat; ranks agree."""
    select = f"rigid {INPUTS}/{molecule}.mol"
    these = {"spacing": spacing, "select": select}
    ours, small = ([fluid(molecule, **these, **rigid, steps=50 * half, every=50 * half, dt=2 / half) for half in (1, 2)]
                   for rigid in ({}, {"rigid": "small"}))
    near(1e-9, ours[0].column("TotEng")[0], small[0].column("TotEng")[0], "energy at the start")
    second_order(ours, small)
    nve = fluid(molecule, **these, steps=400, every=20, before="write_data data nocoeff")
    steady(0.1, nve, 21)
    exact(nve)
    below(1e-9, nve, "v_momentum")
    same(1e-9, "TotEng", nve, fluid(molecule, 2, **these, steps=400, every=20, data="data"))
    npt = fluid(molecule, **these, steps=400, every=20, motion="npt temp 320 320 100 iso 200 200 2000")
    exact(npt)
    below(1e-8, npt, "v_momentum")
    steady(0.5, npt, 21, "Econserve")
    parts = fluid(molecule, **{**these, "select": f"{select} forces 50 tensions 100"}, steps=100,
                  before="compute s all stress/atom NULL fix", later=f"include {INPUTS}/sums.lmp")
    parts_add_up(parts, 1e-6)
    below(1e-7, parts, "v_net")


def water_file(name, bond, degrees, types=(1, 2, 1)):
    """A molecule file of waters as make_scene writes them."""
    x, y = bond * math.cos(math.radians(degrees)), bond * math.sin(math.radians(degrees))
    kinds = "\n".join(f"{k + 1} {kind}" for k, kind in enumerate(types))
    write(name, f"# water\n\n3 atoms\n\nCoords\n\n1 {bond:.17g} 0 0\n2 0 0 0\n3 {x:.17g} {y:.17g} 0\n\nTypes\n\n{kinds}\n")


def atomic(select, ranks=1, **variables):
    return run("atomic", ranks, **{"data": "data", "select": select, **variables})


def shapes():
    """Which molecules a file's shape holds: the one that fits best; a warning and an error if none fits well; all as they stand
    without a file; molecules of an atom style that has no bonds."""
    scene("waters 216")
    water_file("right.mol", 1.05, 109.47)
    water_file("near.mol", 1.06, 109.47)
    water_file("bent.mol", 1.05, 80)
    water_file("other.mol", 1.05, 109.47, (1, 2, 2))
    right = atomic("rigid right.mol")
    check(not right.find("largest displacement"), "a warning without a reason")
    same(1e-12, "TotEng", right, atomic("rigid other.mol rigid near.mol rigid bent.mol rigid right.mol", 2))
    # By hand: the molecule moves along its axis by a third of 2 x 0.01 cos(54.735 deg) at the ends, less at the middle.
    check(atomic("rigid near.mol").find("WARNING.* is 0.00[89][0-9]* from where the file near.mol has it, the largest displacement"), "no warning")
    stops("atomic", "molecule [0-9]* is 0.[12][0-9]* from where the file bent.mol has it", data="data", select="rigid bent.mol")
    for n in (1, 2):
        same(1e-10, "TotEng", right, atomic("rigid", n))
    head, atoms = read("data").split("Bonds")[0].split("Atoms", 1)
    atoms = [line.split() for line in atoms.splitlines()[1:] if line.strip()]
    head = re.sub(r"(?m)^.* (bonds|angles|bond types|angle types)\n", "", head)
    write("data.atomic", "\n".join([head + "Atoms # atomic\n", *(" ".join([a[0], *a[2:6]]) for a in atoms), "\nMolecules\n",
                                    *(f"{a[0]} {a[1]}" for a in atoms), ""]))
    bare = atomic("rigid right.mol forces 10", 2, data="data.atomic fix id NULL Molecules", style="atomic",
                  first="fix id all property/atom mol ghost yes")
    same(1e-10, "TotEng", right, bare)
    below(1e-13, bare, "f_rigid[1]")


def beside():
    """Fix shake that holds bonds of the same atoms is told of, whichever comes first; that of other atoms is not."""
    scene("trimers 125", "plain")
    start, bonds = read("plain").split("\nBonds\n\n")
    bonds = [line.split() for line in bonds.splitlines()]
    write("other", "bond_coeff 2 100.0 1.05\nfix other all shake 1e-8 100 0 b 2\n")
    # Every other bond, or all of every other molecule, is of type 2.
    for n in (1, 2):
        typed = "\n".join(f"{k} {1 + (int(k) - 1) // n % 2} {i} {j}" for k, _, i, j in bonds)
        write("data", start.replace("1 bond types", "2 bond types") + "\nBonds\n\n" + typed + "\n")
        for ranks in (1, 2):
            output = run("beads", ranks, data="data", rigid="holonomic", dt=0.002, wide=3.5, before="include other", steps=1)
            told = output.find(r"WARNING.*Fix other \(shake\) holds bonds of atoms of fix rigid \(holonomic\), atom [0-9]* for one")
            check(told if n == 1 else not output.find("holds bonds"), "no warning" if n == 1 else "a warning without a reason")


def cliques():
    """Atoms on a line (CO2, acetylene) and all distances of five atoms (methane), by bonds and angles."""
    bonds, template = fluid("co2", steps=100), fluid("co2", steps=100, select=f"rigid {INPUTS}/co2.mol")
    same(1e-10, "TotEng", bonds, template)
    same(1e-9, "Press", bonds, template)
    for name, angle, free in (("lines", 180, 5), ("methanes", 109.4712206344907, 6)):
        scene(f"{name} 125")
        these = {"data": "data", "rigid": "holonomic", "more": "a 1", "angle": angle, "norm": "no", "before": "special_bonds lj 0 0 0"}
        output = run("beads", 2, **these, dt=0.002, steps=2000)
        exact(output, 1e-12, 1e-12)
        steady(2e-3, output, 21, unit=125)
        freedoms(run("beads", **these, steps=1, every=1, later=f"include {INPUTS}/freedom.lmp"), free, 125)


def keeps(output, part):
    """The energy stays within this part of it, lengths and rates to rounding."""
    steady(part, output, 21, unit=output.column("TotEng")[0])
    exact(output, 1e-12, 1e-12)


def angles(molecule, free):
    """The trajectory of SHAKE run to its end, on any number of ranks; energy, freedoms."""
    select = held_by(molecule)
    run("angles", select=select, dump="yes", steps=20, every=5)
    positions, velocities, moved = molecules.check("trajectory.dump", 0.01, 3.0)
    at_most(1e-10, positions, "positions, from SHAKE's")
    at_most(1e-9, velocities, "velocities, from SHAKE's")
    check(moved > 0.02, "nothing moved")
    on = {n: run("angles", n, select=select, steps=200) for n in (1, 2, 4)}
    for n in (2, 4):
        same(1e-11, "TotEng", on[1], on[n])
    check(any(x > 0 for x in on[4].column("f_rigid[5]")), "no molecule was divided among ranks")
    keeps(run("angles", select=select, steps=2000, every=100), 2e-4)
    freedoms(run("angles", select=select, steps=1, every=1, later=f"include {INPUTS}/freedom.lmp"), free, 27)


def beside_small(molecule):
    """The same body by fix rigid/small."""
    select = held_by(molecule)
    second_order(*([run("angles", **rigid, dt=0.02 / half, steps=50 * half, every=50 * half) for half in (1, 2)]
                   for rigid in ({"select": select}, {"rigid": "small"})))


def unfit():
    """Angles as a force field has them do not quite fit: they are adjusted, which is said, within the tolerance; what such a
    molecule can not be, and a list of bodies that is wrong, are refused."""
    select = held_by("hexane", 2, 1)
    rounded = run("angles", select=f"{select} tensions 100", steps=2000, every=100)
    check(rounded.find("WARNING.*adjusted in the least way, that of atoms [0-9]* and [0-9]* most, by 0.0[0-9]* per cent"), "no warning")
    keeps(rounded, 2e-4)
    whole = {n: run("angles", n, select=f"{select} divide 4", steps=100) for n in (1, 2)}
    check(whole[2].find(" 0 molecules divided"), "divided, though distances depend on each other")
    same(1e-11, "TotEng", whole[1], whole[2])
    stops("angles", "atoms [0-9]* and [0-9]*.*more than the tolerance", select=f"{select} tolerance 1e-6")
    stops("angles", "tolerance needs a part of a length", select=f"{select} tolerance 0.5")
    select = held_by("joined", 2)
    lines = read("bodies.txt").splitlines()
    write("missing.txt", "\n".join([*lines[:2], lines[2] + " 99999", *lines[3:], ""]))
    write("twice.txt", "17 1 1 2 1\n")
    stops("angles", "body 3 of the file missing.txt has 5 atoms, of which 4 are in the group", select="bodies missing.txt")
    stops("angles", "body 17 of the file twice.txt has atom 1 twice", select="bodies twice.txt")
    stops("angles", "the list of bodies nothing can't be read", select="bodies nothing")
    # Bodies that share an atom, and a molecule's bodies of which none does.
    same(1e-12, "TotEng", *(run("angles", select=held, steps=100) for held in (f"{select} rigid", select)))


def long_npt(molecule, n, spacing, temperature, pressure):
    """Not among the tests, for it takes an hour: what a barostat conserves over 250 ps of N^3 rigid molecules with this fix and
    with rigid/npt/small, and of co2 with springs instead; all from the same start, with the same bath. STEPS: of 2 fs."""
    steps = int(os.environ.get("STEPS", 125000))
    bath = f"temp {temperature} {temperature} 200 iso {pressure} {pressure} 2000"
    these = {"n": n, "spacing": spacing, "temperature": temperature}
    held, free = {"select": f"rigid {INPUTS}/{molecule}.mol", "dt": 2}, {
        "rigid": "none", "later": "thermo_style custom step temp pe etotal press v_momentum econserve vol"}
    fluid(molecule, **these, **held, steps=steps // 6, every=1000, after="write_data start nocoeff",
          motion=f"npt temp {temperature} {temperature} 100 iso {pressure} {pressure} 1000")
    these["data"] = "start"
    outputs = {"holonomic": fluid(molecule, **these, **held, steps=steps, every=250, motion=f"npt {bath}"),
               "small": fluid(molecule, **these, **free, dt=2, steps=steps, every=250,
                              before=f"fix rigid all rigid/npt/small molecule {bath}")}
    if molecule == "co2":
        outputs["springs"] = fluid(molecule, **these, **free, dt=0.5, steps=4 * steps, every=1000, before=f"fix motion all npt {bath}")
    for name, output in outputs.items():
        e = output.column("Econserve")
        middle, mean = (len(e) - 1) / 2, sum(e) / len(e)
        slope = sum((k - middle) * x for k, x in enumerate(e)) / sum((k - middle) ** 2 for k in range(len(e)))
        scatter = math.sqrt(sum((x - mean - slope * (k - middle)) ** 2 for k, x in enumerate(e)) / len(e))
        print(f"{name:9} conserved: end less start {e[-1] - e[0]:.3g}, scatter about a line {scatter:.3g}; means of temperature "
              f"{output.mean('Temp'):.2f}, pressure {output.mean('Press'):.2f}, volume {output.mean('Volume'):.1f}")
    below(1e-13, outputs["holonomic"], "f_rigid[1]")
    below(1e-8, outputs["holonomic"], "v_momentum")
