/**
 * Large molecules along a list whose branches threads share: what comes out solves the equations, and has the bits that
 * one thread gives.
 */
#include "check.h"
#include "equations.h"
#include "large.h"

static const double dt = 0.002;

/** Two equal halves; the same, and corrections; with cycles and without, where there are more branches. */
enum { EXAMPLES = 4 };
static molecule example(int which)
{
    const int64_t n = quick_run() ? 9000 : 100000;
    return which == 0   ? large_rings(n)
           : which == 1 ? large_ladder(n / 3)
           : which == 2 ? large_segments(n, 1, 50, 1)
                        : large_comb(n);
}

/** What the verbs give, in one array. */
typedef struct outputs {
    size_t count;
    double *forces, *solution, *rates, *tau, *tension; /* per bond */
    double *g, *v, *r, *moved, *guessed;               /* per atom */
    double *virial;                                    /* of each verb */
} outputs;

static outputs outputs_of(const molecule *m, hol_chains *chains, int threads)
{
    const size_t n = (size_t)m->n_bonds, size = 3 * (size_t)m->n_atoms;
    double *const all = untouched(5 * n + 5 * size + 36), *const atoms = all + 5 * n;
    const outputs o = {5 * n + 5 * size + 36,
                       all,
                       all + n,
                       all + 2 * n,
                       all + 3 * n,
                       all + 4 * n,
                       atoms,
                       atoms + size,
                       atoms + 2 * size,
                       atoms + 3 * size,
                       atoms + 4 * size,
                       atoms + 5 * size};
    double *start = molecule_drifted(m, dt);
    CHECK(hol_chains_set_threads(chains, threads));
    CHECK(hol_forces(chains, m->r, m->v, m->f, o.forces, o.tension, o.g, HOL_WRITE, o.virial));
    CHECK(hol_solve(chains, m->r, m->f, o.solution, o.g, HOL_ADD, o.virial + 9));
    memcpy(o.v, m->v, size * sizeof *o.v);
    CHECK(hol_project_velocities(chains, m->r, o.v, o.rates, o.virial + 18));
    memcpy(o.r, start, size * sizeof *o.r);
    memcpy(o.moved, m->v, size * sizeof *o.moved);
    CHECK(hol_project_positions(chains, m->r, o.r, o.moved, dt, o.tau, 0, o.virial + 27, NULL));
    memcpy(o.guessed, start, size * sizeof *o.guessed);
    for (size_t k = 0; k < n; ++k) o.tau[k] *= 1 + 1e-6 * (double)(k % 7);
    CHECK(hol_project_positions(chains, m->r, o.guessed, NULL, dt, o.tau, 1, NULL, NULL));
    free(start);
    return o;
}

static void solve_the_equations(const molecule *m, const outputs *o)
{
    leave_roundings_of_equations(m, o->forces, m->v, m->f, 0, NULL);
    leave_roundings_of_equations(m, o->solution, NULL, NULL, 0, m->f);
    leave_roundings_of_equations(m, o->rates, m->v, NULL, 1, NULL);
    double extent = 0;
    for (int64_t i = 0; i < 3 * m->n_atoms; ++i) extent = fmax(extent, fabs(o->r[i]));
    for (int64_t k = 0; k < m->n_bonds; ++k) {
        const int64_t i = 3 * m->pairs[2 * k], j = 3 * m->pairs[2 * k + 1];
        double rate = 0, sizes = 0;
        long double excess = -(long double)m->length[k] * m->length[k];
        for (int c = 0; c < 3; ++c) {
            const double d = m->r[j + c] - m->r[i + c];
            rate += d * (o->v[j + c] - o->v[i + c]);
            sizes += fabs(d) * (fabs(o->v[j + c]) + fabs(o->v[i + c]));
            excess += powl((long double)o->r[j + c] - o->r[i + c], 2);
        }
        CHECK_AT_MOST(fabs(rate), 8 * DBL_EPSILON * sizes);
        CHECK_AT_MOST(fabsl(excess), 8 * DBL_EPSILON * m->length[k] * (m->length[k] + extent));
    }
}

