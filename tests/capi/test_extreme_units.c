/**
 * Units far from ordinary ones, of molecules of every shape: what is answered has the bits that it has in ordinary
 * units, times a power of two; all else is HOL_ERR_NOT_FINITE, and nothing is written.
 */
#include "check.h"
#include "large.h"
#include "mixture.h"

/** Powers of two: lengths, masses and times are in units of 2^-length and so on. */
typedef struct powers {
    int length, mass, time;
} powers;

static double *scaled(const double *a, size_t n, int e)
{
    double *b = copy_of(a, n);
    for (size_t i = 0; i < n; ++i) b[i] = ldexp(a[i], e);
    return b;
}

typedef enum verb { FORCES, SOLVE, VELOCITIES, POSITIONS, METRIC, N_VERBS } verb;

/** What a call writes, beside what was there before. */
typedef struct results {
    int status;
    double *r, *v, *g, *lambda, *tension, virial[9];
} results;

static void release(results *x)
{
    free(x->r), free(x->v), free(x->g), free(x->lambda), free(x->tension);
}

/** In these units; `with_lengths`: the molecules were added with lengths in them, too. */
static results call(const mixture *m, hol_chains *chains, verb which, powers p)
{
    const size_t size = mixture_size(m), n = (size_t)m->n_bonds;
    const int speed = p.length - p.time, force = p.mass + p.length - 2 * p.time;
    double *r = scaled(m->r, size, p.length), *v = scaled(m->v, size, speed), *f = scaled(m->f, size, force);
    double *rhs = scaled(m->length, n, 2 * p.length - 2 * p.time), *drifted = mixture_drifted(m, 1e-3);
    results x = {
        0,  scaled(drifted, size, p.length), scaled(m->v, size, speed), untouched(size), untouched(n), untouched(n),
        {0}};
    for (int i = 0; i < 9; ++i) x.virial[i] = -77;
    if (which == FORCES) x.status = hol_forces(chains, r, v, f, x.lambda, x.tension, x.g, HOL_WRITE, x.virial);
    if (which == SOLVE) x.status = hol_solve(chains, r, rhs, x.lambda, x.g, HOL_WRITE, x.virial);
    if (which == VELOCITIES) x.status = hol_project_velocities(chains, r, x.v, x.lambda, x.virial);
    if (which == POSITIONS)
        x.status = hol_project_positions(chains, r, x.r, x.v, ldexp(1e-3, p.time), x.lambda, 0, x.virial, NULL);
    if (which == METRIC) x.status = hol_metric(chains, r, 1, x.lambda, NULL, NULL, x.g, HOL_WRITE);
    free(r), free(v), free(f), free(rhs), free(drifted);
    return x;
}

/** Numbers that no kernel has written stand as they were, in units or not. */
static int is_scaled(const double *a, const double *b, size_t n, int e)
{
    double *mark = untouched(1);
    int same = 1;
    for (size_t i = 0; i < n && same; ++i) {
        const double expected = memcmp(a + i, mark, sizeof *mark) == 0 ? a[i] : ldexp(a[i], e);
        same = memcmp(&expected, b + i, sizeof expected) == 0 || (isnan(expected) && isnan(b[i]));
    }
    free(mark);
    return same;
}

/** Sums over molecules may be added in another order. */
static int is_nearly_scaled(const double *a, const double *b, int e)
{
    double largest = 0, worst = 0;
    for (int i = 0; i < 9; ++i) {
        largest = fmax(largest, fabs(ldexp(a[i], e)));
        worst = fmax(worst, fabs(ldexp(a[i], e) - b[i]));
    }
    return worst <= 1e-12 * largest;
}

static int is_finite_scaled(const double *a, size_t n, int e)
{
    for (size_t i = 0; i < n; ++i)
        if (isfinite(a[i]) && !isfinite(ldexp(a[i], e))) return 0;
    return 1;
}

