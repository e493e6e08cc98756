/** What the library says about the shapes of molecules, and molecules that share fixed atoms. */
#include "check.h"
#include "mixture.h"
#include "molecule_solution.h"

static void shapes_are_recognised_whatever_the_order_of_the_bonds(void **state)
{
    (void)state;
    static const struct {
        molecule_kind kind;
        int64_t size;
        int shape;
    } known[] = {
        {MOLECULE_CHAIN, 1, HOL_SHAPE_CHAIN},       {MOLECULE_CHAIN, 9, HOL_SHAPE_CHAIN},
        {MOLECULE_XH2, 2, HOL_SHAPE_CHAIN},         {MOLECULE_XH3, 3, HOL_SHAPE_TREE},
        {MOLECULE_XH4, 4, HOL_SHAPE_TREE},          {MOLECULE_NEOPENTANE, 1, HOL_SHAPE_TREE},
        {MOLECULE_ALKANE, 5, HOL_SHAPE_TREE},       {MOLECULE_COMB, 6, HOL_SHAPE_TREE},
        {MOLECULE_DENDRIMER, 2, HOL_SHAPE_TREE},    {MOLECULE_STAR, 5, HOL_SHAPE_TREE},
        {MOLECULE_WATER, 3, HOL_SHAPE_TRIANGLE},    {MOLECULE_BENT, 3, HOL_SHAPE_TRIANGLE},
        {MOLECULE_RING, 4, HOL_SHAPE_RING},         {MOLECULE_RING, 17, HOL_SHAPE_RING},
        {MOLECULE_BENZENE, 6, HOL_SHAPE_OTHER},     {MOLECULE_TRIANGLES, 5, HOL_SHAPE_OTHER},
        {MOLECULE_FUSED_RINGS, 2, HOL_SHAPE_OTHER}, {MOLECULE_CUBE, 8, HOL_SHAPE_OTHER},
        {MOLECULE_LARIAT, 6, HOL_SHAPE_OTHER},      {MOLECULE_PEPTIDE, 3, HOL_SHAPE_OTHER},
        {MOLECULE_PEPTIDE, 1, HOL_SHAPE_TREE},
    };
    enum { N = sizeof known / sizeof *known };
    molecule parts[N];
    int64_t of_shape[5] = {0};
    for (int p = 0; p < N; ++p) {
        parts[p] = molecule_make(known[p].kind, known[p].size, 1);
        ++of_shape[known[p].shape];
    }
    for (uint64_t seed = 0; seed < 3; ++seed) {
        mixture m = mixture_make(parts, N, seed ? MIXED : ONE_AFTER_THE_OTHER, seed);
        int64_t *molecules = calloc((size_t)m.n_bonds, sizeof *molecules), freedoms = 0;
        assert_int_equal(hol_chains_n_molecules(m.chains), N);
        for (int s = 0; s < 5; ++s) assert_int_equal(hol_chains_n_of_shape(m.chains, s), of_shape[s]);
        CHECK(hol_chains_molecules_of_bonds(m.chains, molecules));
        for (int p = 0; p < N; ++p) {
            int shape;
            int64_t n_atoms, n_bonds, atoms[400], bonds[400];
            const int64_t c = molecules[m.bonds[m.first_bond[p]]];
            for (int64_t k = m.first_bond[p]; k < m.first_bond[p + 1]; ++k) assert_int_equal(molecules[m.bonds[k]], c);
            CHECK(hol_chains_molecule(m.chains, c, &shape, &n_atoms, &n_bonds));
            assert_int_equal(shape, known[p].shape);
            assert_int_equal(n_atoms, parts[p].n_atoms);
            assert_int_equal(n_bonds, parts[p].n_bonds);
            CHECK(hol_chains_atoms(m.chains, c, atoms));
            CHECK(hol_chains_bonds(m.chains, c, bonds));
            /* the part's own atoms and bonds: ascending, and by lower and higher atom, but for linear chains */
            for (int64_t i = 0; shape != HOL_SHAPE_CHAIN && i < n_atoms; ++i)
                assert_int_equal(atoms[i], m.atoms[m.first_atom[p] + i]);
            for (int64_t k = 0; k < n_bonds; ++k) {
                assert_int_equal(molecules[bonds[k]], c);
                const int64_t *here = m.pairs + 2 * bonds[k];
                if (shape == HOL_SHAPE_CHAIN) {
                    assert_true((here[0] == atoms[k] && here[1] == atoms[k + 1]) ||
                                (here[1] == atoms[k] && here[0] == atoms[k + 1]));
                } else if (k > 0) {
                    const int64_t *before = m.pairs + 2 * bonds[k - 1];
                    const int64_t low = here[0] < here[1] ? here[0] : here[1], high = here[0] + here[1] - low;
                    const int64_t low0 = before[0] < before[1] ? before[0] : before[1];
                    assert_true(low > low0 || (low == low0 && high > before[0] + before[1] - low0));
                }
            }
            freedoms += 3 * n_atoms - n_bonds;
        }
        assert_int_equal(hol_chains_degrees_of_freedom(m.chains, 3),
                         freedoms + (seed ? 3 * 7 : 0)); /* and atoms alone */
        free(molecules);
        mixture_free(&m);
    }
    for (int p = 0; p < N; ++p) molecule_free(parts + p);
}

