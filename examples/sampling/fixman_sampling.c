/**
 * Rigid trimers and chains of ten bonds, sampled with and without the Fixman potential.
 *
 * Without it the angle between the first two bonds has the distribution of the rigid chain: proportional to
 * sqrt(1 - cos^2/4) for a trimer of equal masses. With it the distribution is flat, as for stiff springs.
 *
 * The sampling is Hamiltonian Monte Carlo on the constraints: velocities from the Maxwell distribution, projected; a
 * short RATTLE trajectory; acceptance by the change of energy. It samples the rigid measure times exp(-U/kT) without
 * any error of the time step, so that what differs from the expected curve is statistics. Masses, bond lengths and kT
 * are 1.
 */
#include <holonomic.h>
#include <stdint.h>

#include "block_average.h"
#include "noise.h"
#include "options.h"

enum { BINS = 40, GRID = 400 };

typedef struct sampler {
    int64_t n_bonds, n_chains, n_atoms;
    hol_chains *chains;
    double fixman; /* factor of the Fixman potential: 1 or 0 */
    double *r, *r_old, *r_ref, *v, *force, *log_det, *log_det_old, *energy_old;
    unsigned char *failed; /* chains whose step the constraints can't follow */
    noise random;
    double accepted, proposed;
} sampler;

static void check(int status)
{
    if (status == HOL_OK) return;
    fprintf(stderr, "%s: %s\n", hol_status_name(status), hol_error_message());
    exit(1);
}

static double *numbers(int64_t n)
{
    double *p = calloc((size_t)n, sizeof *p);
    if (p) return p;
    fprintf(stderr, "out of memory\n");
    exit(1);
}

/** Potential and force at r. */
static void evaluate(sampler *s)
{
    check(hol_metric(s->chains, s->r, 1.0, s->log_det, NULL, NULL, s->force, HOL_WRITE));
}

static sampler start(int64_t n_bonds, int64_t n_chains, double fixman, uint64_t seed)
{
    const int64_t n_atoms = n_chains * (n_bonds + 1);
    sampler s = {n_bonds, n_chains, n_atoms, NULL, fixman, 0, 0, 0, 0, 0, 0, 0, 0, NULL, noise_start(seed), 0, 0};
    s.r = numbers(3 * n_atoms);
    s.r_old = numbers(3 * n_atoms);
    s.r_ref = numbers(3 * n_atoms);
    s.v = numbers(3 * n_atoms);
    s.force = numbers(3 * n_atoms);
    s.log_det = numbers(n_chains);
    s.log_det_old = numbers(n_chains);
    s.energy_old = numbers(n_chains);
    s.failed = (unsigned char *)numbers(n_chains / 8 + 1);
    double *ones = numbers(n_atoms);
    for (int64_t i = 0; i < n_atoms; ++i) ones[i] = 1;
    check(hol_chains_create(n_atoms, ones, &s.chains));
    check(hol_chains_add_block(s.chains, n_chains, n_bonds, 0, ones));
    free(ones);
    for (int64_t i = 0; i < n_atoms; ++i) {
        double u[3] = {0, 0, 0};
        if (i % (n_bonds + 1) > 0) noise_direction(&s.random, u);
        for (int x = 0; x < 3; ++x) s.r[3 * i + x] = u[x] + (i % (n_bonds + 1) > 0 ? s.r[3 * i - 3 + x] : 0);
    }
    evaluate(&s);
    return s;
}

static void finish(sampler *s)
{
    hol_chains_destroy(s->chains);
    free(s->r), free(s->r_old), free(s->r_ref), free(s->v), free(s->force);
    free(s->log_det), free(s->log_det_old), free(s->energy_old), free(s->failed);
}

/** Kinetic energy plus fixman times U_F of one chain. */
static double energy(const sampler *s, int64_t chain)
{
    const int64_t size = 3 * (s->n_bonds + 1);
    double sum = s->fixman * s->log_det[chain];
    for (int64_t i = chain * size; i < (chain + 1) * size; ++i) sum += s->v[i] * s->v[i];
    return sum / 2;
}

static void kick(sampler *s, double dt)
{
    for (int64_t i = 0; i < 3 * s->n_atoms; ++i) s->v[i] += dt * s->fixman * s->force[i];
}

/**
 * Puts the positions back on the constraints. Now and then a step is too large for a chain: the library leaves it as it
 * was and says so. Its proposal will be rejected; until then it goes on from where the proposal began.
 */
