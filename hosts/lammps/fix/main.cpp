// SPDX-License-Identifier: GPL-2.0-only
// LAMMPS with fix holonomic: takes the arguments that lmp takes.
#include <mpi.h>

#include "input.h"
#include "lammps.h"

int main(int argc, char **argv) {
    MPI_Init(&argc, &argv);
    auto *lammps = new LAMMPS_NS::LAMMPS(argc, argv, MPI_COMM_WORLD);
    lammps->input->file();
    delete lammps;
    MPI_Barrier(MPI_COMM_WORLD);
    MPI_Finalize();
    return 0;
}
