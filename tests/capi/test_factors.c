/** Factors that are kept: forces and solutions as with hol_forces and hol_solve, right to the same bound. */
#include "assembly.h"
#include "check.h"
#include "mixture_forces.h"
#include "molecule_solution.h"
#include "random.h"

static const double UNTOUCHED = 7.25;

static double *filled(size_t n)
{
    double *a = malloc((n + 1) * sizeof *a);
    for (size_t i = 0; i <= n; ++i) a[i] = UNTOUCHED;
    return a;
}

static hol_factors *factors_at(const hol_chains *chains, const double *r)
{
    hol_factors *factors;
    CHECK(hol_factors_create(chains, &factors));
    CHECK(hol_factors_update(factors, r));
    return factors;
}

static void assert_solution(const mixture *m, const double *v, const double *f)
{
    forces_results s = {untouched((size_t)m->n_bonds), untouched((size_t)m->n_bonds), untouched(mixture_size(m)), {0}};
    hol_factors *factors = factors_at(m->chains, m->r);
    CHECK(hol_factors_forces(factors, v, f, s.lambda, s.tension, s.g, HOL_WRITE, s.virial));
    assert_mixture_forces(m, v, f, &s);
    hol_factors_destroy(factors);
    forces_results_free(&s);
}

static void forces_agree_with_a_dense_solution_for_molecules_of_every_shape(void **state)
{
    (void)state;
    for (int how = quick_run() ? 1 : 0; how < 2; ++how) {
        mixture m = mixture_of_all(quick_run() ? 1 : 3, (mixing)how, 100);
        assert_solution(&m, m.v, m.f);
        assert_solution(&m, m.v, NULL);
        assert_solution(&m, NULL, m.f);
        mixture_free(&m);
    }
    static const molecule_kind kinds[] = {MOLECULE_TREE, MOLECULE_RING,  MOLECULE_TRIANGLES, MOLECULE_COMB,
                                          MOLECULE_STAR, MOLECULE_CHAIN, MOLECULE_PEPTIDE,   MOLECULE_FUSED_RINGS};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; ++k) {
        mixture m = mixture_of_kind(kinds[k], quick_run() ? 5 : 60, 3, 14, MIXED, 200 + k);
        assert_solution(&m, m.v, m.f);
        mixture_free(&m);
    }
}

/** Forces on some atoms that are a millionth of those on others: multipliers that are small differences. */
static void uneven_forces_agree_with_a_dense_solution(void **state)
{
    (void)state;
    static const molecule_kind kinds[] = {MOLECULE_TREE,  MOLECULE_RING,    MOLECULE_COMB,       MOLECULE_STAR,
                                          MOLECULE_CHAIN, MOLECULE_PEPTIDE, MOLECULE_FUSED_RINGS};
    random_stream stream = random_seed(12);
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; ++k)
        for (int size = 3; size < 30; size = size * 3 + 1) {
            mixture m = mixture_of_kind(kinds[k], quick_run() ? 5 : 60, size, size + 3, MIXED, 400 + k);
            for (size_t i = 0; i < mixture_size(&m) / 3; ++i) {
                const double factor = random_uniform(&stream) < 0.2 ? 1 : 1e-6;
                for (int c = 0; c < 3; ++c) m.f[3 * i + (size_t)c] *= factor;
            }
            for (int64_t p = 0; p < m.n_parts; ++p) mixture_take(&m, p, m.f, m.parts[p].f);
            assert_solution(&m, NULL, m.f);
            mixture_free(&m);
        }
}

/**
 * Right-hand sides of which some bonds have a millionth of what others have, so that multipliers are small
 * differences: of many molecules, with what they pull; and of a single one, without, so that several share a vector.
 */
