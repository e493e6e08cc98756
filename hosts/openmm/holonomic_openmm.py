"""Constraints of OpenMM, solved by holonomic.

    from holonomic_openmm import add_holonomic
    add_holonomic(system)             # before the Context or the Simulation is made
    simulation = Simulation(topology, system, integrator, Platform.getPlatformByName("CPU"))

Constraints are those of the System, whatever their shapes; they are right to the rounding of the coordinates, and the integrator's
constraint tolerance is not looked at. Platforms CPU, Reference and OpenCL, and CUDA and
HIP where the plugin was built for them; others refuse.
"""

import ctypes
import os

import openmm

_NAME = "libOpenMMHolonomic.so"
_plugin = None


def load(path=None):
    """Loads the plugin: from path, the environment variable HOLONOMIC_OPENMM_PLUGIN, this folder, or OpenMM's plugins."""
    global _plugin
    if _plugin is None:
        places = [path or os.environ.get("HOLONOMIC_OPENMM_PLUGIN")]
        places += [os.path.join(folder, _NAME)
                   for folder in (os.path.dirname(os.path.abspath(__file__)), openmm.Platform.getDefaultPluginsDirectory())]
        found = [place for place in places if place and os.path.exists(place)]
        if not found:
            raise ImportError(f"{_NAME} was not found; HOLONOMIC_OPENMM_PLUGIN may name it")
        _plugin = ctypes.CDLL(found[0])
        _plugin.holonomicOpenMMAdd.argtypes = [ctypes.c_void_p, ctypes.c_int]
        _load_devices(os.path.dirname(found[0]))
    return _plugin


def _load_devices(folder):
    """The plugins for devices, where they were built and what they need is there."""
    for platform in "OpenCL", "CUDA", "HIP":
        try:
            ctypes.CDLL(os.path.join(folder, f"libOpenMMHolonomic{platform}.so")).registerKernelFactories()
        except OSError:
            pass  # the refusal when a Context is made says what there is


def add_holonomic(system, threads=1):
    """Adds the Force that lets holonomic solve the constraints of a System. Returns its index.

    threads  how many threads a call may use; worth it from some ten thousand constraints on
    """
    if threads < 1:
        raise ValueError(f"threads is {threads}; it must be at least 1")
    index = load().holonomicOpenMMAdd(int(system.this), threads)
    if index < 0:
        raise openmm.OpenMMException("HolonomicConstraints could not be added")
    return index
