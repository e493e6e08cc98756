# SPDX-License-Identifier: GPL-2.0-only
"""What the tests that run LAMMPS share: a run, the numbers of its table and of its dumps, and comparisons that end the test.

In the environment: LMP (the executable), PLUGIN (to be loaded; empty: LMP knows the fix), SCENE (make_scene), MPIRUN."""
import os
import re
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
INPUTS = f"{HERE}/inputs"
LMP, PLUGIN, SCENE, MPIRUN = (os.environ.get(name, "") for name in ("LMP", "PLUGIN", "SCENE", "MPIRUN"))


def begin():
    """A folder of its own, more ranks than processors, as root in containers."""
    with open(f"{HERE}/../../mpi/environment") as lines:
        os.environ.update(line.strip().split("=", 1) for line in lines if line[0].isupper())
    folder = tempfile.TemporaryDirectory()
    os.chdir(folder.name)
    return folder


def fail(what):
    sys.exit(f"FAILED: {what}")


def skip(why):
    print("SKIPPED:", why)
    sys.exit(77)


def check(true, what):
    if not true:
        fail(what)


def write(name, text):
    with open(name, "w") as out:
        out.write(text)


def read(name):
    with open(name) as text:
        return text.read()


def scene(words, data="data"):
    with open(data, "w") as out:
        subprocess.run([SCENE, *words.split()], stdout=out, check=True)


class Output:
    def __init__(self, text, ended):
        self.text, self.ended = text, ended
        self.tables, reading = [], False
        for line in text.splitlines():
            words = line.split()
            if words[:1] == ["Step"]:
                self.tables.append((words, []))
                reading = True
            elif line.startswith("Loop time"):
                reading = False
            elif reading and len(words) == len(self.tables[-1][0]) and words[0].isdigit():
                self.tables[-1][1].append([float(word) for word in words])
        self.head, self.rows = self.tables[-1] if self.tables else ([], [])

    def column(self, name):
        return [row[self.head.index(name)] for row in self.rows] if name in self.head else []

    def mean(self, name):
        column = self.column(name)
        return sum(column) / len(column)

    def find(self, pattern):
        return re.search(pattern, self.text, re.MULTILINE)

    def numbers(self, start):
        """Those of the line that begins so."""
        line = self.find(f"^{re.escape(start)}.*$")
        check(line, f"no line {start}")
        return [float(x) for x in re.findall(r"(?<![\w.])[-+]?\d[\d.]*(?:e[-+]?\d+)?(?!\w)", line[0][len(start):])]

    def show(self):
        print(*(re.findall(".*ERROR.*\n(?:.*\n)?", self.text) or self.text.splitlines(True)[-20:]))


def command(words):
    done = subprocess.run(words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    return Output(done.stdout.decode(errors="replace"), done.returncode == 0)


def lammps(name, ranks=1, **variables):
    """One of the inputs, or a file that is here, with these variables."""
    path = name if os.path.exists(name) else f"{INPUTS}/{name}.lmp"
    if PLUGIN:
        write("with-plugin.lmp", f"plugin load {PLUGIN}\ninclude {path}\n")
        path = "with-plugin.lmp"
    words = [LMP, "-in", path, "-log", "none"]
    for key, value in variables.items():
        words += ["-var", key, str(value)]
    return command(([MPIRUN, "-np", str(ranks)] if ranks > 1 else []) + words)


def run(name, ranks=1, **variables):
    """The same, which has to end well."""
    output = lammps(name, ranks, **variables)
    if not output.ended or not output.find("^Loop time"):
        output.show()
        fail("LAMMPS stopped")
    return output


def stops(name, words, **variables):
    """LAMMPS stops with an error that has these words."""
    output = lammps(name, **variables)
    check(not output.ended, f"LAMMPS did not stop: {words}")
    error = output.find("^.*ERROR.*$")
    print(error[0] if error else output.text[-2000:])
    check(output.find(f"ERROR.*{words}"), f"not the error expected: {words}")


def largest(values):
    """Of the absolute values; what is no number counts most, nothing as infinite."""
    return max((abs(x) for x in values), key=lambda x: (x != x, x), default=float("inf"))


def at_most(limit, value, what):
    print(f"{what}: {value:.3g} (allowed {limit:g})")
    check(abs(value) <= limit, what)


def near(tolerance, value, expected, what):
    at_most(tolerance, abs(value - expected), f"{what}: {value:.9g}, expected {expected:.9g}")


def apart(a, b):
    check(len(a) == len(b) > 0, f"{len(a)} numbers and {len(b)}")
    return largest(x - y for x, y in zip(a, b))


def same(tolerance, name, a, b):
    """The columns agree, relatively."""
    a, b = a.column(name), b.column(name)
    check(len(a) == len(b) > 1, f"{name} has {len(a)} rows and {len(b)}")
    worst = largest((x - y) / max(abs(x), abs(y)) if x != y else 0.0 for x, y in zip(a, b))
    at_most(tolerance, worst, f"{name}, largest relative difference of {len(a)} rows")


def below(limit, output, *names):
    for name in names:
        at_most(limit, largest(output.column(name)), f"{name}, largest of {len(output.rows)} rows")


def exact(output, lengths=1e-13, rates=1e-13):
    """The largest errors of bond lengths and of their rates."""
    below(lengths, output, "f_rigid[1]")
    below(rates, output, "f_rigid[2]")


def steady(limit, output, rows, name="TotEng", unit=1.0):
    column = output.column(name)
    check(len(column) == rows, f"{len(column)} rows, not {rows}")
    at_most(limit, largest(x - column[0] for x in column) / unit, f"largest change of {name}")


def drift(column, ends):
    """Change between the means of the first and the last rows, so many, for each row."""
    check(len(column) >= 2 * ends, "rows are missing")
    return (sum(column[-ends:]) - sum(column[:ends])) / (ends * (len(column) - ends))


def last_frame(dump):
    """The rows of a dump's last step."""
    rows, reading = [], False
    for line in read(dump).splitlines():
        if line.startswith("ITEM:"):
            reading = line.startswith(("ITEM: ATOMS", "ITEM: ENTRIES"))
            rows = [] if reading else rows
        elif reading:
            rows.append([float(x) for x in line.split()])
    return rows
