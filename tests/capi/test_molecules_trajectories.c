/** Rigid molecules at constant energy: bonds stay at the rounding of the coordinates, energy does not drift. */
#include "check.h"
#include "mixture.h"
#include "molecule_solution.h"
#include "nve.h"

static const double kT = 2.494; /* kJ/mol at 300 K */

/* SPC/E: atom 3n is oxygen, the others hydrogen */
static double pair_of_waters(const double *a, const double *b, double *fa, double *fb)
{
    static const double charge[3] = {-0.8476, 0.4238, 0.4238}, coulomb = 1389.35458, epsilon = 0.65017, sigma = 3.16557;
    double energy = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            double d[3], q = 0;
            for (int x = 0; x < 3; ++x) {
                d[x] = b[3 * j + x] - a[3 * i + x];
                q += d[x] * d[x];
            }
            const double u = coulomb * charge[i] * charge[j] / sqrt(q);
            double slope = u / q; /* - U' / r */
            energy += u;
            if (i == 0 && j == 0) {
                const double s6 = pow(sigma * sigma / q, 3);
                energy += 4 * epsilon * (s6 * s6 - s6);
                slope += 24 * epsilon * (2 * s6 * s6 - s6) / q;
            }
            for (int x = 0; x < 3; ++x) {
                fa[3 * i + x] -= slope * d[x];
                fb[3 * j + x] += slope * d[x];
            }
        }
    return energy;
}

static double waters(const void *of_what, int64_t n_atoms, const double *r, double *f)
{
    double energy = 0;
    (void)of_what;
    for (int64_t a = 0; a < n_atoms; a += 3)
        for (int64_t b = a + 3; b < n_atoms; b += 3)
            energy += pair_of_waters(r + 3 * a, r + 3 * b, f + 3 * a, f + 3 * b);
    return energy;
}

/** Sets velocities to a temperature, with those of the constraints taken out already. */
static void rescale(nve *s, double kinetic)
{
    const double factor = sqrt(kinetic / nve_kinetic(s));
    for (int64_t i = 0; i < 3 * s->n_atoms; ++i) s->v[i] *= factor;
}

/** n^3 molecules on a lattice, in directions at random. */
static mixture water_drop(int n)
{
    molecule *parts = calloc((size_t)(n * n * n), sizeof *parts);
    for (int p = 0; p < n * n * n; ++p) {
        const double at[3] = {3.1 * (p % n), 3.1 * (p / n % n), 3.1 * (p / n / n)};
        parts[p] = molecule_make(MOLECULE_WATER, 3, (uint64_t)p);
        for (int i = 0; i < 9; ++i) {
            parts[p].r[i] += at[i % 3];
            parts[p].v[i] *= sqrt(kT);
        }
    }
    mixture m = mixture_make(parts, n * n * n, ONE_AFTER_THE_OTHER, 0);
    for (int p = 0; p < n * n * n; ++p) molecule_free(parts + p);
    free(parts);
    return m;
}

static nve start(const mixture *m, field forces, const void *of_what)
{
    return nve_make(m->chains, m->n_atoms, m->mass, m->pairs, m->length, m->r, m->v, forces, of_what);
}

/**
 * The same run by textbook SHAKE and RATTLE to 1e-12: what the energy does besides is the time step's, and the library
 * adds nothing to it. `scale`: the kinetic energy.
 */
static void check_beside_sweeps(const nve *s, double dt, int steps, double drift, double scale)
{
    nve other = nve_with_sweeps(s, 1e-12);
    const energy_record e = nve_run(&other, dt, steps);
    print_message(
        "energy after %d steps: %+.3g of the kinetic one; by SHAKE at 1e-12 %+.3g, lengths within %.3g roundings\n",
        steps, drift / scale, (e.last - e.first) / scale, other.worst_length);
    CHECK_AT_MOST(fabs(drift), 2 * fabs(e.last - e.first) + 0.0005 * scale);
    nve_free(&other);
}

