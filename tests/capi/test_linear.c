/** Lists of distances that depend, bodies that share atoms and linear relations: what a copy carries. */
#include "check.h"
#include "random.h"

enum { N = 16, BONDS = 18 };

/* CO2 with three decimals, methane by ten distances that do not quite fit, a site by two atoms, two atoms at one
 * point. */
static const double mass[N] = {16, 12, 16, 12, 1, 1, 1, 1, 3, 4, 5, 0, 1, 1, 1, 1};

typedef struct state {
    double r[3 * N], v[3 * N], f[3 * N];
} state;

static hol_chains *make(state *s)
{
    hol_chains *chains;
    CHECK(hol_chains_create(N, mass, &chains));
    const int64_t line[6] = {0, 1, 1, 2, 0, 2},
                  tetrahedron[20] = {3, 4, 3, 5, 3, 6, 3, 7, 4, 5, 4, 6, 4, 7, 5, 6, 5, 7, 6, 7};
    const double of_line[3] = {1.162, 1.163, 2.324};
    const double of_tetrahedron[10] = {1.09, 1.09, 1.09, 1.09, 1.78, 1.78, 1.78, 1.78, 1.78, 1.779};
    CHECK(hol_chains_add_bonds(chains, 3, line, of_line));
    CHECK(hol_chains_add_bonds(chains, 10, tetrahedron, of_tetrahedron));
    const int64_t three = 3, of[3] = {8, 9, 11}, pairs[6] = {8, 9, 9, 10, 10, 12};
    const double c[3] = {0.25, 0.75, -1}, lengths[3] = {1, 1.1, 1.2};
    CHECK(hol_chains_add_linear(chains, 1, &three, of, c, 3, pairs, lengths));
    const int64_t point[4] = {13, 14, 14, 15};
    const double of_point[2] = {0, 1};
    CHECK(hol_chains_add_bonds(chains, 2, point, of_point));
    random_stream dice = random_seed(3);
    memset(s, 0, sizeof *s);
    for (int i = 0; i < 3 * N; ++i) s->v[i] = random_normal(&dice), s->f[i] = random_normal(&dice);
    s->r[0] = -1.162, s->r[6] = 1.162;
    for (int k = 0; k < 4; ++k)
        for (int x = 0; x < 3; ++x) s->r[3 * (4 + k) + x] = 5 * (x == 0) + 0.6293 * (k == 0 || k == x + 1 ? 1 : -1);
    s->r[9] = 5;
    const double chain[5][3] = {{0, 5, 0}, {1, 5, 0}, {1, 6.1, 0}, {0.75, 5, 0}, {1, 6.1, 1.2}};
    for (int k = 0; k < 5; ++k) memcpy(s->r + 3 * (8 + k), chain[k], sizeof chain[k]);
    s->r[39] = s->r[42] = 20, s->r[45] = 21;
    CHECK(hol_impose(chains, s->r, NULL));
    return chains;
}

typedef struct answers {
    double g[3 * N], v[3 * N], r[3 * N], adjustment;
    unsigned char implied[BONDS];
    int roles[BONDS];
    int64_t bond, freedoms, removed[4];
} answers;

static answers ask(const hol_chains *chains, const state *s)
{
    answers a;
    memset(&a, 0, sizeof a);
    memcpy(a.v, s->v, sizeof a.v);
    for (int i = 0; i < 3 * N; ++i) a.r[i] = s->r[i] + 0.01 * s->v[i];
    CHECK(hol_forces(chains, s->r, s->v, s->f, NULL, NULL, a.g, HOL_WRITE, NULL));
    CHECK(hol_project_velocities(chains, s->r, a.v, NULL, NULL));
    CHECK(hol_project_positions(chains, s->r, a.r, NULL, 0.01, NULL, 0, NULL, NULL));
    CHECK(hol_chains_implied(chains, a.implied));
    CHECK(hol_chains_roles(chains, a.roles, a.removed));
    CHECK(hol_chains_adjustment(chains, &a.adjustment, &a.bond));
    a.freedoms = hol_chains_degrees_of_freedom(chains, 3);
    return a;
}

static void assert_alike(const answers *a, const answers *b)
{
    assert_same_bits(a->g, b->g, 3 * N);
    assert_same_bits(a->v, b->v, 3 * N);
    assert_same_bits(a->r, b->r, 3 * N);
    assert_memory_equal(a->implied, b->implied, sizeof a->implied);
    assert_memory_equal(a->roles, b->roles, sizeof a->roles);
    assert_memory_equal(a->removed, b->removed, sizeof a->removed);
    assert_true(a->adjustment == b->adjustment && a->bond == b->bond && a->freedoms == b->freedoms);
}

static void a_copy_carries_what_lists_mean(void **unused)
{
    (void)unused;
    state s;
    hol_chains *chains = make(&s), *copy;
    assert_int_equal(hol_chains_n_bonds(chains), BONDS);
    const answers its = ask(chains, &s);
    assert_int_equal(its.freedoms, 5 + 6 + 12 - 3 + 9 - 4);
    assert_int_equal(its.implied[BONDS - 2], 1);
    assert_true(its.adjustment > 1e-5 && its.adjustment < 1e-3);
    CHECK(hol_chains_copy(chains, &copy));
    const answers of_copy = ask(copy, &s);
    assert_alike(&its, &of_copy);
    /* apart from each other: masses of the one, and the one gone */
    double heavy[N];
    for (int i = 0; i < N; ++i) heavy[i] = (1 + i % 3) * mass[i];
    CHECK(hol_chains_set_masses(copy, heavy));
    const answers still = ask(chains, &s), other = ask(copy, &s);
    assert_alike(&its, &still);
    assert_true(memcmp(its.g, other.g, sizeof its.g) != 0);
    assert_true(its.adjustment == other.adjustment && its.freedoms == other.freedoms);
    hol_chains_destroy(chains);
    CHECK(hol_chains_set_masses(copy, mass));
    const answers back = ask(copy, &s);
    assert_alike(&its, &back);
    hol_chains_destroy(copy);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_copy_carries_what_lists_mean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
