# SPDX-License-Identifier: GPL-2.0-only
# What the tests that run LAMMPS begin with: a folder of their own, more ranks than processors, as root in containers.
set -u
# shellcheck disable=SC2046
export $(grep "^[A-Z]" "$(dirname "${BASH_SOURCE[0]}")/../../mpi/environment")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1

fail() {
    echo "FAILED: $*"
    exit 1
}
