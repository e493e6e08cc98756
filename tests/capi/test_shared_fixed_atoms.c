/**
 * Fixed atoms that many molecules share: each of these gives what it gives by itself, and the force on the shared atom
 * is the sum over those that are not bad.
 */
#include "check.h"
#include "input.h"
#include "random.h"

#include <float.h>

/* Chains of a few bonds that all begin at atom 0, which is fixed, and one in whose middle it stands. */
enum { N_CHAINS = 21, LONGEST = 300 };

typedef struct brush {
    int64_t n_atoms, n_bonds, n_chains;
    int64_t n[N_CHAINS], first_bond[N_CHAINS + 1];
    int64_t *atoms[N_CHAINS];
    double *mass, *r, *v, *f;
    hol_chains *chains, *alone[N_CHAINS];
} brush;

static brush make_brush(int one_call)
{
    brush b;
    memset(&b, 0, sizeof b);
    random_stream stream = random_seed(4);
    b.n_chains = N_CHAINS;
    for (int c = 0; c < N_CHAINS; ++c) {
        b.n[c] = c == 3 ? LONGEST : 2 + c % 5;
        b.n_bonds += b.n[c];
        b.first_bond[c + 1] = b.n_bonds;
    }
    b.n_atoms = b.n_bonds + 1;
    const size_t n = (size_t)b.n_atoms;
    b.mass = malloc(8 * n), b.r = malloc(24 * n), b.v = malloc(24 * n), b.f = malloc(24 * n);
    int64_t next = 1;
    for (size_t i = 0; i < n; ++i) b.mass[i] = i == 0 ? 0 : 1 + random_uniform(&stream);
    for (size_t i = 0; i < 3 * n; ++i) {
        b.v[i] = i < 3 ? 0 : random_normal(&stream);
        b.f[i] = random_normal(&stream);
        b.r[i] = i < 3 ? 0.5 : 0;
    }
    double *lengths = malloc(8 * n);
    int64_t *pairs = malloc(16 * n);
    for (int c = 0; c < N_CHAINS; ++c) {
        b.atoms[c] = malloc(8 * (size_t)(b.n[c] + 1));
        for (int64_t k = 0; k <= b.n[c]; ++k) b.atoms[c][k] = k == 0 ? 0 : next++;
        for (int64_t k = 1; k <= b.n[c]; ++k) {
            double u[3];
            random_direction(&stream, u);
            for (int i = 0; i < 3; ++i) b.r[3 * b.atoms[c][k] + i] = b.r[3 * b.atoms[c][k - 1] + i] + u[i];
        }
        if (c == 5) { /* the fixed atom in the middle: a chain through it, not from it */
            b.atoms[c][0] = b.atoms[c][1];
            b.atoms[c][1] = 0;
            for (int i = 0; i < 3; ++i) b.r[3 * b.atoms[c][2] + i] = b.r[i] + (i == 1);
        }
        CHECK(hol_chains_create(b.n_atoms, b.mass, &b.alone[c]));
        for (int64_t k = 0; k < b.n[c]; ++k) {
            const double *p = b.r + 3 * b.atoms[c][k], *q = b.r + 3 * b.atoms[c][k + 1];
            lengths[b.first_bond[c] + k] =
                sqrt((q[0] - p[0]) * (q[0] - p[0]) + (q[1] - p[1]) * (q[1] - p[1]) + (q[2] - p[2]) * (q[2] - p[2]));
            pairs[2 * (b.first_bond[c] + k)] = b.atoms[c][k];
            pairs[2 * (b.first_bond[c] + k) + 1] = b.atoms[c][k + 1];
        }
        CHECK(hol_chains_add(b.alone[c], b.n[c], b.atoms[c], lengths + b.first_bond[c]));
    }
    CHECK(hol_chains_create(b.n_atoms, b.mass, &b.chains));
    if (one_call)
        CHECK(hol_chains_add_bonds(b.chains, b.n_bonds, pairs, lengths));
    else
        for (int c = 0; c < N_CHAINS; ++c)
            CHECK(hol_chains_add(b.chains, b.n[c], b.atoms[c], lengths + b.first_bond[c]));
    free(lengths), free(pairs);
    return b;
}

