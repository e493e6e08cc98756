/**
 * A bottle brush: a backbone of beads, each with a side chain, of rigid bonds all of them, in a heat bath. The crowded
 * side chains stretch the backbone; the program shows the mean tension of each generation of bonds.
 *
 *     brush [backbone=20] [arm=8] [steps=20000] [dt=0.005] [friction=1] [pull=0] [seed=1] [output=NAME]
 *
 * pull is a force that draws the ends of the backbone apart. With output, NAME gets the last conformation, a line for
 * each bond: its two ends and its mean tension, as brush.gp draws them. Units: bonds, masses and kT are 1. Beads that
 * no bond joins repel each other (Weeks, Chandler and Andersen 1971). The bath is Langevin's by g-BAOAB, as
 * docs/integrators.md has it.
 */
#include <holonomic.h>

#include "noise.h"
#include "options.h"

enum { BACKBONE, ARM, STEPS, DT, FRICTION, PULL, SEED, OPTIONS };

typedef struct brush {
    int n_backbone, n_arm, n_atoms, n_bonds;
    hol_chains *bonds;
    double *r, *v, *f, *r_ref, *tension, *mean_tension;
    double pull;
    noise random;
} brush;

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

/** The bead of arm a = 1 .. n_arm of backbone bead b; a = 0 is the backbone bead itself. */
static int bead(const brush *s, int b, int a)
{
    return b * (s->n_arm + 1) + a;
}

static brush start(const option *o)
{
    const int n_backbone = (int)o[BACKBONE].value, n_arm = (int)o[ARM].value, n = n_backbone * (n_arm + 1);
    brush s = {n_backbone,
               n_arm,
               n,
               n - 1,
               NULL,
               NULL,
               NULL,
               NULL,
               NULL,
               NULL,
               NULL,
               o[PULL].value,
               noise_start((uint64_t)o[SEED].value)};
    int64_t *pairs = room(2 * (size_t)n, sizeof *pairs);
    double *ones = room((size_t)n, sizeof *ones);
    s.r = room(3 * (size_t)n, sizeof *s.r);
    s.v = room(3 * (size_t)n, sizeof *s.v);
    s.f = room(3 * (size_t)n, sizeof *s.f);
    s.r_ref = room(3 * (size_t)n, sizeof *s.r_ref);
    s.tension = room((size_t)n, sizeof *s.tension);
    s.mean_tension = room((size_t)n, sizeof *s.mean_tension);
    int k = 0;
    for (int b = 0; b < n_backbone; ++b)
        for (int a = 0; a <= n_arm; ++a) { /* straight, neighbouring arms turned against each other */
            double *r = s.r + 3 * bead(&s, b, a);
            r[0] = b, r[1] = a * cos(2.4 * b), r[2] = a * sin(2.4 * b);
            if (a + b == 0) continue;
            pairs[2 * k] = a > 0 ? bead(&s, b, a - 1) : bead(&s, b - 1, 0);
            pairs[2 * k++ + 1] = bead(&s, b, a);
        }
    for (int i = 0; i < n; ++i) ones[i] = 1;
    check(hol_chains_create(n, ones, &s.bonds));
    check(hol_chains_add_bonds(s.bonds, s.n_bonds, pairs, ones));
    free(pairs), free(ones);
    for (int i = 0; i < 3 * n; ++i) s.v[i] = noise_normal(&s.random);
    check(hol_project_velocities(s.bonds, s.r, s.v, NULL, NULL));
    return s;
}

static void finish(brush *s)
{
    hol_chains_destroy(s->bonds);
    free(s->r), free(s->v), free(s->f), free(s->r_ref), free(s->tension), free(s->mean_tension);
}

static int bonded(const brush *s, int i, int j)
{
    const int length = s->n_arm + 1;
    return (j == i + 1 && j % length > 0) || (j == i + length && i % length == 0);
}

/** The pull at the ends, and the repulsion of beads closer than 2^(1/6) that no bond joins. */
static void apply_forces(brush *s)
{
    memset(s->f, 0, sizeof(double) * 3 * (size_t)s->n_atoms);
    s->f[0] = -s->pull;
    s->f[3 * bead(s, s->n_backbone - 1, 0)] = s->pull;
    for (int i = 0; i < s->n_atoms; ++i)
        for (int j = i + 1; j < s->n_atoms; ++j) {
            double d[3], square = 0;
            for (int x = 0; x < 3; ++x) {
                d[x] = s->r[3 * i + x] - s->r[3 * j + x];
                square += d[x] * d[x];
            }
            if (square >= 1.2599210498948732 || bonded(s, i, j)) continue;
            const double six = 1 / (square * square * square), slope = 24 * six * (2 * six - 1) / square;
            for (int x = 0; x < 3; ++x) s->f[3 * i + x] += slope * d[x], s->f[3 * j + x] -= slope * d[x];
        }
}

static void project_velocities(brush *s)
{
    check(hol_project_velocities(s->bonds, s->r, s->v, NULL, NULL));
}

static void kick(brush *s, double dt)
{
    for (int i = 0; i < 3 * s->n_atoms; ++i) s->v[i] += dt * s->f[i];
    project_velocities(s);
}