static void molecules_of_one_kind_are_known_to_be_whatever_the_order_of_their_bonds(void **state)
{
    (void)state;
    enum { N = 12 };
    molecule parts[N];
    for (int p = 0; p < N; ++p) {
        parts[p] = molecule_make(MOLECULE_NEOPENTANE, 1, 1);
        for (int64_t k = 0; k < parts[p].n_bonds; ++k) parts[p].length[k] = 1 + 0.01 * (double)(k % 3);
    }
    mixture m = mixture_make(parts, N, MIXED, 5);
    assert_int_equal(hol_chains_n_kinds(m.chains), 1);
    mixture_free(&m);
    parts[3].mass[4] *= 2; /* another kind of the same shape */
    m = mixture_make(parts, N, MIXED, 6);
    assert_int_equal(hol_chains_n_kinds(m.chains), 2);
    mixture_free(&m);
    for (int p = 0; p < N; ++p) molecule_free(parts + p);
}

/** A brush: branched molecules on one fixed atom, in several calls, beside others; each as if it had that atom alone.
 */
static void molecules_may_share_a_fixed_atom(void **state)
{
    (void)state;
    enum { N = 5 };
    molecule part[N], all = molecule_empty();
    const double origin[3] = {0, 0, 0};
    molecule_add_atom(&all, 0, origin);
    for (uint64_t p = 0; p < N; ++p) { /* a tree from the fixed atom on */
        random_stream s = random_seed(p + 1);
        part[p] = molecule_empty();
        molecule_add_atom(&part[p], 0, origin);
        for (int64_t k = 0; k < 6; ++k) {
            double u[3];
            random_direction(&s, u);
            molecule_grow(&part[p], k == 0 ? 0 : random_integer(&s, 1, k), 1 + random_uniform(&s), 1, u);
        }
        molecule_finish(&part[p], &s);
        for (int64_t i = 1; i <= 6; ++i) molecule_add_atom(&all, part[p].mass[i], part[p].r + 3 * i);
    }
    hol_chains *chains;
    CHECK(hol_chains_create(all.n_atoms, all.mass, &chains));
    for (int p = 0; p < N; ++p) {
        int64_t pairs[12];
        for (int k = 0; k < 12; ++k) pairs[k] = part[p].pairs[k] == 0 ? 0 : part[p].pairs[k] + 6 * p;
        CHECK(hol_chains_add_bonds(chains, 6, pairs, part[p].length));
        for (int i = 1; i <= 6; ++i)
            for (int x = 0; x < 3; ++x) {
                all.v[3 * (6 * p + i) + x] = part[p].v[3 * i + x];
                all.f[3 * (6 * p + i) + x] = part[p].f[3 * i + x];
            }
    }
    for (int x = 0; x < 3; ++x) all.v[x] = all.f[x] = 0;
    double lambda[6 * N], g[3 * (6 * N + 1)], fixman[3 * (6 * N + 1)];
    long double on_fixed[3] = {0}, size = 0;
    CHECK(hol_forces(chains, all.r, all.v, all.f, lambda, NULL, g, HOL_WRITE, NULL));
    CHECK(hol_metric(chains, all.r, 1, NULL, NULL, NULL, fixman, HOL_WRITE));
    for (int p = 0; p < N; ++p) {
        const molecule_problem problem = molecule_problem_of(part + p);
        const long double unit = oracle_bound(6) * DBL_EPSILON;
        molecule_solution exact;
        part[p].f[0] = part[p].f[1] = part[p].f[2] = 0;
        assert_int_equal(molecule_forces(&problem, &exact), 0);
        for (int k = 0; k < 6; ++k)
            CHECK_AT_MOST(fabsl(lambda[6 * p + k] - exact.lambda[k]), unit * exact.lambda_scale[k]);
        for (int i = 3; i < 21; ++i) CHECK_AT_MOST(fabsl(g[18 * p + i] - exact.g[i]), unit * exact.g_scale[i / 3]);
        for (int x = 0; x < 3; ++x) on_fixed[x] += exact.g[x];
        size += exact.g_scale[0];
        molecule_solution_free(&exact);
    }
    long double total[3] = {0};
    for (int i = 0; i < 3 * (6 * N + 1); ++i) total[i % 3] += fixman[i];
    for (int x = 0; x < 3; ++x) {
        CHECK_AT_MOST(fabsl(g[x] - on_fixed[x]), oracle_bound(6) * DBL_EPSILON * size);
        CHECK_AT_MOST(fabsl(total[x]), 1000 * DBL_EPSILON);
    }
    hol_chains_destroy(chains);
    molecule_free(&all);
    for (int p = 0; p < N; ++p) molecule_free(part + p);
}

