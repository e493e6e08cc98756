/**
 * An all-atom n-alkane with all its bonds rigid, in molecular dynamics at constant energy: a branched molecule, given
 * to the library as a list of bonds.
 *
 *     alkane [carbons=12] [steps=20000] [dt=1] [temperature=300] [seed=1]      dt in fs, temperature in K
 *
 * The program prints energy, temperature and the largest error of a bond along the run, and at its end the mean tension
 * of the bonds.
 */
#include <holonomic.h>

#include "alkane_forces.h"
#include "noise.h"
#include "options.h"

enum { CARBONS, STEPS, DT, TEMPERATURE, SEED, OPTIONS };

typedef struct run {
    alkane molecule;
    hol_chains *bonds;
    double *r, *v, *f, *r_ref, *tension, *tension_sum;
    double potential, kinetic, worst_length, worst_rate;
} run;

static void check(int status)
{
    if (status == HOL_OK) return;
    fprintf(stderr, "%s: %s\n", hol_status_name(status), hol_error_message());
    exit(1);
}

static double *numbers(int n)
{
    double *p = calloc((size_t)n, sizeof *p);
    if (p) return p;
    fprintf(stderr, "out of memory\n");
    exit(1);
}

/** Velocities of the temperature along the bonds' freedoms, without a total momentum. */
static void thermal_velocities(run *s, double temperature, noise *random)
{
    const alkane *m = &s->molecule;
    double momentum[3] = {0, 0, 0}, total = 0;
    for (int i = 0; i < 3 * m->n_atoms; ++i)
        s->v[i] = sqrt(BOLTZMANN * temperature / m->mass[i / 3]) * noise_normal(random);
    check(hol_project_velocities(s->bonds, s->r, s->v, NULL, NULL));
    for (int i = 0; i < 3 * m->n_atoms; ++i) momentum[i % 3] += m->mass[i / 3] * s->v[i];
    for (int i = 0; i < m->n_atoms; ++i) total += m->mass[i];
    for (int i = 0; i < 3 * m->n_atoms; ++i) s->v[i] -= momentum[i % 3] / total;
}

static void start(run *s, const option *o)
{
    noise random = noise_start((uint64_t)o[SEED].value);
    alkane *m = &s->molecule;
    if (alkane_make((int)o[CARBONS].value, m)) {
        fprintf(stderr, "out of memory\n");
        exit(1);
    }
    s->r = m->r;
    s->v = numbers(3 * m->n_atoms);
    s->f = numbers(3 * m->n_atoms);
    s->r_ref = numbers(3 * m->n_atoms);
    s->tension = numbers(m->n_bonds);
    s->tension_sum = numbers(m->n_bonds);
    check(hol_chains_create(m->n_atoms, m->mass, &s->bonds));
    check(hol_chains_add_bonds(s->bonds, m->n_bonds, m->bonds, m->lengths));
    thermal_velocities(s, o[TEMPERATURE].value, &random);
    s->potential = alkane_forces(m, s->r, s->f);
}

static void finish(run *s)
{
    hol_chains_destroy(s->bonds);
    free(s->v), free(s->f), free(s->r_ref), free(s->tension), free(s->tension_sum);
    alkane_free(&s->molecule);
}

static void kick(run *s, double dt)
{
    for (int i = 0; i < 3 * s->molecule.n_atoms; ++i) s->v[i] += dt / s->molecule.mass[i / 3] * s->f[i];
}

/** Velocity Verlet (RATTLE). */
static void step(run *s, double dt)
{
    const int n = 3 * s->molecule.n_atoms;
    kick(s, dt / 2);
    memcpy(s->r_ref, s->r, sizeof(double) * (size_t)n);
    for (int i = 0; i < n; ++i) s->r[i] += dt * s->v[i];
    check(hol_project_positions(s->bonds, s->r_ref, s->r, s->v, dt, NULL, 0, NULL, NULL));
    s->potential = alkane_forces(&s->molecule, s->r, s->f);
    kick(s, dt / 2);
    check(hol_project_velocities(s->bonds, s->r, s->v, NULL, NULL));
}

