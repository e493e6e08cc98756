#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-only
"""One test: runs LAMMPS with the fix and compares numbers, not exit codes.

    case.py NAME ARGUMENT...      NAME is a function of trajectory_cases, molecule_cases or other_cases"""
import sys

import lammps
import molecule_cases
import other_cases
import trajectory_cases

with lammps.begin():
    name, *arguments = sys.argv[1:]
    case = next(getattr(m, name) for m in (trajectory_cases, molecule_cases, other_cases) if hasattr(m, name))
    case(*arguments)
