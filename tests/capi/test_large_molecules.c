/**
 * Molecules of thousands of bonds, whose trees are worked on in pieces and several atoms at a time: no bit depends on
 * layout, threads or the order of the bonds, and what is found solves the equations.
 */
#include "check.h"
#include "input.h"
#include "large.h"

typedef struct results {
    double *lambda, *tension, *g, *v, *mu, *solved;
} results;

static results compute(const molecule *m, const hol_chains *chains)
{
    const size_t n = (size_t)m->n_bonds, size = 3 * (size_t)m->n_atoms;
    results x = {untouched(n), untouched(n), untouched(size), copy_of(m->v, size), untouched(n), untouched(n)};
    CHECK(hol_forces(chains, m->r, m->v, m->f, x.lambda, x.tension, x.g, HOL_WRITE, NULL));
    CHECK(hol_project_velocities(chains, m->r, x.v, x.mu, NULL));
    CHECK(hol_solve(chains, m->r, m->length, x.solved, NULL, HOL_WRITE, NULL));
    return x;
}

static void forget(results *x)
{
    free(x->lambda), free(x->tension), free(x->g), free(x->v), free(x->mu), free(x->solved);
}

static void assert_same(const molecule *m, const results *a, const results *b)
{
    const size_t n = (size_t)m->n_bonds, size = 3 * (size_t)m->n_atoms;
    assert_same_bits(a->lambda, b->lambda, n);
    assert_same_bits(a->tension, b->tension, n);
    assert_same_bits(a->g, b->g, size);
    assert_same_bits(a->v, b->v, size);
    assert_same_bits(a->mu, b->mu, n);
    assert_same_bits(a->solved, b->solved, n);
}

static int64_t size_of_test(void)
{
    return quick_run() ? 3000 : 100000;
}

static molecule example(int which)
{
    const int64_t n = size_of_test();
    return which == 0   ? large_segments(n, 1, 0, 1)
           : which == 1 ? large_segments(n, 300, 0, 2)
           : which == 2 ? large_segments(n, 12, 40, 3)
                        : large_comb(n);
}

static void number_of_threads_changes_no_bit(void **state)
{
    (void)state;
    for (int which = 0; which < 4; ++which) {
        molecule m = example(which);
        hol_chains *chains = large_chains(&m);
        results one = compute(&m, chains);
        double virial[2][9];
        CHECK(hol_forces(chains, m.r, m.v, m.f, NULL, NULL, NULL, HOL_WRITE, virial[0]));
        for (int threads = 2; threads < 4; ++threads) {
            CHECK(hol_chains_set_threads(chains, threads));
            results several = compute(&m, chains);
            assert_same(&m, &several, &one);
            CHECK(hol_forces(chains, m.r, m.v, m.f, NULL, NULL, NULL, HOL_WRITE, virial[1]));
            assert_same_bits(virial[0], virial[1], 9);
            forget(&several);
        }
        forget(&one);
        hol_chains_destroy(chains);
        molecule_free(&m);
    }
}

static void order_of_bonds_changes_no_bit(void **state)
{
    (void)state;
    for (int which = 0; which < 4; ++which) {
        molecule m = example(which);
        hol_chains *chains = large_chains(&m);
        results plain = compute(&m, chains);
        hol_chains_destroy(chains);
        const int64_t n = m.n_bonds;
        large_turn_bonds(&m);
        chains = large_chains(&m);
        results turned = compute(&m, chains);
        assert_same_bits(turned.g, plain.g, 3 * (size_t)m.n_atoms);
        assert_same_bits(turned.v, plain.v, 3 * (size_t)m.n_atoms);
        for (int64_t k = 0; k < n; ++k) {
            assert_same_bits(turned.lambda + k, plain.lambda + n - 1 - k, 1);
            assert_same_bits(turned.solved + k, plain.solved + n - 1 - k, 1);
        }
        forget(&plain), forget(&turned);
        hol_chains_destroy(chains);
        molecule_free(&m);
    }
}

/** Rows of four doubles, the last of which is not the library's. */
static double *padded(const double *a, int64_t n)
{
    double *p = untouched(4 * (size_t)n);
    for (int64_t i = 0; i < n; ++i) memcpy(p + 4 * i, a + 3 * i, 3 * sizeof *p);
    return p;
}

static hol_view view_of(double *p)
{
    const hol_view view = {p, p + 1, p + 2, 4 * sizeof *p, HOL_DOUBLE, 0};
    return view;
}