static void brush_free(brush *b)
{
    for (int c = 0; c < N_CHAINS; ++c) hol_chains_destroy(b->alone[c]), free(b->atoms[c]);
    hol_chains_destroy(b->chains);
    free(b->mass), free(b->r), free(b->v), free(b->f);
}

static void each_molecule_gives_what_it_gives_alone(void **state)
{
    (void)state;
    brush b = make_brush(0);
    const size_t n = (size_t)b.n_atoms, m = (size_t)b.n_bonds;
    assert_int_equal(hol_chains_n_molecules(b.chains), N_CHAINS);
    for (int threads = 1; threads <= 3; threads += 2)
        for (int mode = HOL_WRITE; mode <= HOL_ADD; ++mode) {
            CHECK(hol_chains_set_threads(b.chains, threads));
            double *l = untouched(m), *g = copy_of(b.f, 3 * n), *l1 = untouched(m), *g1 = copy_of(b.f, 3 * n), sum[3],
                   size[3] = {0, 0, 0};
            CHECK(hol_forces(b.chains, b.r, b.v, b.f, l, NULL, g, mode, NULL));
            for (int i = 0; i < 3; ++i) sum[i] = mode == HOL_ADD ? b.f[i] : 0;
            for (int c = 0; c < N_CHAINS; ++c) {
                for (int i = 0; i < 3; ++i) g1[i] = 0;
                CHECK(hol_forces(b.alone[c], b.r, b.v, b.f, l1 + b.first_bond[c], NULL, g1, mode, NULL));
                for (int i = 0; i < 3; ++i) sum[i] += g1[i], size[i] += fabs(g1[i]);
            }
            assert_same_bits(l, l1, m);
            assert_same_bits(g + 3, g1 + 3, 3 * (n - 1));
            /* a sum of N_CHAINS forces, each rounding once */
            for (int i = 0; i < 3; ++i)
                CHECK_AT_MOST(fabs(g[i] - sum[i]), (N_CHAINS + 1) * DBL_EPSILON * (size[i] + 1));
            free(l), free(g), free(l1), free(g1);
        }
    brush_free(&b);
}

static void velocities_positions_and_fixman_force_too(void **state)
{
    (void)state;
    brush b = make_brush(0);
    const size_t n = (size_t)b.n_atoms, m = (size_t)b.n_bonds;
    double *l = untouched(m), *l1 = untouched(m), *v = copy_of(b.v, 3 * n), *v1 = copy_of(b.v, 3 * n),
           size[3] = {0, 0, 0};
    CHECK(hol_project_velocities(b.chains, b.r, v, l, NULL));
    for (int c = 0; c < N_CHAINS; ++c) CHECK(hol_project_velocities(b.alone[c], b.r, v1, l1 + b.first_bond[c], NULL));
    assert_same_bits(l, l1, m);
    assert_same_bits(v, v1, 3 * n);
    double *r = copy_of(b.r, 3 * n), *r1;
    for (size_t i = 3; i < 3 * n; ++i) r[i] += 1e-3 * v[i];
    r1 = copy_of(r, 3 * n);
    hol_report report;
    CHECK(hol_project_positions(b.chains, b.r, r, v, 1e-3, l, 0, NULL, &report));
    assert_int_equal(report.n_corrected, N_CHAINS);
    for (int c = 0; c < N_CHAINS; ++c)
        CHECK(hol_project_positions(b.alone[c], b.r, r1, v1, 1e-3, l1 + b.first_bond[c], 0, NULL, NULL));
    assert_same_bits(l, l1, m);
    assert_same_bits(v, v1, 3 * n);
    assert_same_bits(r, r1, 3 * n);
    double *f = untouched(3 * n), *f1 = untouched(3 * n), sum[3] = {0, 0, 0};
    CHECK(hol_metric(b.chains, b.r, 2, NULL, NULL, NULL, f, HOL_WRITE));
    for (int c = 0; c < N_CHAINS; ++c) {
        CHECK(hol_metric(b.alone[c], b.r, 2, NULL, NULL, NULL, f1, HOL_WRITE));
        for (int i = 0; i < 3; ++i) sum[i] += f1[i], size[i] += fabs(f1[i]);
    }
    assert_same_bits(f + 3, f1 + 3, 3 * (n - 1));
    for (int i = 0; i < 3; ++i) CHECK_AT_MOST(fabs(f[i] - sum[i]), N_CHAINS * DBL_EPSILON * size[i]);
    free(l), free(l1), free(v), free(v1), free(r), free(r1), free(f), free(f1);
    brush_free(&b);
}

