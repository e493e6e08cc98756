"""The library inside the Python package: what setuptools does not know, the rest stands in pyproject.toml.

    pip install .                       cmake builds the library for this machine's kind of processor, with kernels for AVX2
    CMAKE_ARGS=... pip install .        further options for cmake, e.g. -DHOLONOMIC_INSTRUCTION_SETS="avx2;avx512vl;scalar"
    HOLONOMIC_PREFIX=DIR pip install .  nothing is built: the package uses the library that was installed into DIR
    HOLONOMIC_WHEEL_LIBRARIES=DIR       nothing is built: the libraries in DIR go into the package
"""

import glob
import os
import platform
import re
import shlex
import shutil
import subprocess

from setuptools import setup
from setuptools.command.build_py import build_py
from setuptools.dist import Distribution
from wheel.bdist_wheel import bdist_wheel

HERE = os.path.dirname(os.path.abspath(__file__))
PREFIX = os.environ.get("HOLONOMIC_PREFIX")


def version():
    """As the header says: what the library is called must not stand in two places."""
    with open(os.path.join(HERE, "capi", "holonomic.h")) as file:
        numbers = re.findall(r"#define HOL_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", file.read())
    return ".".join(numbers)


def build_library(folder):
    """The folder with libholonomic.so.0, which has the C++ library inside, and with OpenMP's library beside it."""
    jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL", str(os.cpu_count() or 1))
    options = ["-DCMAKE_BUILD_TYPE=Release", "-DHOLONOMIC_BUILD_FORTRAN=OFF", "-DHOLONOMIC_INSTRUCTION_SETS=avx2;scalar"]
    subprocess.check_call(["cmake", "-S", HERE, "-B", folder, *options, *shlex.split(os.environ.get("CMAKE_ARGS", ""))])
    subprocess.check_call(["cmake", "--build", folder, "--target", "holonomic_wheel", "-j", jobs])
    return os.path.join(folder, "python", "libraries")


class BuildWithLibrary(build_py):
    def run(self):
        super().run()
        package = os.path.join(self.build_lib, "holonomic")
        if PREFIX:
            library, = glob.glob(os.path.join(PREFIX, "lib*", "libholonomic.so.0")) or [None]
            if not library:
                raise SystemExit(f"HOLONOMIC_PREFIX: there is no lib/libholonomic.so.0 in {PREFIX}")
            with open(os.path.join(package, "_installed.py"), "w") as file:
                file.write(f'"""The library that this package was installed beside."""\n\nLIBRARY = {os.path.abspath(library)!r}\n')
            return
        folder = os.environ.get("HOLONOMIC_WHEEL_LIBRARIES") or build_library(os.path.abspath(os.path.join(self.build_lib, "..", "cmake")))
        for path in glob.glob(os.path.join(folder, "*.so*")) + glob.glob(os.path.join(folder, "*.dll")):
            shutil.copy(path, package)


class WithLibrary(Distribution):
    """What has a library in it is for one kind of processor."""

    def has_ext_modules(self):
        return not PREFIX


class TagBySymbols(bdist_wheel):
    """One wheel for all versions of Python; the oldest C library that it runs on is that of its youngest symbol."""

    def get_tag(self):
        if PREFIX:
            return "py3", "none", "any"
        if glob.glob(os.path.join(self.bdist_dir, "**", "*.dll"), recursive=True):
            return "py3", "none", "win_amd64"
        libraries = glob.glob(os.path.join(self.bdist_dir, "**", "*.so*"), recursive=True)
        machine = machine_of(libraries)
        if platform.libc_ver()[0] != "glibc" or not libraries:
            return "py3", "none", f"linux_{machine}"
        minor = max(int(number) for path in libraries for number in re.findall(rb"GLIBC_2\.(\d+)", read(path)))
        return "py3", "none", f"manylinux_2_{minor}_{machine}"


def machine_of(libraries):
    """The kind of processor that they are for, which may be another than this one: a field of their heads."""
    kinds = {read(path)[18:20] for path in libraries}
    if len(kinds) > 1:
        raise SystemExit("the libraries are for several kinds of processors")
    return {b"\x3e\0": "x86_64", b"\xb7\0": "aarch64"}.get(kinds.pop() if kinds else b"", platform.machine())


def read(path):
    with open(path, "rb") as file:
        return file.read()


setup(version=version(), distclass=WithLibrary, cmdclass={"build_py": BuildWithLibrary, "bdist_wheel": TagBySymbols})