static void layout_changes_no_bit(void **state)
{
    (void)state;
    for (int which = 0; which < 4; ++which) {
        molecule m = example(which);
        hol_chains *chains = large_chains(&m);
        results plain = compute(&m, chains);
        double *r = padded(m.r, m.n_atoms), *v = padded(m.v, m.n_atoms), *f = padded(m.f, m.n_atoms);
        double *lambda = untouched((size_t)m.n_bonds);
        const hol_view vr = view_of(r), vv = view_of(v), vf = view_of(f);
        CHECK(hol_forces_view(chains, INPUT(&vr), INPUT(&vv), INPUT(&vf), lambda, NULL, &vf, HOL_WRITE, NULL));
        assert_same_bits(lambda, plain.lambda, (size_t)m.n_bonds);
        for (int64_t i = 0; i < m.n_atoms; ++i) assert_same_bits(f + 4 * i, plain.g + 3 * i, 3);
        CHECK(hol_project_velocities_view(chains, INPUT(&vr), &vv, lambda, NULL));
        assert_same_bits(lambda, plain.mu, (size_t)m.n_bonds);
        for (int64_t i = 0; i < m.n_atoms; ++i) assert_same_bits(v + 4 * i, plain.v + 3 * i, 3);
        free(r), free(v), free(f), free(lambda);
        forget(&plain);
        hol_chains_destroy(chains);
        molecule_free(&m);
    }
}

/**
 * No list takes an atom of so many bonds, and few lanes would be full: such a tree is worked on atom by atom.
 */
static void large_trees_with_an_atom_of_many_bonds_are_solved(void **state)
{
    (void)state;
    for (int which = 0; which < 2; ++which) {
        molecule m = which == 0 ? large_hub(2500, 100) : large_hub(6000, 90);
        hol_chains *chains = large_chains(&m);
        const size_t n = (size_t)m.n_bonds, size = 3 * (size_t)m.n_atoms;
        double *g = untouched(size), *v = copy_of(m.v, size);
        CHECK(hol_forces(chains, m.r, m.v, m.f, NULL, NULL, g, HOL_WRITE, NULL));
        CHECK(hol_project_velocities(chains, m.r, v, NULL, NULL));
        double *r = copy_of(m.r, size);
        for (size_t i = 0; i < size; ++i) r[i] += 0.002 * v[i];
        CHECK(hol_project_positions(chains, m.r, r, NULL, 0.002, NULL, 0, NULL, NULL));
        double largest = 0;
        for (size_t i = 0; i < size; ++i) largest = fmax(largest, fabs(r[i]));
        for (size_t k = 0; k < n; ++k) {
            const int64_t i = 3 * m.pairs[2 * k], j = 3 * m.pairs[2 * k + 1];
            double sum = 0, terms = 0, rate = 0, speeds = 0, square = 0;
            for (int c = 0; c < 3; ++c) {
                const double d = m.r[j + c] - m.r[i + c], dv = m.v[j + c] - m.v[i + c],
                             a = (m.f[j + c] + g[j + c]) / m.mass[j / 3], b = (m.f[i + c] + g[i + c]) / m.mass[i / 3];
                sum += d * (a - b) + dv * dv;
                terms += fabs(d) * (fabs(m.f[j + c] / m.mass[j / 3]) + fabs(a) + fabs(b)) + dv * dv;
                rate += d * (v[j + c] - v[i + c]);
                speeds += fabs(d) * (fabs(v[j + c]) + fabs(v[i + c]));
                square += (r[j + c] - r[i + c]) * (r[j + c] - r[i + c]);
            }
            CHECK_AT_MOST(fabs(sum), 1000 * DBL_EPSILON * terms);
            CHECK_AT_MOST(fabs(rate), 100 * DBL_EPSILON * speeds);
            CHECK_AT_MOST(fabs(square / (m.length[k] * m.length[k]) - 1), 32 * DBL_EPSILON * (1 + largest));
        }
        free(g), free(v), free(r);
        hol_chains_destroy(chains);
        molecule_free(&m);
    }
}

/**
 * What lambda leaves of d.(a_j - a_i) + |dv|^2, in long double, solved for once more: the error of lambda. It is a few
 * roundings of the largest multiplier at the bond's atoms; trees at random have atoms that plain arithmetic can't do.
 */
