#!/bin/sh
# The wheel with the library in it, made from a source archive and installed by pip in an empty virtual environment, without a
# network and with no other library to be found, calculates. The package beside an installed library uses that one, and the
# package without a library says what is missing.
#
#   wheel.sh SOURCE BUILD WORK PYTHON CMAKE        Exit status 77: this Python has no venv, no pip or no setuptools.
set -eu
source=$1 build=$2 work=$3 python=$4 cmake=$5
. "$source/tests/python/environment.sh"

# The source archive has what the library is built from: cmake takes it. sdist.sh compiles it.
source_archive
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
calculates "$work/environment"
echo "the first result after $(($(date +%s) - began)) s"

# Beside an installed library: its path is kept.
pip uninstall --quiet --yes holonomic
mkdir -p "$work/prefix/lib"
cp "$build"/capi/libholonomic.so.0 "$work/prefix/lib"
HOLONOMIC_PREFIX=$work/prefix pip install --quiet --no-index --no-build-isolation "$sources"
calculates "$work/prefix"

# Without any library the package says what is missing.
cd "$work"
rm "$work/prefix/lib/libholonomic.so.0"
if HOLONOMIC_LIBRARY=$work/nothing.so python -c 'import holonomic' 2>message; then exit 1; fi
grep -q "ImportError: the library of holonomic could not be loaded" message
if python -c 'import holonomic' 2>message; then exit 1; fi
grep -q "ImportError: the library of holonomic could not be loaded" message
HOLONOMIC_LIBRARY=$build/capi/libholonomic.so python -c 'import holonomic; print(holonomic.version())'