static void rigid_water_keeps_its_energy_and_its_bonds(void **state)
{
    (void)state;
    const int edge = quick_run() ? 2 : 3, n = edge * edge * edge, steps = quick_run() ? 100 : 2000;
    mixture m = water_drop(edge);
    nve s = start(&m, waters, NULL);
    for (int warming = 0; warming < 20; ++warming) {
        nve_run(&s, 0.01, 10);
        rescale(&s, 3 * n * kT);
    }
    nve from_here = nve_with_sweeps(&s, 0);
    const energy_record e = nve_run(&s, 0.01, steps); /* 1 fs */
    print_message("%d waters: energy %.6f, later %.6f, spread %.2g of %.3g; lengths within %.2f roundings\n", n,
                  e.first, e.last, e.spread, 3 * n * kT, s.worst_length);
    CHECK_AT_MOST(s.worst_length, 8);
    /* Verlet's energy swings by (omega dt)^2 / 24 of what is in the fastest librations, 0.15 rad a step; it does not
       drift */
    CHECK_AT_MOST(e.spread, 0.02 * 3 * n * kT);
    CHECK_AT_MOST(fabs(e.last - e.first), 0.004 * 3 * n * kT);
    check_beside_sweeps(&from_here, 0.01, steps, e.last - e.first, 3 * n * kT);
    nve_free(&s), nve_free(&from_here);
    mixture_free(&m);
}

/** A peptide's springs for bonds that are not constrained, soft repulsion between all its atoms, and a weak trap. */
typedef struct springs {
    int64_t n;
    int64_t *pairs;
    double *length, *centre;
} springs;

static double elastic(const void *of_what, int64_t n_atoms, const double *r, double *f)
{
    const springs *s = of_what;
    double energy = 0;
    for (int64_t k = 0; k < s->n; ++k) {
        const int64_t i = 3 * s->pairs[2 * k], j = 3 * s->pairs[2 * k + 1];
        double d[3], q = 0;
        for (int x = 0; x < 3; ++x) {
            d[x] = r[j + x] - r[i + x];
            q += d[x] * d[x];
        }
        const double strain = sqrt(q) - s->length[k], stiffness = 1000;
        energy += stiffness / 2 * strain * strain;
        for (int x = 0; x < 3; ++x) {
            f[i + x] += stiffness * strain * d[x] / sqrt(q);
            f[j + x] -= stiffness * strain * d[x] / sqrt(q);
        }
    }
    for (int64_t i = 0; i < n_atoms; ++i)
        for (int64_t j = i + 1; j < n_atoms; ++j) {
            double d[3], q = 0;
            for (int x = 0; x < 3; ++x) {
                d[x] = r[3 * j + x] - r[3 * i + x];
                q += d[x] * d[x];
            }
            const double u = 8 * exp(-q / 2);
            energy += u;
            for (int x = 0; x < 3; ++x) {
                f[3 * i + x] -= u * d[x];
                f[3 * j + x] += u * d[x];
            }
        }
    for (int64_t i = 0; i < 3 * n_atoms; ++i) {
        energy += (r[i] - s->centre[i]) * (r[i] - s->centre[i]) / 2;
        f[i] -= r[i] - s->centre[i];
    }
    return energy;
}

/** Bonds of a molecule that have a light end stay, the others become springs, if light_alone; otherwise all stay. */
static springs split(molecule *m, int light_alone)
{
    springs s = {0, calloc(2 * (size_t)m->n_bonds, sizeof(int64_t)), calloc((size_t)m->n_bonds, sizeof(double)),
                 copy_of(m->r, 3 * (size_t)m->n_atoms)};
    int64_t kept = 0;
    for (int64_t k = 0; k < m->n_bonds; ++k) {
        const int64_t i = m->pairs[2 * k], j = m->pairs[2 * k + 1];
        const int stays = !light_alone || fmin(m->mass[i], m->mass[j]) < 2;
        int64_t *pairs = stays ? m->pairs + 2 * kept : s.pairs + 2 * s.n;
        (stays ? m->length + kept : s.length + s.n)[0] = m->length[k];
        pairs[0] = i;
        pairs[1] = j;
        if (stays)
            ++kept;
        else
            ++s.n;
    }
    m->n_bonds = kept;
    return s;
}

static void run_peptide(int light_alone, double dt)
{
    molecule part = molecule_make(MOLECULE_PEPTIDE, 6, 3);
    springs s = split(&part, light_alone);
    for (int64_t i = 0; i < 3 * part.n_atoms; ++i) part.v[i] *= sqrt(kT);
    mixture m = mixture_make(&part, 1, ONE_AFTER_THE_OTHER, 0);
    nve n = start(&m, elastic, &s);
    const double scale = 1.5 * (double)part.n_atoms * kT;
    nve_run(&n, dt, quick_run() ? 20 : 200);
    const int steps = quick_run() ? 50 : 2000;
    nve from_here = nve_with_sweeps(&n, 0);
    const energy_record e = nve_run(&n, dt, steps);
    print_message(
        "peptide, %d atoms, %d molecules: energy %.6f, later %.6f, spread %.2g of %.3g; lengths within %.2f\n",
        (int)part.n_atoms, (int)hol_chains_n_molecules(m.chains), e.first, e.last, e.spread, scale, n.worst_length);
    CHECK_AT_MOST(n.worst_length, 8);
    CHECK_AT_MOST(e.spread, 0.02 * scale);
    CHECK_AT_MOST(fabs(e.last - e.first), 0.004 * scale);
    check_beside_sweeps(&from_here, dt, steps, e.last - e.first, scale);
    nve_free(&n), nve_free(&from_here);
    free(s.pairs), free(s.length), free(s.centre);
    mixture_free(&m);
    molecule_free(&part);
}