static void multipliers_are_right_to_a_few_roundings(void **state)
{
    (void)state;
    for (int which = 0; which < 4; ++which) {
        molecule m = example(which);
        hol_chains *chains = large_chains(&m);
        results x = compute(&m, chains);
        const size_t n = (size_t)m.n_bonds, size = 3 * (size_t)m.n_atoms;
        long double *a = calloc(size, sizeof *a);
        double *left = untouched(n), *error = untouched(n), *largest = calloc(size / 3, sizeof *largest);
        for (size_t k = 0; k < n; ++k)
            for (int e = 0; e < 2; ++e) {
                const int64_t i = m.pairs[2 * k + (size_t)e], j = m.pairs[2 * k + (size_t)(1 - e)];
                largest[i] = fmax(largest[i], fabs(x.lambda[k]));
                for (int c = 0; c < 3; ++c)
                    a[3 * i + c] += 2 * (long double)x.lambda[k] * ((long double)m.r[3 * j + c] - m.r[3 * i + c]);
            }
        for (size_t i = 0; i < size; ++i) a[i] = (a[i] + m.f[i]) / m.mass[i / 3];
        for (size_t k = 0; k < n; ++k) {
            const int64_t i = m.pairs[2 * k], j = m.pairs[2 * k + 1];
            long double sum = 0;
            for (int c = 0; c < 3; ++c) {
                const long double dv = (long double)m.v[3 * j + c] - m.v[3 * i + c];
                sum += ((long double)m.r[3 * j + c] - m.r[3 * i + c]) * (a[3 * j + c] - a[3 * i + c]) + dv * dv;
            }
            left[k] = (double)(2 * sum);
        }
        CHECK(hol_solve(chains, m.r, left, error, NULL, HOL_WRITE, NULL));
        for (size_t k = 0; k < n; ++k) {
            const double most = fmax(largest[m.pairs[2 * k]], largest[m.pairs[2 * k + 1]]);
            CHECK_AT_MOST(fabs(error[k]), 1000 * fmax(DBL_EPSILON, (double)long_double_rounding()) * most);
        }
        free(a), free(left), free(error), free(largest);
        forget(&x);
        hol_chains_destroy(chains);
        molecule_free(&m);
    }
}

/** With an atom of 1e-6 between two of 1e12 nearly in line, and two more atoms in line behind it. */
static molecule with_a_light_atom_between_heavy_ones(molecule m)
{
    random_stream s = random_seed(5);
    const double mass[] = {1e12, 1e-6, 1e12, 1e-3, 1e3}, side[] = {0, 0, 1e-5, -1e-5, 3e-6};
    const int64_t from[] = {0, 1, 2, 2, 4};
    int64_t at[6] = {m.n_atoms - 1};
    for (int i = 0; i < 5; ++i) {
        const double u[3] = {0.93, -0.36 + side[i], 1e-6 * i};
        at[i + 1] = molecule_grow(&m, at[from[i]], mass[i], 1, u);
    }
    molecule_finish(&m, &s);
    return m;
}

/**
 * Multipliers as doubles move a light atom between heavy ones by more than the rounding of its velocity. That must not
 * move its neighbours: they get what their multipliers give them, to a few roundings.
 */
static void leave_their_neighbours(molecule m)
{
    hol_chains *chains = large_chains(&m);
    const size_t n = (size_t)m.n_bonds, size = 3 * (size_t)m.n_atoms;
    double *v = copy_of(m.v, size), *mu = untouched(n);
    CHECK(hol_project_velocities(chains, m.r, v, mu, NULL));
    long double *moved = calloc(size, sizeof *moved), *terms = calloc(size, sizeof *terms);
    for (size_t k = 0; k < n; ++k)
        for (size_t e = 0; e < 2; ++e) {
            const int64_t i = m.pairs[2 * k + e], j = m.pairs[2 * k + 1 - e];
            for (int c = 0; c < 3; ++c) {
                const long double term = 2 * (long double)mu[k] * ((long double)m.r[3 * j + c] - m.r[3 * i + c]);
                moved[3 * i + c] += term / m.mass[i];
                terms[3 * i + c] += fabsl(term) / m.mass[i];
            }
        }
    for (size_t i = 0; i < size; ++i) {
        const double error = (double)fabsl(m.v[i] + moved[i] - v[i]);
        CHECK_AT_MOST(error, 16 * DBL_EPSILON * (fabs(m.v[i]) + fabs(v[i]) + (double)terms[i]));
    }
    free(v), free(mu), free(moved), free(terms);
    hol_chains_destroy(chains);
    molecule_free(&m);
}

static void light_atoms_between_heavy_ones_do_not_move_their_neighbours(void **state)
{
    (void)state;
    const molecule trees[] = {large_segments(3000, 1, 0, 1), large_segments(3000, 300, 0, 2), large_comb(3000),
                              large_rings(3000)};
    for (int i = 0; i < 4; ++i) leave_their_neighbours(with_a_light_atom_between_heavy_ones(trees[i]));
}

/** Positions and the metric, which compute() leaves out. */
typedef struct more_results {
    double *r, *v, *lambda, *force, log_det, energy;
} more_results;