static void a_bad_molecule_is_missing_from_the_sum(void **state)
{
    (void)state;
    brush b = make_brush(0);
    const size_t n = (size_t)b.n_atoms, m = (size_t)b.n_bonds;
    unsigned char active[N_CHAINS];
    for (int c = 0; c < N_CHAINS; ++c) active[c] = c == 0 || c == 2;
    for (int all_bad = 0; all_bad < 2; ++all_bad)
        for (int mode = HOL_WRITE; mode <= HOL_ADD; ++mode) {
            double *f = copy_of(b.f, 3 * n), *g = untouched(3 * n), *kept = untouched(3 * n), *l = untouched(m),
                   *g1 = untouched(3 * n);
            f[3 * b.atoms[0][1]] = NAN;
            if (all_bad) f[3 * b.atoms[2][1]] = INFINITY;
            for (int i = 0; i < 3; ++i) g[i] = g1[i] = kept[i] = 7; /* the pattern is no number to add to */
            CHECK(hol_chains_set_active(b.chains, active));
            if (mode == HOL_ADD)
                for (size_t i = 3; i < 3 * n; ++i) g[i] = g1[i] = kept[i] = 1;
            CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_forces(b.chains, b.r, b.v, f, l, NULL, g, mode, NULL));
            if (!all_bad) CHECK(hol_forces(b.alone[2], b.r, b.v, f, NULL, NULL, g1, mode, NULL));
            assert_same_bits(g, all_bad ? kept : g1, 3 * n);
            free(f), free(g), free(kept), free(l), free(g1);
        }
    brush_free(&b);
}

static void arrays_of_any_layout_share_atoms(void **state)
{
    (void)state;
    brush b = make_brush(1);
    brush c = make_brush(0);
    const size_t n = (size_t)b.n_atoms, m = (size_t)b.n_bonds;
    /* floats in records of five numbers; results are those of the same numbers as doubles, rounded once for each chain
     */
    float *r = malloc(20 * n), *f = malloc(20 * n), *g = malloc(20 * n);
    double *exact = malloc(24 * n), *g1 = malloc(24 * n), *l = untouched(m), *l1 = untouched(m);
    for (size_t i = 0; i < n; ++i)
        for (size_t k = 0; k < 3; ++k) {
            r[5 * i + k] = (float)b.r[3 * i + k];
            f[5 * i + k] = (float)b.f[3 * i + k];
            exact[3 * i + k] = (double)r[5 * i + k];
            g1[3 * i + k] = (double)f[5 * i + k];
        }
    const hol_view vr = {r, r + 1, r + 2, 20, HOL_FLOAT, 0}, vf = {f, f + 1, f + 2, 20, HOL_FLOAT, 0},
                   vg = {g, g + 1, g + 2, 20, HOL_FLOAT, 0};
    CHECK(hol_forces_view(c.chains, INPUT(&vr), NULL, INPUT(&vf), l, NULL, &vg, HOL_WRITE, NULL));
    CHECK(hol_forces(c.chains, exact, NULL, g1, l1, NULL, g1, HOL_WRITE, NULL)); /* g is f itself */
    assert_same_bits(l, l1, m);
    for (size_t i = 1; i < n; ++i)
        for (size_t k = 0; k < 3; ++k) assert_true(g[5 * i + k] == (float)g1[3 * i + k]);
    for (size_t k = 0; k < 3; ++k) CHECK_AT_MOST(fabs(g[k] - g1[k]), N_CHAINS * FLT_EPSILON * (fabs(g1[k]) + 50));
    free(r), free(f), free(g), free(exact), free(g1), free(l), free(l1);
    brush_free(&b), brush_free(&c);
}