static void uneven_right_hand_sides_agree_with_a_dense_solution(void **state)
{
    (void)state;
    enum { SIDES = 5 };
    static const molecule_kind kinds[] = {MOLECULE_TREE,  MOLECULE_RING,    MOLECULE_COMB,       MOLECULE_STAR,
                                          MOLECULE_CHAIN, MOLECULE_PEPTIDE, MOLECULE_FUSED_RINGS};
    random_stream stream = random_seed(11);
    for (size_t k = 0; k < 2 * (sizeof kinds / sizeof *kinds); ++k)
        for (int size = 3; size < 30; size = size * 3 + 1) {
            const int64_t n = k % 2 ? 1 : quick_run() ? 5 : 40;
            mixture m = mixture_of_kind(kinds[k / 2], n, size, size + 3, MIXED, 300 + k / 2);
            const size_t bonds = (size_t)m.n_bonds, atoms = mixture_size(&m);
            double *rhs = untouched(SIDES * bonds), *lambda = untouched(SIDES * bonds), *g = untouched(SIDES * atoms);
            for (size_t i = 0; i < SIDES * bonds; ++i)
                rhs[i] = random_normal(&stream) * pow(10, random_uniform(&stream) < 0.5 ? 0 : -6);
            hol_factors *factors = factors_at(m.chains, m.r);
            CHECK(hol_factors_solve(factors, SIDES, rhs, lambda, n > 1 ? g : NULL, HOL_WRITE, NULL));
            for (int64_t p = 0; p < m.n_parts; ++p)
                for (size_t s = 0; s < SIDES; ++s) {
                    const molecule *part = m.parts + p;
                    const molecule_problem problem = molecule_problem_of(part);
                    const long double unit = oracle_bound(part->n_bonds) * DBL_EPSILON;
                    double *of = untouched((size_t)part->n_bonds), *found = untouched((size_t)part->n_bonds);
                    double *pull = untouched(3 * (size_t)part->n_atoms);
                    molecule_solution exact;
                    mixture_take_bonds(&m, p, rhs + s * bonds, of);
                    mixture_take_bonds(&m, p, lambda + s * bonds, found);
                    mixture_take(&m, p, g + s * atoms, pull);
                    assert_int_equal(molecule_solve(&problem, of, &exact), 0);
                    for (int64_t b = 0; b < part->n_bonds; ++b)
                        CHECK_AT_MOST(fabsl(found[b] - exact.lambda[b]), unit * exact.lambda_scale[b]);
                    for (int64_t i = 0; i < 3 * part->n_atoms; ++i)
                        if (n > 1 && exact.g_scale[i / 3] > 0)
                            CHECK_AT_MOST(fabsl(pull[i] - exact.g[i]), unit * exact.g_scale[i / 3]);
                    free(of), free(found), free(pull);
                    molecule_solution_free(&exact);
                }
            hol_factors_destroy(factors);
            free(rhs), free(lambda), free(g);
            mixture_free(&m);
        }
}

/** Chains of every length, in rows, lists and blocks that are not full, beside hol_forces. */
static void chains_agree_with_hol_forces(void **state)
{
    (void)state;
    const chain_kind kinds[] = {CHAIN_COIL, CHAIN_NEARLY_STRAIGHT, CHAIN_MASSES_1E6};
    for (int k = 0; k < 3; ++k)
        for (int how = 0; how < 2; ++how)
            for (int64_t n = 1; n < (quick_run() ? 500 : 2000); n = n < 12 ? n + 1 : n * 5 / 2) {
                assembly a = assembly_of_kind(kinds[k], 11, n, n % 3 ? n : n + 2, (arrangement)how, (uint64_t)n);
                const size_t size = assembly_size(&a), bonds = (size_t)a.n_bonds;
                double *lambda[2], *tension[2], *g[2], virial[2][9];
                for (int i = 0; i < 2; ++i)
                    lambda[i] = untouched(bonds), tension[i] = untouched(bonds), g[i] = untouched(size);
                hol_factors *factors = factors_at(a.chains, a.r);
                CHECK(hol_forces(a.chains, a.r, a.v, a.f, lambda[0], tension[0], g[0], HOL_WRITE, virial[0]));
                CHECK(hol_factors_forces(factors, a.v, a.f, lambda[1], tension[1], g[1], HOL_WRITE, virial[1]));
                for (int64_t c = 0; c < a.n_chains; ++c) {
                    double largest = 0;
                    for (int64_t b = a.first_bond[c]; b < a.first_bond[c + 1]; ++b)
                        largest = fmax(largest, fabs(tension[0][b]));
                    for (int64_t b = a.first_bond[c]; b < a.first_bond[c + 1]; ++b) {
                        CHECK_AT_MOST(fabs(tension[1][b] - tension[0][b]), 1e-13 * largest);
                        CHECK_AT_MOST(fabs(lambda[1][b] - lambda[0][b]), 1e-13 * fabs(largest / a.length[b]));
                    }
                    for (int64_t i = 0; i <= assembly_bonds(&a, c); ++i)
                        for (int x = 0; x < 3; ++x) {
                            const int64_t e = 3 * a.atoms[a.first[c] + i] + x;
                            CHECK_AT_MOST(fabs(g[1][e] - g[0][e]), 2e-13 * largest);
                        }
                }
                for (int i = 0; i < 2; ++i) free(lambda[i]), free(tension[i]), free(g[i]);
                hol_factors_destroy(factors);
                assembly_free(&a);
            }
}