static void constrain(sampler *s, double dt)
{
    const int status = hol_project_positions(s->chains, s->r_ref, s->r, s->v, dt, NULL, 0, NULL, NULL);
    if (status != HOL_ERR_NO_CONVERGENCE) {
        check(status);
        return;
    }
    const int64_t atoms = s->n_bonds + 1;
    for (int64_t c = 0; c < s->n_chains; ++c) {
        double *r = s->r + 3 * c * atoms, error = 0;
        for (int64_t k = 0; k < s->n_bonds; ++k) {
            double square = 0;
            for (int x = 3 * (int)k; x < 3 * (int)k + 3; ++x) square += (r[x + 3] - r[x]) * (r[x + 3] - r[x]);
            error = fmax(error, fabs(square - 1));
        }
        if (error < 1e-8) continue;
        s->failed[c] = 1;
        memcpy(r, s->r_old + 3 * c * atoms, sizeof(double) * 3 * (size_t)atoms);
    }
}

/** One proposal for every chain. */
static void move(sampler *s, int steps, double dt)
{
    const size_t bytes = sizeof(double) * 3 * (size_t)s->n_atoms, chain_bytes = bytes / (size_t)s->n_chains;
    memcpy(s->r_old, s->r, bytes);
    memset(s->failed, 0, (size_t)s->n_chains);
    memcpy(s->log_det_old, s->log_det, sizeof(double) * (size_t)s->n_chains);
    for (int64_t i = 0; i < 3 * s->n_atoms; ++i) s->v[i] = noise_normal(&s->random);
    check(hol_project_velocities(s->chains, s->r, s->v, NULL, NULL));
    for (int64_t c = 0; c < s->n_chains; ++c) s->energy_old[c] = energy(s, c);
    for (int step = 0; step < steps; ++step) { /* RATTLE */
        kick(s, dt / 2);
        memcpy(s->r_ref, s->r, bytes);
        for (int64_t i = 0; i < 3 * s->n_atoms; ++i) s->r[i] += dt * s->v[i];
        constrain(s, dt);
        evaluate(s);
        kick(s, dt / 2);
        check(hol_project_velocities(s->chains, s->r, s->v, NULL, NULL));
    }
    int rejected = 0;
    for (int64_t c = 0; c < s->n_chains; ++c) {
        ++s->proposed;
        const double u = noise_uniform(&s->random);
        if (!s->failed[c] && u < exp(s->energy_old[c] - energy(s, c))) {
            ++s->accepted;
            continue;
        }
        rejected = 1;
        memcpy((char *)s->r + (size_t)c * chain_bytes, (char *)s->r_old + (size_t)c * chain_bytes, chain_bytes);
        s->log_det[c] = s->log_det_old[c];
    }
    if (rejected) evaluate(s); /* the forces of the chains that were put back */
}

/** Cosine between bonds 1 and 2, or between the last two: by symmetry it has the same distribution. */
static double end_cosine(const sampler *s, int64_t chain, int last)
{
    const double *r = s->r + 3 * (chain * (s->n_bonds + 1) + (last ? s->n_bonds - 2 : 0));
    double sum = 0;
    for (int x = 0; x < 3; ++x) sum += (r[3 + x] - r[x]) * (r[6 + x] - r[3 + x]);
    return sum;
}

/**
 * The density of the end cosine of the rigid chain of equal masses, from what the other bonds contribute given the
 * pivot Omega_2^2 = 1 - c^2/4: V_N = 1, V_{n-1}(Omega) = mean over c of Omega' V_n(Omega'), Omega'^2 = 1 -
 * (c/2)^2/Omega^2 (docs/theory.md (44)). Simpson's rule, tables on Omega in sqrt(1/2)..1. Returns the mean of cos^2.
 */
static double rigid_density(int64_t n_bonds, double *density, int points)
{
    const double low = sqrt(0.5), step = (1 - low) / GRID;
    double table[GRID + 1], next[GRID + 1], norm = 0, square = 0;
    for (int i = 0; i <= GRID; ++i) table[i] = 1;
    for (int64_t n = n_bonds; n >= 2; --n) {
        for (int i = 0; i <= (n == 2 ? 0 : GRID); ++i) {
            const double omega = n == 2 ? 1 : low + i * step;
            double sum = 0;
            const int m = n == 2 ? points - 1 : 200;
            for (int k = 0; k <= m; ++k) {
                const double c = (double)k / m, pivot = sqrt(1 - c * c / (4 * omega * omega)),
                             at = (pivot - low) / step;
                const int j = at > 1 ? (at < GRID - 2 ? (int)at - 1 : GRID - 3) : 0;
                double value = 0; /* cubic interpolation */
                for (int a = 0; a < 4; ++a) {
                    double term = table[j + a];
                    for (int b = 0; b < 4; ++b)
                        if (b != a) term *= (at - (j + b)) / (a - b);
                    value += term;
                }
                const double weight = (k == 0 || k == m ? 1.0 : k % 2 ? 4.0 : 2.0) / (3 * m);
                sum += weight * pivot * value;
                if (n > 2) continue;
                density[k] = pivot * value;
                norm += weight * density[k];
                square += weight * density[k] * c * c;
            }
            next[i] = sum;
        }
        memcpy(table, next, sizeof table);
    }
    for (int k = 0; k < points; ++k) density[k] /= norm;
    return square / norm;
}

