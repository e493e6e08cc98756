"""The shared library: where it is, and its functions as capi/holonomic.h declares them."""

from __future__ import annotations

import ctypes
import os
from ctypes import c_double, c_int, c_int32, c_int64, c_void_p

try:
    from ._installed import LIBRARY as _INSTALLED  # written by `HOLONOMIC_PREFIX=... pip install`
except ImportError:
    _INSTALLED = None

_NEEDED = 300  # HOL_VERSION of 0.3.0
_NAME = "libholonomic-0.dll" if os.name == "nt" else "libholonomic.so.0"

# Result and arguments: p a pointer, i int, l int64_t, d double, s a text, - nothing. A test reads the header beside this.
SIGNATURES = {
    "hol_version": "s",
    "hol_version_number": "i",
    "hol_status_name": "s i",
    "hol_error_message": "s",
    "hol_error_location": "- pppp",
    "hol_error_remember": "i ip",
    "hol_instruction_set": "s",
    "hol_chains_create": "i lpp",
    "hol_chains_copy": "i pp",
    "hol_chains_destroy": "- p",
    "hol_chains_add": "i plpp",
    "hol_chains_add_block": "i plllp",
    "hol_chains_add_bonds": "i plpp",
    "hol_chains_add_molecules": "i pllllpp",
    "hol_chains_add_linear": "i plppplpp",
    "hol_chains_add_linear_molecules": "i pllllppplpp",
    "hol_chains_add_rigid": "i plppplpp",
    "hol_chains_add_rigid_molecules": "i pllllppplpp",
    "hol_chains_set_lengths": "i pp",
    "hol_chains_set_length": "i pld",
    "hol_chains_set_masses": "i pp",
    "hol_chains_set_bodies": "i pi",
    "hol_chains_set_box": "i pp",
    "hol_chains_set_reference_box": "i pp",
    "hol_chains_set_box_rate": "i pp",
    "hol_chains_set_labels": "i ppp",
    "hol_chains_labels": "i ppp",
    "hol_chains_set_checks": "i pi",
    "hol_chains_set_threads": "i pi",
    "hol_chains_set_outcomes": "i pi",
    "hol_chains_set_active": "i pp",
    "hol_chains_set_length_tolerance": "i pd",
    "hol_chains_adjustment": "i ppp",
    "hol_chains_held_sites": "i pp",
    "hol_chains_implied": "i pp",
    "hol_chains_set_memory_limit": "i pl",
    "hol_chains_set_tolerance": "i pd",
    "hol_chains_set_max_iterations": "i pi",
    "hol_chains_bodies": "i p",
    "hol_chains_checks": "i p",
    "hol_chains_threads": "i p",
    "hol_chains_outcomes": "i p",
    "hol_chains_tolerance": "d p",
    "hol_chains_length_tolerance": "d p",
    "hol_chains_max_iterations": "i p",
    "hol_chains_memory_limit": "l p",
    "hol_chains_n_atoms": "l p",
    "hol_chains_n_molecules": "l p",
    "hol_chains_n_bonds": "l p",
    "hol_chains_n_of_shape": "l pi",
    "hol_chains_n_kinds": "l p",
    "hol_chains_molecule": "i plppp",
    "hol_chains_atoms": "i plp",
    "hol_chains_bonds": "i plp",
    "hol_chains_molecules_of_bonds": "i pp",
    "hol_chains_pairs": "i pp",
    "hol_chains_lengths": "i pp",
    "hol_chains_masses": "i pp",
    "hol_chains_box": "i pip",
    "hol_chains_roles": "i ppp",
    "hol_chains_degrees_of_freedom": "l pi",
    "hol_chains_memory": "l p",
    "hol_chains_check_view": "i ppi",
    "hol_forces": "i pppppppip",
    "hol_forces_view": "i pppppppip",
    "hol_solve_view": "i pppppip",
    "hol_factors_create": "i pp",
    "hol_factors_destroy": "- p",
    "hol_factors_update_view": "i pp",
    "hol_factors_forces_view": "i ppppppip",
    "hol_factors_solve_view": "i plpppip",
    "hol_reactions_view": "i ppipppipp",
    "hol_project_velocities": "i ppppp",
    "hol_project_velocities_view": "i ppppp",
    "hol_project_positions": "i ppppdpipp",
    "hol_project_positions_view": "i ppppdpipp",
    "hol_project_positions_along_view": "i ppppdpipp",
    "hol_reference_error": "i pppp",
    "hol_violation_view": "i pppp",
    "hol_residuals_view": "i ppppp",
    "hol_impose_view": "i ppp",
    "hol_outcomes": "i ppp",
    "hol_metric_view": "i ppdppppi",
    "hol_inverse_create_view": "i plpp",
    "hol_inverse_destroy": "- p",
    "hol_inverse_n_bonds": "l p",
    "hol_inverse_entry": "i pillp",
    "hol_inverse_row": "i pilp",
    "hol_inverse_band": "i pilp",
    "hol_inverse_matrix": "i pip",
    "hol_inverse_condition": "i pp",
    "hol_inverse_error_bound_view": "i pppppp",
    "hol_device_plan_create": "i pilp",
    "hol_device_plan_destroy": "- p",
    "hol_device_plan_source": "s p",
    "hol_device_plan_array": "i pipp",
    "hol_device_plan_n_launches": "l p",
    "hol_device_plan_launch": "i plpppp",
    "hol_device_plan_n_left": "l p",
    "hol_device_plan_left": "i pp",
    "hol_tridiagonal_pivots": "i lpp",
    "hol_tridiagonal_log_det": "i lpp",
    "hol_tridiagonal_solve": "i lppp",
    "hol_tridiagonal_inverse_entry": "i lpllp",
    "hol_tridiagonal_inverse_band": "i lplp",
    "hol_partition_function": "i lpppp",
    "hol_equimomental_points": "i dppppp",
    "hol_chains_add_bonds_with_images": "i plppp",
    "hol_chains_set_images": "i pp",
    "hol_chains_images": "i pp",
}
_TYPES = {"p": c_void_p, "i": c_int, "l": c_int64, "d": c_double, "s": ctypes.c_char_p, "-": None}


