/**
 * A status and a number of iterations for each molecule: those that a call gives in which all other molecules are
 * inactive. Results are the same bits as without.
 */
#include "check.h"
#include "mixture.h"

static int *untold(int64_t n)
{
    int *list = malloc((size_t)n * sizeof *list);
    for (int64_t i = 0; i < n; ++i) list[i] = -99;
    return list;
}

typedef enum verb { FORCES, VELOCITIES, POSITIONS, SOLVE, METRIC, IMPOSE, N_VERBS } verb;

/** What a call writes. */
typedef struct results {
    double *per_bond, *r, *v;
    hol_report report;
    int status;
} results;

static results call(const mixture *m, verb which, const double *trial)
{
    const size_t n = (size_t)m->n_bonds, size = mixture_size(m);
    results x = {untouched(n), copy_of(which == POSITIONS ? trial : m->r, size), copy_of(m->v, size), {0}, 0};
    double *rhs = copy_of(m->length, n), *log_det = untouched((size_t)hol_chains_n_molecules(m->chains)), energy;
    if (which == FORCES) x.status = hol_forces(m->chains, m->r, m->v, m->f, x.per_bond, NULL, x.v, HOL_WRITE, NULL);
    if (which == VELOCITIES) x.status = hol_project_velocities(m->chains, m->r, x.v, x.per_bond, NULL);
    if (which == POSITIONS)
        x.status = hol_project_positions(m->chains, m->r, x.r, x.v, 0.01, x.per_bond, 0, NULL, &x.report);
    if (which == SOLVE) x.status = hol_solve(m->chains, m->r, rhs, x.per_bond, x.v, HOL_WRITE, NULL);
    if (which == METRIC) x.status = hol_metric(m->chains, m->r, 1, log_det, NULL, &energy, x.v, HOL_WRITE);
    if (which == IMPOSE) x.status = hol_impose(m->chains, x.r, &x.report);
    free(rhs), free(log_det);
    return x;
}

static void release(results *x)
{
    free(x->per_bond), free(x->r), free(x->v);
}

/** All molecules by one call, and each of them alone, in a call that finds the others inactive. */
static int64_t compare(const mixture *m, verb which, const double *trial)
{
    const int64_t n = hol_chains_n_molecules(m->chains);
    int *status = untold(n), *iterations = untold(n);
    CHECK(hol_chains_set_outcomes(m->chains, 0));
    results plain = call(m, which, trial);
    CHECK(hol_chains_set_outcomes(m->chains, 1));
    results kept = call(m, which, trial);
    assert_int_equal(kept.status, plain.status);
    assert_same_bits(kept.per_bond, plain.per_bond, (size_t)m->n_bonds);
    assert_same_bits(kept.r, plain.r, mixture_size(m));
    assert_same_bits(kept.v, plain.v, mixture_size(m));
    if (which == POSITIONS || which == IMPOSE) {
        /* Side by side with a bad molecule its solves count, too. */
        assert_true(plain.status ? kept.report.iterations <= plain.report.iterations
                                 : kept.report.iterations == plain.report.iterations);
        assert_int_equal(kept.report.n_corrected, plain.report.n_corrected);
        assert_int_equal(kept.report.n_failed, plain.report.n_failed);
    }
    CHECK(hol_outcomes(m->chains, status, iterations));
    release(&plain), release(&kept);

    CHECK(hol_chains_set_outcomes(m->chains, 0));
    unsigned char *active = calloc((size_t)n, 1);
    int64_t n_bad = 0;
    for (int64_t i = 0; i < n; ++i) {
        active[i] = 1;
        CHECK(hol_chains_set_active(m->chains, active));
        active[i] = 0;
        results alone = call(m, which, trial);
        if (alone.status != status[i])
            fail_msg("verb %d, molecule %d: %s instead of %s", (int)which, (int)i, hol_status_name(status[i]),
                     hol_status_name(alone.status));
        if (alone.status == HOL_OK && alone.report.iterations != iterations[i])
            fail_msg("verb %d, molecule %d: %d iterations instead of %d", (int)which, (int)i, iterations[i],
                     (int)alone.report.iterations);
        n_bad += alone.status != HOL_OK;
        release(&alone);
    }
    CHECK(hol_chains_set_active(m->chains, NULL));
    free(active), free(status), free(iterations);
    return n_bad;
}

