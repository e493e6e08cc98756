/**
 * Molecules of thousands of bonds that are eliminated along one list: positions, of trees too, and what is done where
 * multipliers of those with cycles can't be proven right without a correction.
 */
#include "check.h"
#include "equations.h"
#include "input.h"
#include "large.h"
#include "molecule_solution.h"

static const double dt = 0.002;

static int64_t size_of_test(void)
{
    return quick_run() ? 2500 : 80000;
}

/** With cycles, a random tree, and a tree of arms. */
static molecule example(int which)
{
    return which == 0   ? large_rings(size_of_test())
           : which == 1 ? large_segments(size_of_test(), 1, 0, 1)
                        : large_segments(size_of_test(), 300, 0, 2);
}

/** |d.d - a^2| / a^2 of a bond. */
static double error_of(const molecule *m, const double *r, int64_t k)
{
    const int64_t i = m->pairs[2 * k], j = m->pairs[2 * k + 1];
    long double sum = -(long double)m->length[k] * m->length[k];
    for (int c = 0; c < 3; ++c) sum += powl((long double)r[3 * j + c] - r[3 * i + c], 2);
    return (double)(fabsl(sum) / (m->length[k] * m->length[k]));
}

static void get_their_lengths(molecule m)
{
    hol_chains *chains = large_chains(&m);
    const size_t n = (size_t)m.n_bonds, size = 3 * (size_t)m.n_atoms;
    double *start = molecule_drifted(&m, dt), *r = copy_of(start, size), *v = copy_of(m.v, size);
    double *lambda = untouched(n);
    hol_report report;
    CHECK(hol_project_positions(chains, m.r, r, v, dt, lambda, 0, NULL, &report));
    assert_int_equal(report.n_corrected, 1);
    double extent = 0, shortest = 1;
    for (size_t i = 0; i < size; ++i) extent = fmax(extent, fabs(r[i]));
    for (size_t k = 0; k < n; ++k) shortest = fmin(shortest, m.length[k]);
    for (int64_t k = 0; k < m.n_bonds; ++k)
        CHECK_AT_MOST(error_of(&m, r, k), 8 * DBL_EPSILON * (1 + extent / shortest));
    double *move = calloc(size, sizeof *move), largest = 0;
    for (size_t k = 0; k < n; ++k)
        for (int e = 0; e < 2; ++e) {
            const int64_t i = m.pairs[2 * k + (size_t)e], j = m.pairs[2 * k + (size_t)(1 - e)];
            largest = fmax(largest, dt * dt * fabs(lambda[k]) / fmin(m.mass[i], m.mass[j]));
            for (int c = 0; c < 3; ++c)
                move[3 * i + c] += 2 * dt * dt / m.mass[i] * lambda[k] * (m.r[3 * j + c] - m.r[3 * i + c]);
        }
    for (size_t i = 0; i < size; ++i) {
        CHECK_AT_MOST(fabs(start[i] + move[i] - r[i]), 4 * DBL_EPSILON * extent + 16 * DBL_EPSILON * largest);
        CHECK_AT_MOST(fabs(m.v[i] + move[i] / dt - v[i]), 4 * DBL_EPSILON * 8 + 16 * DBL_EPSILON * largest / dt);
    }
    /* Once more, with these as a guess: nothing but roundings can have changed. */
    CHECK(hol_project_positions(chains, m.r, start, NULL, dt, lambda, 1, NULL, NULL));
    for (size_t i = 0; i < size; ++i) CHECK_AT_MOST(fabs(start[i] - r[i]), 64 * DBL_EPSILON * extent);
    free(start), free(r), free(v), free(lambda), free(move);
    hol_chains_destroy(chains);
    molecule_free(&m);
}
static void bonds_get_their_lengths_by_the_forces_that_lambda_says(void **state)
{
    (void)state;
    for (int which = 0; which < 3; ++which) get_their_lengths(example(which));
}

static void report_the_worst(molecule m)
{
    hol_chains *chains = large_chains(&m);
    for (int turn = 0; turn < 2; ++turn) { /* moved, and near enough as they are */
        double *r = molecule_drifted(&m, dt), worst = 0;
        hol_report report;
        int64_t bond = 0, *order = malloc((size_t)m.n_bonds * sizeof *order);
        CHECK(hol_chains_set_tolerance(chains, turn == 0 ? 1e-5 : 0.5));
        CHECK(hol_project_positions(chains, m.r, r, NULL, dt, NULL, 0, NULL, &report));
        assert_int_equal(report.n_corrected, turn == 0);
        for (int64_t k = 0; k < m.n_bonds; ++k)
            if (error_of(&m, r, k) > worst) worst = error_of(&m, r, k), bond = k;
        CHECK_AT_MOST(fabs(report.max_error - worst), 1e-12);
        CHECK(hol_chains_bonds(chains, 0, order));
        if (worst > 1e-10) assert_int_equal(order[report.bond], bond);
        free(r), free(order);
    }
    hol_chains_destroy(chains);
    molecule_free(&m);
}
static void the_worst_bond_is_reported(void **state)
{
    (void)state;
    for (int which = 0; which < 3; ++which) report_the_worst(example(which));
}