/** Molecules too large for lanes, by sparse LDL^T, as large trees and as rings, beside hol_forces and hol_solve. */
static void large_molecules_agree_with_hol_forces(void **state)
{
    (void)state;
    static const molecule_kind kinds[] = {MOLECULE_PEPTIDE, MOLECULE_FUSED_RINGS, MOLECULE_COMB, MOLECULE_RING};
    static const int64_t sizes[] = {60, 120, 1100, 700};
    random_stream stream = random_seed(13);
    for (int k = 0; k < 4; ++k)
        for (int how = 0; how < 2; ++how) {
            mixture m = mixture_of_kind(kinds[k], 2, sizes[k], sizes[k], (mixing)how, 500 + (uint64_t)k);
            const size_t bonds = (size_t)m.n_bonds;
            double *rhs = untouched(2 * bonds), *lambda[2], *g[2], largest;
            for (int i = 0; i < 2; ++i) lambda[i] = untouched(2 * bonds), g[i] = untouched(mixture_size(&m));
            for (size_t b = 0; b < bonds; ++b) rhs[b] = rhs[bonds + b] = random_normal(&stream);
            hol_factors *factors = factors_at(m.chains, m.r);
            for (int what = 0; what < 4; ++what) {
                const double *v = what == 1 ? m.v : NULL;
                if (what == 2) {
                    CHECK(hol_solve(m.chains, m.r, rhs, lambda[0], g[0], HOL_WRITE, NULL));
                    CHECK(hol_factors_solve(factors, 1, rhs, lambda[1], g[1], HOL_WRITE, NULL));
                } else if (what == 3) {  // the same as two at once
                    memcpy(lambda[0], lambda[1], bonds * sizeof *rhs);
                    CHECK(hol_factors_solve(factors, 2, rhs, lambda[1], NULL, HOL_WRITE, NULL));
                    assert_same_bits(lambda[1], lambda[0], bonds);
                    assert_same_bits(lambda[1] + bonds, lambda[0], bonds);
                } else {
                    CHECK(hol_forces(m.chains, m.r, v, m.f, lambda[0], NULL, g[0], HOL_WRITE, NULL));
                    CHECK(hol_factors_forces(factors, v, m.f, lambda[1], NULL, g[1], HOL_WRITE, NULL));
                }
                largest = 0;
                for (size_t b = 0; b < bonds; ++b) largest = fmax(largest, fabs(lambda[0][b]));
                assert_true(largest > 0);
                for (size_t b = 0; b < bonds; ++b) CHECK_AT_MOST(fabs(lambda[1][b] - lambda[0][b]), 1e-12 * largest);
            }
            hol_factors_destroy(factors);
            free(rhs);
            for (int i = 0; i < 2; ++i) free(lambda[i]), free(g[i]);
            mixture_free(&m);
        }
}