static void bonds_between_fixed_atoms_are_no_constraints(void **state)
{
    (void)state;
    /* a square of fixed atoms with both diagonals, and a molecule that hangs between two of them */
    const double mass[6] = {0, 0, 0, 0, 1, 2};
    const double r[18] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0.4, 0.3, 0.9, 0.8, 0.6, 1.1};
    const int64_t pairs[20] = {0, 1, 1, 2, 2, 3, 3, 0, 0, 2, 1, 3, 0, 4, 4, 5, 5, 2, 4, 1};
    double length[10], f[18], lambda[10], tension[10], g[18], virial[9];
    int64_t molecules[10];
    hol_chains *chains;
    for (int k = 0; k < 10; ++k) length[k] = 1;
    for (int i = 0; i < 18; ++i) f[i] = 1 - i % 4, g[i] = 7;
    CHECK(hol_chains_create(6, mass, &chains));
    CHECK(hol_chains_add_bonds(chains, 10, pairs, length));
    assert_int_equal(hol_chains_n_molecules(chains), 1);
    assert_int_equal(hol_chains_n_bonds(chains), 10);
    assert_int_equal(hol_chains_degrees_of_freedom(chains, 3), 6 - 4);
    CHECK(hol_chains_molecules_of_bonds(chains, molecules));
    for (int k = 0; k < 10; ++k) assert_int_equal(molecules[k], k < 6 ? -1 : 0);
    CHECK(hol_forces(chains, r, NULL, f, lambda, tension, g, HOL_WRITE, virial));
    const double w[6] = {0, 0, 0, 0, 1, 0.5};
    const molecule_problem problem = {6, 10, pairs, w, r, NULL, f, NULL};
    molecule_solution exact;
    assert_int_equal(molecule_forces(&problem, &exact), 0);
    for (int k = 0; k < 10; ++k) {
        CHECK_AT_MOST(fabsl(lambda[k] - exact.lambda[k]), oracle_bound(4) * DBL_EPSILON * exact.lambda_scale[k]);
        if (k < 6) assert_true(lambda[k] == 0 && tension[k] == 0);
    }
    for (int x = 0; x < 3; ++x) assert_true(g[9 + x] == 7); /* atom 3 has no constraint: not written */
    molecule_solution_free(&exact);
    hol_chains_destroy(chains);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shapes_are_recognised_whatever_the_order_of_the_bonds),
        cmocka_unit_test(molecules_of_one_kind_are_known_to_be_whatever_the_order_of_their_bonds),
        cmocka_unit_test(molecules_may_share_a_fixed_atom),
        cmocka_unit_test(bonds_between_fixed_atoms_are_no_constraints),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