/** Returns whether it was answered. */
static int compare(const mixture *m, hol_chains *chains, verb which, powers p, const results *ordinary,
                   const char *name)
{
    const size_t size = mixture_size(m), n = (size_t)m->n_bonds;
    const int speed = p.length - p.time, force = p.mass + p.length - 2 * p.time;
    const int multiplier = which == METRIC ? 0 : which == VELOCITIES ? p.mass - p.time : p.mass - 2 * p.time;
    const int on_atoms = which == METRIC ? -p.length : force;
    const int energy = force + p.length + (which == VELOCITIES ? p.time : 0);
    const results a = *ordinary;
    results b = call(m, chains, which, p);
    int answered = 0;
    if (a.status == HOL_OK && b.status == HOL_OK) {
        answered = 1;
        if (!(is_scaled(a.r, b.r, size, p.length) && is_scaled(a.v, b.v, size, speed) &&
              is_scaled(a.g, b.g, size, on_atoms) && is_scaled(a.lambda, b.lambda, n, multiplier) &&
              is_scaled(a.tension, b.tension, n, force) &&
              is_nearly_scaled(a.virial, b.virial, which == METRIC ? 0 : energy)))
            fail_msg("%s, verb %d, lengths 2^%d, masses 2^%d, times 2^%d: other bits", name, (int)which, p.length,
                     p.mass, p.time);
    } else if (a.status == HOL_OK) {
        if (b.status != HOL_ERR_NOT_FINITE)
            fail_msg("%s, verb %d, lengths 2^%d, masses 2^%d, times 2^%d: %s: %s", name, (int)which, p.length, p.mass,
                     p.time, hol_status_name(b.status), hol_error_message());
        /* molecules are complete where it is their sum that overflows */
        if (is_finite_scaled(a.virial, 9, energy)) {
            assert_untouched(b.g, size);
            assert_untouched(b.lambda, n);
        }
        for (int i = 0; i < 9; ++i) assert_true(b.virial[i] == -77);
    }
    release(&b);
    return answered;
}

static hol_chains *chains_of(const mixture *m, powers p)
{
    hol_chains *chains;
    double *mass = scaled(m->mass, (size_t)m->n_atoms, p.mass);
    double *length = scaled(m->length, (size_t)m->n_bonds, p.length);
    CHECK(hol_chains_create(m->n_atoms, mass, &chains));
    CHECK(hol_chains_add_bonds(chains, m->n_bonds, m->pairs, length));
    CHECK(hol_chains_set_checks(chains, HOL_NEVER));
    free(mass), free(length);
    return chains;
}

/** Handles in these units, at all levels. `ordinary`: the results in the mixture's own. */
static void check_units(const mixture *m, const results *ordinary, const char *name)
{
    static const powers units[] = {{-33, -86, -50}, {0, -340, 0},   {0, -344, 0},   {0, -400, 0},    {0, 356, 0},
                                   {120, -240, 0},  {128, -256, 0}, {88, -176, 20}, {-256, 0, 0},    {-264, 0, -30},
                                   {-300, 0, 0},    {-140, 280, 0}, {0, 600, 100},  {0, 700, 100},   {-96, 564, 60},
                                   {-306, 360, 0},  {400, -300, 0}, {-450, 100, 0}, {450, -900, -8}, {480, 300, 250}};
    int answered = 0;
    for (size_t u = 0; u < sizeof units / sizeof *units; u += quick_run() ? 7 : 1) {
        hol_chains *chains = chains_of(m, units[u]);
        for (int which = 0; which < N_VERBS; ++which)
            answered += compare(m, chains, (verb)which, units[u], &ordinary[which], name);
        hol_chains_destroy(chains);
    }
    if (answered < (quick_run() ? 6 : 60)) fail_msg("%s: %d calls have been answered", name, answered);
}

/** Positions in other units than the lengths, which forces and velocities do not look at. */
static void check_bonds(const mixture *m, const results *ordinary, const char *name)
{
    int answered = 0;
    for (int e = -480; e <= 480; e += quick_run() ? 160 : 20) {
        const powers p = {e, 0, 0};
        for (int which = FORCES; which <= VELOCITIES; ++which)
            answered += compare(m, m->chains, (verb)which, p, &ordinary[which], name);
    }
    if (answered < (quick_run() ? 6 : 60)) fail_msg("%s: %d calls have been answered", name, answered);
}

/** Alone, and with so many others like it. */
static void check_molecule(molecule m, int others, const char *name)
{
    molecule parts[5] = {m, m, m, m, m};
    for (int n = 1; n <= 1 + others; n += others) {
        mixture x = mixture_make(parts, n, n > 1 ? MIXED : ONE_AFTER_THE_OTHER, 7);
        results ordinary[N_VERBS];
        CHECK(hol_chains_set_checks(x.chains, HOL_NEVER));
        for (int which = 0; which < N_VERBS; ++which)
            ordinary[which] = call(&x, x.chains, (verb)which, (powers){0, 0, 0});
        check_units(&x, ordinary, name);
        check_bonds(&x, ordinary, name);
        for (int which = 0; which < N_VERBS; ++which) release(&ordinary[which]);
        mixture_free(&x);
    }
    molecule_free(&m);
}

static void small_molecules(void **state)
{
    (void)state;
    for (int kind = 0; kind < MOLECULE_GOOD_KINDS; ++kind)
        check_molecule(molecule_make((molecule_kind)kind, kind == MOLECULE_DENDRIMER ? 2 : 6, 3), 4,
                       molecule_kind_name((molecule_kind)kind));
}

