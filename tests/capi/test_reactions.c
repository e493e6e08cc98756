/** What given multipliers do: forces, impulses, tensions and virials, against the calls that found the multipliers. */
#include "assembly.h"
#include "check.h"
#include "input.h"
#include "layout.h"
#include "mixture.h"

static double largest_of(const double *x, size_t n)
{
    double largest = 0;
    for (size_t i = 0; i < n; ++i)
        if (fabs(x[i]) > largest) largest = fabs(x[i]);
    return largest;
}

/** To so many roundings of the largest pull of a bond, which sums of them may be much smaller than. */
static void assert_alike(const double *got, const double *expected, size_t n, double roundings, double pull)
{
    for (size_t i = 0; i < n; ++i)
        if (!isnan(expected[i])) CHECK_AT_MOST(fabs(got[i] - expected[i]), roundings * DBL_EPSILON * pull);
}

/** The six numbers of all bonds, added up, as [3][3]. */
static void sum_of_bonds(const double *w, int64_t n, double *virial)
{
    const int place[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    for (int i = 0; i < 9; ++i) {
        long double sum = 0;
        for (int64_t k = 0; k < n; ++k) sum += w[6 * k + place[i]];
        virial[i] = (double)sum;
    }
}

static void they_are_those_of_the_forces(void **state)
{
    (void)state;
    for (int kind = 0; kind < MOLECULE_GOOD_KINDS; ++kind) {
        mixture m = mixture_of_kind((molecule_kind)kind, 9, 3, 8, MIXED, 20 + (uint64_t)kind);
        const size_t size = mixture_size(&m), n = (size_t)m.n_bonds;
        double *lambda = untouched(n), *tension = untouched(n), *T = untouched(n), *w = untouched(6 * n),
               *g = untouched(size), *G = untouched(size), virial[9], sum[9], of_bonds[9];
        CHECK(hol_forces(m.chains, m.r, m.v, m.f, lambda, tension, g, HOL_WRITE, virial));
        CHECK(hol_reactions(m.chains, m.r, HOL_BOX, lambda, T, G, HOL_WRITE, w, sum));
        const double pull = largest_of(tension, n), longest = largest_of(m.length, n);
        assert_alike(T, tension, n, 8, pull);
        sum_of_bonds(w, m.n_bonds, of_bonds);
        assert_alike(sum, of_bonds, 9, 8 * (double)n, pull * longest);
        assert_alike(sum, virial, 9, 8 * (double)n, pull * longest);
        for (size_t i = 0; i < size; ++i) assert_true(isnan(g[i]) == isnan(G[i]));
        assert_alike(G, g, size, 32, pull);
        free(lambda), free(tension), free(T), free(w), free(g), free(G);
        mixture_free(&m);
    }
}

static void impulses_are_what_velocities_and_positions_get(void **state)
{
    (void)state;
    const double dt = 0.002, box[9] = {23, 0, 0, 2, 19, 0, -3, 1, 29}, before[9] = {22.9, 0, 0, 2, 19.1, 0, -3, 1, 29};
    static const molecule_kind kinds[] = {MOLECULE_CHAIN, MOLECULE_WATER, MOLECULE_COMB, MOLECULE_RING, MOLECULE_CUBE};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; ++k) {
        mixture m = mixture_of_kind(kinds[k], 40, 3, 9, MIXED, 30 + k);
        const size_t size = mixture_size(&m), n = (size_t)m.n_bonds;
        double *v = copy_of(m.v, size), *G = untouched(size), *dv = untouched(size), *lambda = untouched(n),
               *w = untouched(6 * n), virial[9], sum[9];
        CHECK(hol_project_velocities(m.chains, m.r, v, lambda, virial));
        CHECK(hol_reactions(m.chains, m.r, HOL_BOX, lambda, NULL, G, HOL_WRITE, w, NULL));
        for (size_t i = 0; i < size; ++i)
            if (!isnan(v[i])) CHECK_AT_MOST(fabs(m.mass[i / 3] * (v[i] - m.v[i]) - G[i]), 1e-13 * (1 + m.mass[i / 3]));
        sum_of_bonds(w, m.n_bonds, sum);
        assert_alike(sum, virial, 9, 8 * (double)n, 4 * largest_of(lambda, n));

        double *r_ref = copy_of(m.r, size), *r;
        for (size_t i = 0; i < size; ++i)
            r_ref[i] += before[4 * (i % 3)] * (double)((int)(i / 3) % 3 - 1) * (i % 3 == 0);
        r = copy_of(r_ref, size);
        for (size_t i = 0; i < size; ++i)
            r[i] += dt * m.v[i] + (i % 3 == 0 ? (box[0] - before[0]) * ((int)(i / 3) % 3 - 1) : 0);
        double *drifted = copy_of(r, size);
        CHECK(hol_chains_set_box(m.chains, box));
        CHECK(hol_chains_set_reference_box(m.chains, before));
        CHECK(hol_project_positions(m.chains, r_ref, r, NULL, dt, lambda, 0, virial, NULL));
        CHECK(hol_reactions(m.chains, r_ref, HOL_REFERENCE_BOX, lambda, NULL, G, HOL_WRITE, w, sum));
        assert_alike(sum, virial, 9, 8 * (double)n, 4 * largest_of(lambda, n));
        for (size_t i = 0; i < size; ++i)
            if (!isnan(r[i]) && m.mass[i / 3] > 0)
                CHECK_AT_MOST(fabs(r[i] - drifted[i] - dt * dt * G[i] / m.mass[i / 3]), 64 * 30 * DBL_EPSILON);
        free(v), free(G), free(dv), free(lambda), free(w), free(r_ref), free(r), free(drifted);
        mixture_free(&m);
    }
}

