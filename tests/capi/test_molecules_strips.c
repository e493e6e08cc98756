/** Chains whose angles are all rigid, strips of triangles, which have kernels of their own. */
#include "check.h"
#include "mixture.h"
#include "molecule_solution.h"

/** A molecule without its bond k, or all its bonds with k = -1; atom `held` is held fixed, -1: none. */
static molecule altered(const molecule *m, int64_t k, int64_t held)
{
    molecule out = molecule_empty();
    for (int64_t i = 0; i < m->n_atoms; ++i) molecule_add_atom(&out, i == held ? 0 : m->mass[i], m->r + 3 * i);
    for (int64_t b = 0; b < m->n_bonds; ++b)
        if (b != k) molecule_add_bond(&out, m->pairs[2 * b], m->pairs[2 * b + 1]);
    random_stream stream = random_seed(5);
    molecule_finish(&out, &stream);
    return out;
}

/** Multipliers of forces, and velocities and positions as projected, within the bounds of tests/oracle/molecules. */
static void assert_right(const mixture *m, double dt)
{
    double *lambda = untouched((size_t)m->n_bonds), *v = copy_of(m->v, mixture_size(m));
    CHECK(hol_forces(m->chains, m->r, m->v, m->f, lambda, NULL, NULL, HOL_WRITE, NULL));
    CHECK(hol_project_velocities(m->chains, m->r, v, NULL, NULL));
    double *r = copy_of(m->r, mixture_size(m));
    for (size_t i = 0; i < mixture_size(m); ++i) r[i] += dt * v[i];
    double *drifted = copy_of(r, mixture_size(m));
    CHECK(hol_project_positions(m->chains, m->r, r, NULL, dt, NULL, 0, NULL, NULL));
    for (int64_t p = 0; p < m->n_parts; ++p) {
        const molecule *part = m->parts + p;
        const molecule_problem problem = molecule_problem_of(part);
        const size_t size = 3 * (size_t)part->n_atoms;
        const long double unit = oracle_bound(part->n_bonds) * DBL_EPSILON;
        double *multiplier = untouched((size_t)part->n_bonds), *start = untouched(size), *got = untouched(size);
        molecule_solution exact;
        assert_int_equal(molecule_forces(&problem, &exact), 0);
        mixture_take_bonds(m, p, lambda, multiplier);
        for (int64_t k = 0; k < part->n_bonds; ++k)
            CHECK_AT_MOST(fabsl(multiplier[k] - exact.lambda[k]), unit * exact.lambda_scale[k]);
        molecule_solution_free(&exact);
        assert_int_equal(molecule_velocities(&problem, &exact), 0);
        mixture_take(m, p, v, got);
        for (size_t i = 0; i < size; ++i)
            CHECK_AT_MOST(fabsl(got[i] - exact.moved[i]), unit * exact.moved_scale[i / 3]);
        molecule_solution_free(&exact);
        mixture_take(m, p, drifted, start);
        mixture_take(m, p, r, got);
        assert_int_equal(molecule_positions(&problem, start, NULL, part->length, dt, &exact), 0);
        for (size_t i = 0; i < size; ++i)
            CHECK_AT_MOST(fabsl(got[i] - exact.moved[i]), unit * exact.moved_scale[i / 3]);
        molecule_solution_free(&exact);
        free(multiplier), free(start), free(got);
    }
    free(lambda), free(v), free(r), free(drifted);
}

static void strips_of_every_size_agree_with_a_solution_in_many_digits(void **state)
{
    (void)state;
    static const molecule_kind kinds[] = {MOLECULE_TRIANGLES, MOLECULE_ZIGZAG, MOLECULE_TRIANGLES_179};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; ++k) {
        mixture m = mixture_of_kind(kinds[k], quick_run() ? 12 : 60, 4, 40, MIXED, 300 + k);
        assert_right(&m, kinds[k] == MOLECULE_TRIANGLES_179 ? 1e-5 : 1e-3);
        mixture_free(&m);
    }
}