static void chains(void **state)
{
    (void)state;
    static const int64_t bonds[] = {1, 2, 3, 4, 5, 8, 32, 100, 300, 600};
    for (size_t i = 0; i < sizeof bonds / sizeof *bonds; ++i) {
        char name[40];
        snprintf(name, sizeof name, "chain of %d", (int)bonds[i]);
        check_molecule(molecule_make(MOLECULE_CHAIN, bonds[i], 11 + i), 4, name);
    }
}

static void large_molecules(void **state)
{
    (void)state;
    if (quick_run()) return;
    check_molecule(molecule_make(MOLECULE_RING, 300, 5), 1, "ring of 300");
    check_molecule(large_arms(300, 306, 2), 1, "arms");
    check_molecule(large_segments(1200, 150, 0, 3), 1, "segments");
    check_molecule(large_segments(1200, 150, 40, 3), 1, "segments with rings");
    check_molecule(large_comb(1200), 1, "comb");
    check_molecule(large_rings(900), 1, "rings");
    check_molecule(large_ladder(300), 1, "ladder");
}

/** Every third molecule is in units of its own. */
static void molecules_in_different_units_stand_side_by_side(void **state)
{
    (void)state;
    enum { N = 99 };
    for (int kind = MOLECULE_CHAIN; kind <= MOLECULE_XH4; ++kind) {
        mixture m = mixture_of_kind((molecule_kind)kind, N, 2, 2, ONE_AFTER_THE_OTHER, 3);
        const size_t size = mixture_size(&m), n = (size_t)m.n_bonds;
        double *r = copy_of(m.r, size), *mass = copy_of(m.mass, (size_t)m.n_atoms), *g = untouched(size);
        double *expected = untouched(size), *lambda = untouched(n);
        CHECK(hol_forces(m.chains, m.r, NULL, m.f, NULL, NULL, expected, HOL_WRITE, NULL));
        for (int64_t i = 0; i < m.n_atoms; ++i) {
            const int64_t part = i / (m.n_atoms / N);
            mass[i] = ldexp(mass[i], part % 3 == 0 ? -500 : 0);
            for (int c = 0; c < 3; ++c) r[3 * i + c] = ldexp(r[3 * i + c], part % 3 == 1 ? 300 : 0);
        }
        CHECK(hol_chains_set_masses(m.chains, mass));
        CHECK(hol_forces(m.chains, r, NULL, m.f, lambda, NULL, g, HOL_WRITE, NULL));
        assert_same_bits(g, expected, size);
        free(r), free(mass), free(g), free(expected), free(lambda);
        mixture_free(&m);
    }
}

/** Lengths that differ by many decades, beside the exact solution. */
static void bonds_of_1e80_and_1e100_are_right(void **state)
{
    (void)state;
    const double mass[3] = {1, 1, 1}, length[2] = {1, 1}, f[9] = {1, 2, 3, 5, 1, 2, 2.5, 3, 1};
    const double r[9] = {0, 0, 0, 1e80, 3e79, 2e79, 5e79, 1e80, 7e79};
    const int64_t atoms[3] = {0, 1, 2};
    hol_chains *chains;
    double lambda[2];
    CHECK(hol_chains_create(3, mass, &chains));
    CHECK(hol_chains_add(chains, 2, atoms, length));
    CHECK(hol_forces(chains, r, NULL, f, lambda, NULL, NULL, HOL_WRITE, NULL));
    long double d[2][3], Z[2][2], b[2] = {0, 0};
    for (int k = 0; k < 2; ++k)
        for (int c = 0; c < 3; ++c) {
            d[k][c] = ((long double)r[3 * k + 3 + c] - r[3 * k + c]) * 1e-80L; /* in units of 1e80 */
            b[k] += 2 * d[k][c] * ((long double)f[3 * k + 3 + c] - f[3 * k + c]);
        }
    for (int k = 0; k < 2; ++k)
        for (int l = 0; l < 2; ++l)
            Z[k][l] = (k == l ? 8 : -4) * (d[k][0] * d[l][0] + d[k][1] * d[l][1] + d[k][2] * d[l][2]);
    const long double det = Z[0][0] * Z[1][1] - Z[0][1] * Z[1][0];
    CHECK_AT_MOST(fabsl(lambda[0] * 1e80L / ((b[0] * Z[1][1] - b[1] * Z[0][1]) / det) - 1), 1e-14L);
    CHECK_AT_MOST(fabsl(lambda[1] * 1e80L / ((b[1] * Z[0][0] - b[0] * Z[1][0]) / det) - 1), 1e-14L);
    /* nearly antiparallel, to 1e-100: by fractions */
    const double far[9] = {0, 0, 0, 1e100, .3, .2, .5, 1, .7};
    CHECK(hol_forces(chains, far, NULL, f, lambda, NULL, NULL, HOL_WRITE, NULL));
    CHECK_AT_MOST(fabs(lambda[0] / 9.166666666666666e-101 - 1), 1e-14);
    CHECK_AT_MOST(fabs(lambda[1] / 1.6666666666666665e-101 - 1), 1e-14);
    hol_chains_destroy(chains);
}

