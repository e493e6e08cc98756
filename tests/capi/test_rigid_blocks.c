/** Rigid bodies of a kind side by side: each as if it were alone, whatever its neighbours are, and wherever they stand.
 */
#include "check.h"
#include "random.h"

enum { COUNT = 11, MOST = 7, ALL = COUNT * MOST };

typedef struct kind {
    int n;
    double mass[MOST], place[3 * MOST];
} kind;

static const kind kinds[] = {
    {3, {16, 12, 16}, {-1.1, 0, 0, 0.1, 0, 0, 1.2, 0, 0}},
    {4, {16, 1, 1, 0}, {0, 0, 0, 0.96, 0, 0, -0.24, 0.93, 0, 0.1, 0.1, 0}},
    {6, {12, 12, 12, 13, 14, 15}, {1.4, 0, 0, 0.7, 1.2, 0, -0.7, 1.2, 0, -1.4, 0, 0, -0.7, -1.2, 0, 0.7, -1.2, 0}},
    {5, {12, 1, 2, 3, 4}, {0, 0, 0, 0.6, 0.6, 0.6, 0.6, -0.6, -0.6, -0.6, 0.6, -0.6, -0.6, -0.6, 0.7}},
    {7, {0, 1, 2, 3, 4, 5, 0}, {0, 0, 0, 1, 0.2, 0, 0, 1, 0.1, 0.3, 0, 1, -1, 0, 0, 0, -1, 0.2, 0.1, 0.2, 0.3}},
    {6, {0, 16, 1, 0, 2, 0}, {0.1, 0.2, 0.7, 0, 0, 0, 0.96, 0, 0, 0.1, 0.2, -0.6, -0.24, 0.93, 0, 0.1, 0.1, 0}},
};
enum { N_KINDS = sizeof kinds / sizeof *kinds };

enum { R, V, F, MOVED, N_ARRAYS };

typedef struct scene {
    const kind *k;
    int n;             /* atoms of all */
    int64_t atom[ALL]; /* of body b, number a: atom[b n + a] */
    double mass[ALL], x[N_ARRAYS][3 * ALL];
} scene;

/** Bodies turned at random; scattered: their atoms stand in the arrays in any order. */
static scene make_scene(const kind *k, int scattered, const double *box)
{
    scene s = {.k = k, .n = COUNT * k->n};
    random_stream dice = random_seed(4 + (uint64_t)k->n);
    for (int i = 0; i < s.n; ++i) s.atom[i] = scattered ? (i * 37) % s.n : i;
    for (int b = 0; b < COUNT; ++b) {
        double q[4], shift[3], size = 0;
        for (int c = 0; c < 4; ++c) q[c] = random_normal(&dice), size += q[c] * q[c];
        for (int c = 0; c < 3; ++c) shift[c] = 4 * random_normal(&dice);
        const double w = q[0], x = q[1], y = q[2], z = q[3];
        const double turn[9] = {
            w * w + x * x - y * y - z * z, 2 * (x * y - w * z),           2 * (x * z + w * y),
            2 * (x * y + w * z),           w * w - x * x + y * y - z * z, 2 * (y * z - w * x),
            2 * (x * z - w * y),           2 * (y * z + w * x),           w * w - x * x - y * y + z * z};
        for (int a = 0; a < k->n; ++a) {
            const int64_t i = s.atom[b * k->n + a];
            s.mass[i] = k->mass[a];
            for (int c = 0; c < 3; ++c) {
                double r = shift[c];
                for (int d = 0; d < 3; ++d) r += turn[3 * c + d] / size * k->place[3 * a + d];
                s.x[R][3 * i + c] = r;
                s.x[V][3 * i + c] = random_normal(&dice);
                s.x[F][3 * i + c] = random_normal(&dice);
                s.x[MOVED][3 * i + c] = r + 0.02 * random_normal(&dice);
            }
            for (int side = 0; box && side < 3; ++side) { /* any image of any atom */
                const double n = floor(3 * random_uniform(&dice)) - 1, m = floor(3 * random_uniform(&dice)) - 1;
                for (int c = 0; c < 3; ++c) {
                    s.x[R][3 * i + c] += n * box[3 * side + c];
                    s.x[MOVED][3 * i + c] += m * box[3 * side + c];
                }
            }
        }
    }
    return s;
}