static void nearly_strips_are_right_too(void **state)
{
    (void)state;
    enum { N = 8 };
    molecule parts[N], strip = molecule_make(MOLECULE_TRIANGLES, 12, 7);
    for (int64_t k = 0; k < N; ++k) parts[k] = k % 2 ? altered(&strip, 2 + k, -1) : altered(&strip, -1, k);
    mixture m = mixture_make(parts, N, MIXED, 8);
    assert_right(&m, 1e-3);
    mixture_free(&m);
    for (int64_t k = 0; k < N; ++k) molecule_free(parts + k);
    molecule_free(&strip);
}

/** Results of one molecule whose atom i stands at place[i] of the arrays, in the order of its own atoms and bonds. */
static void compute_renumbered(const molecule *m, const int64_t *place, double *lambda, double *atoms)
{
    const size_t size = 3 * (size_t)m->n_atoms, n_bonds = (size_t)m->n_bonds;
    double *mass = untouched((size_t)m->n_atoms), *r = untouched(size), *v = untouched(size), *f = untouched(size);
    double *g = untouched(size), *drifted = untouched(size);
    int64_t *pairs = malloc(2 * n_bonds * sizeof *pairs);
    assert_non_null(pairs);
    for (int64_t i = 0; i < m->n_atoms; ++i) {
        mass[place[i]] = m->mass[i];
        memcpy(r + 3 * place[i], m->r + 3 * i, 24);
        memcpy(v + 3 * place[i], m->v + 3 * i, 24);
        memcpy(f + 3 * place[i], m->f + 3 * i, 24);
    }
    for (size_t k = 0; k < 2 * n_bonds; ++k) pairs[k] = place[m->pairs[k]];
    hol_chains *chains = NULL;
    CHECK(hol_chains_create(m->n_atoms, mass, &chains));
    CHECK(hol_chains_add_bonds(chains, m->n_bonds, pairs, m->length));
    CHECK(hol_forces(chains, r, v, f, lambda, NULL, g, HOL_WRITE, NULL));
    CHECK(hol_project_velocities(chains, r, v, lambda + n_bonds, NULL));
    for (size_t i = 0; i < size; ++i) drifted[i] = r[i] + 1e-3 * v[i];
    CHECK(hol_project_positions(chains, r, drifted, v, 1e-3, lambda + 2 * n_bonds, 0, NULL, NULL));
    for (int64_t i = 0; i < m->n_atoms; ++i) {
        memcpy(atoms + 3 * i, g + 3 * place[i], 24);
        memcpy(atoms + size + 3 * i, v + 3 * place[i], 24);
        memcpy(atoms + 2 * size + 3 * i, drifted + 3 * place[i], 24);
    }
    hol_chains_destroy(chains);
    free(mass), free(r), free(v), free(f), free(g), free(drifted), free(pairs);
}

/** As long as the same end has the smaller number. */
static void numbers_of_the_atoms_of_a_strip_change_no_bit(void **state)
{
    (void)state;
    enum { N = 30 };
    molecule m = molecule_make(MOLECULE_TRIANGLES, N, 3);
    assert_int_equal(m.n_atoms, N);
    int64_t place[N];
    double lambda[2][3 * 2 * N], atoms[2][9 * N];
    for (int64_t i = 0; i < N; ++i) place[i] = i;
    compute_renumbered(&m, place, lambda[0], atoms[0]);
    for (int64_t step = 7; step < 30; step += 4) {
        if (step % 3 == 0 || step % 5 == 0) continue; /* numbers would not be different */
        for (int64_t i = 0; i < N; ++i) place[i] = i * step % N;
        compute_renumbered(&m, place, lambda[1], atoms[1]);
        assert_same_bits(lambda[0], lambda[1], 3 * (size_t)m.n_bonds);
        assert_same_bits(atoms[0], atoms[1], 9 * N);
    }
    molecule_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(strips_of_every_size_agree_with_a_solution_in_many_digits),
        cmocka_unit_test(nearly_strips_are_right_too),
        cmocka_unit_test(numbers_of_the_atoms_of_a_strip_change_no_bit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