/** Several right-hand sides at once, in place, added, and with what changes beside them. */
static void right_hand_sides_are_solved_as_by_hol_solve(void **state)
{
    (void)state;
    enum { SIDES = 3 };
    mixture m = mixture_of_all(1, MIXED, 7);
    const size_t bonds = (size_t)m.n_bonds, size = mixture_size(&m);
    random_stream stream = random_seed(8);
    double *rhs = filled(SIDES * bonds), *lambda = filled(SIDES * bonds), *one = filled(bonds);
    double *g = filled(SIDES * size), *g_one = filled(size), virial[SIDES][9], virial_one[9];
    for (size_t i = 0; i < SIDES * bonds; ++i)
        rhs[i] = m.length[i % bonds] * m.length[i % bonds] * random_normal(&stream);
    hol_factors *factors = factors_at(m.chains, m.r);
    CHECK(hol_factors_solve(factors, SIDES, rhs, lambda, g, HOL_WRITE, virial[0]));
    for (int s = 0; s < SIDES; ++s) {
        CHECK(hol_solve(m.chains, m.r, rhs + (size_t)s * bonds, one, g_one, HOL_WRITE, virial_one));
        double largest = 0;
        for (size_t i = 0; i < size; ++i) largest = fmax(largest, fabs(g_one[i]) < 1e300 ? fabs(g_one[i]) : 0);
        for (size_t i = 0; i < size; ++i)
            if (g_one[i] != UNTOUCHED) CHECK_AT_MOST(fabs(g[(size_t)s * size + i] - g_one[i]), 1e-11 * largest);
        for (int i = 0; i < 9; ++i)
            CHECK_AT_MOST(fabs(virial[s][i] - virial_one[i]),
                          1e-11 * fabs(virial_one[0] + virial_one[4] + virial_one[8]) + 1e-9 * largest);
    }
    CHECK(hol_factors_solve(factors, SIDES, rhs, rhs, NULL, HOL_WRITE, NULL));
    assert_same_bits(rhs, lambda, SIDES * bonds);
    CHECK(hol_factors_solve(factors, 0, NULL, NULL, NULL, HOL_WRITE, NULL));
    hol_factors_destroy(factors);
    free(rhs), free(lambda), free(one), free(g), free(g_one);
    mixture_free(&m);
}

static void forces_may_replace_the_applied_ones_or_be_added_in_any_layout(void **state)
{
    (void)state;
    mixture m = mixture_of_all(1, MIXED, 9);
    const size_t size = mixture_size(&m), n = size / 3;
    double *g = filled(size), *in_place = copy_of(m.f, size), *sum = copy_of(m.f, size);
    double *parts = malloc(size * sizeof *parts), *to = malloc(size * sizeof *to);
    hol_factors *factors = factors_at(m.chains, m.r);
    CHECK(hol_factors_forces(factors, m.v, m.f, NULL, NULL, g, HOL_WRITE, NULL));
    CHECK(hol_factors_forces(factors, m.v, in_place, NULL, NULL, in_place, HOL_WRITE, NULL));
    CHECK(hol_factors_forces(factors, m.v, sum, NULL, NULL, sum, HOL_ADD, NULL));
    for (size_t i = 0; i < size; ++i) parts[i % 3 * n + i / 3] = m.f[i], to[i] = UNTOUCHED;
    const hol_const_view v = hol_const_view_rows(m.v), f = hol_const_view_parts(parts, parts + n, parts + 2 * n);
    const hol_view out = hol_view_parts(to, to + n, to + 2 * n);
    CHECK(hol_factors_forces_view(factors, &v, &f, NULL, NULL, &out, HOL_WRITE, NULL));
    for (size_t i = 0; i < size; ++i) {
        const double is = to[i % 3 * n + i / 3];
        assert_true(is == g[i]);
        if (g[i] == UNTOUCHED) continue;
        assert_true(in_place[i] == g[i] && sum[i] == m.f[i] + g[i]);
    }
    hol_factors_destroy(factors);
    free(g), free(in_place), free(sum), free(parts), free(to);
    mixture_free(&m);
}