typedef struct results {
    double g[3 * ALL], v[3 * ALL], r[3 * ALL], moved_v[3 * ALL];
    int status[3];
} results;

static hol_chains *chains_of(const scene *s, int first, int count, const double *box)
{
    hol_chains *chains;
    CHECK(hol_chains_create(s->n, s->mass, &chains));
    for (int b = first; b < first + count; ++b) {
        const int64_t n = s->k->n;
        CHECK(hol_chains_add_rigid(chains, 1, &n, s->atom + b * n, s->k->place, 0, NULL, NULL));
    }
    CHECK(hol_chains_set_box(chains, box));
    CHECK(hol_chains_set_checks(chains, HOL_NEVER));
    return chains;
}

/** Of arrays that hold a number where nothing is written. */
static results compute(const scene *s, hol_chains *chains)
{
    results o;
    for (int i = 0; i < 3 * ALL; ++i) o.g[i] = -7;
    memcpy(o.v, s->x[V], sizeof o.v);
    memcpy(o.r, s->x[MOVED], sizeof o.r);
    memcpy(o.moved_v, s->x[V], sizeof o.moved_v);
    o.status[0] = hol_forces(chains, s->x[R], s->x[V], s->x[F], NULL, NULL, o.g, HOL_WRITE, NULL);
    o.status[1] = hol_project_velocities(chains, s->x[R], o.v, NULL, NULL);
    o.status[2] = hol_project_positions(chains, s->x[R], o.r, o.moved_v, 0.01, NULL, 0, NULL, NULL);
    hol_chains_destroy(chains);
    return o;
}

static void assert_body(const scene *s, int body, const double *is, const double *wanted)
{
    for (int a = 0; a < s->k->n; ++a) {
        const int64_t i = s->atom[body * s->k->n + a];
        assert_same_bits(is + 3 * i, wanted + 3 * i, 3);
    }
}

static const double orthorhombic[9] = {30, 0, 0, 0, 25, 0, 0, 0, 40}, triclinic[9] = {30, 0, 0, 7, 25, 0, -5, 6, 40};

static void each_is_as_if_alone(void **state)
{
    (void)state;
    const double *boxes[3] = {NULL, orthorhombic, triclinic};
    for (int which = 0; which < N_KINDS * 6; ++which) {
        const double *box = boxes[which / N_KINDS % 3];
        const scene s = make_scene(&kinds[which % N_KINDS], which / N_KINDS / 3, box);
        const results all = compute(&s, chains_of(&s, 0, COUNT, box));
        for (int level = 0; level < 3; ++level) assert_int_equal(all.status[level], HOL_OK);
        for (int b = 0; b < COUNT; ++b) {
            const results one = compute(&s, chains_of(&s, b, 1, box));
            assert_body(&s, b, all.g, one.g);
            assert_body(&s, b, all.v, one.v);
            assert_body(&s, b, all.r, one.r);
            assert_body(&s, b, all.moved_v, one.moved_v);
        }
    }
}

/** Scattered over the arrays, in a box or not: the same to a few roundings. */
static void the_order_of_atoms_and_the_box_do_not_matter(void **state)
{
    (void)state;
    for (int which = 0; which < N_KINDS; ++which) {
        const scene s = make_scene(&kinds[which], 0, NULL), t = make_scene(&kinds[which], 1, NULL);
        const results a = compute(&s, chains_of(&s, 0, COUNT, NULL)), b = compute(&t, chains_of(&t, 0, COUNT, NULL)),
                      c = compute(&s, chains_of(&s, 0, COUNT, triclinic));
        for (int i = 0; i < s.n; ++i) {
            assert_same_bits(a.g + 3 * s.atom[i], b.g + 3 * t.atom[i], 3);
            assert_same_bits(a.v + 3 * s.atom[i], b.v + 3 * t.atom[i], 3);
            assert_same_bits(a.r + 3 * s.atom[i], b.r + 3 * t.atom[i], 3);
        }
        for (int i = 0; i < 3 * s.n; ++i) {
            CHECK_AT_MOST(fabs(a.g[i] - c.g[i]), 1e-12);
            CHECK_AT_MOST(fabs(a.v[i] - c.v[i]), 1e-13);
            CHECK_AT_MOST(fabs(a.r[i] - c.r[i]), 1e-13);
        }
    }
}