static more_results compute_more(const molecule *m, const hol_chains *chains)
{
    const double dt = 0.002;
    const size_t size = 3 * (size_t)m->n_atoms;
    more_results x = {
        molecule_drifted(m, dt), copy_of(m->v, size), untouched((size_t)m->n_bonds), untouched(size), 0, 0};
    CHECK(hol_project_positions(chains, m->r, x.r, x.v, dt, x.lambda, 0, NULL, NULL));
    CHECK(hol_metric(chains, m->r, 1, &x.log_det, NULL, &x.energy, x.force, HOL_WRITE));
    return x;
}

static void masses_and_lengths_given_later_are_as_those_of_a_new_set(void **state)
{
    (void)state;
    for (int which = 0; which < 4; ++which) {
        molecule m = example(which), other = example(which);
        const size_t n = (size_t)m.n_bonds, size = 3 * (size_t)m.n_atoms;
        for (size_t i = 0; i < size / 3; ++i) other.mass[i] = 1 + (double)(i % 7);
        for (size_t k = 0; k < n; ++k) other.length[k] = m.length[k] * (1 + 1e-3 * (double)(k % 3));
        hol_chains *chains = large_chains(&m), *changed = large_chains(&other);
        results of_other = compute(&other, changed);
        more_results more_of_other = compute_more(&other, changed);
        CHECK(hol_chains_set_masses(changed, m.mass));
        CHECK(hol_chains_set_lengths(changed, m.length));
        results a = compute(&m, chains), b = compute(&m, changed);
        assert_same(&m, &a, &b);
        assert_true(memcmp(a.lambda, of_other.lambda, n * sizeof *a.lambda) != 0);
        more_results c = compute_more(&m, chains), d = compute_more(&m, changed);
        assert_same_bits(c.r, d.r, size);
        assert_same_bits(c.v, d.v, size);
        assert_same_bits(c.lambda, d.lambda, n);
        assert_same_bits(c.force, d.force, size);
        assert_same_bits(&c.log_det, &d.log_det, 1);
        assert_same_bits(&c.energy, &d.energy, 1);
        assert_true(memcmp(c.r, more_of_other.r, size * sizeof *c.r) != 0);
        more_results *const more[] = {&more_of_other, &c, &d};
        for (int i = 0; i < 3; ++i) free(more[i]->r), free(more[i]->v), free(more[i]->lambda), free(more[i]->force);
        forget(&of_other), forget(&a), forget(&b);
        hol_chains_destroy(chains), hol_chains_destroy(changed);
        molecule_free(&m), molecule_free(&other);
    }
}

static void bad_data_leave_all_of_it_untouched(molecule m, int threads, size_t places)
{
    hol_chains *chains = large_chains(&m);
    CHECK(hol_chains_set_threads(chains, threads));
    check_bad_data_change_nothing(&m, chains, places);
    hol_chains_destroy(chains);
    molecule_free(&m);
}

static void bad_data_leave_everything_untouched(void **state)
{
    (void)state;
    bad_data_leave_all_of_it_untouched(large_segments(2500, 300, 0, 2), 2, 1);
    bad_data_leave_all_of_it_untouched(large_ladder(200), 1, 1);
    if (quick_run()) return;
    bad_data_leave_all_of_it_untouched(large_comb(2500), 1, 3);
    for (int threads = 1; threads < 3; ++threads) {
        const size_t places = threads == 1 ? 3 : 1;
        bad_data_leave_all_of_it_untouched(large_segments(2500, 1, 0, 1), threads, places);
        bad_data_leave_all_of_it_untouched(large_segments(2500, 300, 0, 2), threads, places);
        bad_data_leave_all_of_it_untouched(large_rings(2500), threads, places);
        bad_data_leave_all_of_it_untouched(large_ladder(200), threads, places);
    }
    bad_data_leave_all_of_it_untouched(large_ladder(quick_run() ? 6000 : 40000), 1, 1); /* several tiles in a branch */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(number_of_threads_changes_no_bit),
        cmocka_unit_test(order_of_bonds_changes_no_bit),
        cmocka_unit_test(layout_changes_no_bit),
        cmocka_unit_test(multipliers_are_right_to_a_few_roundings),
        cmocka_unit_test(large_trees_with_an_atom_of_many_bonds_are_solved),
        cmocka_unit_test(light_atoms_between_heavy_ones_do_not_move_their_neighbours),
        cmocka_unit_test(masses_and_lengths_given_later_are_as_those_of_a_new_set),
        cmocka_unit_test(bad_data_leave_everything_untouched),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