static void long_chains_threads_and_layouts_change_no_bit(void **state)
{
    (void)state;
    chain parts[7];
    for (int c = 0; c < 7; ++c) parts[c] = chain_make(CHAIN_HETEROGENEOUS, c < 5 ? 3 + c : 9000 * (c - 4), (uint64_t)c);
    for (int way = 0; way < 2; ++way) {
        assembly a = assembly_make(parts, 7, way ? SCATTERED : IN_ORDER, 4);
        const size_t size = assembly_size(&a), n = (size_t)a.n_bonds;
        double *lambda = untouched(n), *g = untouched(size), *G = untouched(size), *H = untouched(size),
               *w = untouched(6 * n), *u = untouched(6 * n), virial[9], sum[9];
        CHECK(hol_forces(a.chains, a.r, a.v, a.f, lambda, NULL, g, HOL_WRITE, NULL));
        CHECK(hol_reactions(a.chains, a.r, HOL_BOX, lambda, NULL, G, HOL_WRITE, w, virial));
        assert_alike(G, g, size, 32, 4 * largest_of(lambda, n));
        CHECK(hol_chains_set_threads(a.chains, 2));
        CHECK(hol_reactions(a.chains, a.r, HOL_BOX, lambda, NULL, H, HOL_WRITE, u, sum));
        assert_same_bits(G, H, size);
        assert_same_bits(w, u, 6 * n);
        assert_same_bits(virial, sum, 9);
        for (int l = 0; l < n_double_layouts; ++l) {
            laid_out r = lay_out(layouts + l, a.n_atoms, a.r, 3), out = lay_out(layouts + l, a.n_atoms, H, 3);
            CHECK(hol_reactions_view(a.chains, INPUT(&r.view), HOL_BOX, lambda, NULL, &out.view, HOL_WRITE, u, NULL));
            collect(&out, H);
            assert_same_bits(G, H, size);
            assert_same_bits(w, u, 6 * n);
            assert_true(gaps_untouched(&out));
            laid_out_free(&r), laid_out_free(&out);
        }
        free(lambda), free(g), free(G), free(H), free(w), free(u);
        assembly_free(&a);
    }
    for (int c = 0; c < 7; ++c) chain_free(parts + c);
}

static void they_are_added_where_asked_and_floats_round_once(void **state)
{
    (void)state;
    mixture m = mixture_of_kind(MOLECULE_PEPTIDE, 4, 1, 3, MIXED, 40);
    const size_t size = mixture_size(&m);
    double *lambda = untouched((size_t)m.n_bonds), *g = untouched(size), *sum = copy_of(m.f, size);
    CHECK(hol_forces(m.chains, m.r, m.v, m.f, lambda, NULL, NULL, HOL_WRITE, NULL));
    CHECK(hol_reactions(m.chains, m.r, HOL_BOX, lambda, NULL, g, HOL_WRITE, NULL, NULL));
    CHECK(hol_reactions(m.chains, m.r, HOL_BOX, lambda, NULL, sum, HOL_ADD, NULL, NULL));
    for (size_t i = 0; i < size; ++i)
        if (!isnan(m.f[i])) assert_true(sum[i] == m.f[i] + g[i]);
    for (int l = n_double_layouts; l < n_layouts; ++l) {
        laid_out r = lay_out(layouts + l, m.n_atoms, m.r, 3), out = lay_out(layouts + l, m.n_atoms, m.f, 3);
        double *x = copy_of(m.r, size), *expected = untouched(size), *got = untouched(size);
        collect(&r, x);
        CHECK(hol_reactions(m.chains, x, HOL_BOX, lambda, NULL, expected, HOL_WRITE, NULL, NULL));
        CHECK(hol_reactions_view(m.chains, INPUT(&r.view), HOL_BOX, lambda, NULL, &out.view, HOL_WRITE, NULL, NULL));
        collect(&out, got);
        for (size_t i = 0; i < size; ++i)
            if (!isnan(m.f[i])) assert_true(got[i] == (double)(float)expected[i]);
        free(x), free(expected), free(got);
        laid_out_free(&r), laid_out_free(&out);
    }
    free(lambda), free(g), free(sum);
    mixture_free(&m);
}