/** NaN, an infinite force, a body that is collapsed: it keeps its outputs, the others are complete. */
static void a_bad_one_is_left_alone(void **state)
{
    (void)state;
    for (int which = 0; which < N_KINDS * 3; ++which) {
        scene s = make_scene(&kinds[which % N_KINDS], 0, NULL);
        const int bad = which % COUNT, how = which / N_KINDS;
        const results good = compute(&s, chains_of(&s, 0, COUNT, NULL));
        const int64_t first = s.atom[bad * s.k->n], last = s.atom[bad * s.k->n + s.k->n - 1];
        if (how == 0) s.x[R][3 * last + 1] = (double)NAN;
        if (how == 1) s.x[F][3 * first] = (double)INFINITY;
        for (int a = 0; how == 2 && a < s.k->n; ++a)
            memcpy(s.x[R] + 3 * s.atom[bad * s.k->n + a], s.x[R] + 3 * first, 3 * sizeof(double));
        const results o = compute(&s, chains_of(&s, 0, COUNT, NULL));
        const int spoiled[3] = {1, how != 1, how != 1};
        for (int level = 0; level < 3; ++level) assert_int_equal(o.status[level] != HOL_OK, spoiled[level]);
        for (int b = 0; b < COUNT; ++b) {
            double nothing[3 * ALL];
            for (int i = 0; i < 3 * ALL; ++i) nothing[i] = -7;
            const int is_bad = b == bad;
            assert_body(&s, b, o.g, is_bad ? nothing : good.g);
            assert_body(&s, b, o.v, is_bad && spoiled[1] ? s.x[V] : good.v);
            assert_body(&s, b, o.r, is_bad && spoiled[2] ? s.x[MOVED] : good.r);
            assert_body(&s, b, o.moved_v, is_bad && spoiled[2] ? s.x[V] : good.moved_v);
        }
    }
}

/** What is rigid already stays as it is, to a rounding, beside bodies that are not. */
static void a_rigid_one_does_not_move(void **state)
{
    (void)state;
    for (int which = 0; which < N_KINDS; ++which) {
        scene s = make_scene(&kinds[which], 0, NULL);
        for (int i = 3 * 2 * s.k->n; i < 3 * 4 * s.k->n; ++i) s.x[MOVED][i] = s.x[R][i];
        const results o = compute(&s, chains_of(&s, 0, COUNT, NULL));
        for (int i = 3 * 2 * s.k->n; i < 3 * 4 * s.k->n; ++i) CHECK_AT_MOST(fabs(o.r[i] - s.x[R][i]), 1e-14);
    }
}

static void memory_of_bodies_has_a_limit(void **state)
{
    (void)state;
    const scene s = make_scene(&kinds[2], 0, NULL);
    hol_chains *chains;
    const int64_t six = 6, list[6] = {0, 1, 2, 3, 4, 5};
    CHECK(hol_chains_create(s.n, s.mass, &chains));
    CHECK(hol_chains_set_memory_limit(chains, 4000));
    CHECK_FAILS(HOL_ERR_MEMORY,
                hol_chains_add_rigid_molecules(chains, COUNT, 6, 0, 1, &six, list, s.k->place, 0, NULL, NULL));
    assert_message_names("hol_chains_set_memory_limit");
    CHECK_FAILS(HOL_ERR_MEMORY, hol_chains_add_rigid(chains, 1, &six, list, s.k->place, 0, NULL, NULL));
    assert_int_equal(hol_chains_n_molecules(chains), 0);
    CHECK(hol_chains_set_memory_limit(chains, 1000000));
    CHECK(hol_chains_add_rigid_molecules(chains, 1, 6, 0, 1, &six, list, s.k->place, 0, NULL, NULL));
    hol_chains_destroy(chains);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_is_as_if_alone),          cmocka_unit_test(the_order_of_atoms_and_the_box_do_not_matter),
        cmocka_unit_test(a_bad_one_is_left_alone),      cmocka_unit_test(a_rigid_one_does_not_move),
        cmocka_unit_test(memory_of_bodies_has_a_limit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