static void factors_belong_to_the_set_and_positions_of_the_update(void **state)
{
    (void)state;
    const double mass[4] = {1, 2, 3, 4}, length[3] = {1, 1, 1}, rate[9] = {0.1, 0, 0, 0, 0.2, 0, 0, 0, 0.3};
    double r[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 1, 1, 1}, f[12], v[12], g[2][12], box[9] = {5, 0, 0, 0, 5, 0, 0, 0, 5};
    hol_chains *chains;
    hol_factors *factors;
    CHECK(hol_chains_create(4, mass, &chains));
    CHECK(hol_chains_add_block(chains, 1, 3, 0, length));
    CHECK(hol_factors_create(chains, &factors));
    for (int i = 0; i < 12; ++i) f[i] = 0.1 * i * i - i, v[i] = 0.3 * i - 0.05 * i * i;
    CHECK_FAILS(HOL_ERR_STATE, hol_factors_forces(factors, v, f, NULL, NULL, g[0], HOL_WRITE, NULL));
    r[9] += 5;
    CHECK(hol_chains_set_box(chains, box));
    CHECK(hol_chains_set_box_rate(chains, rate));
    CHECK(hol_factors_update(factors, r));
    CHECK(hol_forces(chains, r, v, f, NULL, NULL, g[0], HOL_WRITE, NULL));
    CHECK(hol_chains_set_box(chains, NULL));
    CHECK(hol_factors_forces(factors, v, f, NULL, NULL, g[1], HOL_WRITE, NULL));
    for (int i = 0; i < 12; ++i) CHECK_AT_MOST(fabs(g[0][i] - g[1][i]), 1e-13);
    CHECK(hol_chains_set_length(chains, 1, 1.5));
    CHECK_FAILS(HOL_ERR_STATE, hol_factors_forces(factors, v, f, NULL, NULL, g[0], HOL_WRITE, NULL));
    CHECK_FAILS(HOL_ERR_STATE, hol_factors_solve(factors, 1, f, NULL, NULL, HOL_WRITE, NULL));
    CHECK(hol_factors_update(factors, r));
    CHECK_FAILS(HOL_ERR_VALUE, hol_factors_forces(factors, v, f, NULL, NULL, g[0], (hol_mode)2, NULL));
    CHECK_FAILS(HOL_ERR_VALUE, hol_factors_solve(factors, -1, f, NULL, NULL, HOL_WRITE, NULL));
    CHECK_FAILS(HOL_ERR_NULL, hol_factors_update(factors, NULL));
    CHECK_FAILS(HOL_ERR_NULL, hol_factors_forces(NULL, v, f, NULL, NULL, g[0], HOL_WRITE, NULL));
    hol_factors_destroy(factors);
    CHECK_FAILS(HOL_ERR_NULL, hol_factors_create(NULL, &factors));
    assert_null(factors);
    hol_chains_destroy(chains);
}

static void a_bad_molecule_is_named_and_the_others_are_complete(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_COIL, 9, 7, 7, IN_ORDER, 4);
    const size_t size = assembly_size(&a);
    double *g = filled(size), *good = filled(size), *lambda = filled((size_t)a.n_bonds), virial[9] = {7};
    hol_factors *factors = factors_at(a.chains, a.r);
    int64_t bad, atom;
    CHECK(hol_factors_forces(factors, a.v, a.f, NULL, NULL, good, HOL_WRITE, NULL));
    a.f[3 * a.atoms[a.first[4] + 2]] = NAN;
    CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_factors_forces(factors, a.v, a.f, lambda, NULL, g, HOL_WRITE, virial));
    hol_error_location(&bad, NULL, &atom, NULL);
    assert_true(bad == 4 && atom == a.atoms[a.first[4] + 2] && virial[0] == 7);
    for (int64_t c = 0; c < 9; ++c)
        for (int64_t i = 3 * a.atoms[a.first[c]]; i < 3 * a.atoms[a.first[c]] + 24; ++i)
            if (c == 4)
                assert_true(g[i] == UNTOUCHED);
            else
                CHECK_AT_MOST(fabs(g[i] - good[i]), 1e-12 * fabs(good[i]) + 1e-12);
    a.f[3 * a.atoms[a.first[4] + 2]] = 0;
    memcpy(a.r + 3 * a.atoms[a.first[6]], a.r + 3 * a.atoms[a.first[6] + 1], 3 * sizeof(double));
    CHECK_FAILS(HOL_ERR_DEGENERATE, hol_factors_update(factors, a.r));
    CHECK_FAILS(HOL_ERR_DEGENERATE, hol_factors_forces(factors, a.v, a.f, lambda, NULL, g, HOL_WRITE, virial));
    hol_error_location(&bad, NULL, NULL, NULL);
    assert_int_equal(bad, 6);
    hol_factors_destroy(factors);
    free(g), free(good), free(lambda);
    assembly_free(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forces_agree_with_a_dense_solution_for_molecules_of_every_shape),
        cmocka_unit_test(uneven_forces_agree_with_a_dense_solution),
        cmocka_unit_test(uneven_right_hand_sides_agree_with_a_dense_solution),
        cmocka_unit_test(chains_agree_with_hol_forces),
        cmocka_unit_test(large_molecules_agree_with_hol_forces),
        cmocka_unit_test(right_hand_sides_are_solved_as_by_hol_solve),
        cmocka_unit_test(forces_may_replace_the_applied_ones_or_be_added_in_any_layout),
        cmocka_unit_test(factors_belong_to_the_set_and_positions_of_the_update),
        cmocka_unit_test(a_bad_molecule_is_named_and_the_others_are_complete),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
