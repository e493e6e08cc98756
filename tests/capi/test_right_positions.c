/** Molecules whose positions are right as they came, beside others that are not: these stay as they are, bit by bit,
 * and those get what they get among others of their kind. Chains of one to seven bonds, at which kernels change, and
 * some longer. */
#include "check.h"
#include "random.h"

enum { most_atoms = 600 };

typedef struct scene {
    int64_t n_bonds, n_chains, n_atoms;
    int64_t place[most_atoms]; /**< atom k of chain c stands in row place[c (n_bonds + 1) + k] */
    double r_ref[3 * most_atoms], wrong[3 * most_atoms], v[3 * most_atoms];
    hol_chains *chains;
} scene;

static double uniform(random_stream *state)
{
    return 2 * random_uniform(state) - 1;
}

/** Unit bonds, positions a short step away from them; some coordinates are -0. */
static void make(scene *s, int64_t n_bonds, int scattered, int boxed)
{
    random_stream state = random_seed(77 + (uint64_t)n_bonds);
    double mass[most_atoms], length[40];
    s->n_bonds = n_bonds, s->n_chains = most_atoms / (n_bonds + 1), s->n_atoms = s->n_chains * (n_bonds + 1);
    for (int64_t i = 0; i < s->n_atoms; ++i) {
        mass[i] = 1 + 0.1 * (double)(i % (n_bonds + 1));
        s->place[i] = scattered ? (i * 7 + 3) % s->n_atoms : i;
    }
    if (scattered && s->n_atoms % 7 == 0)
        for (int64_t i = 0; i < s->n_atoms; ++i) s->place[i] = (i * 11 + 3) % s->n_atoms;
    for (int64_t k = 0; k < n_bonds; ++k) length[k] = 1;
    double of_place[most_atoms];
    for (int64_t i = 0; i < s->n_atoms; ++i) of_place[s->place[i]] = mass[i];
    CHECK(hol_chains_create(s->n_atoms, of_place, &s->chains));
    for (int64_t c = 0; c < s->n_chains; ++c) {
        double at[3] = {3 * uniform(&state), 3 * uniform(&state), -0.0};
        for (int64_t k = 0; k <= n_bonds; ++k) {
            const int64_t i = s->place[c * (n_bonds + 1) + k];
            const double angle = 0.9 * (double)k + uniform(&state);
            if (k > 0) at[0] += cos(angle), at[1] += sin(angle);
            for (int e = 0; e < 3; ++e) {
                s->r_ref[3 * i + e] = at[e];
                s->v[3 * i + e] = uniform(&state);
                s->wrong[3 * i + e] = at[e] + 0.003 * uniform(&state);
            }
        }
        if (scattered) CHECK(hol_chains_add(s->chains, n_bonds, s->place + c * (n_bonds + 1), length));
    }
    if (!scattered) CHECK(hol_chains_add_block(s->chains, s->n_chains, n_bonds, 0, length));
    const double box[9] = {100, 0, 0, 0, 90, 0, 0, 0, 80};
    if (boxed) CHECK(hol_chains_set_box(s->chains, box));
}

/** The chains c with c % period >= wrong_from are wrong, the others right. */
static void check(int64_t n_bonds, int scattered, int boxed, int64_t period, int64_t wrong_from)
{
    scene s;
    make(&s, n_bonds, scattered, boxed);
    const size_t n = 3 * (size_t)s.n_atoms;
    double solved[3 * most_atoms], v_solved[3 * most_atoms], lambda_solved[most_atoms], given[3 * most_atoms];
    double r[3 * most_atoms], v[3 * most_atoms], lambda[most_atoms];
    memcpy(solved, s.wrong, sizeof solved), memcpy(v_solved, s.v, sizeof v);
    CHECK(hol_project_positions(s.chains, s.r_ref, solved, v_solved, 0.1, lambda_solved, 0, NULL, NULL));
    memcpy(given, s.wrong, sizeof given), memcpy(v, s.v, sizeof v);
    for (int64_t c = 0; c < s.n_chains; ++c)
        for (int64_t k = 0; k <= n_bonds && c % period < wrong_from; ++k) {
            const int64_t i = s.place[c * (n_bonds + 1) + k];
            for (int e = 0; e < 3; ++e) given[3 * i + e] = s.r_ref[3 * i + e];
        }
    memcpy(r, given, sizeof r);
    for (size_t i = 0; i < most_atoms; ++i) lambda[i] = 3;
    CHECK(hol_project_positions(s.chains, s.r_ref, r, v, 0.1, lambda, 0, NULL, NULL));
    for (int64_t c = 0; c < s.n_chains; ++c) {
        const int right = c % period < wrong_from;
        for (int64_t k = 0; k <= n_bonds; ++k) {
            const size_t i = 3 * (size_t)s.place[c * (n_bonds + 1) + k];
            assert_same_bits(r + i, (right ? given : solved) + i, 3);
            assert_same_bits(v + i, (right ? s.v : v_solved) + i, 3);
        }
        for (int64_t k = c * n_bonds; k < (c + 1) * n_bonds; ++k) {
            if (!right) assert_same_bits(lambda + k, lambda_solved + k, 1);
            if (right) assert_true(lambda[k] == 0);
        }
    }
    for (size_t i = 0; i < n; ++i) assert_true(isfinite(r[i]));
    /* An infinity in a reference is refused, whether its molecule needs a correction or not. */
    double bad[3 * most_atoms];
    memcpy(bad, s.r_ref, sizeof bad);
    bad[3 * s.place[s.n_atoms / 2]] = INFINITY;
    memcpy(r, given, sizeof r);
    assert_int_not_equal(hol_project_positions(s.chains, bad, r, NULL, 0.1, NULL, 0, NULL, NULL), HOL_OK);
    hol_chains_destroy(s.chains);
}

