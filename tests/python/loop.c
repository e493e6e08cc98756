/* Calls of C in a loop, for test_overhead.py: nanoseconds per call. */
#include <holonomic.h>
#include <time.h>

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

double forces_in_c(const hol_chains *chains, int count, const double *r, const double *v, const double *f, double *out)
{
    const int64_t n = hol_chains_n_bonds(chains); /* out: lambda, tensions, virial, forces */
    const double start = now();
    for (int i = 0; i < count; ++i)
        if (hol_forces(chains, r, v, f, out, out + n, out + 2 * n + 9, HOL_WRITE, out + 2 * n)) return -1;
    return (now() - start) / count;
}

double positions_in_c(const hol_chains *chains, int count, const double *r_ref, double *r, double *v)
{
    hol_report report;
    const double start = now();
    for (int i = 0; i < count; ++i)
        if (hol_project_positions(chains, r_ref, r, v, 1e-3, NULL, 0, NULL, &report)) return -1;
    return (now() - start) / count;
}

double velocities_in_c(const hol_chains *chains, int count, const double *r, double *v)
{
    const double start = now();
    for (int i = 0; i < count; ++i)
        if (hol_project_velocities(chains, r, v, NULL, NULL)) return -1;
    return (now() - start) / count;
}