/** Samples; adds the histogram of |cos| to a file. Returns by how many standard errors mean cos^2 is off. */
static double sample(int64_t n_bonds, double fixman, double expected, const option *o, uint64_t seed, FILE *data)
{
    const int64_t n_chains = (int64_t)o[0].value;
    const long moves = (long)o[1].value, warm_up = moves / 10;
    const int steps = (int)o[2].value;
    sampler s = start(n_bonds, n_chains, fixman, seed);
    double *series = numbers(moves), *histogram = numbers(BINS * moves);
    const int ends = n_bonds > 2 ? 2 : 1;
    const double share = 1.0 / (double)(n_chains * ends);
    for (long m = -warm_up; m < moves; ++m) {
        move(&s, steps, o[3].value * (0.8 + 0.4 * noise_uniform(&s.random)));
        for (int64_t c = 0; c < n_chains && m >= 0; ++c)
            for (int last = 0; last < ends; ++last) {
                const double cosine = fabs(end_cosine(&s, c, last));
                const int bin = cosine < 1 ? (int)(cosine * BINS) : BINS - 1;
                histogram[bin * moves + m] += BINS * share;
                series[m] += cosine * cosine * share;
            }
    }
    const estimate e = block_average(series, moves);
    const double off = (e.mean - expected) / e.error;
    printf(
        "%2d bonds, Fixman potential times %-3g mean cos^2 %.6f +- %.6f, expected %.6f: %+.2f errors off; accepted "
        "%.4f\n",
        (int)n_bonds, fixman, e.mean, e.error, expected, off, s.accepted / s.proposed);
    fflush(stdout);
    for (int b = 0; b < BINS; ++b) {
        const estimate height = block_average(histogram + b * moves, moves);
        fprintf(data, "%g %g %g\n", (b + 0.5) / BINS, height.mean, height.error);
    }
    fprintf(data, "\n\n");
    free(series), free(histogram);
    finish(&s);
    return fabs(off);
}

static void plot(const char *output)
{
    char name[512], command[1100];
    snprintf(name, sizeof name, "%s.gp", output);
    FILE *gp = fopen(name, "w");
    if (!gp) return;
    fprintf(gp, "set terminal pngcairo size 1000,450\nset output '%s.png'\nset multiplot layout 1,2\n", output);
    fprintf(gp, "set xlabel '|cos theta| of the first two bonds'\nset ylabel 'density'\nset yrange [0.85:1.15]\n");
    for (int i = 0; i < 2; ++i)
        fprintf(
            gp,
            "set title '%s'\nplot '%s.dat' index %d with yerrorbars title 'rigid', '' index %d with yerrorbars title "
            "'with the Fixman potential', '' index %d with lines lw 2 title 'rigid, exact', 1 lw 2 title 'flat'\n",
            i ? "10 bonds" : "trimer", output, 3 * i, 3 * i + 1, 3 * i + 2);
    fclose(gp);
    snprintf(command, sizeof command, "command -v gnuplot >/dev/null 2>&1 && gnuplot '%s' 2>/dev/null", name);
    if (system(command) == 0)
        printf("plot: %s.png\n", output);
    else
        printf("plot: gnuplot was not found; %s draws it\n", name);
}

int main(int argc, char **argv)
{
    option o[] = {{"molecules", 1000, 1}, {"moves", 4096, 64}, {"steps", 8, 1},
                  {"dt", 0.12, 1e-6},     {"seed", 1, 0},      {"factor", 1, -10}};
    const char *output = "fixman_sampling";
    char name[512];
    double density[2 * BINS + 1], worst = 0;
    read_options(argc, argv, o, 6, &output);
    snprintf(name, sizeof name, "%s.dat", output);
    FILE *data = fopen(name, "w");
    if (!data) {
        fprintf(stderr, "%s: can't be written\n", name);
        return 1;
    }
    fprintf(data,
            "# |cos|, density, its error: rigid; with the Fixman potential; rigid, exact. Trimer, then ten bonds.\n");
    for (int i = 0; i < 2; ++i) {
        const int64_t n_bonds = i == 0 ? 2 : 10;
        const double rigid = rigid_density(n_bonds, density, 2 * BINS + 1);
        worst = fmax(worst, sample(n_bonds, 0, rigid, o, (uint64_t)o[4].value + 10, data));
        worst = fmax(worst, sample(n_bonds, o[5].value, 1.0 / 3, o, (uint64_t)o[4].value + 20, data));
        for (int k = 0; k <= 2 * BINS; ++k) fprintf(data, "%g %g 0\n", k / (2.0 * BINS), density[k]);
        fprintf(data, "\n\n");
    }
    fclose(data);
    plot(output);
    printf("largest deviation: %.2f standard errors\n", worst);
    if (worst < 4) return 0;
    fprintf(stderr, "the sampling is not what it should be\n");
    return 1;
}