/** Some molecules are spoilt, each in its way. */
static int64_t spoil(mixture *m, double *trial)
{
    int64_t n = 0;
    for (int64_t part = 1; part < m->n_parts; part += 3, ++n) {
        const molecule *p = m->parts + part;
        const int64_t *atoms = m->atoms + m->first_atom[part];
        const int64_t i = 3 * atoms[p->pairs[0]], j = 3 * atoms[p->pairs[1]];
        if (n % 4 == 0) m->r[j + 1] = NAN;
        if (n % 4 == 1) memcpy(m->r + j, m->r + i, 3 * sizeof *m->r);
        if (n % 4 == 2) trial[j] += 3 * m->length[m->bonds[m->first_bond[part]]];
        if (n % 4 == 3) trial[j] += 100 * m->length[m->bonds[m->first_bond[part]]];
    }
    return n;
}

static void check_scene(mixture m, int n_threads)
{
    double *trial = mixture_drifted(&m, 0.01);
    CHECK(hol_chains_set_threads(m.chains, n_threads));
    CHECK(hol_chains_set_checks(m.chains, HOL_NEVER)); /* who is inactive changes what a first step is */
    for (int which = 0; which < N_VERBS; ++which) compare(&m, (verb)which, trial);
    const int64_t spoilt = spoil(&m, trial);
    for (int which = 0; which < N_VERBS; ++which) {
        const int64_t n_bad = compare(&m, (verb)which, trial);
        assert_true(n_bad > spoilt / 4);
    }
    free(trial);
    mixture_free(&m);
}

static void every_bad_molecule_is_named(void **state)
{
    (void)state;
    const int64_t copies = quick_run() ? 1 : 3;
    check_scene(mixture_of_all(copies, ONE_AFTER_THE_OTHER, 1), 1);
    check_scene(mixture_of_all(copies, MIXED, 2), 2);
}

static void alike_molecules_have_outcomes_of_their_own(void **state)
{
    (void)state;
    for (int kind = 0; kind < MOLECULE_GOOD_KINDS; kind += quick_run() ? 5 : 1)
        check_scene(mixture_of_kind((molecule_kind)kind, 9, 5, 5, ONE_AFTER_THE_OTHER, (uint64_t)kind), 1);
}

/** Three chains, of which one is so long that several threads share it. */
static void long_chains_too(void **state)
{
    (void)state;
    enum { N = 40000, M = 700 };
    const int64_t n_atoms = N + M + 2;
    double *mass = malloc((size_t)n_atoms * sizeof *mass), *length = malloc(N * sizeof *length);
    double *r = calloc(3 * (size_t)n_atoms, sizeof *r);
    for (int64_t i = 0; i < n_atoms; ++i) {
        mass[i] = 1;
        r[3 * i] = (double)(i / 2 + i % 2);
        r[3 * i + 1] = (double)(i / 2);
        if (i < N) length[i] = 1;
    }
    hol_chains *chains;
    CHECK(hol_chains_create(n_atoms, mass, &chains));
    CHECK(hol_chains_add_block(chains, 1, N, 0, length));
    CHECK(hol_chains_add_block(chains, 1, M, N + 1, length));
    CHECK(hol_chains_set_outcomes(chains, 1));
    for (int n_threads = 1; n_threads <= 2; ++n_threads) {
        int status[2], iterations[2];
        CHECK(hol_chains_set_threads(chains, n_threads));
        double *trial = copy_of(r, 3 * (size_t)n_atoms);
        for (int64_t i = 0; i < 3 * (N + 1); ++i) trial[i] += 1e-3 * (double)(i % 7);
        hol_report report;
        CHECK(hol_project_positions(chains, r, trial, NULL, 1, NULL, 0, NULL, &report));
        CHECK(hol_outcomes(chains, status, iterations));
        assert_int_equal(iterations[0], report.iterations);
        assert_int_equal(iterations[1], 0);
        const double was = r[3 * 1000];
        r[3 * 1000] = NAN;
        CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_project_velocities(chains, r, trial, NULL, NULL));
        CHECK(hol_outcomes(chains, status, NULL));
        assert_int_equal(status[0], HOL_ERR_NOT_FINITE);
        assert_int_equal(status[1], HOL_OK);
        r[3 * 1000] = was;
        free(trial);
    }
    hol_chains_destroy(chains);
    free(mass), free(length), free(r);
}

