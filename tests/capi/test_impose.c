/** Positions that lie anywhere are moved onto the constraints; and what is left of each constraint. */
#include "check.h"
#include "input.h"

enum { most_atoms = 40 };

/** Numbers in -1 .. 1, the same in every run. */
static double dice(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) / 4503599627370496.0 - 1;
}

typedef enum shape {
    CHAIN,
    TREE,
    RING,
    TRIANGLE,
    N_SHAPES,
    CAGE = N_SHAPES, /* as many distances as it has freedoms */
    ROD,             /* three distances on a line, which the library takes for a body */
    N_ALL_SHAPES
} shape;

/** A molecule with different masses, and bonds of 0.7 to 1.3 that it has in r. */
typedef struct molecule {
    int64_t n_atoms, n_bonds, pairs[2 * most_atoms];
    double mass[most_atoms], length[most_atoms], r[3 * most_atoms];
} molecule;

static molecule make(shape kind, int64_t n_atoms, uint64_t *state)
{
    molecule m = {.n_atoms = kind == TRIANGLE || kind == ROD ? 3 : n_atoms};
    for (int64_t i = 0; i < m.n_atoms; ++i) {
        m.mass[i] = 2 + dice(state);
        if (i == 0) continue;
        const int64_t parent = kind == TREE ? (i - 1) / 2 : i - 1;
        double u[3], square = 0;
        for (int c = 0; c < 3; ++c) {
            u[c] = dice(state);
            square += u[c] * u[c];
        }
        for (int c = 0; c < 3; ++c)
            m.r[3 * i + c] = m.r[3 * parent + c] + u[c] / sqrt(square) * (1 + 0.3 * dice(state));
        m.pairs[2 * m.n_bonds] = parent;
        m.pairs[2 * m.n_bonds++ + 1] = i;
    }
    if (kind == ROD)
        for (int c = 0; c < 3; ++c) m.r[6 + c] = m.r[c] + 2.5 * (m.r[3 + c] - m.r[c]);
    for (int64_t i = 2; kind == CAGE && i < m.n_atoms; ++i)
        for (int64_t j = 0; j < 2 && j < i - 1; ++j) { /* beside the one before it */
            m.pairs[2 * m.n_bonds] = j;
            m.pairs[2 * m.n_bonds++ + 1] = i;
        }
    if (kind == RING || kind == TRIANGLE || kind == ROD) {
        m.pairs[2 * m.n_bonds] = m.n_atoms - 1;
        m.pairs[2 * m.n_bonds++ + 1] = 0;
    }
    for (int64_t k = 0; k < m.n_bonds; ++k) {
        double square = 0;
        for (int c = 0; c < 3; ++c) {
            const double d = m.r[3 * m.pairs[2 * k + 1] + c] - m.r[3 * m.pairs[2 * k] + c];
            square += d * d;
        }
        m.length[k] = sqrt(square);
    }
    return m;
}

static hol_chains *handle_of(const molecule *m)
{
    hol_chains *chains;
    CHECK(hol_chains_create(m->n_atoms, m->mass, &chains));
    CHECK(hol_chains_add_bonds(chains, m->n_bonds, m->pairs, m->length));
    return chains;
}

/** Largest relative error of a square length; periods 0: no box. */
static double worst(const molecule *m, const double *r, double period)
{
    double found = 0;
    for (int64_t k = 0; k < m->n_bonds; ++k) {
        long double square = 0;
        for (int c = 0; c < 3; ++c) {
            long double d = (long double)r[3 * m->pairs[2 * k + 1] + c] - r[3 * m->pairs[2 * k] + c];
            if (period > 0) d -= period * roundl(d / period);
            square += d * d;
        }
        const long double a2 = (long double)m->length[k] * m->length[k];
        if (!(fabsl(square - a2) / a2 <= found)) found = (double)(fabsl(square - a2) / a2);
    }
    return found;
}

