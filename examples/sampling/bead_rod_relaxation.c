/**
 * Brownian dynamics of bead-rod chains that start straight and coil up.
 *
 * Overdamped beads of friction 1 at kT = 1 on rods of length 1. A step displaces the beads by sqrt(2 dt) times normal
 * random numbers and dt times the metric force, and puts the rods back to their lengths with hol_project_positions:
 * first along the old rods (predictor), then along the rods half-way between the old and the new beads and with the
 * force of there (corrector). That is a mid-point scheme as in Liu, J. Chem. Phys. 90, 5826 (1989), with the
 * constraints obeyed to rounding. A step must be so small that no rod turns by a right angle at once: dt = 0.002 moves
 * a rod's end by 0.06.
 *
 * With the metric force the rods become a freely jointed chain: mean square end-to-end distance N and mean square of
 * the cosine between neighbouring rods 1/3. Without it (metric=0) the cosine settles at what rigid rods have.
 */
#include <holonomic.h>
#include <stdint.h>

#include "block_average.h"
#include "noise.h"
#include "options.h"

enum { BONDS, CHAINS, DT, TIME, METRIC, SEED, OPTIONS };

typedef struct melt {
    int64_t n_bonds, n_chains, n_atoms;
    hol_chains *chains;
    double metric;
    double *r, *old, *middle, *kick, *force;
    noise random;
} melt;

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

static melt straight_chains(const option *o)
{
    const int64_t bonds = (int64_t)o[BONDS].value, chains = (int64_t)o[CHAINS].value, atoms = chains * (bonds + 1);
    melt m = {bonds,
              chains,
              atoms,
              NULL,
              o[METRIC].value,
              numbers(3 * atoms),
              numbers(3 * atoms),
              numbers(3 * atoms),
              numbers(3 * atoms),
              numbers(3 * atoms),
              noise_start((uint64_t)o[SEED].value)};
    double *ones = numbers(atoms);
    for (int64_t i = 0; i < atoms; ++i) {
        ones[i] = 1;
        m.r[3 * i] = (double)(i % (bonds + 1));
    }
    check(hol_chains_create(atoms, ones, &m.chains)); /* masses 1: frictions 1 */
    check(hol_chains_add_block(m.chains, chains, bonds, 0, ones));
    free(ones);
    return m;
}

static void finish(melt *m)
{
    hol_chains_destroy(m->chains);
    free(m->r), free(m->old), free(m->middle), free(m->kick), free(m->force);
}

/** From the old positions by the random kick and the force; the rods act along their directions at `along`. */
static void displace(melt *m, const double *along, double dt)
{
    for (int64_t i = 0; i < 3 * m->n_atoms; ++i) m->r[i] = m->old[i] + m->kick[i] + dt * m->force[i];
    check(hol_project_positions(m->chains, along, m->r, NULL, dt, NULL, 0, NULL, NULL));
}

static void step(melt *m, double dt)
{
    const int64_t size = 3 * m->n_atoms;
    const double amplitude = sqrt(2 * dt);
    memcpy(m->old, m->r, sizeof(double) * (size_t)size);
    for (int64_t i = 0; i < size; ++i) m->kick[i] = amplitude * noise_normal(&m->random);
    displace(m, m->old, dt); /* with the force of the last step: it only has to find the middle */
    for (int64_t i = 0; i < size; ++i) m->middle[i] = (m->old[i] + m->r[i]) / 2;
    if (m->metric != 0) check(hol_metric(m->chains, m->middle, m->metric, NULL, NULL, NULL, m->force, HOL_WRITE));
    displace(m, m->middle, dt);
}

/** Means over the chains: square of the end-to-end distance, square of the cosine between neighbouring rods. */
static void measure(const melt *m, double *square, double *cosine)
{
    *square = *cosine = 0;
    for (int64_t c = 0; c < m->n_chains; ++c) {
        const double *r = m->r + 3 * c * (m->n_bonds + 1), *end = r + 3 * m->n_bonds;
        for (int x = 0; x < 3; ++x) *square += (end[x] - r[x]) * (end[x] - r[x]);
        for (int64_t k = 1; k < m->n_bonds; ++k) {
            const double *b = r + 3 * k;
            double dot = 0;
            for (int x = 0; x < 3; ++x) dot += (b[x] - b[x - 3]) * (b[x + 3] - b[x]);
            *cosine += dot * dot / (double)(m->n_bonds - 1);
        }
    }
    *square /= (double)m->n_chains;
    *cosine /= (double)m->n_chains;
}