/** Two chains that end at a fixed atom, one that passes through another, and a bond between the two. */
static void fixed_atoms_get_the_sum_of_what_pulls_at_them(void **state)
{
    (void)state;
    const double mass[6] = {1, 0, 2, 0, 1, 3}, length[6] = {1, 1, 1, 1, 1, 1};
    const double r[18] = {-1, 0, 0, 0, 0, 0, 0.6, 0.8, 0, 3, 0, 0, 3, 1, 0, 3, 0, 1};
    const int64_t pairs[10] = {0, 1, 1, 2, 3, 4, 3, 5, 1, 3};
    const double lambda[5] = {1, -2, 3, 0.5, NAN};
    double g[18], tension[5], w[30];
    hol_chains *chains = NULL;
    CHECK(hol_chains_create(6, mass, &chains));
    CHECK(hol_chains_add_bonds(chains, 5, pairs, length));
    CHECK(hol_reactions(chains, r, HOL_BOX, lambda, tension, g, HOL_WRITE, w, NULL));
    const double expected[18] = {2, 0, 0, -2 - 2.4, -3.2, 0, 2.4, 3.2, 0, 0, 6, 1, 0, -6, 0, 0, 0, -1};
    for (int i = 0; i < 18; ++i) CHECK_AT_MOST(fabs(g[i] - expected[i]), 8 * DBL_EPSILON * 6);
    assert_true(tension[4] == 0 && w[24] == 0 && w[29] == 0);
    assert_true(tension[1] < 0);
    hol_chains_destroy(chains);
}

/** hol_solve divides a chain at its fixed atoms: both parts pull at them, and the chain is one molecule all the same.
 */
static void parts_of_a_divided_chain_are_put_together(void **state)
{
    (void)state;
    const double mass[5] = {1, 0, 2, 0, 1}, length[4] = {1, 1, 1, 1};
    const double r[15] = {0, 0, 0, 1, 0, 0, 1, 1, 0.2, 2, 1, 0, 2, 1, 1},
                 v[15] = {1, 2, 3, 0, 0, 0, 3, 1, 2, 0, 0, 0, 1, 5, 2};
    double f[15], rhs[4], lambda[4], expected[4], g[15], G[15], virial[9], other[9];
    const int64_t atoms[5] = {0, 1, 2, 3, 4};
    hol_chains *chains = NULL;
    for (int i = 0; i < 15; ++i) f[i] = i % 4 - 1.5;
    CHECK(hol_chains_create(5, mass, &chains));
    CHECK(hol_chains_add(chains, 4, atoms, length));
    for (int k = 0; k < 4; ++k) {
        double sum = 0;
        for (int x = 0; x < 3; ++x) {
            const int i = 3 * k + x, j = i + 3;
            const double wi = mass[k] > 0 ? 1 / mass[k] : 0, wj = mass[k + 1] > 0 ? 1 / mass[k + 1] : 0;
            sum += (r[j] - r[i]) * (wj * f[j] - wi * f[i]) + (v[j] - v[i]) * (v[j] - v[i]);
        }
        rhs[k] = 2 * sum;
    }
    CHECK(hol_forces(chains, r, v, f, expected, NULL, G, HOL_WRITE, virial));
    CHECK(hol_solve(chains, r, rhs, lambda, g, HOL_WRITE, other));
    for (int k = 0; k < 4; ++k) CHECK_AT_MOST(fabs(lambda[k] - expected[k]), 1e-13);
    for (int i = 0; i < 15; ++i) CHECK_AT_MOST(fabs(g[i] - G[i]), 1e-13);
    for (int i = 0; i < 9; ++i) CHECK_AT_MOST(fabs(virial[i] - other[i]), 1e-12);
    rhs[3] = NAN;
    double *untouched_g = untouched(15), *untouched_lambda = untouched(4);
    int64_t bond, n_bad;
    CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_solve(chains, r, rhs, untouched_lambda, untouched_g, HOL_WRITE, NULL));
    hol_error_location(NULL, &bond, NULL, &n_bad);
    assert_true(bond == 3 && n_bad == 1);
    assert_untouched(untouched_g, 15);
    assert_untouched(untouched_lambda, 4);
    free(untouched_g), free(untouched_lambda);
    hol_chains_destroy(chains);
}

