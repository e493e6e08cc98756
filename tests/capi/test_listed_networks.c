/**
 * Large gels whose bonds the caller lists in any order: arrays per bond are read and written where the caller has them,
 * and no bit of a result depends on the order.
 */
#include <stdlib.h>

#include "network_scene.h"
#include "random.h"

enum { side = 7, per_strand = 10 };

/** Strands between the nodes of a cubic lattice, and a chain of two bonds, whose second one will be listed first. */
static network_scene make(void)
{
    network_scene s = network_scene_empty(0);
    random_stream random = random_seed(1);
    for (int i = 0; i < side * side * side; ++i) {
        const double r[3] = {4. * (i % side), 4. * (i / side % side), 4. * (i / side / side)};
        molecule_add_atom(&s.m, 1 + i % 3, r);
    }
    for (int i = 0; i < side * side * side; ++i) {
        const int at[3] = {i % side, i / side % side, i / side / side}, step[3] = {1, side, side * side};
        for (int c = 0; c < 3; ++c) {
            if (at[c] + 1 == side) continue;
            int64_t last = i;
            for (int k = 1; k < per_strand; ++k) {
                double r[3];
                for (int x = 0; x < 3; ++x)
                    r[x] = 4. * (at[x] + (x == c) * (double)k / per_strand) + random_uniform(&random) - 0.5;
                const int64_t next = molecule_add_atom(&s.m, 1, r);
                molecule_add_bond(&s.m, last, next);
                last = next;
            }
            molecule_add_bond(&s.m, last, i + step[c]);
        }
    }
    double r[3] = {-9, -9, -9};
    const double u[3] = {0, 0.6, 0.8}, w[3] = {1, 0, 0};
    const int64_t first = molecule_add_atom(&s.m, 1, r);
    molecule_grow(&s.m, molecule_grow(&s.m, first, 1, 1, u), 1, 1, w);
    molecule_finish(&s.m, &random);
    return s;
}

/** All results of one handle, per bond by the molecule's own numbers. */
typedef struct {
    double *g, *v, *r, *forces, *tension, *solve, *velocities, *positions, *again, *kept_forces, *kept_solve;
} results;

/** `place` [n_bonds]: where bonds stand in the list; of the first n_bonds alone. */
static results find(network_scene *s, int64_t n_bonds, const int64_t *place)
{
    const size_t size = 3 * (size_t)s->m.n_atoms, n = (size_t)n_bonds;
    int64_t *pairs = malloc(2 * n * sizeof *pairs);
    double *length = untouched(n), *rhs = untouched(n), *values[8];
    results out = {.g = untouched(size), .v = copy_of(s->m.v, size), .r = molecule_drifted(&s->m, 1e-3)};
    double *const start = copy_of(out.r, size);
    double **const to[8] = {&out.forces,    &out.tension, &out.solve,       &out.velocities,
                            &out.positions, &out.again,   &out.kept_forces, &out.kept_solve};
    for (size_t k = 0; k < n; ++k) {
        for (int e = 0; e < 2; ++e) pairs[2 * place[k] + e] = s->m.pairs[2 * k + (size_t)e];
        length[place[k]] = s->m.length[k];
        rhs[place[k]] = k % 9 == 1;
    }
    for (int i = 0; i < 8; ++i) values[i] = untouched(n);
    CHECK(hol_chains_create(s->m.n_atoms, s->m.mass, &s->chains));
    CHECK(hol_chains_add_bonds(s->chains, n_bonds, pairs, length));
    for (size_t i = 0; i < size; ++i) out.g[i] = 0;
    CHECK(hol_forces(s->chains, s->m.r, s->m.v, s->m.f, values[0], values[1], out.g, HOL_WRITE, NULL));
    CHECK(hol_solve(s->chains, s->m.r, rhs, values[2], NULL, HOL_WRITE, NULL));
    hol_factors *factors;
    CHECK(hol_factors_create(s->chains, &factors));
    CHECK(hol_factors_update(factors, s->m.r));
    CHECK(hol_factors_forces(factors, s->m.v, s->m.f, values[6], NULL, NULL, HOL_WRITE, NULL));
    CHECK(hol_factors_solve(factors, 1, rhs, values[7], NULL, HOL_WRITE, NULL));
    hol_factors_destroy(factors);
    CHECK(hol_project_velocities(s->chains, s->m.r, out.v, values[3], NULL));
    CHECK(hol_project_positions(s->chains, s->m.r, out.r, NULL, 1e-3, values[4], 0, NULL, NULL));
    for (size_t k = 0; k < n; ++k) values[5][k] = values[4][k];
    CHECK(hol_project_positions(s->chains, s->m.r, start, NULL, 1e-3, values[5], 1, NULL, NULL));
    for (int i = 0; i < 8; ++i) {
        *to[i] = untouched(n);
        for (size_t k = 0; k < n; ++k) (*to[i])[k] = values[i][place[k]];
        free(values[i]);
    }
    hol_chains_destroy(s->chains);
    free(pairs), free(length), free(rhs), free(start);
    return out;
}

static void free_results(results x)
{
    free(x.g), free(x.v), free(x.r), free(x.forces), free(x.tension), free(x.solve), free(x.velocities);
    free(x.positions), free(x.again), free(x.kept_forces), free(x.kept_solve);
}

/** The gel alone, and beside a chain whose bonds are copied. */
static void the_order_of_bonds_changes_no_bit(void **state)
{
    (void)state;
    network_scene s = make();
    const int64_t all = s.m.n_bonds, of_gel = all - 2;
    const size_t size = 3 * (size_t)s.m.n_atoms;
    int64_t *place = malloc((size_t)all * sizeof *place);
    random_stream random = random_seed(2);
    assert_true(of_gel > 8192);
    for (int64_t k = 0; k < all; ++k) place[k] = k;
    results sorted = find(&s, all, place);
    for (int64_t n = of_gel; n <= all; n += 2) {
        for (int64_t k = 0; k < n; ++k) place[k] = k;
        for (int64_t i = of_gel - 1; i > 0; --i) {
            const int64_t j = (int64_t)((double)(i + 1) * random_uniform(&random)), kept = place[i];
            place[i] = place[j], place[j] = kept;
        }
        if (n == all) place[n - 2] = n - 1, place[n - 1] = n - 2;
        results any = find(&s, n, place);
        const size_t m = (size_t)n;
        assert_same_bits(any.forces, sorted.forces, m);
        assert_same_bits(any.tension, sorted.tension, m);
        assert_same_bits(any.solve, sorted.solve, m);
        assert_same_bits(any.velocities, sorted.velocities, m);
        assert_same_bits(any.positions, sorted.positions, m);
        assert_same_bits(any.again, sorted.again, m);
        assert_same_bits(any.kept_forces, sorted.kept_forces, m);
        assert_same_bits(any.kept_solve, sorted.kept_solve, m);
        if (n == all) {
            assert_same_bits(any.g, sorted.g, size);
            assert_same_bits(any.v, sorted.v, size);
            assert_same_bits(any.r, sorted.r, size);
        }
        free_results(any);
    }
    free_results(sorted);
    free(place);
    molecule_free(&s.m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_order_of_bonds_changes_no_bit)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