class View(ctypes.Structure):
    """hol_view: where a vector per atom stands in memory."""

    _fields_ = [("x", c_void_p), ("y", c_void_p), ("z", c_void_p), ("stride", c_int64), ("element", c_int32),
                ("reserved", c_int32)]


def _load() -> ctypes.CDLL:
    """HOLONOMIC_LIBRARY if it is set, else the library in this folder (wheels), else the one that this package was installed
    beside, else the system's."""
    named = os.environ.get("HOLONOMIC_LIBRARY")
    beside = os.path.join(os.path.dirname(os.path.abspath(__file__)), _NAME)
    path = named or (beside if os.path.exists(beside) else _INSTALLED or _NAME)
    try:
        library = ctypes.CDLL(path)
    except OSError as error:
        raise ImportError(
            f"the library of holonomic could not be loaded ({error}). Install it (package libholonomic0, or "
            "`cmake --install`, then ldconfig), or name the file in the environment variable HOLONOMIC_LIBRARY."
        ) from None
    if not hasattr(library, "hol_version"):
        raise ImportError(f"{path} is not the library of holonomic")
    library.hol_version.restype = ctypes.c_char_p
    if not hasattr(library, "hol_version_number") or library.hol_version_number() < _NEEDED:
        raise ImportError(f"{path} is holonomic {library.hol_version().decode()}; this package needs "
                          f"{_NEEDED // 10000}.{_NEEDED // 100 % 100} or later")
    for name, signature in SIGNATURES.items():
        function = getattr(library, name, None)
        if function is None:
            raise ImportError(f"{path} has no {name}: it is older than this package")
        result, _, arguments = signature.partition(" ")
        function.restype = _TYPES[result]
        function.argtypes = [_TYPES[letter] for letter in arguments]
    return library


library = _load()


def bare(name: str):
    """The function without conversion of arguments, for calls that have to be short: it is to be given None, integers
    for int, and objects of ctypes for all else."""
    function = library[name]  # by index: an object of its own
    function.restype = c_int
    return function


def version() -> str:
    """Version of the library that runs, "MAJOR.MINOR.PATCH"."""
    return library.hol_version().decode()


def instruction_set() -> str:
    """The instruction set that the calculations use on this machine: "baseline", "avx2" or "avx512vl"; on 64-bit Arm "neon"."""
    return library.hol_instruction_set().decode()
