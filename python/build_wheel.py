"""Makes the wheel of the package, with nothing but Python's own modules.

    build_wheel.py FOLDER [LIBRARY...]       leaves the wheel in FOLDER and prints its name

LIBRARY   libholonomic.so and what it needs that other systems may not have (libgomp). With libraries the wheel is one for
          this processor and for systems whose C library is at least this one's; without, it is for every system that has
          the library installed.
It is also the build backend of pyproject.toml, so that `pip install python/` works without a network; the environment
variable HOLONOMIC_WHEEL_LIBRARIES then names the libraries, with colons in between.
"""

import base64
import hashlib
import os
import platform
import re
import sys
import zipfile

HERE = os.path.dirname(os.path.abspath(__file__))


def package_version():
    with open(os.path.join(HERE, "holonomic", "__init__.py")) as file:
        return re.search(r'^__version__ = "(.*)"', file.read(), re.M).group(1)


def tag(libraries):
    if not libraries:
        return "py3-none-any"
    machine, (name, release) = platform.machine(), platform.libc_ver()
    system = "manylinux_" + release.replace(".", "_") if name == "glibc" else "linux"
    return f"py3-none-{system}_{machine}"


def soname(path):
    """libholonomic.so.0.2.0 as the loader asks for it: libholonomic.so.0."""
    return re.sub(r"(\.so\.\d+)[.\d]*$", r"\1", os.path.basename(os.path.realpath(path)))


def read(*path):
    with open(os.path.join(*path), "rb") as file:
        return file.read()


def contents(libraries):
    """Names and bytes of all files but RECORD."""
    version = package_version()
    package = os.path.join(HERE, "holonomic")
    for name in sorted(os.listdir(package)):
        if name.endswith(".py") or name == "py.typed":
            yield f"holonomic/{name}", read(package, name)
    for path in libraries:
        yield f"holonomic/{soname(path)}", read(path)
    info = f"holonomic-{version}.dist-info"
    metadata = f"""Metadata-Version: 2.1
Name: holonomic
Version: {version}
Summary: Exact Lagrange multipliers and constraint forces of molecules with rigid bonds
License: BSD-3-Clause
Requires-Python: >=3.8
Requires-Dist: numpy (>=1.19)
Description-Content-Type: text/markdown

"""
    yield f"{info}/METADATA", metadata.encode() + read(HERE, "README.md")
    pure = "false" if libraries else "true"
    yield f"{info}/WHEEL", f"Wheel-Version: 1.0\nGenerator: holonomic\nRoot-Is-Purelib: {pure}\nTag: {tag(libraries)}\n".encode()
    licence = os.path.join(HERE, "..", "LICENSE")
    if os.path.exists(licence):
        yield f"{info}/LICENSE", read(licence)


def make(folder, libraries):
    info = f"holonomic-{package_version()}.dist-info"
    name = f"holonomic-{package_version()}-{tag(libraries)}.whl"
    record = []
    os.makedirs(folder, exist_ok=True)
    with zipfile.ZipFile(os.path.join(folder, name), "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, data in contents(libraries):
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            record.append(f"{path},sha256={digest},{len(data)}")
            wheel.writestr(entry(path), data)
        record.append(f"{info}/RECORD,,\n")
        wheel.writestr(entry(f"{info}/RECORD"), "\n".join(record))
    return name


def entry(path):
    """The same bytes whenever the wheel is made, and files that all may read."""
    found = zipfile.ZipInfo(path, (2020, 1, 1, 0, 0, 0))
    found.external_attr = 0o100644 << 16
    found.compress_type = zipfile.ZIP_DEFLATED
    return found


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """What pip calls."""
    libraries = [path for path in os.environ.get("HOLONOMIC_WHEEL_LIBRARIES", "").split(":") if path]
    return make(wheel_directory, libraries)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    print(make(sys.argv[1], sys.argv[2:]))
