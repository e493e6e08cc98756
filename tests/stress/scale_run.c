/**
 * The largest systems, through every function:
 *     scale_run N_CHAINS BONDS_PER_CHAIN
 * e.g. `scale_run 1 50000000` and `scale_run 10000000 3` (about 12 and 10 gigabytes). Random walks of unit bonds;
 * checked are the second derivative of each bond length, d.v, the bond lengths, ln det between its bounds, and the
 * force balance.
 */
#define _POSIX_C_SOURCE 200809L
#include <float.h>
#include <holonomic.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "random.h"

static int failures;

static double seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double started;

static void say(const char *what, double value)
{
    printf("%-34s %8.2f s   %.3e\n", what, seconds() - started, value);
    fflush(stdout);
    started = seconds();
}

static void must(int status)
{
    if (status == HOL_OK) return;
    printf("FAILED: %s: %s\n", hol_status_name(status), hol_error_message());
    exit(1);
}

static void require(int right, const char *what)
{
    if (right) return;
    printf("FAILED: %s\n", what);
    ++failures;
}

static double *allocate(int64_t n)
{
    double *a = malloc(sizeof *a * (size_t)n);
    if (a) return a;
    printf("not enough memory\n");
    exit(3);
}

/** Largest |d . (a' - a) + dv^2| over the bonds, relative to what is added up. */
static double second_derivative(int64_t n_chains, int64_t n, const double *r, const double *v, const double *f,
                                const double *g)
{
    double largest = 0;
    for (int64_t c = 0; c < n_chains; ++c)
        for (int64_t k = 0; k < n; ++k) {
            const int64_t i = 3 * (c * (n + 1) + k);
            double sum = 0, size = 0;
            for (int x = 0; x < 3; ++x) {
                const double d = r[i + 3 + x] - r[i + x], dv = v[i + 3 + x] - v[i + x];
                sum += d * (f[i + 3 + x] + g[i + 3 + x] - f[i + x] - g[i + x]) + dv * dv;
                size += fabs(d) * (fabs(f[i + 3 + x]) + fabs(g[i + 3 + x]) + fabs(f[i + x]) + fabs(g[i + x])) + dv * dv;
            }
            largest = fmax(largest, fabs(sum) / size);
        }
    return largest;
}

int main(int argc, char **argv)
{
    const int64_t n_chains = argc == 3 ? atoll(argv[1]) : 0, n = argc == 3 ? atoll(argv[2]) : 0;
    if (n_chains < 1 || n < 1) {
        fprintf(stderr, "usage: scale_run N_CHAINS BONDS_PER_CHAIN\n");
        return 2;
    }
    const int64_t atoms = n_chains * (n + 1), size = 3 * atoms;
    random_stream stream = random_seed(1);
    started = seconds();
    double *mass = allocate(atoms), *ones = allocate(n), *r = allocate(size), *v = allocate(size), *f = allocate(size);
    for (int64_t i = 0; i < atoms; ++i) {
        double u[3];
        random_direction(&stream, u);
        mass[i] = 1;
        for (int x = 0; x < 3; ++x) {
            r[3 * i + x] = i == 0 ? 0 : r[3 * i - 3 + x] + u[x];
            v[3 * i + x] = 2 * random_uniform(&stream) - 1;
            f[3 * i + x] = 2 * random_uniform(&stream) - 1;
        }
    }
    for (int64_t k = 0; k < n; ++k) ones[k] = 1;
    say("made, atoms:", (double)atoms);
    hol_chains *chains = NULL;
    must(hol_chains_create(atoms, mass, &chains));
    must(hol_chains_add_block(chains, n_chains, n, 0, ones));
    must(hol_chains_set_threads(chains, 2));
    say("handle, bytes per bond:", (double)hol_chains_memory(chains) / (double)(n_chains * n));

    double *g = allocate(size), *lambda = allocate(n_chains * n), virial[9];
    must(hol_forces(chains, r, v, f, lambda, NULL, g, HOL_WRITE, virial));
    say("hol_forces, virial xx:", virial[0]);
    const double second = second_derivative(n_chains, n, r, v, f, g);
    say("  second derivative, relative:", second);
    /* rounding of the coordinates' differences is exact; G is good to 16 + sqrt N roundings of its scale */
    require(second < DBL_EPSILON * (16 + sqrt((double)n)), "the second derivatives of the bond lengths are not zero");

    double energy = 0, *log_det = allocate(n_chains);
    must(hol_metric(chains, r, 1, log_det, NULL, &energy, g, HOL_WRITE));
    double total[3] = {0, 0, 0}, sum = 0;
    for (int64_t i = 0; i < size; ++i) total[i % 3] += g[i];
    for (int64_t c = 0; c < n_chains; ++c) sum += log_det[c] / 2;
    say("hol_metric, energy per bond:", energy / (double)(n_chains * n));
    require(fabs(sum - energy) <= 1e-10 * fabs(sum), "the energy is not the sum over the chains");
    require(energy < 0, "the determinant is not below one");
    for (int x = 0; x < 3; ++x)
        require(fabs(total[x]) < 1e-9 * sqrt((double)size), "Fixman forces do not add up to zero");

    hol_worst worst;
    must(hol_project_velocities(chains, r, v, lambda, virial));
    must(hol_violation(chains, r, v, &worst));
    say("hol_project_velocities, d.v left:", worst.rate);
    require(worst.rate < 1e-13, "velocities along bonds are left");

    hol_report report;
    double extent = 0;
    for (int64_t i = 0; i < size; ++i) {
        g[i] = r[i] + 0.005 * v[i];
        extent = fmax(extent, fabs(g[i]));
    }
    must(hol_project_positions(chains, r, g, v, 0.005, lambda, 0, virial, &report));
    must(hol_violation(chains, g, NULL, &worst));
    say("hol_project_positions, bond error:", worst.length);
    printf("    %lld iterations, %lld chains moved, coordinates to %.0f\n", (long long)report.iterations,
           (long long)report.n_corrected, extent);
    require(worst.length < 2 * sqrt(3) * DBL_EPSILON * (1 + extent),
            "bond lengths are off by more than the coordinates' rounding");

    hol_inverse *inverse = NULL;
    double condition = 0, entry = 0;
    must(hol_inverse_create(chains, n_chains - 1, r, &inverse));
    must(hol_inverse_condition(inverse, &condition));
    must(hol_inverse_entry(inverse, HOL_UNIT_DIAGONAL, n - 1, n - 1, &entry));
    say("hol_inverse, condition number:", condition);
    require(condition >= 1 && entry >= 1, "an inverse element below one on the diagonal");
    hol_inverse_destroy(inverse);
    hol_chains_destroy(chains);
    printf("%s\n", failures ? "FAILED" : "all right");
    return failures != 0;
}