static void crude_positions_of_every_shape_get_their_lengths(void **state)
{
    (void)state;
    uint64_t dice_state = 1;
    int64_t refused = 0;
    for (int round = 0; round < 60; ++round)
        for (int kind = 0; kind < N_SHAPES; ++kind) {
            const molecule m = make((shape)kind, 5 + round % 30, &dice_state);
            hol_chains *chains = handle_of(&m);
            double r[3 * most_atoms], plain[3 * most_atoms], centre[3] = {0}, size = 0;
            for (int64_t i = 0; i < 3 * m.n_atoms; ++i) {
                r[i] = m.r[i] + 1.5 * dice(&dice_state);
                centre[i % 3] += m.mass[i / 3] * r[i];
                if (fabs(r[i]) > size) size = fabs(r[i]);
            }
            memcpy(plain, r, sizeof r);
            hol_report report;
            CHECK(hol_impose(chains, r, &report));
            /* coordinates round to eps times their size, against bonds of 0.7 */
            CHECK_AT_MOST(worst(&m, r, 0), 20 * DBL_EPSILON * (1 + size));
            CHECK_AT_MOST(report.max_error, 20 * DBL_EPSILON * (1 + size));
            assert_int_equal(report.n_corrected, 1);
            assert_int_equal(report.n_failed, 0);
            assert_in_range(report.iterations, 2, 30);
            /* No step moves the centre of mass. */
            for (int64_t i = 0; i < 3 * m.n_atoms; ++i) centre[i % 3] -= m.mass[i / 3] * r[i];
            for (int c = 0; c < 3; ++c) CHECK_AT_MOST(fabs(centre[c]), 1e-12 * size);
            /* What is right is not touched. */
            double again[3 * most_atoms];
            memcpy(again, r, sizeof r);
            CHECK(hol_impose(chains, again, &report));
            assert_same_bits(again, r, (size_t)(3 * m.n_atoms));
            assert_int_equal(report.n_corrected, 0);
            /* A projection does not always do it: that is what this is for. */
            CHECK(hol_chains_set_checks(chains, HOL_NEVER));
            refused += hol_project_positions(chains, plain, plain, NULL, 1, NULL, 0, NULL, NULL) != HOL_OK;
            hol_chains_destroy(chains);
        }
    assert_in_range(refused, 20, 240);
}

/**
 * SHAKE as programs have it, along the bonds of the positions as they come, or as they are in each round: does it bring
 * them home?
 */
static int shake(const molecule *m, double *r, int as_they_are)
{
    double reference[3 * most_atoms], worst_now = 1;
    memcpy(reference, r, sizeof reference);
    for (int round = 0; round < 20000 && worst_now > 1e-8; ++round) {
        worst_now = 0;
        if (as_they_are) memcpy(reference, r, sizeof reference);
        for (int64_t k = 0; k < m->n_bonds; ++k) {
            const int64_t i = m->pairs[2 * k], j = m->pairs[2 * k + 1];
            double square = 0, along = 0;
            for (int c = 0; c < 3; ++c) {
                const double d = r[3 * j + c] - r[3 * i + c];
                square += d * d;
                along += d * (reference[3 * j + c] - reference[3 * i + c]);
            }
            const double left = square - m->length[k] * m->length[k];
            const double g = left / (2 * (1 / m->mass[i] + 1 / m->mass[j]) * along);
            worst_now = fmax(worst_now, isfinite(g) ? fabs(left) / square : INFINITY);
            for (int c = 0; c < 3; ++c) {
                const double b = reference[3 * j + c] - reference[3 * i + c];
                r[3 * i + c] += g / m->mass[i] * b;
                r[3 * j + c] -= g / m->mass[j] * b;
            }
        }
        if (!isfinite(worst_now)) return 0;
    }
    return worst_now <= 1e-8;
}

