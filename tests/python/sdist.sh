#!/bin/sh
# pip installs the source archive in an empty virtual environment, without a network: cmake builds the library there. The archive
# has all that the library is made of, as it is; so the objects of the build that this test is part of serve.
#
#   sdist.sh SOURCE WORK PYTHON OPTIONS      OPTIONS: a file of cmake's. Exit status 77: this Python has no venv, no pip or no setuptools.
set -eu
source=$1 work=$2 python=$3 options=$4
. "$source/tests/python/environment.sh"
source_archive
mkdir "$work/unpacked"
tar -xzf "$work"/holonomic-*.tar.gz -C "$work/unpacked" --strip-components=1
for name in CMakeLists.txt capi cmake core python; do
    diff -rq "$work/clean/$name" "$work/unpacked/$name" || { echo "the archive has another $name"; exit 1; }
done
began=$(date +%s)
CMAKE_ARGS="-C $options" pip install --no-index --no-build-isolation "$work"/holonomic-*.tar.gz >"$work/pip.log" 2>&1 ||
    { tail -n 20 "$work/pip.log"; exit 1; }
calculates "$work/environment"
echo "the first result after $(($(date +%s) - began)) s"
