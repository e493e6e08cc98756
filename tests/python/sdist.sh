#!/bin/sh
# pip installs the source archive in an empty virtual environment, without a network: cmake builds the library there, with the
# kernels that every processor runs and without optimisation, which is what takes long.
#
#   sdist.sh SOURCE WORK PYTHON        Exit status 77: this Python has no venv, no pip or no setuptools.
set -eu
source=$1 work=$2 python=$3
. "$source/tests/python/environment.sh"
source_archive
began=$(date +%s)
CMAKE_ARGS="-DHOLONOMIC_INSTRUCTION_SETS= -DCMAKE_BUILD_TYPE=None -DCMAKE_CXX_FLAGS=-O0" \
    pip install --no-index --no-build-isolation "$work"/holonomic-*.tar.gz >"$work/pip.log" 2>&1 ||
    { tail -n 20 "$work/pip.log"; exit 1; }
calculates "$work/environment"
echo "the first result after $(($(date +%s) - began)) s"
