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

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(right_ones_stay_and_others_are_solved_as_without_them)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