static void threads_change_no_bit_and_their_results_solve_the_equations(void **state)
{
    (void)state;
    for (int which = 0; which < EXAMPLES; ++which) {
        molecule m = example(which);
        hol_chains *chains = large_chains(&m);
        outputs one = outputs_of(&m, chains, 1);
        solve_the_equations(&m, &one);
        for (int threads = 2; threads <= 4; ++threads) {
            outputs several = outputs_of(&m, chains, threads);
            assert_same_bits(several.forces, one.forces, one.count);
            free(several.forces);
        }
        free(one.forces);
        hol_chains_destroy(chains);
        molecule_free(&m);
    }
}

/** The last atom is held, and bonded to one of each copy: what pulls it is the sum of both. */
static void large_molecules_share_a_fixed_atom(void **state)
{
    (void)state;
    molecule m = large_rings(9000);
    const size_t atoms = (size_t)m.n_atoms, n = (size_t)m.n_bonds, all = 2 * atoms + 1, held = 2 * atoms;
    double *mass = calloc(all, sizeof *mass), *r = calloc(3 * all, sizeof *r), *f = calloc(3 * all, sizeof *f);
    double *length = untouched(2 * n + 2), *lambda = untouched(2 * n + 2), *g = untouched(3 * all);
    int64_t *pairs = malloc((2 * n + 2) * 2 * sizeof *pairs);
    for (size_t copy = 0; copy < 2; ++copy) {
        memcpy(mass + copy * atoms, m.mass, atoms * sizeof *mass);
        memcpy(r + 3 * copy * atoms, m.r, 3 * atoms * sizeof *r);
        memcpy(f + 3 * copy * atoms, m.f, 3 * atoms * sizeof *f);
        memcpy(length + copy * (n + 1), m.length, n * sizeof *length);
        for (size_t k = 0; k < 2 * n; ++k) pairs[2 * copy * (n + 1) + k] = m.pairs[k] + (int64_t)(copy * atoms);
        const int64_t end[2] = {(int64_t)(copy * atoms + atoms / 2), (int64_t)held};
        memcpy(pairs + 2 * (copy * (n + 1) + n), end, sizeof end);
        length[copy * (n + 1) + n] = 1;
    }
    memcpy(r + 3 * held, m.r + 3 * (atoms / 2), 3 * sizeof *r);
    r[3 * held] += 1;
    hol_chains *chains = NULL;
    CHECK(hol_chains_create((int64_t)all, mass, &chains));
    CHECK(hol_chains_add_bonds(chains, (int64_t)(2 * n + 2), pairs, length));
    assert_int_equal(hol_chains_n_molecules(chains), 2);
    for (int threads = 1; threads <= 3; ++threads) {
        CHECK(hol_chains_set_threads(chains, threads));
        CHECK(hol_forces(chains, r, NULL, f, lambda, NULL, g, HOL_WRITE, NULL));
        double most = 0, left = 0;
        for (size_t k = 0; k < 2 * n + 2; ++k) {
            most = fmax(most, fabs(lambda[k]));
            for (int e = 0; e < 2; ++e)
                for (size_t c = 0; c < 3; ++c) {
                    const size_t i = 3 * (size_t)pairs[2 * k + (size_t)e] + c,
                                 j = 3 * (size_t)pairs[2 * k + (size_t)(1 - e)] + c;
                    g[i] -= 2 * lambda[k] * (r[j] - r[i]);
                }
        }
        for (size_t i = 0; i < 3 * all; ++i) left = fmax(left, fabs(g[i]));
        assert_true(fabs(lambda[n]) > 0);
        CHECK_AT_MOST(left, 64 * DBL_EPSILON * most);
    }
    free(mass), free(r), free(f), free(length), free(lambda), free(g), free(pairs);
    hol_chains_destroy(chains);
    molecule_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(threads_change_no_bit_and_their_results_solve_the_equations),
        cmocka_unit_test(large_molecules_share_a_fixed_atom),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
