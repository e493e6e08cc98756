/**
 * A gel in a periodic box under strain: strands of rigid bonds between the nodes of a diamond lattice, whose cycles go
 * round the box. The box is stretched along z by a factor, at constant volume, and the program shows how stress
 * follows.
 *
 *     gel [cells=2] [strand=10] [steps=4000] [points=6] [stretch=2] [dt=0.01] [friction=1] [threads=1] [seed=1]
 *         [output=NAME]
 *
 * Bonds, masses and kT are 1. Strands do not feel each other (a phantom network), so that for small stretches theory
 * knows the answer: the mean position of every node follows the box, a coil of N bonds pulls with 3 kT R / N, and
 *
 *     s_zz - (s_xx + s_yy) / 2 = n kT / V (R^2 / N) (stretch^2 - 1 / stretch),
 *
 * n strands of mean end-to-end distance R in the volume V; here R^2 = N. Stretched far, bonds line up and pull harder.
 * With output, NAME gets stretch, stress, its error and theory's, as gel.gp draws them. The bath is Langevin's by
 * g-BAOAB, as docs/integrators.md has it.
 */
#include <holonomic.h>

#include "noise.h"
#include "options.h"

enum { CELLS, STRAND, STEPS, POINTS, STRETCH, DT, FRICTION, THREADS, SEED, OPTIONS };

typedef struct gel {
    int n_atoms, n_bonds, n_strands;
    double side[3], volume;
    hol_chains *bonds;
    double *r, *v, *r_ref;
    noise random;
} gel;

static void check(int status)
{
    if (status == HOL_OK) return;
    fprintf(stderr, "%s: %s\n", hol_status_name(status), hol_error_message());
    exit(1);
}

static void *room(size_t n, size_t size)
{
    void *p = calloc(n, size);
    if (p) return p;
    fprintf(stderr, "out of memory\n");
    exit(1);
}

/** A coil from one node to another: a random walk, to which each bond adds its part of what is missing and takes its
 * length again, until nothing is missing. */
static void lay_strand(gel *s, int n, const double *from, const double *to, int first_atom)
{
    double *walk = room(3 * (size_t)n, sizeof *walk), missing[3] = {0, 0, 0}, at[3];
    for (int k = 0; k < n; ++k) noise_direction(&s->random, walk + 3 * k);
    for (int round = 0; round < 500; ++round) {
        for (int x = 0; x < 3; ++x) missing[x] = (to[x] - from[x]) / n;
        for (int k = 0; k < n; ++k) {
            double *d = walk + 3 * k;
            const double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
            for (int x = 0; x < 3; ++x) missing[x] -= (d[x] /= length) / n;
        }
        for (int k = 0; k < 3 * n; ++k) walk[k] += missing[k % 3];
    }
    memcpy(at, from, sizeof at);
    for (int k = 0; k + 1 < n; ++k)
        for (int x = 0; x < 3; ++x) s->r[3 * (first_atom + k) + x] = at[x] += walk[3 * k + x];
    free(walk);
}