static void a_virial_that_overflows_is_refused(void **state)
{
    (void)state;
    const double mass[3] = {1, 1, 1}, length[2] = {1e120, 1e120}, r[9] = {0, 0, 0, 1e120, 0, 0, 1e120, 1e120, 0};
    const double f[9] = {0, 0, 0, 1e250, 0, 0, 0, 1e250, 0}, rhs[2] = {1e300, 1e300};
    const int64_t atoms[3] = {0, 1, 2};
    double virial[9], sixes[12];
    hol_chains *chains;
    CHECK(hol_chains_create(3, mass, &chains));
    CHECK(hol_chains_add(chains, 2, atoms, length));
    for (int i = 0; i < 9; ++i) virial[i] = 5;
    CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_forces(chains, r, NULL, f, NULL, NULL, NULL, HOL_WRITE, virial));
    assert_message_names("virial");
    double lambda[2] = {1e100, 1e100};
    CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_reactions(chains, r, HOL_BOX, lambda, NULL, NULL, HOL_WRITE, sixes, virial));
    CHECK(hol_solve(chains, r, rhs, lambda, NULL, HOL_WRITE, NULL));
    double v[9] = {0, 0, 0, 1e200, 0, 0, 0, 1e200, 0};
    CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_project_velocities(chains, r, v, NULL, virial));
    for (int i = 0; i < 9; ++i) assert_true(virial[i] == 5);
    hol_chains_destroy(chains);
}

/** Multipliers of an infinite bond would be zero. */
static void an_infinite_position_is_named_by_every_verb(void **state)
{
    (void)state;
    const double bad[] = {INFINITY, -INFINITY, NAN};
    for (int64_t n = 1; n <= 12; ++n)
        for (int copies = 1; copies <= 5; copies += 4) {
            const molecule one = molecule_make(MOLECULE_CHAIN, n, 5);
            molecule parts[5] = {one, one, one, one, one};
            mixture m = mixture_make(parts, copies, ONE_AFTER_THE_OTHER, 1);
            CHECK(hol_chains_set_checks(m.chains, HOL_NEVER));
            for (int64_t at = 0; at <= n; ++at)
                for (int b = 0; b < 3; ++b) {
                    double *const x = m.r + 3 * (at + (copies / 2) * (n + 1)) + b, kept = *x;
                    *x = bad[b];
                    for (int which = 0; which < N_VERBS; ++which) {
                        results y = call(&m, m.chains, (verb)which, (powers){0, 0, 0});
                        int64_t atom = -1;
                        hol_error_location(NULL, NULL, &atom, NULL);
                        assert_int_equal(y.status, HOL_ERR_NOT_FINITE);
                        assert_int_equal(atom, at + (copies / 2) * (n + 1));
                        release(&y);
                    }
                    *x = kept;
                }
            mixture_free(&m);
            molecule_free(parts);
        }
}

/** Bonds longer than lengths may be, wherever they stand: their multipliers would be zero by overflow. */
static void bonds_beyond_lengths_are_refused(void **state)
{
    (void)state;
    static const int64_t bonds[] = {1, 2, 5, 30, 257, 300, 1500};
    for (size_t b = 0; b < sizeof bonds / sizeof *bonds; ++b) {
        const int64_t n = bonds[b];
        molecule one = molecule_make(MOLECULE_CHAIN, n, 7);
        mixture m = mixture_make(&one, 1, ONE_AFTER_THE_OTHER, 1);
        const int64_t places[] = {0, 1, n / 3, n / 2, n - 1, n};
        for (size_t p = 0; p < sizeof places / sizeof *places; ++p)
            for (double far = 1e156; far < 1e300; far *= 1e70) {
                double *const x = m.r + 3 * places[p] + 1, kept = *x;
                *x = far;
                for (int which = FORCES; which <= VELOCITIES; ++which) {
                    results y = call(&m, m.chains, (verb)which, (powers){0, 0, 0});
                    assert_int_equal(y.status, HOL_ERR_NOT_FINITE);
                    release(&y);
                }
                *x = kept;
            }
        mixture_free(&m);
        molecule_free(&one);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(small_molecules),
        cmocka_unit_test(chains),
        cmocka_unit_test(large_molecules),
        cmocka_unit_test(molecules_in_different_units_stand_side_by_side),
        cmocka_unit_test(bonds_of_1e80_and_1e100_are_right),
        cmocka_unit_test(a_virial_that_overflows_is_refused),
        cmocka_unit_test(an_infinite_position_is_named_by_every_verb),
        cmocka_unit_test(bonds_beyond_lengths_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
