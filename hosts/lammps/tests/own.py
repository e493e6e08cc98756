#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-only
"""LAMMPS's own tests of constraints with fix holonomic in their place: its source tree has the scenes, their commands and the
numbers that fix shake, rattle or ilves gave at its tolerance.

    own.py YAML      with LMP, SOURCE (LAMMPS's source tree) and PLUGIN (empty: LMP knows the fix)

"tight" is the fix of the reference at a tolerance of 1e-13: how far it is from the reference's numbers shows what these
are good for."""
import os
import re
import sys

from lammps import LMP, PLUGIN, apart, at_most, begin, command, fail, last_frame, read, skip, write

folder = begin()
force_styles = os.environ["SOURCE"] + "/unittest/force-styles"
scenes = force_styles + "/tests"
if not os.path.exists(f"{scenes}/{sys.argv[1]}"):
    skip(f"this source tree has no {sys.argv[1]}")
yaml = read(f"{scenes}/{sys.argv[1]}")


def entry(key):
    """What the file has for it, in one line or in the indented ones below."""
    line, below = re.search(rf"^{key}: *(.*)\n((?: .*\n)*)", yaml, re.MULTILINE).groups()
    return re.sub(r"(?m)^ +", "", below).replace('""\n', "") if line[:1] in "!|" and line else line.replace('""', "")


def numbers(key):
    return [[float(x) for x in line.split()] for line in entry(key).splitlines()]


commands = entry("post_commands")
style = re.search(r"^fix test \S+ (\S+)", commands, re.MULTILINE)[1]


def translated(which):
    """The selectors stay; tolerance, iterations and steps between messages go, or are made tight."""
    fix = "holonomic" if which == "holonomic" else f"{style} 1e-13 500 0"
    return re.sub(rf"(?m)^(fix test \S+) {style} \S+ \S+ \S+", rf"\1 {fix}", commands).rstrip("\n")


def coefficients():
    """What the scene leaves to a second file, in older releases to the test's source: styles, coefficients and groups; lengths
    and angles for the styles zero."""
    if os.path.exists(f"{scenes}/coeffs.fourmol"):
        lines = read(f"{scenes}/coeffs.fourmol").splitlines()
    else:
        lines = re.findall(r'^ *command\("((?:pair_|bond_|angle_|group ).*)"\);', read(f"{force_styles}/test_fix_timestep.cpp"), re.MULTILINE)
    if entry("input_file") == "in.fourmol":
        return lines
    words = [line.split() for line in lines]
    return [" ".join([w[0], w[1], *w[3:4]]) for w in words if w and w[0] in ("bond_coeff", "angle_coeff")] + ["pair_coeff * *"]


def take(which, start, parts, *run):
    """Runs these commands from a restart file, or from the scene itself, each step in so many parts: positions, velocities,
    the virial, and velocities made tangent."""
    lines = [f"plugin load {PLUGIN}"] if PLUGIN else []
    lines += [f"variable input_dir index {scenes}", f"read_restart {start}" if start else f"include {scenes}/{entry('input_file')}"]
    lines += [line for line in coefficients() if not (start and line.startswith("group"))]
    lines += [translated(which), "compute p all pressure NULL fix", "thermo_style custom step " + " ".join(f"c_p[{k}]" for k in range(1, 7)),
              "thermo_modify norm no format float %.17g", f"timestep {0.25 / parts:.17g}", *run,
              "write_dump all custom end id x y z vx vy vz modify format float %.17g sort id",
              # The virial, from the pressure of real units: the scenes have these.
              "variable w equal vol/68568.415"]
    lines += [f"variable w{k} equal c_p[{k}]*v_w" for k in range(1, 7)]
    lines += ['print "VIRIAL ' + " ".join(f"$(v_w{k}:%.17g)" for k in range(1, 7)) + '"']
    # Its velocities, made tangent; positions stay.
    if which != "holonomic":
        lines += ["unfix test", *re.findall("(?m)^fix test.*", translated("holonomic"))]
    lines += ["run 0", "write_dump all custom tangent id vx vy vz modify format float %.17g sort id", ""]
    write("take.in", "\n".join(lines))
    output = command([LMP, "-in", "take.in", "-log", "none"])
    if not output.ended or not output.find("^VIRIAL"):
        if output.find("Unknown fix|Unrecognized fix") and which == "tight":
            skip(f"this LAMMPS has no fix {style}")
        output.show()
        fail(f"fix {style if which == 'tight' else 'holonomic'} stopped")
    end = last_frame("end")
    return {"pos": [row[:4] for row in end], "vel": [[row[0], *row[4:]] for row in end], "tangent": last_frame("tangent"),
            "stress": [output.numbers("VIRIAL")]}


def far(a, b):
    """Largest difference of any numbers."""
    return apart(sum(a, []), sum(b, []))


run = ["run 0 post no", "thermo 2", "run 4 post no start 0 stop 8", "write_restart half", "run 4 start 0 stop 8"]
positions, velocities, epsilon = numbers("run_pos"), numbers("run_vel"), float(entry("epsilon"))
tight = take("tight", "", 1, *run)
ours = take("holonomic", "", 1, run[0], "write_restart start", *run[1:])
print(f"fix {style} at its tolerance and at 1e-13: positions {far(positions, tight['pos']):.3g}, velocities {far(velocities, tight['vel']):.3g}")
if style == "ilves":
    # It takes a start that is off the constraints in another way: the numbers of the reference belong to that.
    print(f"positions of the reference and of fix holonomic: {far(positions, ours['pos']):.3g}")
else:
    at_most(epsilon, far(positions, ours["pos"]), "positions, from those of the reference")
    if style != "shake":
        at_most(epsilon, far(velocities, ours["vel"]), "velocities, from those of the reference")
    at_most(1e-12, far(tight["tangent"], ours["vel"]), f"velocities, from those of fix {style} made tangent")
again = take("holonomic", "half", 1, "thermo 2", "run 4")
for what in ("pos", "vel", "stress"):
    at_most(1e-13, far(ours[what], again[what]), f"{what} after a restart")

# From a start on the constraints, in steps and in quarters of them. Fix shake and ilves have the virial of a step's
# impulses, fix rattle one of first order in the step: what they differ by has to go, to nothing.
virials = []
for parts in (1, 4):
    theirs, ours = (take(which, "start", parts, f"thermo {2 * parts}", f"run {8 * parts}") for which in ("tight", "holonomic"))
    for what in ("pos", "tangent"):
        at_most(1e-8 if style == "ilves" else 1e-12, far(theirs[what], ours[what]), f"{what}, from a common start, {parts}")
    virials.append(far(theirs["stress"], ours["stress"]))
at_most(virials[0] / 3.5 + 1e-7, virials[1], f"virials differ by {virials[0]:.3g}, in quarters of steps")