static void the_middle_one_falls_apart_in_a_list_of_bonds(void **state)
{
    (void)state;
    brush b = make_brush(1);
    /* the chain through the fixed atom is cut there: its two ends couple to nothing */
    assert_int_equal(hol_chains_n_molecules(b.chains), N_CHAINS + 1);
    assert_int_equal(hol_chains_n_of_shape(b.chains, HOL_SHAPE_CHAIN), N_CHAINS + 1);
    assert_int_equal(hol_chains_degrees_of_freedom(b.chains, 3), 3 * (b.n_atoms - 1) - b.n_bonds);
    brush c = make_brush(0);
    const size_t n = (size_t)b.n_atoms;
    double *g = malloc(24 * n), *g1 = malloc(24 * n);
    CHECK(hol_forces(b.chains, b.r, b.v, b.f, NULL, NULL, g, HOL_WRITE, NULL));
    CHECK(hol_forces(c.chains, b.r, b.v, b.f, NULL, NULL, g1, HOL_WRITE, NULL));
    for (size_t i = 0; i < 3 * n; ++i) CHECK_AT_MOST(fabs(g[i] - g1[i]), 1e-12 * (1 + fabs(g1[i])));
    free(g), free(g1);
    brush_free(&b), brush_free(&c);
}

static void a_ring_through_a_fixed_atom_is_a_chain_between_two_copies_of_it(void **state)
{
    (void)state;
    const double mass[4] = {0, 1, 2, 1}, length[4] = {1, 1, 1, 1}, s = 0.7071067811865476,
                 r[12] = {0, 0, 0, s, s, 0, 2 * s, 0, 0.1, s, -s, 0};
    const int64_t pairs[8] = {1, 2, 3, 0, 0, 1, 2, 3};
    double f[12], lambda[4], g[12], total[3] = {0, 0, 0};
    random_stream stream = random_seed(9);
    for (int i = 0; i < 12; ++i) f[i] = random_normal(&stream);
    hol_chains *c;
    CHECK(hol_chains_create(4, mass, &c));
    CHECK(hol_chains_add_bonds(c, 4, pairs, length));
    assert_int_equal(hol_chains_n_molecules(c), 1);
    int shape;
    int64_t n_atoms, n_bonds, atoms[5];
    CHECK(hol_chains_molecule(c, 0, &shape, &n_atoms, &n_bonds));
    assert_true(shape == HOL_SHAPE_CHAIN && n_atoms == 5 && n_bonds == 4);
    CHECK(hol_chains_atoms(c, 0, atoms));
    assert_true(atoms[0] == 0 && atoms[1] == 1 && atoms[2] == 2 && atoms[3] == 3 && atoms[4] == 0);
    CHECK(hol_forces(c, r, NULL, f, lambda, NULL, g, HOL_WRITE, NULL));
    for (int k = 0; k < 4; ++k) { /* sigma'' = 0, at rest, to some roundings of the largest acceleration */
        const int64_t i = pairs[2 * k], j = pairs[2 * k + 1];
        double sum = 0;
        for (int x = 0; x < 3; ++x) {
            const double wi = mass[i] > 0 ? 1 / mass[i] : 0, wj = mass[j] > 0 ? 1 / mass[j] : 0;
            sum += (r[3 * j + x] - r[3 * i + x]) *
                   (wj * (f[3 * j + x] + g[3 * j + x]) - wi * (f[3 * i + x] + g[3 * i + x]));
        }
        CHECK_AT_MOST(fabs(sum), 100 * DBL_EPSILON);
    }
    for (int i = 0; i < 12; ++i) total[i % 3] += g[i];
    for (int x = 0; x < 3; ++x) CHECK_AT_MOST(fabs(total[x]), 100 * DBL_EPSILON);
    hol_chains_destroy(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_molecule_gives_what_it_gives_alone),
        cmocka_unit_test(velocities_positions_and_fixman_force_too),
        cmocka_unit_test(a_bad_molecule_is_missing_from_the_sum),
        cmocka_unit_test(arrays_of_any_layout_share_atoms),
        cmocka_unit_test(the_middle_one_falls_apart_in_a_list_of_bonds),
        cmocka_unit_test(a_ring_through_a_fixed_atom_is_a_chain_between_two_copies_of_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