static void bad_molecules_are_named_and_left_alone(void **state)
{
    (void)state;
    mixture m = mixture_of_kind(MOLECULE_TREE, 12, 3, 9, ONE_AFTER_THE_OTHER, 50);
    const size_t size = mixture_size(&m), n = (size_t)m.n_bonds;
    double *lambda = untouched(n), *g = untouched(size), *all = untouched(size), *T = untouched(n),
           *w = untouched(6 * n);
    double virial[9];
    CHECK(hol_forces(m.chains, m.r, m.v, m.f, lambda, NULL, NULL, HOL_WRITE, NULL));
    CHECK(hol_reactions(m.chains, m.r, HOL_BOX, lambda, NULL, all, HOL_WRITE, NULL, NULL));
    lambda[m.first_bond[4] + 1] = NAN;
    m.r[3 * m.first_atom[9]] = INFINITY;
    for (int i = 0; i < 9; ++i) virial[i] = 7;
    CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_reactions(m.chains, m.r, HOL_BOX, lambda, T, g, HOL_WRITE, w, virial));
    int64_t number, bond, n_bad;
    hol_error_location(&number, &bond, NULL, &n_bad);
    assert_true(number == 4 && n_bad == 2);
    assert_message_names("multiplier of bond");
    for (int64_t p = 0; p < 12; ++p) {
        const size_t at = 3 * (size_t)m.first_atom[p], atoms = 3 * (size_t)m.parts[p].n_atoms,
                     first = (size_t)m.first_bond[p], bonds = (size_t)m.parts[p].n_bonds;
        if (p == 4 || p == 9) {
            assert_untouched(g + at, atoms);
            assert_untouched(T + first, bonds);
            assert_untouched(w + 6 * first, 6 * bonds);
        } else {
            assert_same_bits(g + at, all + at, atoms);
        }
    }
    for (int i = 0; i < 9; ++i) assert_true(virial[i] == 7);
    lambda[m.first_bond[4] + 1] = 1e308;
    CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_reactions(m.chains, m.r, HOL_BOX, lambda, NULL, g, HOL_WRITE, NULL, NULL));
    hol_error_location(&number, NULL, NULL, &n_bad);
    assert_true(number == 4 && n_bad == 2);
    unsigned char active[12];
    memset(active, 1, sizeof active);
    active[4] = active[9] = 0;
    CHECK(hol_chains_set_active(m.chains, active));
    CHECK(hol_reactions(m.chains, m.r, HOL_BOX, lambda, T, g, HOL_WRITE, w, virial));
    assert_untouched(T + m.first_bond[4], (size_t)m.parts[4].n_bonds);
    CHECK_FAILS(HOL_ERR_NULL, hol_reactions(NULL, m.r, HOL_BOX, lambda, T, NULL, HOL_WRITE, NULL, NULL));
    CHECK_FAILS(HOL_ERR_NULL, hol_reactions(m.chains, NULL, HOL_BOX, lambda, T, NULL, HOL_WRITE, NULL, NULL));
    CHECK_FAILS(HOL_ERR_NULL, hol_reactions(m.chains, m.r, HOL_BOX, NULL, T, NULL, HOL_WRITE, NULL, NULL));
    CHECK_FAILS(HOL_ERR_VALUE, hol_reactions(m.chains, m.r, 2, lambda, T, NULL, HOL_WRITE, NULL, NULL));
    CHECK_FAILS(HOL_ERR_VALUE, hol_reactions(m.chains, m.r, HOL_BOX, lambda, T, NULL, 2, NULL, NULL));
    free(lambda), free(g), free(all), free(T), free(w);
    mixture_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(they_are_those_of_the_forces),
        cmocka_unit_test(impulses_are_what_velocities_and_positions_get),
        cmocka_unit_test(long_chains_threads_and_layouts_change_no_bit),
        cmocka_unit_test(they_are_added_where_asked_and_floats_round_once),
        cmocka_unit_test(fixed_atoms_get_the_sum_of_what_pulls_at_them),
        cmocka_unit_test(parts_of_a_divided_chain_are_put_together),
        cmocka_unit_test(bad_molecules_are_named_and_left_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