/** Nodes at the eight places of a diamond's cell, each of the first four with strands to four of the others. */
static gel start(const option *o, double stretch)
{
    static const double corner[4][3] = {{0, 0, 0}, {0, 2, 2}, {2, 0, 2}, {2, 2, 0}},
                        to[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    const int cells = (int)o[CELLS].value, n = (int)o[STRAND].value, n_cells = cells * cells * cells;
    const double quarter = sqrt(n / 3.0); /* of a cell's side: strands reach as far as coils do */
    gel s = {0};
    s.n_strands = 16 * n_cells;
    s.n_atoms = 8 * n_cells + s.n_strands * (n - 1);
    s.n_bonds = s.n_strands * n;
    s.random = noise_start((uint64_t)o[SEED].value);
    s.volume = pow(4 * cells * quarter, 3);
    const double scale[3] = {quarter / sqrt(stretch), quarter / sqrt(stretch), quarter * stretch};
    for (int x = 0; x < 3; ++x) s.side[x] = 4 * cells * scale[x];
    s.r = room(3 * (size_t)s.n_atoms, sizeof *s.r);
    s.v = room(3 * (size_t)s.n_atoms, sizeof *s.v);
    s.r_ref = room(3 * (size_t)s.n_atoms, sizeof *s.r_ref);
    int64_t *pairs = room(2 * (size_t)s.n_bonds, sizeof *pairs);
    double *ones = room((size_t)(s.n_atoms + s.n_bonds), sizeof *ones);
    int atom = 8 * n_cells, k = 0;
    for (int c = 0; c < 4 * n_cells; ++c) {
        const int cell[3] = {c / 4 % cells, c / 4 / cells % cells, c / 4 / cells / cells};
        double from[3], end[3];
        for (int x = 0; x < 3; ++x) s.r[3 * c + x] = from[x] = scale[x] * (4 * cell[x] + corner[c % 4][x]);
        for (int e = 0; e < 4; ++e) {
            int place[3], node = 0;
            for (int x = 0; x < 3; ++x) {
                end[x] = from[x] + scale[x] * to[e][x];
                place[x] = (4 * cell[x] + (int)(corner[c % 4][x] + to[e][x]) + 4 * cells) % (4 * cells);
            }
            /* The other half of the nodes: those at odd places, by their cell and the corner one step back. */
            for (int x = 2; x >= 0; --x) node = cells * node + place[x] / 4;
            node = 4 * node + (place[0] % 4 == 1 ? (place[1] % 4 == 1 ? 0 : 1) : (place[1] % 4 == 1 ? 2 : 3));
            node += 4 * n_cells;
            for (int x = 0; x < 3; ++x) s.r[3 * node + x] = scale[x] * place[x];
            lay_strand(&s, n, from, end, atom);
            for (int b = 0; b < n; ++b) {
                pairs[2 * k] = b == 0 ? c : atom + b - 1;
                pairs[2 * k++ + 1] = b + 1 == n ? node : atom + b;
            }
            atom += n - 1;
        }
    }
    for (int i = 0; i < s.n_atoms + s.n_bonds; ++i) ones[i] = 1;
    const double box[9] = {s.side[0], 0, 0, 0, s.side[1], 0, 0, 0, s.side[2]};
    check(hol_chains_create(s.n_atoms, ones, &s.bonds));
    check(hol_chains_add_bonds(s.bonds, s.n_bonds, pairs, ones));
    check(hol_chains_set_box(s.bonds, box));
    check(hol_chains_set_threads(s.bonds, (int)o[THREADS].value));
    /* A crude model: lengths are found before they are held. */
    check(hol_chains_set_checks(s.bonds, HOL_NEVER));
    memcpy(s.r_ref, s.r, sizeof(double) * 3 * (size_t)s.n_atoms);
    check(hol_project_positions(s.bonds, s.r_ref, s.r, NULL, 1, NULL, 0, NULL, NULL));
    check(hol_chains_set_checks(s.bonds, HOL_AT_START));
    for (int i = 0; i < 3 * s.n_atoms; ++i) s.v[i] = noise_normal(&s.random);
    check(hol_project_velocities(s.bonds, s.r, s.v, NULL, NULL));
    free(pairs), free(ones);
    return s;
}

static void finish(gel *s)
{
    hol_chains_destroy(s->bonds);
    free(s->r), free(s->v), free(s->r_ref);
}

static void drift(gel *s, double dt)
{
    memcpy(s->r_ref, s->r, sizeof(double) * 3 * (size_t)s->n_atoms);
    for (int i = 0; i < 3 * s->n_atoms; ++i) s->r[i] += dt * s->v[i];
    check(hol_project_positions(s->bonds, s->r_ref, s->r, s->v, dt, NULL, 0, NULL, NULL));
    check(hol_project_velocities(s->bonds, s->r, s->v, NULL, NULL));
}

/** g-BAOAB; there are no forces but those of the bonds. */
static void step(gel *s, double dt, double friction)
{
    const double keep = exp(-friction * dt), kick_size = sqrt(1 - keep * keep);
    drift(s, dt / 2);
    for (int i = 0; i < 3 * s->n_atoms; ++i) s->v[i] = keep * s->v[i] + kick_size * noise_normal(&s->random);
    check(hol_project_velocities(s->bonds, s->r, s->v, NULL, NULL));
    drift(s, dt / 2);
}

/** s_zz - (s_xx + s_yy) / 2 of this instant: minus the pressure's, of motion and of the bonds' pulls. */
static double stress_of(gel *s)
{
    double w[9];
    check(hol_forces(s->bonds, s->r, s->v, NULL, NULL, NULL, NULL, HOL_WRITE, w));
    double sum = w[8] - 0.5 * (w[0] + w[4]);
    for (int i = 0; i < s->n_atoms; ++i) {
        const double *v = s->v + 3 * i;
        sum += v[2] * v[2] - 0.5 * (v[0] * v[0] + v[1] * v[1]);
    }
    return -sum / s->volume;
}

int main(int argc, char **argv)
{
    option o[OPTIONS] = {{"cells", 2, 1},       {"strand", 10, 3}, {"steps", 4000, 40},
                         {"points", 6, 1},      {"stretch", 2, 1}, {"dt", 0.01, 1e-9},
                         {"friction", 1, 1e-9}, {"threads", 1, 1}, {"seed", 1, 0}};
    const char *output = "";
    read_options(argc, argv, o, OPTIONS, &output);
    const int steps = (int)o[STEPS].value, points = (int)o[POINTS].value, melt = steps / 4, n_blocks = 10;
    FILE *file = *output ? fopen(output, "w") : NULL;
    if (*output && !file) {
        fprintf(stderr, "gel: %s cannot be opened\n", output);
        return 1;
    }
    double worst_length = 0, worst_rate = 0;
    printf("holonomic %s (%s)\n", hol_version(), hol_instruction_set());
    if (file) fprintf(file, "# stretch, stress, its error, phantom network: in kT per volume of a strand\n");
    for (int p = 0; p < points; ++p) {
        const double stretch = points == 1 ? o[STRETCH].value : 1 + (o[STRETCH].value - 1) * p / (points - 1);
        gel s = start(o, stretch);
        if (p == 0)
            printf(
                "%d strands of %d bonds, %d networks, box %.2f %.2f %.2f\n   stretch    stress     error   phantom\n",
                s.n_strands, (int)o[STRAND].value, (int)hol_chains_n_molecules(s.bonds), s.side[0], s.side[1],
                s.side[2]);
        double block[10] = {0}, mean = 0, error = 0;
        for (int i = 0; i < steps; ++i) {
            hol_worst worst;
            step(&s, o[DT].value, o[FRICTION].value);
            if (i < melt) continue;
            const int b = (i - melt) * n_blocks / (steps - melt);
            block[b] += stress_of(&s) * n_blocks / (steps - melt) * s.volume / s.n_strands;
            check(hol_violation(s.bonds, s.r, s.v, &worst));
            worst_length = fmax(worst_length, worst.length);
            worst_rate = fmax(worst_rate, worst.rate);
        }
        for (int b = 0; b < n_blocks; ++b) mean += block[b] / n_blocks;
        for (int b = 0; b < n_blocks; ++b) error += (block[b] - mean) * (block[b] - mean) / (n_blocks * (n_blocks - 1));
        const double phantom = stretch * stretch - 1 / stretch;
        printf("%10.3f%10.4f%10.4f%10.4f\n", stretch, mean, sqrt(error), phantom);
        if (file) fprintf(file, "%g %g %g %g\n", stretch, mean, sqrt(error), phantom);
        finish(&s);
    }
    printf("largest bond error    %.2e = |d^2 - a^2|/a^2, of all steps\n", worst_length);
    printf("largest |d.v|         %.2e\n", worst_rate);
    if (file) fclose(file);
    return 0;
}