/** Also where masses lie six decades apart, and where bonds are three times too long. */
static void what_shake_brings_home_is_brought_home(void **state)
{
    (void)state;
    uint64_t dice_state = 3;
    int64_t home = 0, tried = 0;
    const int rounds = quick_run() ? 4 : 40;
    for (int round = 0; round < rounds; ++round)
        for (int kind = 0; kind < N_ALL_SHAPES; ++kind) {
            molecule m = make((shape)kind, kind == CAGE ? 5 + round % 6 : 5 + round % 20, &dice_state);
            for (int64_t i = 0; round % 2 && i < m.n_atoms; ++i) m.mass[i] = pow(10, 3 * dice(&dice_state));
            hol_chains *chains = handle_of(&m);
            const double off = round % 3 == 0 ? 1 : 0.4, size = round % 5 == 0 ? 3 : 1;
            double crude[3 * most_atoms], r[3 * most_atoms];
            for (int64_t i = 0; i < 3 * m.n_atoms; ++i) crude[i] = size * m.r[i] + off * dice(&dice_state);
            int brought = 0;
            for (int as_they_are = 0; as_they_are < 2; ++as_they_are) {
                memcpy(r, crude, sizeof r);
                brought += shake(&m, r, as_they_are);
            }
            ++tried;
            if (brought) {
                ++home;
                memcpy(r, crude, sizeof r);
                CHECK(hol_impose(chains, r, NULL));
                CHECK_AT_MOST(worst(&m, r, 0), 1e-12);
            }
            hol_chains_destroy(chains);
        }
    assert_true(home > tried / 2 && home < tried);
}

/** Two atoms on each other leave their bond no direction, but other bonds pull them apart. */
static void atoms_on_each_other_are_pulled_apart_by_others(void **state)
{
    (void)state;
    uint64_t dice_state = 5;
    molecule m = make(CHAIN, 8, &dice_state);
    hol_chains *chains = handle_of(&m);
    memcpy(m.r + 9, m.r + 6, 3 * sizeof *m.r);
    CHECK(hol_impose(chains, m.r, NULL));
    CHECK_AT_MOST(worst(&m, m.r, 0), 1e-13);
    hol_chains_destroy(chains);
}

static void molecules_cut_by_a_box_and_in_floats_are_imposed_on(void **state)
{
    (void)state;
    uint64_t dice_state = 7;
    const double period = 5;
    const molecule m = make(TREE, 20, &dice_state);
    hol_chains *chains = handle_of(&m);
    float r[3 * most_atoms];
    double wide[3 * most_atoms];
    CHECK(hol_chains_set_box(chains, (const double[9]){period, 0, 0, 0, period, 0, 0, 0, period}));
    for (int64_t i = 0; i < 3 * m.n_atoms; ++i) {
        r[i] = (float)(m.r[i] + 0.3 * dice(&dice_state) + period * (double)(i % 3 - 1));
        wide[i] = r[i];
    }
    const hol_view view = {r, r + 1, r + 2, 3 * sizeof(float), HOL_FLOAT, 0};
    CHECK(hol_impose_view(chains, &view, NULL));
    CHECK(hol_impose(chains, wide, NULL));
    CHECK_AT_MOST(worst(&m, wide, period), 200 * DBL_EPSILON);
    for (int64_t i = 0; i < 3 * m.n_atoms; ++i) assert_true(r[i] == (float)wide[i]);
    hol_chains_destroy(chains);
}

static void held_atoms_stay_and_bad_molecules_are_left_alone(void **state)
{
    (void)state;
    /* a pair with one atom held; one with both atoms on each other; one with a NaN; an inactive one; a good one */
    const double mass[10] = {0, 1, 1, 1, 1, 1, 1, 1, 1, 3}, length[5] = {1, 1, 1, 1, 1};
    double r[30] = {
        [1] = 0.5, [3] = 3, [6] = 7, [9] = 7, [12] = 9, [15] = NAN, [18] = 20, [21] = 24, [24] = 30, [27] = 34};
    const int64_t pairs[10] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
    double before[30];
    memcpy(before, r, sizeof r);
    hol_chains *chains;
    CHECK(hol_chains_create(10, mass, &chains));
    CHECK(hol_chains_add_bonds(chains, 5, pairs, length));
    CHECK(hol_chains_set_active(chains, (const unsigned char[5]){1, 1, 1, 0, 1}));
    hol_report report;
    int64_t chain, n_bad;
    CHECK_FAILS(HOL_ERR_DEGENERATE, hol_impose(chains, r, &report));
    hol_error_location(&chain, NULL, NULL, &n_bad);
    assert_int_equal(chain, 1);
    assert_int_equal(n_bad, 2);
    assert_int_equal(report.n_failed, 2);
    assert_int_equal(report.n_corrected, 2);
    assert_same_bits(r, before, 3);
    assert_same_bits(r + 6, before + 6, 18);
    const double d[3] = {r[3], r[4] - 0.5, r[5]};
    CHECK_AT_MOST(fabs(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - 1), 8 * DBL_EPSILON);
    CHECK_AT_MOST(fabs(r[27] - r[24] - 1), 64 * DBL_EPSILON);
    CHECK_AT_MOST(fabs(r[24] - 32.25), 64 * DBL_EPSILON); /* the heavier one moves a third as far */
    hol_chains_destroy(chains);
}