static void change_no_bit(molecule m)
{
    hol_chains *chains = large_chains(&m);
    const size_t n = (size_t)m.n_bonds, size = 3 * (size_t)m.n_atoms;
    double *start = molecule_drifted(&m, dt), *r = copy_of(start, size), *other = copy_of(start, size);
    double *lambda = untouched(n);
    double *components = untouched(size);
    CHECK(hol_project_positions(chains, m.r, r, NULL, dt, lambda, 0, NULL, NULL));
    CHECK(hol_chains_set_threads(chains, 3));
    CHECK(hol_project_positions(chains, m.r, other, NULL, dt, NULL, 0, NULL, NULL));
    assert_same_bits(other, r, size);
    for (size_t i = 0; i < size; ++i) components[i % 3 * (size / 3) + i / 3] = start[i];
    const hol_view ref = {m.r, m.r + 1, m.r + 2, 3 * sizeof(double), HOL_DOUBLE, 0},
                   now = {components, components + size / 3, components + 2 * (size / 3), sizeof(double), HOL_DOUBLE,
                          0};
    CHECK(hol_project_positions_view(chains, INPUT(&ref), &now, NULL, dt, NULL, 0, NULL, NULL));
    for (size_t i = 0; i < size; ++i) assert_same_bits(components + i % 3 * (size / 3) + i / 3, r + i, 1);
    hol_chains_destroy(chains);
    large_turn_bonds(&m);
    chains = large_chains(&m);
    memcpy(other, start, size * sizeof *other);
    double *turned = untouched(n);
    CHECK(hol_project_positions(chains, m.r, other, NULL, dt, turned, 0, NULL, NULL));
    assert_same_bits(other, r, size);
    for (size_t k = 0; k < n; ++k) assert_same_bits(turned + k, lambda + n - 1 - k, 1);
    free(start), free(r), free(other), free(lambda), free(turned), free(components);
    hol_chains_destroy(chains);
    molecule_free(&m);
}
static void order_threads_and_layout_change_no_bit_of_positions(void **state)
{
    (void)state;
    for (int which = 0; which < 3; ++which) change_no_bit(example(which));
}

/** Where a single atom is pulled, most equations have no terms but what is left of that pull. */
static void pulled_at_one_atom_each_of_two_molecules_gets_its_own_digits(void **state)
{
    (void)state;
    molecule m = large_rings(size_of_test());
    hol_chains *one = large_chains(&m), *two = NULL;
    const size_t n = (size_t)m.n_bonds, atoms = (size_t)m.n_atoms, size = 3 * atoms;
    double *mass = untouched(2 * atoms), *r = untouched(2 * size), *f = calloc(2 * size, sizeof *f);
    double *v = untouched(2 * size), *lambda = untouched(2 * n), *alone = untouched(n);
    for (size_t copy = 0; copy < 2; ++copy) {
        memcpy(mass + copy * atoms, m.mass, atoms * sizeof *mass);
        memcpy(r + copy * size, m.r, size * sizeof *r);
        memcpy(v + copy * size, m.v, size * sizeof *v);
        f[copy * size + size / 2] = 1;
    }
    CHECK(hol_chains_create(2 * m.n_atoms, mass, &two));
    CHECK(hol_chains_add_molecules(two, 2, m.n_atoms, 0, m.n_bonds, m.pairs, m.length));
    CHECK(hol_forces(one, r, NULL, f, alone, NULL, NULL, HOL_WRITE, NULL));
    CHECK(hol_forces(two, r, NULL, f, lambda, NULL, NULL, HOL_WRITE, NULL));
    assert_same_bits(lambda, alone, n);
    assert_same_bits(lambda + n, alone, n);
    CHECK(hol_project_velocities(one, r, v, alone, NULL));
    memcpy(v, v + size, size * sizeof *v);
    CHECK(hol_project_velocities(two, r, v, lambda, NULL));
    assert_same_bits(lambda, alone, n);
    assert_same_bits(lambda + n, alone, n);
    assert_same_bits(v, v + size, size);
    free(mass), free(r), free(f), free(v), free(lambda), free(alone);
    hol_chains_destroy(one), hol_chains_destroy(two);
    molecule_free(&m);
}

static void agree(const double *lambda, const double *moved, const molecule *m, molecule_solution *exact)
{
    const long double unit = oracle_bound(m->n_bonds) * DBL_EPSILON;
    for (int64_t k = 0; k < m->n_bonds; ++k)
        CHECK_AT_MOST(fabsl(lambda[k] - exact->lambda[k]), unit * exact->lambda_scale[k]);
    for (int64_t i = 0; moved && i < 3 * m->n_atoms; ++i)
        CHECK_AT_MOST(fabsl(moved[i] - exact->moved[i]), unit * exact->moved_scale[i / 3]);
    molecule_solution_free(exact);
}
/** Below some size they are worked on in lanes, above it along the list. Velocities twice: when they are projected
 * already, multipliers are rounding. */