static void drift(brush *s, double dt)
{
    memcpy(s->r_ref, s->r, sizeof(double) * 3 * (size_t)s->n_atoms);
    for (int i = 0; i < 3 * s->n_atoms; ++i) s->r[i] += dt * s->v[i];
    check(hol_project_positions(s->bonds, s->r_ref, s->r, s->v, dt, NULL, 0, NULL, NULL));
    project_velocities(s);
}

/** g-BAOAB */
static void step(brush *s, double dt, double friction)
{
    const double keep = exp(-friction * dt), kick_size = sqrt(1 - keep * keep);
    kick(s, dt / 2);
    drift(s, dt / 2);
    for (int i = 0; i < 3 * s->n_atoms; ++i) s->v[i] = keep * s->v[i] + kick_size * noise_normal(&s->random);
    project_velocities(s);
    drift(s, dt / 2);
    apply_forces(s);
    kick(s, dt / 2);
}

/** Adds the tensions of this instant: backbone (without its two ends' bonds) at [0], bond a of the arms at [a]. */
static void add_tensions(brush *s, double *sum)
{
    const int length = s->n_arm + 1;
    check(hol_forces(s->bonds, s->r, s->v, s->f, NULL, s->tension, NULL, HOL_WRITE, NULL));
    for (int k = 0; k < s->n_bonds; ++k) { /* bond k leads to bead k + 1 */
        s->mean_tension[k] += s->tension[k];
        const int b = (k + 1) / length, a = (k + 1) % length;
        if (b < 2 || b > s->n_backbone - 3) continue;
        sum[a] += s->tension[k] / (s->n_backbone - 4);
    }
}

/** The bonds with their mean tensions over so many samples. */
static void write_bonds(const brush *s, int samples, const char *name)
{
    FILE *file = fopen(name, "w");
    if (!file) {
        fprintf(stderr, "brush: %s cannot be opened\n", name);
        exit(1);
    }
    fprintf(file, "# x y z of both ends, mean tension in kT/a\n");
    for (int k = 0; k < s->n_bonds; ++k) {
        const int b = (k + 1) / (s->n_arm + 1), a = (k + 1) % (s->n_arm + 1);
        const double *from = s->r + 3 * (a > 0 ? bead(s, b, a - 1) : bead(s, b - 1, 0)), *to = s->r + 3 * (k + 1);
        fprintf(file, "%g %g %g %g %g %g %g\n", from[0], from[1], from[2], to[0], to[1], to[2],
                s->mean_tension[k] / samples);
    }
    fclose(file);
}

int main(int argc, char **argv)
{
    option o[OPTIONS] = {{"backbone", 20, 6},   {"arm", 8, 1},  {"steps", 20000, 20}, {"dt", 0.005, 1e-9},
                         {"friction", 1, 1e-9}, {"pull", 0, 0}, {"seed", 1, 0}};
    const char *output = "";
    read_options(argc, argv, o, OPTIONS, &output);
    brush s = start(o);
    const int steps = (int)o[STEPS].value, melt = steps / 4;
    const double freedoms = (double)hol_chains_degrees_of_freedom(s.bonds, 3);
    double *sum = room((size_t)s.n_arm + 1, sizeof *sum);
    double temperature = 0, worst_length = 0, worst_rate = 0, end = 0, square = 0;
    printf("holonomic %s (%s)\n", hol_version(), hol_instruction_set());
    printf("%d beads: a backbone of %d with an arm of %d at each; branched molecules: %d\n", s.n_atoms, s.n_backbone,
           s.n_arm, (int)hol_chains_n_of_shape(s.bonds, HOL_SHAPE_TREE));
    printf("      time   kT so far   end-to-end   bond error\n");
    apply_forces(&s);
    for (int i = 1; i <= steps; ++i) {
        hol_worst worst;
        step(&s, o[DT].value, o[FRICTION].value);
        check(hol_violation(s.bonds, s.r, s.v, &worst));
        worst_length = fmax(worst_length, worst.length);
        worst_rate = fmax(worst_rate, worst.rate);
        square = 0;
        for (int x = 0; x < 3; ++x) {
            const double d = s.r[3 * bead(&s, s.n_backbone - 1, 0) + x] - s.r[x];
            square += d * d;
        }
        if (i > melt) {
            for (int k = 0; k < 3 * s.n_atoms; ++k) temperature += s.v[k] * s.v[k] / freedoms;
            end += square;
            add_tensions(&s, sum);
        }
        if (i % (steps / 10) == 0)
            printf("%10.2f%12.4f%13.3f%13.2e\n", i * o[DT].value, i > melt ? temperature / (i - melt) : 0, sqrt(square),
                   worst_length);
    }
    const int samples = steps - melt;
    printf("largest bond error    %.2e = |d^2 - a^2|/a^2, of all steps\n", worst_length);
    printf("largest |d.v|         %.2e\n", worst_rate);
    printf("kT                    %.4f\n", temperature / samples);
    printf("backbone stretched to %.1f%% of its length\n", 100 * sqrt(end / samples) / (s.n_backbone - 1));
    printf("mean tension backbone %8.3f kT/a\n", sum[0] / samples);
    for (int a = 1; a <= s.n_arm; ++a) printf("mean tension arm %4d %8.3f\n", a, sum[a] / samples);
    if (*output) write_bonds(&s, samples, output);
    finish(&s);
    free(sum);
    return 0;
}