static void residuals_are_those_of_each_bond(void **state)
{
    (void)state;
    uint64_t dice_state = 3;
    const molecule m = make(TREE, 20, &dice_state);
    hol_chains *chains = handle_of(&m);
    double r[3 * most_atoms], v[3 * most_atoms], length[most_atoms], rate[most_atoms];
    for (int64_t i = 0; i < 3 * m.n_atoms; ++i) {
        r[i] = m.r[i] + 0.01 * dice(&dice_state);
        v[i] = dice(&dice_state);
    }
    CHECK(hol_residuals(chains, r, v, length, rate));
    for (int64_t k = 0; k < m.n_bonds; ++k) {
        long double square = 0, product = 0;
        for (int c = 0; c < 3; ++c) {
            const int64_t i = 3 * m.pairs[2 * k] + c, j = 3 * m.pairs[2 * k + 1] + c;
            square += ((long double)r[j] - r[i]) * ((long double)r[j] - r[i]);
            product += ((long double)r[j] - r[i]) * ((long double)v[j] - v[i]);
        }
        const long double a2 = (long double)m.length[k] * m.length[k];
        CHECK_AT_MOST(fabsl(length[k] - (square - a2) / a2), 16 * DBL_EPSILON);
        CHECK_AT_MOST(fabsl(rate[k] - product), 16 * DBL_EPSILON);
    }
    const hol_view at = {r, r + 1, r + 2, 3 * sizeof(double), HOL_DOUBLE, 0};
    double again[most_atoms];
    CHECK(hol_residuals_view(chains, INPUT(&at), NULL, again, rate));
    assert_same_bits(again, length, (size_t)m.n_bonds);
    for (int64_t k = 0; k < m.n_bonds; ++k) assert_true(rate[k] == 0);
    CHECK(hol_residuals(chains, r, v, NULL, NULL));
    double *const kept = untouched((size_t)m.n_bonds);
    r[4] = NAN;
    CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_residuals(chains, r, v, kept, NULL));
    assert_untouched(kept, (size_t)m.n_bonds);
    free(kept);
    hol_chains_destroy(chains);
}

static void wrong_arguments_are_refused(void **state)
{
    (void)state;
    const double mass[2] = {1, 1};
    double r[6] = {0};
    hol_chains *chains;
    CHECK(hol_chains_create(2, mass, &chains));
    CHECK_FAILS(HOL_ERR_NULL, hol_impose(NULL, r, NULL));
    CHECK_FAILS(HOL_ERR_NULL, hol_impose(chains, NULL, NULL));
    CHECK_FAILS(HOL_ERR_NULL, hol_impose_view(chains, NULL, NULL));
    CHECK_FAILS(HOL_ERR_NULL, hol_residuals(NULL, r, NULL, r, NULL));
    CHECK_FAILS(HOL_ERR_NULL, hol_residuals(chains, NULL, NULL, r, NULL));
    CHECK_FAILS(HOL_ERR_NULL, hol_residuals_view(chains, NULL, NULL, r, NULL));
    hol_report report;
    CHECK(hol_impose(chains, r, &report));
    assert_int_equal(report.molecule, -1);
    hol_chains_destroy(chains);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(crude_positions_of_every_shape_get_their_lengths),
        cmocka_unit_test(what_shake_brings_home_is_brought_home),
        cmocka_unit_test(atoms_on_each_other_are_pulled_apart_by_others),
        cmocka_unit_test(molecules_cut_by_a_box_and_in_floats_are_imposed_on),
        cmocka_unit_test(held_atoms_stay_and_bad_molecules_are_left_alone),
        cmocka_unit_test(residuals_are_those_of_each_bond),
        cmocka_unit_test(wrong_arguments_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
