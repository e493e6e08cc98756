"""Runs GROMACS, with the library or without, and reads what it wrote."""
import os
import pathlib
import re
import shutil
import struct
import subprocess

HERE = pathlib.Path(__file__).resolve().parent
WRAPPER = os.environ.get("HOLONOMIC_GMX", str(HERE.parent / "gmx-holonomic"))
DOUBLE, MIXED = "gmx_d", "gmx"
MPIRUN = ["mpirun", "--oversubscribe", "-n", "1"]
ENVIRONMENT = {"GMX_MAXBACKUP": "-1", "GMX_SUPPRESS_DUMP": "1", "OMPI_ALLOW_RUN_AS_ROOT": "1",
               "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


class Failed(Exception):
    pass


def call(command, folder, stdin="", environment=None):
    variables = {**os.environ, **ENVIRONMENT, **(environment or {})}
    done = subprocess.run(command, cwd=folder, input=stdin, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          env={name: value for name, value in variables.items() if value is not None})
    if done.returncode:
        raise Failed(done.stdout)
    return done.stdout


def grompp(folder, gmx=DOUBLE, *arguments):
    return call([gmx, "-quiet", "grompp", "-maxwarn", "20", *arguments], folder)


def mdrun(folder, *arguments, gmx=DOUBLE, holonomic=True, name="run", environment=None, threads=1):
    command = [WRAPPER] if holonomic else [gmx]
    command += ["-quiet", "mdrun", "-deffnm", name, "-s", arguments[0] if arguments and arguments[0].endswith(".tpr")
                else "topol.tpr", "-pin", "off"]
    if not any(a == "-ntmpi" for a in arguments):
        command += ["-ntmpi", "1"]
    command += ["-ntomp", str(threads)] + [a for a in arguments if not a.endswith(".tpr")]
    return call(command, folder, environment={"GMX": gmx, **(environment or {})})


def energies(folder, terms, gmx=DOUBLE, name="run"):
    """The terms at each time that was written: {term: [values]}."""
    call([gmx, "-quiet", "energy", "-dp", "-f", f"{name}.edr", "-o", f"{name}.xvg"], folder, "\n".join(terms) + "\n\n")
    columns, legends = [], []
    for line in (folder / f"{name}.xvg").read_text().splitlines():
        legend = re.match(r'@ s\d+ legend "(.*)"', line)
        if legend:
            legends.append(legend.group(1))
        elif line and line[0] not in "#@":
            columns.append([float(v) for v in line.split()])
    table = list(zip(*columns))
    result = {"time": list(table[0])}
    for legend, values in zip(legends, table[1:]):
        result[legend] = list(values)
    return result


def frames(path):
    """Positions and velocities of a .trr: [(x, v)], each a list of triples, or empty."""
    data, at, result = pathlib.Path(path).read_bytes(), 0, []
    while at < len(data):
        at += 8  # magic number, length of the version with its zero
        (n,) = struct.unpack_from(">i", data, at)
        at += 4 + (n + 3) // 4 * 4
        sizes = struct.unpack_from(">13i", data, at)
        at += 52
        box, x, v, f, n_atoms = sizes[2], sizes[7], sizes[8], sizes[9], sizes[10]
        real = (box or x or v or f) // (9 if box else 3 * n_atoms)
        at += 2 * real
        at += sum(sizes[k] for k in (0, 1, 2, 3, 4, 5, 6))
        triples = []
        for size in (x, v, f):
            values = struct.unpack_from(f">{size // real}{'d' if real == 8 else 'f'}", data, at)
            at += size
            triples.append([values[k:k + 3] for k in range(0, len(values), 3)])
        result.append((triples[0], triples[1]))
    return result


def constraint_seconds(log):
    """GROMACS's own row, "Constraints": wall seconds."""
    for line in pathlib.Path(log).read_text().splitlines():
        row = re.match(r"\s*Constraints\s+\d+\s+\d+\s+\d+\s+([\d.]+)", line)
        if row:
            return float(row.group(1))
    raise Failed(f"{log} has no row Constraints")


def has(program):
    return shutil.which(program) is not None