static void a_protein_with_rigid_hydrogens_keeps_its_energy_and_its_bonds(void **state)
{
    (void)state;
    run_peptide(1, 0.01);
}

static void a_protein_with_all_bonds_rigid_keeps_its_energy_and_its_bonds(void **state)
{
    (void)state;
    run_peptide(0, 0.01);
}

/** A path of six atoms with rigid angles, and one triangle. */
static void run_rigid_angle(double degrees, double dt)
{
    for (int shape = 0; shape < 2; ++shape) {
        molecule part = molecule_make(MOLECULE_TRIANGLES_179, shape ? 6 : 3, 5);
        const double bend = 3.14159265358979323846 * (180 - degrees) / 180;
        double u[3] = {1, 0, 0}, side[3] = {0, 1, 0};
        for (int64_t i = 1; i < part.n_atoms; ++i) { /* bends in turn about y and z: no plane holds all atoms */
            for (int x = 0; x < 3; ++x) {
                part.r[3 * i + x] = part.r[3 * i - 3 + x] + 1.5 * u[x];
                u[x] = cos(bend) * u[x] + sin(bend) * side[x];
            }
            double along = 0, size = 0, next[3] = {0, i % 2 ? 0 : 1, i % 2 ? 1 : 0};
            for (int x = 0; x < 3; ++x) along += next[x] * u[x];
            for (int x = 0; x < 3; ++x) {
                side[x] = next[x] - along * u[x];
                size += side[x] * side[x];
            }
            for (int x = 0; x < 3; ++x) side[x] /= sqrt(size);
        }
        random_stream stream = random_seed(7);
        molecule_finish(&part, &stream);
        springs s = split(&part, 0);
        mixture m = mixture_make(&part, 1, ONE_AFTER_THE_OTHER, 0);
        nve n = start(&m, elastic, &s);
        const double kinetic = nve_kinetic(&n);
        double *r0 = copy_of(n.r, mixture_size(&m));
        const energy_record e = nve_run(&n, dt, quick_run() ? 40 : 1000);
        print_message("%g degrees, %d atoms: energy %.6f, later %.6f, spread %.2g of %.3g; lengths within %.2f\n",
                      degrees, (int)part.n_atoms, e.first, e.last, e.spread, kinetic, n.worst_length);
        CHECK_AT_MOST(n.worst_length, 8);
        CHECK_AT_MOST(e.spread, 1e-3 * (kinetic + 1));
        CHECK_AT_MOST(fabs(e.last - e.first), 2e-4 * (kinetic + 1));
        /* backwards: the integrator is reversible, so what comes back differs by rounding, which grows with the
         * stiffness */
        for (size_t i = 0; i < mixture_size(&m); ++i) n.v[i] = -n.v[i];
        nve_run(&n, dt, quick_run() ? 40 : 1000);
        for (size_t i = 0; i < mixture_size(&m); ++i) CHECK_AT_MOST(fabs(n.r[i] - r0[i]), 1e-6);
        free(r0);
        nve_free(&n);
        free(s.pairs), free(s.length), free(s.centre);
        mixture_free(&m);
        molecule_free(&part);
    }
}

static void rigid_angles_up_to_179_9_degrees_keep_energy_and_bonds_and_run_backwards(void **state)
{
    (void)state;
    run_rigid_angle(150, 0.01);
    run_rigid_angle(170, 0.01);
    run_rigid_angle(175, 0.005);
    run_rigid_angle(179, 0.001);
    run_rigid_angle(179.9, 0.0001);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rigid_water_keeps_its_energy_and_its_bonds),
        cmocka_unit_test(a_protein_with_rigid_hydrogens_keeps_its_energy_and_its_bonds),
        cmocka_unit_test(a_protein_with_all_bonds_rigid_keeps_its_energy_and_its_bonds),
        cmocka_unit_test(rigid_angles_up_to_179_9_degrees_keep_energy_and_bonds_and_run_backwards),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
