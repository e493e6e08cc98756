"""Plans for kernels of a GPU, for programs with PyOpenCL, CuPy or PyTorch."""

from __future__ import annotations

from ctypes import byref, c_char_p, c_int64, c_void_p, string_at
from typing import Any, NamedTuple, Tuple

import numpy as np

from ._arrays import address
from ._library import library
from .errors import ArgumentError, ask

_PRECISIONS = ("single", "mixed", "double")


class Launch(NamedTuple):
    """Two kernels of a plan, and how they are launched."""

    positions: str  #: name of the kernel that corrects positions
    velocities: str  #: name of the kernel that corrects velocities
    n_groups: int  #: work-groups, or CUDA's blocks
    group_size: int  #: work-items, or CUDA's threads, of each


class DevicePlan(NamedTuple):
    """What kernels need to solve the constraints on a GPU, from `Molecules.device_plan()`. Copies: it depends on nothing.

    The first arguments of all kernels are integers, numbers, scratch and failures, as arrays of the device, and the number of the
    call; then come the program's own: r_ref, r, v and 1/dt for positions, r and v for velocities, packed (n_atoms, 3).
    """

    source: str  #: text of the kernels, in the common subset of OpenCL C, CUDA and HIP
    integers: np.ndarray  #: int32
    numbers: np.ndarray  #: float32 in single precision, else float64
    scratch: int  #: bytes of an array that is as it comes
    failures: np.ndarray  #: int32 zeros: whether any molecule failed; for each, the call in which it did first
    launches: Tuple[Launch, ...]
    left: np.ndarray  #: molecules that are left to the host


def make_plan(handle: Any, precision: str, max_entries: int) -> DevicePlan:
    if precision not in _PRECISIONS:
        raise ArgumentError(f"precision is {precision!r}; it must be 'single', 'mixed' or 'double'")
    plan = c_void_p()
    ask(library.hol_device_plan_create(handle, _PRECISIONS.index(precision), max_entries, byref(plan)))
    try:
        left = np.zeros(library.hol_device_plan_n_left(plan), dtype=np.int64)
        ask(library.hol_device_plan_left(plan, address(left)))
        return DevicePlan(
            library.hol_device_plan_source(plan).decode(), np.frombuffer(_bytes(plan, 0), np.int32),
            np.frombuffer(_bytes(plan, 1), np.float32 if precision == "single" else np.float64), _size(plan, 2),
            np.frombuffer(_bytes(plan, 3), np.int32),
            tuple(_launch(plan, k) for k in range(library.hol_device_plan_n_launches(plan))), left)
    finally:
        library.hol_device_plan_destroy(plan)


def _array(plan: c_void_p, which: int) -> Tuple[c_void_p, int]:
    data, size = c_void_p(), c_int64()
    ask(library.hol_device_plan_array(plan, which, byref(data), byref(size)))
    return data, size.value


def _size(plan: c_void_p, which: int) -> int:
    return _array(plan, which)[1]


def _bytes(plan: c_void_p, which: int) -> bytes:
    data, size = _array(plan, which)
    return string_at(data, size)


def _launch(plan: c_void_p, k: int) -> Launch:
    positions, velocities, n_groups, group_size = c_char_p(), c_char_p(), c_int64(), c_int64()
    ask(library.hol_device_plan_launch(plan, k, byref(positions), byref(velocities), byref(n_groups), byref(group_size)))
    return Launch((positions.value or b"").decode(), (velocities.value or b"").decode(), n_groups.value, group_size.value)
