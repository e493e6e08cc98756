# SPDX-License-Identifier: GPL-2.0-only
"""Tests of case.py: what is put out, restarts, errors, minimisation, and molecules that change while LAMMPS runs."""
import re

from lammps import (INPUTS, apart, at_most, below, check, exact, lammps, last_frame, near, run, same, scene, skip, steady, stops)
from molecule_cases import parts_add_up
from trajectory_cases import beads


def outputs(divide=0, steps=200):
    """Virials per atom add up to the pressure, constraint forces to nothing, tensions to the virial; on any number of ranks."""
    scene("melt 40 32")
    out, tensions = {}, {}
    for n in (1, 4):
        out[n] = beads(n, more=f"forces 50 tensions 100 divide {divide}", before="compute s all stress/atom NULL fix",
                       later=f"include {INPUTS}/sums.lmp", steps=steps)
        below(1e-10, out[n], "v_net")
        tensions[n] = sorted(last_frame("tensions.dump"))
    same(1e-10, "v_p", out[1], out[4])
    parts_add_up(out[1], 1e-10)
    near(1e-7, sum(row[2] * row[3] for row in tensions[4]), out[4].column("v_trace")[-1], "sum of tension and length, and the virial")
    check(len(tensions[1]) == 1240 and all(a[:2] == b[:2] for a, b in zip(tensions[1], tensions[4])), "not the bonds of one rank")
    at_most(1e-9, apart(*([row[2] for row in tensions[n]] for n in (1, 4))), "tensions on one and four ranks")


def restart():
    """Interrupted by a restart file, and by run after run."""
    scene("trimers 216")
    motion = "npt temp 1.0 1.0 0.5 iso 0.5 0.5 2.0"
    whole = beads(steps=400, motion=motion)
    parts = beads(steps=200, motion=motion, later="run 200")
    beads(steps=200, motion=motion, after="write_restart state")
    for name, output in (("parts", parts), ("rest", run("resume", 2, state="state", motion=motion))):
        for column in ("TotEng", "Press"):
            near(1e-8, output.column(column)[-1], whole.column(column)[-1], f"{column}, {name}")


def rerun():
    """Positions of a dump give the same potential energy and pressure; a state without motion can be read again."""
    scene("melt 8 16")
    first = beads(steps=200, every=50, later=f"include {INPUTS}/dump.lmp")
    second = beads(steps=0, every=50, after="rerun trajectory.dump dump x y z vx vy vz")
    same(1e-10, "PotEng", first, second)
    same(1e-7, "Press", first, second)


def errors():
    """What is wrong is said, with the atoms concerned."""
    scene("melt 8 16")
    template = f"rigid {INPUTS}/co2.mol"
    for words, wrong in (("respa", {"before": "run_style respa 2 2"}),
                         ("no bond type 7", {"more": "b 7"}),
                         ("no keyword", {"more": "colour 7"}),
                         ("molecule of atom 1 has 2 atoms, of which 1", {"later": f"include {INPUTS}/delete.lmp"}),
                         ("bond lengths can't be reached", {"dt": 0.5}),
                         ("no bond is selected", {"before": "delete_bonds all bond 1 remove"}),
                         ("molecule file nothing can't be read", {"more": "rigid nothing"}),
                         ("no molecule looks like", {"select": template})):
        stops("beads", words, data="data", rigid="holonomic", **wrong)
    scene("bent 8 180")
    stops("beads", "fixed", data="data", rigid="holonomic", select=f"{template} fixed held", before=f"include {INPUTS}/held.lmp")


def minimise(ranks, style, words, select):
    """Rigid minima are what springs tend to as they stiffen. With springs of 1, 2 and 4 times a strength the energies
    extrapolate to the third order of their softness."""
    scene(words)
    output = run("minimise", int(ranks), data="data", style=style, select=select)
    energy, force, bond, _ = output.numbers("rigid ")
    springs = [(float(e), float(f)) for e, f in re.findall(r"^springs \S+ (\S+) (\S+)", output.text, re.MULTILINE)]
    check(len(springs) == 3, "not three strengths of springs")
    (one, _), (two, _), (four, _) = springs
    soft = energy - four
    print(f"minimum {energy:.12g}, of springs {soft:.3g} lower")
    check(soft > 1e-6, "springs are not softer")
    at_most(0.01 * soft, (8 * four - 6 * two + one) / 3 - energy, "the springs' limit")
    at_most(1.1e-7, max([force] + [f for _, f in springs]), "largest force")
    at_most(1e-13, bond, "bond error")