static void every_size_about_the_limit_agrees_with_a_dense_solution(void **state)
{
    (void)state;
    const int64_t middle = 242, more = quick_run() ? 1 : 5;
    for (int64_t n = middle - more; n <= middle + more; ++n) {
        molecule m = large_rings(n);
        hol_chains *chains = large_chains(&m);
        double *lambda = untouched((size_t)m.n_bonds), *v = copy_of(m.v, 3 * (size_t)m.n_atoms);
        molecule_problem problem = molecule_problem_of(&m);
        molecule_solution exact;
        CHECK(hol_forces(chains, m.r, m.v, m.f, lambda, NULL, NULL, HOL_WRITE, NULL));
        assert_int_equal(molecule_forces(&problem, &exact), 0);
        agree(lambda, NULL, &m, &exact);
        CHECK(hol_solve(chains, m.r, m.length, lambda, NULL, HOL_WRITE, NULL));
        if (!quick_run()) { /* under slow tools dense solutions take most of the time: one of them will do */
            assert_int_equal(molecule_solve(&problem, m.length, &exact), 0);
            agree(lambda, NULL, &m, &exact);
        }
        for (int turn = 0; turn < 2 && !quick_run(); ++turn) {
            assert_int_equal(molecule_velocities(&problem, &exact), 0);
            CHECK(hol_project_velocities(chains, m.r, v, lambda, NULL));
            agree(lambda, v, &m, &exact);
            for (size_t i = 0; i < 3 * (size_t)m.n_atoms; ++i) m.v[i] = v[i];
        }
        free(lambda), free(v);
        hol_chains_destroy(chains);
        molecule_free(&m);
    }
}

/** Of several tiles; the bounds of one bond in a hundred fail there, and those of some forces' by more than a little.
 */
static void ladders_of_several_tiles_leave_roundings_of_their_equations(void **state)
{
    (void)state;
    molecule m = large_ladder(quick_run() ? 6000 : 40000);
    hol_chains *chains = large_chains(&m);
    const size_t n = (size_t)m.n_bonds, size = 3 * (size_t)m.n_atoms;
    double *lambda = untouched(n), *v = copy_of(m.v, size), *g = untouched(size);
    CHECK(hol_forces(chains, m.r, m.v, m.f, lambda, NULL, g, HOL_WRITE, NULL));
    leave_roundings_of_equations(&m, lambda, m.v, m.f, 0, NULL);
    for (size_t k = 0; k < n; ++k)
        for (int e = 0; e < 2; ++e) {
            const int64_t i = m.pairs[2 * k + (size_t)e], j = m.pairs[2 * k + (size_t)(1 - e)];
            for (int c = 0; c < 3; ++c) g[3 * i + c] -= 2 * lambda[k] * (m.r[3 * j + c] - m.r[3 * i + c]);
        }
    double left = 0, most = 0;
    for (size_t i = 0; i < size; ++i) left = fmax(left, fabs(g[i]));
    for (size_t k = 0; k < n; ++k) most = fmax(most, fabs(lambda[k]));
    CHECK_AT_MOST(left, 64 * DBL_EPSILON * most);
    CHECK(hol_solve(chains, m.r, m.f, lambda, NULL, HOL_WRITE, NULL));
    leave_roundings_of_equations(&m, lambda, NULL, NULL, 0, m.f);
    CHECK(hol_project_velocities(chains, m.r, v, lambda, NULL));
    leave_roundings_of_equations(&m, lambda, m.v, NULL, 1, NULL);
    for (size_t k = 0; k < n; ++k) {
        const int64_t i = m.pairs[2 * k], j = m.pairs[2 * k + 1];
        double rate = 0, sizes = 0;
        for (int c = 0; c < 3; ++c) {
            const double d = m.r[3 * j + c] - m.r[3 * i + c];
            rate += d * (v[3 * j + c] - v[3 * i + c]);
            sizes += fabs(d) * (fabs(v[3 * j + c]) + fabs(v[3 * i + c]));
        }
        CHECK_AT_MOST(fabs(rate), 8 * DBL_EPSILON * sizes);
    }
    free(lambda), free(v), free(g);
    hol_chains_destroy(chains);
    molecule_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bonds_get_their_lengths_by_the_forces_that_lambda_says),
        cmocka_unit_test(the_worst_bond_is_reported),
        cmocka_unit_test(order_threads_and_layout_change_no_bit_of_positions),
        cmocka_unit_test(pulled_at_one_atom_each_of_two_molecules_gets_its_own_digits),
        cmocka_unit_test(every_size_about_the_limit_agrees_with_a_dense_solution),
        cmocka_unit_test(ladders_of_several_tiles_leave_roundings_of_their_equations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