/** Dimers, of which some come with wrong lengths: all are named, and nothing is moved. */
static void a_first_step_names_all_that_do_not_fit(void **state)
{
    (void)state;
    enum { N = 9 };
    double mass[2 * N], length[1] = {1}, r[2 * N][3] = {{0}};
    for (int i = 0; i < 2 * N; ++i) mass[i] = 1, r[i][0] = i % 2 * (i / 2 % 4 == 1 ? 1.5 : 1), r[i][1] = 3.0 * (i / 2);
    hol_chains *chains;
    int status[N];
    CHECK(hol_chains_create(2 * N, mass, &chains));
    CHECK(hol_chains_add_block(chains, N, 1, 0, length));
    CHECK(hol_chains_set_outcomes(chains, 1));
    CHECK_FAILS(HOL_ERR_LENGTHS, hol_project_positions(chains, r[0], r[0], NULL, 1, NULL, 0, NULL, NULL));
    CHECK(hol_outcomes(chains, status, NULL));
    for (int i = 0; i < N; ++i) assert_int_equal(status[i], i % 4 == 1 ? HOL_ERR_LENGTHS : HOL_OK);

    for (int i = 0; i < 2 * N; ++i) r[i][0] = i % 2;
    double trial[2 * N][3];
    memcpy(trial, r, sizeof r);
    CHECK(hol_project_positions(chains, r[0], trial[0], NULL, 1, NULL, 0, NULL, NULL));
    for (int i = 0; i < N; ++i) trial[2 * i][0] = i % 4 == 1 ? -7 : i % 4 == 2 ? NAN : 0.1;
    CHECK_FAILS(HOL_ERR_NO_CONVERGENCE, hol_project_positions(chains, r[0], trial[0], NULL, 1, NULL, 0, NULL, NULL));
    CHECK(hol_outcomes(chains, status, NULL));
    for (int i = 0; i < N; ++i)
        assert_int_equal(status[i], i % 4 == 1 ? HOL_ERR_NO_CONVERGENCE : i % 4 == 2 ? HOL_ERR_NOT_FINITE : HOL_OK);
    hol_chains_destroy(chains);
}

