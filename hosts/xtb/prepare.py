"""Changes what xtb's build files say: prepare.py FOLDER

Leaves out what Debian has no package of and molecular dynamics does not use (PTB's dependencies, the tests), writes two sizes of
arrays as numbers where gfortran 12 does not take the expression, and links holonomic, which nothing calls before the modules are put
in. Each is left alone where it has been done or is not needed.
"""

import os
import re
import sys


def change(path, pattern, replacement):
    with open(path) as file:
        before = file.read()
    after = re.sub(pattern, replacement, before, flags=re.S)
    if after != before:
        with open(path, "w") as file:
            file.write(after)
    return after


folder = sys.argv[1]
dependencies, build = os.path.join(folder, "meson", "meson.build"), os.path.join(folder, "meson.build")
for name in "multicharge", "dftd4":
    change(dependencies, rf"{name}_dep = dependency\([^)]*\)\nlib_deps \+= {name}_dep\n", "")
change(build, r"\nsubdir\('test'\)", "")
energy = os.path.join(folder, "src", "gfnff", "gfnff_eg.f90")
change(energy, r"(intent\(in\) :: rTrans\( *3, )product\(2\*ewaldCutD\+1\)", r"\g<1>125")
change(energy, r"(intent\(in\) :: gTrans\( *3, )product\(2\*ewaldCutR\+1\)-1", r"\g<1>124")
line = "lib_deps += dependency('holonomic-fortran')\n"
if line not in change(dependencies, r"(lib_deps \+= mctc_dep\n)(?!lib_deps \+= dependency)", r"\1" + line):
    sys.exit("prepare.py: mctc_dep is not where it was")
if not os.path.exists(os.path.join(folder, "src", "shake_module.f90")):
    sys.exit("prepare.py: there is no src/shake_module.f90")