static void observe(run *s)
{
    hol_worst worst;
    check(hol_violation(s->bonds, s->r, s->v, &worst));
    s->worst_length = fmax(s->worst_length, worst.length);
    s->worst_rate = fmax(s->worst_rate, worst.rate);
    s->kinetic = 0;
    for (int i = 0; i < 3 * s->molecule.n_atoms; ++i) s->kinetic += s->molecule.mass[i / 3] * s->v[i] * s->v[i] / 2;
}

/** Mean tension of the bonds between two carbons, and of the others. */
static void print_tensions(const run *s, int samples)
{
    double sum[2] = {0, 0};
    int count[2] = {0, 0};
    for (int k = 0; k < s->molecule.n_bonds; ++k) {
        const int hydrogen = s->molecule.bonds[2 * k + 1] >= s->molecule.n_carbons;
        sum[hydrogen] += s->tension_sum[k] / samples / PICONEWTON;
        ++count[hydrogen];
    }
    printf("mean tension          %.1f pN in C-C, %.1f pN in C-H\n", sum[0] / count[0], sum[1] / count[1]);
}

static const char *shape_name(hol_chains *bonds)
{
    static const char *const names[] = {"chain", "tree", "ring", "triangle", "graph"};
    int shape;
    check(hol_chains_molecule(bonds, 0, &shape, NULL, NULL));
    return names[shape];
}

int main(int argc, char **argv)
{
    option o[OPTIONS] = {
        {"carbons", 12, 2}, {"steps", 20000, 10}, {"dt", 1, 1e-6}, {"temperature", 300, 0}, {"seed", 1, 0}};
    const char *output = "";
    run s = {0};
    read_options(argc, argv, o, OPTIONS, &output);
    start(&s, o);
    const int steps = (int)o[STEPS].value;
    const double dt = o[DT].value / 1000, freedoms = (double)hol_chains_degrees_of_freedom(s.bonds, 3) - 3;
    printf("holonomic %s (%s)\n", hol_version(), hol_instruction_set());
    printf("atoms                 %d, joined by %d rigid bonds: a %s\n", s.molecule.n_atoms, s.molecule.n_bonds,
           shape_name(s.bonds));
    printf("degrees of freedom    %.0f in the temperature\n", freedoms);
    printf("   time/ps      E/(kJ/mol)       T/K   bond error\n");
    double temperature_sum = 0, sum[5] = {0}; /* 1, t, t^2, E, t E */
    double first = 0, square = 0;
    for (int i = 1; i <= steps; ++i) {
        step(&s, dt);
        observe(&s);
        const double energy = (s.kinetic + s.potential) / KJ_PER_MOL, t = i * dt;
        const double temperature = 2 * s.kinetic / (freedoms * BOLTZMANN);
        if (i == 1) first = energy;
        const double e = energy - first;
        sum[0] += 1, sum[1] += t, sum[2] += t * t, sum[3] += e, sum[4] += t * e, square += e * e;
        temperature_sum += temperature;
        check(hol_forces(s.bonds, s.r, s.v, s.f, NULL, s.tension, NULL, HOL_WRITE, NULL));
        for (int k = 0; k < s.molecule.n_bonds; ++k) s.tension_sum[k] += s.tension[k];
        if (i % (steps / 10) == 0) printf("%10.3f%16.8f%10.2f%13.2e\n", t, energy, temperature, s.worst_length);
    }
    const double mean_t = sum[1] / sum[0], mean_e = sum[3] / sum[0], spread = sum[2] / sum[0] - mean_t * mean_t;
    const double slope = (sum[4] / sum[0] - mean_t * mean_e) / spread;
    printf("largest bond error    %.2e = |d^2 - a^2|/a^2, of all steps\n", s.worst_length);
    printf("largest |d.v|         %.2e A^2/ps\n", s.worst_rate);
    printf("energy drift          %.2e kJ/mol per ns\n", slope * 1000);
    printf("energy fluctuation    %.2e kJ/mol rms about it\n",
           sqrt(fmax(0, square / sum[0] - mean_e * mean_e - slope * slope * spread)));
    printf("mean temperature      %.2f K\n", temperature_sum / steps);
    print_tensions(&s, steps);
    finish(&s);
    return 0;
}
