# SPDX-License-Identifier: GPL-2.0-only
# What the tests that run LAMMPS begin with: a folder of their own, more ranks than processors, as root in containers.
set -u
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1
export OMPI_MCA_hwloc_base_binding_policy=none OMPI_MCA_mpi_yield_when_idle=1 OMP_NUM_THREADS=1

fail() {
    echo "FAILED: $*"
    exit 1
}