static void plot(const char *output, int64_t n_bonds)
{
    char name[512], command[1100];
    snprintf(name, sizeof name, "%s.gp", output);
    FILE *gp = fopen(name, "w");
    if (!gp) return;
    fprintf(gp,
            "set terminal pngcairo size 700,480\nset output '%s.png'\nset logscale xy\nset format y '%%g'\n"
            "set xlabel 'time / (friction a^2 / kT)'\nset ylabel 'mean square end-to-end distance / (N a^2)'\n"
            "set title '%d rods from straight to coil'\nset yrange [0.7:%g]\n"
            "plot '%s.dat' using 1:2 with lines lw 2 title 'bead-rod chains', 1 lw 2 title 'freely jointed chain'\n",
            output, (int)n_bonds, 1.3 * (double)n_bonds, output);
    fclose(gp);
    snprintf(command, sizeof command, "command -v gnuplot >/dev/null 2>&1 && gnuplot '%s' 2>/dev/null", name);
    if (system(command) == 0)
        printf("plot: %s.png\n", output);
    else
        printf("plot: gnuplot was not found; %s draws it\n", name);
}

static double report(const char *what, estimate e, double expected)
{
    const double off = (e.mean - expected) / e.error;
    printf("%s %.5f +- %.5f, expected %.5f: %+.2f errors off\n", what, e.mean, e.error, expected, off);
    return fabs(off);
}

int main(int argc, char **argv)
{
    option o[OPTIONS] = {{"bonds", 10, 2},    {"chains", 200, 1}, {"dt", 0.002, 1e-9},
                         {"time", 150, 1e-6}, {"metric", 1, 0},   {"seed", 1, 0}};
    const char *output = "bead_rod_relaxation";
    char name[512];
    read_options(argc, argv, o, OPTIONS, &output);
    melt m = straight_chains(o);
    const double dt = o[DT].value, n = (double)m.n_bonds, relaxation = n * n / 29.6; /* Rouse, N^2 / (3 pi^2) */
    const long steps = (long)(o[TIME].value / dt + 0.5), start = (long)(10 * relaxation / dt);
    const long samples = 10; /* steps from sample to sample */
    double *squares = numbers(steps), *cosines = numbers(steps), square, cosine, next_line = dt, next_print = 0;
    long count = 0;
    snprintf(name, sizeof name, "%s.dat", output);
    FILE *data = fopen(name, "w");
    if (!data) {
        fprintf(stderr, "%s: can't be written\n", name);
        return 1;
    }
    if (steps - start < 64 * samples) {
        fprintf(stderr, "time=%g is too short: it takes %g to forget the start\n", o[TIME].value, 10 * relaxation);
        return 2;
    }
    measure(&m, &square, &cosine);
    printf("%d chains of %d rods, at the start mean square end-to-end distance / N = %.6f\n", (int)m.n_chains,
           (int)m.n_bonds, square / n);
    fprintf(data, "# time, mean square end-to-end distance / N, mean square cosine\n");
    for (long i = 1; i <= steps; ++i) {
        const double time = (double)i * dt;
        const int writes = time >= next_line * (1 - 1e-9);
        step(&m, dt);
        if (i % samples > 0 && !writes) continue;
        measure(&m, &square, &cosine);
        if (i > start && i % samples == 0) {
            squares[count] = square / n;
            cosines[count++] = cosine;
        }
        if (!writes) continue;
        fprintf(data, "%g %.6f %.6f\n", time, square / n, cosine);
        next_line = fmax(next_line * 1.03, next_line + dt);
        if (time < next_print) continue;
        printf("time %8.3f: mean square end-to-end distance / N = %.4f\n", time, square / n);
        fflush(stdout);
        next_print = fmax(2 * time, 1e-2);
    }
    fclose(data);
    hol_worst worst;
    check(hol_violation(m.chains, m.r, NULL, &worst));
    printf("largest bond error: %.2e\n", worst.length);
    const double distance = report("mean square end-to-end distance / N:", block_average(squares, count), 1);
    const double angle = report("mean square cosine:", block_average(cosines, count), 1.0 / 3);
    plot(output, m.n_bonds);
    finish(&m);
    free(squares), free(cosines);
    if (distance < 4 && angle < 4) return 0;
    fprintf(stderr, "the chains did not become freely jointed ones\n");
    return 1;
}
