#!/bin/sh
# The wheel with the library in it, made from a source archive and installed by pip in an empty virtual environment, without a
# network and with no other library to be found, calculates. The package beside an installed library uses that one, and the
# package without a library says what is missing.
#
#   wheel.sh SOURCE BUILD WORK PYTHON CMAKE        Exit status 77: this Python has no venv, no pip or no setuptools.
set -eu
source=$1 build=$2 work=$3 python=$4 cmake=$5
unset HOLONOMIC_LIBRARY HOLONOMIC_PREFIX PYTHONPATH LD_LIBRARY_PATH LD_PRELOAD || :
rm -rf "$work"
mkdir -p "$work"
"$python" -c 'import venv, ensurepip' 2>/dev/null || { echo "left out: $python has no venv"; exit 77; }
"$python" -c 'import setuptools, wheel' 2>/dev/null || { echo "left out: $python has no setuptools or no wheel"; exit 77; }

# numpy and setuptools are the system's, as there is no network; all else of the environment is empty.
"$python" -m venv --system-site-packages "$work/environment"
PATH=$work/environment/bin:$PATH
pip() { "$work/environment/bin/python" -m pip "$@"; }

# The source archive has what the library is built from: cmake takes it. Compiling it once more would show nothing.
mkdir "$work/clean"
(cd "$source" && git ls-files -z 2>/dev/null | xargs -0 -r cp --parents -t "$work/clean") || cp -r "$source/." "$work/clean"
(cd "$work/clean" && python -c "from setuptools import build_meta; build_meta.build_sdist('$work')") >"$work/sdist.log" 2>&1
tar -xf "$work"/holonomic-*.tar.gz -C "$work"
sources=$(ls -d "$work"/holonomic-*/)
"$cmake" -S "$sources" -B "$work/configured" -DHOLONOMIC_BUILD_TESTS=ON -DHOLONOMIC_BUILD_EXAMPLES=ON >"$work/configure.log" 2>&1 ||
    { tail -n 20 "$work/configure.log"; exit 1; }

"$cmake" --build "$build" --target holonomic_wheel >"$work/build.log" 2>&1 || { cat "$work/build.log"; exit 1; }
HOLONOMIC_WHEEL_LIBRARIES=$build/python/libraries \
    pip wheel --quiet --no-index --no-deps --no-build-isolation --wheel-dir "$work" "$sources"
wheel=$(ls "$work"/*.whl)
echo "$wheel"
# Its name says how old a C library may be: none of its symbols is younger.
needed=$(grep -aohE 'GLIBC_2\.[0-9]+' "$build"/python/libraries/* | sed 's/.*\.//' | sort -n | tail -n 1)
case $wheel in *-manylinux_2_"$needed"_*) ;; *) [ -z "$needed" ] || { echo "a symbol of glibc 2.$needed"; exit 1; } ;; esac

began=$(date +%s)
pip install --quiet --no-index "$wheel"
cd "$work"
cat >try.py <<'END'
import numpy, os, sys
import holonomic as hol
assert hol.__file__.startswith(sys.prefix), hol.__file__
libraries = {line.split()[-1] for line in open("/proc/self/maps") if "libholonomic" in line or "libgomp" in line}
assert libraries and all(name.startswith(os.path.realpath(sys.argv[1])) for name in libraries if "holonomic" in name), libraries
molecules = hol.Molecules([0, 1, 1, 1])
molecules.add([(0, 1), (1, 2), (2, 3)], 1.0)
r = -numpy.outer(range(4), [0, 0, 1.0])
print(molecules.forces(r, None, numpy.outer([0, 1, 1, 1], [0, 0, -10.0])).tensions)
END
python try.py "$work/environment" | tee printed
[ "$(cat printed)" = "[30. 20. 10.]" ]
echo "the first result after $(($(date +%s) - began)) s"

# Beside an installed library: its path is kept.
pip uninstall --quiet --yes holonomic
mkdir -p "$work/prefix/lib"
cp "$build"/capi/libholonomic.so.0 "$work/prefix/lib"
HOLONOMIC_PREFIX=$work/prefix pip install --quiet --no-index --no-build-isolation "$sources"
python try.py "$work/prefix" | tee printed
[ "$(cat printed)" = "[30. 20. 10.]" ]

# Without any library the package says what is missing.
rm "$work/prefix/lib/libholonomic.so.0"
if HOLONOMIC_LIBRARY=$work/nothing.so python -c 'import holonomic' 2>message; then exit 1; fi
grep -q "ImportError: the library of holonomic could not be loaded" message
if python -c 'import holonomic' 2>message; then exit 1; fi
grep -q "ImportError: the library of holonomic could not be loaded" message
HOLONOMIC_LIBRARY=$build/capi/libholonomic.so python -c 'import holonomic; print(holonomic.version())'
