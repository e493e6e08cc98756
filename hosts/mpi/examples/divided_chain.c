/* A chain that hangs from a fixed bead and swings, divided among the processes of MPI:
 *     mpirun -n 4 divided_chain
 * Each process has some beads, one behind the other. Bond k joins beads k and k + 1. */
#include <holonomic.h>
#include <math.h>
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>

#include "holonomic_subdomain.h"

enum { N = 400 }; /* beads */

static int add_up(void *context, int64_t n, double *numbers) {
    (void)context;
    return MPI_Allreduce(MPI_IN_PLACE, numbers, (int)n, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
}

static void need(int status) {
    if (status == HOL_OK) return;
    fprintf(stderr, "%s\n", hol_subdomain_error_message());
    MPI_Abort(MPI_COMM_WORLD, 1);
}

int main(int argc, char **argv) {
    static double mass[N], r[N][3], v[N][3], f[N][3], length[N], cut_length[N];
    static int64_t pairs[N][2], ends[N][2];
    const double dt = 1e-3;
    int rank, n_ranks, p, i, c, step;
    MPI_Init(&argc, &argv);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &n_ranks);
    /* Beads first .. first + n - 1 are here; a bond is cut behind the last bead of each process but one. */
    const int first = N * rank / n_ranks, n = N * (rank + 1) / n_ranks - first;
    for (i = 0; i < n; ++i) {
        mass[i] = first + i > 0; /* mass 0: held fixed */
        r[i][0] = first + i;
        f[i][2] = -mass[i];
        pairs[i][0] = i, pairs[i][1] = i + 1, length[i] = 1;
    }
    for (p = 0; p < n_ranks - 1; ++p) {
        ends[p][0] = p == rank ? n - 1 : -1;
        ends[p][1] = p + 1 == rank ? 0 : -1;
        cut_length[p] = 1;
    }
    hol_subdomain *chain;
    need(hol_subdomain_create(rank, n_ranks, add_up, NULL, n, mass, n - 1, pairs[0], length, n_ranks - 1, ends[0],
                              cut_length, &chain));
    need(hol_subdomain_factorize(chain, r[0]));
    for (step = 0; step < 200; ++step) { /* velocity Verlet */
        for (i = 0; i < n; ++i)
            for (c = 0; c < 3; ++c) {
                v[i][c] += mass[i] > 0 ? dt / 2 * f[i][c] / mass[i] : 0;
                r[i][c] += dt * v[i][c];
            }
        need(hol_subdomain_project_positions(chain, r[0], v[0], dt, NULL, NULL, NULL, NULL));
        for (i = 0; i < n; ++i)
            for (c = 0; c < 3; ++c) v[i][c] += mass[i] > 0 ? dt / 2 * f[i][c] / mass[i] : 0;
        need(hol_subdomain_factorize(chain, r[0])); /* serves velocities, forces, and the next step's positions */
        need(hol_subdomain_project_velocities(chain, v[0], NULL, NULL, NULL));
    }
    double energy[2] = {0, 0}; /* kinetic and potential; both were 0 */
    for (i = 0; i < n; ++i)
        for (c = 0; c < 3; ++c) energy[0] += mass[i] * v[i][c] * v[i][c] / 2, energy[1] -= f[i][c] * r[i][c];
    need(add_up(NULL, 2, energy));
    if (rank == 0) printf("kinetic energy %.10f, with the potential energy %.1e\n", energy[0], energy[0] + energy[1]);
    const int good = energy[0] > 1 && fabs(energy[0] + energy[1]) < 1e-6 * energy[0];
    hol_subdomain_destroy(chain);
    MPI_Finalize();
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