static void right_ones_stay_and_others_are_solved_as_without_them(void **state)
{
    (void)state;
    const int64_t bonds[] = {1, 2, 3, 4, 5, 6, 7, 10, 19};
    for (size_t b = 0; b < sizeof bonds / sizeof *bonds; ++b)
        for (int scattered = 0; scattered < 2; ++scattered)
            for (int boxed = 0; boxed < 2; ++boxed) {
                check(bonds[b], scattered, boxed, 1, 1);   /* all are right */
                check(bonds[b], scattered, boxed, 3, 1);   /* in turns, in every block */
                check(bonds[b], scattered, boxed, 23, 20); /* whole blocks, then one that is not */
            }
}

/** Molecules that are no chains, in the plane z = -0. */
typedef struct shape {
    int n_atoms, n_bonds;
    int64_t pairs[20];
    double x[10][2];
} shape;

static const shape shapes[] = {
    {4, 3, {0, 1, 0, 2, 0, 3}, {{0, 0}, {1, 0}, {-0.5, 0.8}, {-0.4, -0.9}}},
    {5, 4, {0, 1, 0, 2, 0, 3, 0, 4}, {{0, 0}, {1, 0}, {0, 1}, {-1, 0}, {0.3, -1}}},
    {7, 6, {0, 1, 0, 2, 2, 3, 2, 4, 4, 5, 4, 6}, {{0, 0}, {0, 1}, {1, 0}, {1, 1}, {2, 0.3}, {2, 1}, {3, 0}}},
    {6, 6, {0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 0, 5}, {{1, 0}, {0.5, 0.9}, {-0.5, 0.9}, {-1, 0}, {-0.5, -0.9}, {0.5, -0.9}}},
    {5, 6, {0, 1, 1, 2, 2, 3, 0, 3, 0, 2, 3, 4}, {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {-0.7, 1.5}}},
};
enum { copies = 13 };

/* By default and where a tolerance lets them be; a third are right, or every other one. */
static void right_molecules_of_other_shapes_stay(void **state)
{
    (void)state;
    for (size_t which = 0; which < 4 * sizeof shapes / sizeof *shapes; ++which) {
        const shape *const m = shapes + which / 4;
        const int period = which % 2 ? 2 : 3, n = copies * m->n_atoms;
        random_stream stream = random_seed(5 + which);
        double mass[10 * copies], length[20], ref[30 * copies], r[30 * copies], all[30 * copies], v[30 * copies],
            v_all[30 * copies], came[30 * copies], v_came[30 * copies];
        for (int k = 0; k < m->n_bonds; ++k) {
            const double *const a = m->x[m->pairs[2 * k]], *const b = m->x[m->pairs[2 * k + 1]];
            length[k] = hypot(b[0] - a[0], b[1] - a[1]);
        }
        for (int i = 0; i < n; ++i) {
            mass[i] = i % m->n_atoms == 0 ? 12 : 1;
            const int right = i / m->n_atoms % period == 0;
            for (int c = 0; c < 3; ++c) {
                ref[3 * i + c] = c == 2 ? -0.0 : m->x[i % m->n_atoms][c] + i / m->n_atoms;
                const double moved = ref[3 * i + c] + 0.01 * uniform(&stream);
                came[3 * i + c] = r[3 * i + c] = right ? ref[3 * i + c] : moved;
                all[3 * i + c] = moved;
                v_came[3 * i + c] = v[3 * i + c] = v_all[3 * i + c] = c == 2 ? -0.0 : uniform(&stream);
            }
        }
        hol_chains *chains;
        CHECK(hol_chains_create(n, mass, &chains));
        CHECK(hol_chains_add_molecules(chains, copies, m->n_atoms, 0, m->n_bonds, m->pairs, length));
        CHECK(hol_chains_set_tolerance(chains, which % 4 < 2 ? 0 : 1e-4));
        CHECK(hol_project_positions(chains, ref, r, v, 0.1, NULL, 0, NULL, NULL));
        CHECK(hol_project_positions(chains, ref, all, v_all, 0.1, NULL, 0, NULL, NULL));
        for (int c = 0; c < copies; ++c) {
            const int first = 3 * c * m->n_atoms;
            const size_t values = 3 * (size_t)m->n_atoms;
            const int right = c % period == 0;
            assert_same_bits(r + first, (right ? came : all) + first, values);
            assert_same_bits(v + first, (right ? v_came : v_all) + first, values);
            for (int k = 0; k < m->n_bonds; ++k) {
                const double *const a = r + first + 3 * m->pairs[2 * k], *const b = r + first + 3 * m->pairs[2 * k + 1];
                const double d = hypot(hypot(b[0] - a[0], b[1] - a[1]), b[2] - a[2]);
                CHECK_AT_MOST(fabs(d / length[k] - 1), 1e-4);
            }
        }
        hol_chains_destroy(chains);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(right_ones_stay_and_others_are_solved_as_without_them),
                                       cmocka_unit_test(right_molecules_of_other_shapes_stay)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