def peptide(data):
    """A protein in water, LAMMPS's own example, is minimised and then runs: bonds of hydrogens, and water with its angle."""
    output = run("peptide", 2, data=data)
    before, after = output.numbers("energies ")
    print(f"energy {before:.9g}, minimised {after:.9g}")
    check(after < before - 100, "not minimised")
    below(1e-12, output, "f_rigid[1]")
    steady(5, output, 6)


def made(rows, joined=False):
    """Bonds made: as many are rigid; where they join molecules, there are so many fewer."""
    for row in rows:
        check(row[7] == 343 + row[8] and (not joined or row[6] == 343 - row[8]), f"molecules or bonds are missing in step {row[0]}")
    print(f"{rows[-1][8]:g} bonds made")
    return rows[-1][8]


def react():
    """Bonds that fix bond/create makes are rigid from the step on in which they come; the molecules are those that a new run
    finds. Breaking flexible bonds moves entries in the lists of rigid ones: all of those stay, and act again after unfix."""
    scene("dimers 343")
    grow = {"start": f"include {INPUTS}/grow.lmp"}
    create = {n: run("react", n, **grow, later=f"include {INPUTS}/on.lmp") for n in (1, 2)}
    for output in create.values():
        check(made(output.tables[0][1]) >= 20, "few bonds")
        exact(output, 1e-12, 1e-12)
    same(1e-7, "TotEng", create[1], create[2])
    # Only the molecules that change are found anew on the way; each run begins with all of them.
    long, anew = (run("react", **grow, steps=steps).column("TotEng")[-1] for steps in (1000, "1000 every 100 NULL"))
    near(1e-7, anew, long, "energy, all found anew every hundred steps")
    fresh = run("resume", state="grown", motion="nve", special="0 1 1").column("TotEng")
    check(len(fresh) == 2, "rows are missing")
    at_most(1e-9, max(abs(a / b - 1) for a, b in zip(create[1].column("TotEng")[-2:], fresh)), "going on and starting anew")

    come = run("react", 2, INPUTS=INPUTS, start=f"include {INPUTS}/come.lmp", steps=600)
    least = min(row[7] for row in come.rows)
    print(f"from 686 to {least:g} atoms")
    check(len(come.rows) == 7 and least <= 660 and all(2 * row[6] == row[7] for row in come.rows), "molecules are missing")
    exact(come, 1e-12, 1e-12)

    # The same by commands between runs, on any number of ranks.
    swap = {}
    for n in (1, 2):
        swap[n] = run("react", n, INPUTS=INPUTS, start="fix rigid all holonomic b 1", steps=200, later=f"include {INPUTS}/swap.lmp")
        dimers, one_that_came = swap[n].numbers("swapped ")
        check(300 < dimers < 343 and one_that_came == dimers + 1, "not all molecules are there")
        exact(swap[n], 1e-12, 1e-12)
    same(1e-10, "TotEng", swap[1], swap[2])

    scene("melt 16 16")
    cut = run("react", 2, start=f"include {INPUTS}/cut.lmp", later=f"include {INPUTS}/uncut.lmp", steps=1000, dt=0.001)
    broken, rigid, error = cut.numbers("broken ")[:3]
    types = sum(row[0] for row in last_frame("types.dump"))
    print(f"{broken:g} bonds of 48 broken, {rigid:g} rigid, sum of types after unfix {types:g}")
    check(broken > 5 and rigid == 192 and types == 192 + 2 * (48 - broken) and error < 1e-12, "rigid bonds were lost")


def bond_react():
    """Fix bond/react, which changes types besides, and by which LAMMPS joins dimers to chains of four. What it chooses depends
    on the number of ranks."""
    scene("dimers 343")
    join = {"INPUTS": INPUTS, "start": f"include {INPUTS}/join.lmp"}
    for n in (1, 2, 4):
        output = lammps("react", n, **join, steps=1000)
        if output.find("fix style 'bond/react'"):
            skip("this LAMMPS has no fix bond/react")
        check(output.ended and output.find("^Loop time"), "LAMMPS stopped")
        check(len(output.rows) == 11 and made(output.rows, joined=True) >= 50, "few bonds")
        exact(output, 1e-12, 1e-12)
        if n == 1:
            alone = output.column("TotEng")[4]
    anew = run("react", **join, steps="400 every 100 NULL")
    near(1e-7, anew.column("TotEng")[-1], alone, "energy, all found anew every hundred steps")


def boundary():
    """Velocities of a molecule across the boundary are on the constraints as those of one inside are; what fix rattle makes of
    the same input is said, for it depends on the release."""
    for n in (1, 2):
        along = run("rattle_boundary", n, rigid="holonomic b 1").numbers("d.v of the dimer inside")
        at_most(1e-12, max(map(abs, along)), "velocities along bonds")
    print(run("rattle_boundary").find("^d.v of.*$")[0])