/** Carbon dioxide and chains with bad ones among both. */
static void rigid_bodies_too(void **state)
{
    (void)state;
    enum { N = 6 };
    const int64_t size = 3, atoms[3] = {0, 1, 2};
    const double places[9] = {-1, 0, 0, 0, 0, 0, 1, 0, 0}, length[2] = {1, 1};
    double mass[6 * N], r[6 * N][3] = {{0}}, trial[6 * N][3];
    for (int i = 0; i < 6 * N; ++i) mass[i] = 1 + i % 3, r[i][0] = i % 3, r[i][1] = 2.0 * (i / 3);
    hol_chains *chains;
    int status[2 * N], iterations[2 * N];
    CHECK(hol_chains_create(6 * N, mass, &chains));
    CHECK(hol_chains_add_block(chains, N, 2, 3 * N, length));
    CHECK(hol_chains_add_rigid_molecules(chains, N, 3, 0, 1, &size, atoms, places, 0, NULL, NULL));
    CHECK(hol_chains_set_outcomes(chains, 1));
    memcpy(trial, r, sizeof r);
    for (int i = 0; i < 6 * N; ++i) trial[i][1 + i % 2] += 0.1 * (i % 3 == 1);
    hol_report report;
    CHECK(hol_project_positions(chains, r[0], trial[0], NULL, 1, NULL, 0, NULL, &report));
    CHECK(hol_outcomes(chains, status, iterations));
    int most = 0;
    for (int i = 0; i < 2 * N; ++i) {
        assert_int_equal(status[i], HOL_OK);
        assert_true(iterations[i] > 0);
        if (iterations[i] > most) most = iterations[i];
    }
    assert_int_equal(most, report.iterations);
    r[3 * 2][0] = NAN;                               /* body 2, molecule N + 2 */
    r[3 * 4 + 1][2] = INFINITY;                      /* body 4 */
    memcpy(r[3 * N + 3], r[3 * N + 4], sizeof r[0]); /* chain 1 */
    double v[6 * N][3] = {{0}};
    CHECK_FAILS(HOL_ERR_DEGENERATE, hol_project_velocities(chains, r[0], v[0], NULL, NULL));
    CHECK(hol_outcomes(chains, status, iterations));
    for (int i = 0; i < 2 * N; ++i) {
        assert_int_equal(status[i], i == 1                     ? HOL_ERR_DEGENERATE
                                    : i == N + 2 || i == N + 4 ? HOL_ERR_NOT_FINITE
                                                               : HOL_OK);
        assert_int_equal(iterations[i], 0);
    }
    hol_chains_destroy(chains);
}

static void outcomes_that_are_not_there_are_refused(void **state)
{
    (void)state;
    const double mass[4] = {1, 1, 1, 1}, length = 1, r[4][3] = {{0, 0, 0}, {1, 0, 0}, {3, 0, 0}, {4, 0, 0}};
    double g[4][3];
    int status[2];
    hol_chains *chains, *other;
    CHECK(hol_chains_create(4, mass, &chains));
    CHECK(hol_chains_create(4, mass, &other));
    CHECK(hol_chains_add_block(chains, 1, 1, 0, &length));
    CHECK(hol_chains_add_block(other, 1, 1, 0, &length));
    CHECK_FAILS(HOL_ERR_NULL, hol_outcomes(NULL, status, NULL));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_set_outcomes(NULL, 1));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_outcomes(chains, 2));
    CHECK(hol_forces(chains, r[0], NULL, NULL, NULL, NULL, g[0], HOL_WRITE, NULL));
    CHECK_FAILS(HOL_ERR_STATE, hol_outcomes(chains, status, NULL)); /* not kept */
    CHECK(hol_chains_set_outcomes(chains, 1));
    CHECK(hol_chains_set_outcomes(other, 1));
    CHECK_FAILS(HOL_ERR_STATE, hol_outcomes(chains, status, NULL)); /* no call since */
    CHECK(hol_forces(chains, r[0], NULL, NULL, NULL, NULL, g[0], HOL_WRITE, NULL));
    CHECK(hol_outcomes(chains, status, NULL));
    CHECK(hol_outcomes(chains, NULL, NULL));
    CHECK_FAILS(HOL_ERR_STATE, hol_outcomes(other, status, NULL));
    CHECK_FAILS(HOL_ERR_VALUE, hol_metric(chains, r[0], -1, NULL, NULL, NULL, g[0], HOL_WRITE));
    CHECK_FAILS(HOL_ERR_STATE, hol_outcomes(chains, status, NULL)); /* that call did nothing */
    CHECK(hol_forces(chains, r[0], NULL, NULL, NULL, NULL, g[0], HOL_WRITE, NULL));
    CHECK(hol_chains_add_block(chains, 1, 1, 2, &length));
    CHECK_FAILS(HOL_ERR_STATE, hol_outcomes(chains, status, NULL)); /* there are more now */
    hol_chains_destroy(chains);
    hol_chains_destroy(other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_bad_molecule_is_named),
        cmocka_unit_test(alike_molecules_have_outcomes_of_their_own),
        cmocka_unit_test(long_chains_too),
        cmocka_unit_test(a_first_step_names_all_that_do_not_fit),
        cmocka_unit_test(rigid_bodies_too),
        cmocka_unit_test(outcomes_that_are_not_there_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
