/** Boxes, reference boxes, inactive molecules, new lengths and masses, for molecules of any shape. */
#include "check.h"
#include "mixture.h"
#include "molecule_solution.h"

static const double orthorhombic[9] = {9, 0, 0, 0, 11, 0, 0, 0, 10}, triclinic[9] = {9, 0, 0, 2, 10, 0, -1, 3, 11};

/** Puts every atom into another cell of its own. */
static void wrap(double *r, int64_t n_atoms, const double *box)
{
    for (int64_t i = 0; i < n_atoms; ++i)
        for (int h = 0; h < 3; ++h)
            for (int x = 0; x < 3; ++x) r[3 * i + x] += (double)((i * (h + 2)) % 3 - 1) * box[3 * h + x];
}

/** Solutions are those of the rounded positions, whose images the reference finds by trying them. */
static void assert_forces(const mixture *m, const molecule *part, const double *box)
{
    molecule_problem problem = molecule_problem_of(part);
    molecule_solution exact;
    double *lambda = untouched((size_t)m->n_bonds);
    problem.r = m->r;
    problem.box = box;
    assert_int_equal(molecule_forces(&problem, &exact), 0);
    CHECK(hol_forces(m->chains, m->r, m->v, m->f, lambda, NULL, NULL, HOL_WRITE, NULL));
    /* images round: each component of a bond by eps of a cell or two, in units of a bond of 1 */
    for (int64_t k = 0; k < m->n_bonds; ++k)
        CHECK_AT_MOST(fabsl(lambda[k] - exact.lambda[k]),
                      (oracle_bound(m->n_bonds) + 64) * DBL_EPSILON * exact.lambda_scale[k]);
    free(lambda);
    molecule_solution_free(&exact);
}

static void molecules_across_the_boundary_of_a_box_are_solved_by_their_images(void **state)
{
    (void)state;
    static const molecule_kind kinds[] = {MOLECULE_WATER, MOLECULE_XH3,  MOLECULE_NEOPENTANE, MOLECULE_RING,
                                          MOLECULE_COMB,  MOLECULE_CUBE, MOLECULE_TRIANGLES};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; ++k)
        for (int shape = 0; shape < 2; ++shape) {
            const double *box = shape ? triclinic : orthorhombic;
            molecule part = molecule_make(kinds[k], 8, k);
            mixture m = mixture_make(&part, 1, ONE_AFTER_THE_OTHER, 0);
            wrap(m.r, m.n_atoms, box);
            CHECK(hol_chains_set_box(m.chains, box));
            assert_forces(&m, &part, box);
            mixture_free(&m);
            molecule_free(&part);
        }
}

/** The reference positions lie in another cell than the new ones: each bond is an image in its own. */
static void positions_use_the_reference_box_for_the_old_bonds(void **state)
{
    (void)state;
    const double dt = 0.002;
    static const molecule_kind kinds[] = {MOLECULE_WATER, MOLECULE_CHAIN, MOLECULE_COMB, MOLECULE_RING, MOLECULE_CUBE};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; ++k) {
        molecule part = molecule_make(kinds[k], 7, 3 + k);
        mixture m = mixture_make(&part, 1, ONE_AFTER_THE_OTHER, 0);
        const size_t size = mixture_size(&m);
        double *r = mixture_drifted(&m, dt), *drifted, *lambda = untouched((size_t)m.n_bonds);
        double *wrapped = copy_of(m.r, size);
        wrap(wrapped, m.n_atoms, orthorhombic);
        wrap(r, m.n_atoms, triclinic);
        drifted = copy_of(r, size);
        CHECK(hol_chains_set_box(m.chains, triclinic));
        CHECK(hol_chains_set_reference_box(m.chains, orthorhombic));
        CHECK(hol_project_positions(m.chains, wrapped, r, NULL, dt, lambda, 0, NULL, NULL));
        molecule_problem problem = molecule_problem_of(&part);
        molecule_solution exact;
        problem.r = wrapped;
        problem.box = orthorhombic;
        assert_int_equal(molecule_positions(&problem, drifted, triclinic, part.length, dt, &exact), 0);
        const long double unit = (oracle_bound(m.n_bonds) + 64) * DBL_EPSILON;
        for (size_t i = 0; i < size; ++i) CHECK_AT_MOST(fabsl(r[i] - exact.moved[i]), unit * exact.moved_scale[i / 3]);
        for (int64_t b = 0; b < m.n_bonds; ++b)
            CHECK_AT_MOST(fabsl(lambda[b] - exact.lambda[b]), unit * exact.lambda_scale[b]);
        molecule_solution_free(&exact);
        free(r), free(drifted), free(lambda), free(wrapped);
        mixture_free(&m);
        molecule_free(&part);
    }
}

static void inactive_molecules_are_neither_read_nor_written(void **state)
{
    (void)state;
    mixture m = mixture_of_kind(MOLECULE_XH3, 30, 3, 3, ONE_AFTER_THE_OTHER, 4);
    unsigned char active[30];
    double *all = untouched(90), *lambda = untouched(90), *g = untouched(mixture_size(&m)), virial[9], sum[9] = {0};
    CHECK(hol_forces(m.chains, m.r, m.v, m.f, all, NULL, NULL, HOL_WRITE, NULL));
    const int64_t freedoms = hol_chains_degrees_of_freedom(m.chains, 3);
    for (int c = 0; c < 30; ++c) active[c] = c % 3 != 1;
    CHECK(hol_chains_set_active(m.chains, active));
    assert_int_equal(hol_chains_degrees_of_freedom(m.chains, 3), freedoms + 30);
    for (int c = 1; c < 30; c += 3) m.r[12 * c] = NAN;
    CHECK(hol_forces(m.chains, m.r, m.v, m.f, lambda, NULL, g, HOL_WRITE, virial));
    for (int c = 0; c < 30; ++c) {
        if (c % 3 == 1) {
            assert_untouched(lambda + 3 * c, 3);
            assert_untouched(g + 12 * c, 12);
            continue;
        }
        assert_same_bits(lambda + 3 * c, all + 3 * c, 3);
        for (int64_t k = 3 * c; k < 3 * c + 3; ++k)
            for (int n = 0; n < 9; ++n) {
                const double *i = m.r + 3 * m.pairs[2 * k], *j = m.r + 3 * m.pairs[2 * k + 1];
                sum[n] -= 2 * lambda[k] * (j[n / 3] - i[n / 3]) * (j[n % 3] - i[n % 3]);
            }
    }
    for (int n = 0; n < 9; ++n)
        CHECK_AT_MOST(fabs(virial[n] - sum[n]), 1e-12 * (fabs(sum[0]) + fabs(sum[4]) + fabs(sum[8])));
    free(all), free(lambda), free(g);
    mixture_free(&m);
}

/** The same handle with new lengths and masses is a handle made with these from the start. */
static void new_lengths_and_masses_give_the_bits_of_a_new_handle(void **state)
{
    (void)state;
    const double dt = 1e-3;
    mixture m = mixture_of_kind(MOLECULE_PEPTIDE, 9, 1, 2, MIXED, 5);
    const size_t n = (size_t)m.n_bonds, size = mixture_size(&m);
    for (size_t k = 0; k < n; ++k) m.length[k] *= 1 + 1e-3 * (double)(k % 5);
    for (int64_t i = 0; i < m.n_atoms; ++i) m.mass[i] *= 1 + 0.5 * (double)(i % 3);
    CHECK(hol_chains_set_lengths(m.chains, m.length));
    CHECK(hol_chains_set_masses(m.chains, m.mass));
    hol_chains *fresh;
    CHECK(hol_chains_create(m.n_atoms, m.mass, &fresh));
    CHECK(hol_chains_add_bonds(fresh, m.n_bonds, m.pairs, m.length));
    double *lambda[2], *tau[2], *r[2];
    for (int k = 0; k < 2; ++k) {
        hol_chains *chains = k ? fresh : m.chains;
        lambda[k] = untouched(n), tau[k] = untouched(n), r[k] = mixture_drifted(&m, dt);
        CHECK(hol_forces(chains, m.r, m.v, m.f, lambda[k], NULL, NULL, HOL_WRITE, NULL));
        CHECK(hol_project_positions(chains, m.r, r[k], NULL, dt, tau[k], 0, NULL, NULL));
    }
    assert_same_bits(lambda[0], lambda[1], n);
    assert_same_bits(tau[0], tau[1], n);
    for (size_t i = 0; i < size; ++i)
        if (!isnan(m.r[i])) assert_same_bits(r[0] + i, r[1] + i, 1);
    for (int k = 0; k < 2; ++k) free(lambda[k]), free(tau[k]), free(r[k]);
    hol_chains_destroy(fresh);
    mixture_free(&m);
}

static void wrong_lengths_and_masses_change_nothing(void **state)
{
    (void)state;
    mixture m = mixture_of_kind(MOLECULE_FIXED_ATOMS, 2, 6, 6, ONE_AFTER_THE_OTHER, 6);
    const size_t n = (size_t)m.n_bonds;
    double *before = untouched(n), *after = untouched(n), *mass = copy_of(m.mass, (size_t)m.n_atoms);
    double *length = copy_of(m.length, n);
    int64_t fixed = 0, movable = 0;
    while (m.mass[fixed] != 0) ++fixed;
    while (m.mass[movable] == 0) ++movable;
    CHECK(hol_forces(m.chains, m.r, m.v, m.f, before, NULL, NULL, HOL_WRITE, NULL));
    length[3] = -1;
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_lengths(m.chains, length));
    mass[movable] = -2;
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_masses(m.chains, mass));
    mass[movable] = 0; /* would divide its molecule */
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_masses(m.chains, mass));
    mass[movable] = m.mass[movable];
    mass[fixed] = 1; /* would join molecules */
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_masses(m.chains, mass));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_set_masses(m.chains, NULL));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_set_lengths(NULL, length));
    CHECK(hol_forces(m.chains, m.r, m.v, m.f, after, NULL, NULL, HOL_WRITE, NULL));
    assert_same_bits(before, after, n);
    free(before), free(after), free(mass), free(length);
    mixture_free(&m);
}

/** What needs more than the bound is left as it was. */
static void no_molecule_takes_more_iterations_than_the_bound(void **state)
{
    (void)state;
    const double dt = 0.02;
    int refused = 0, solved = 0;
    for (int kind = 0; kind < MOLECULE_KINDS; ++kind) {
        if (kind >= MOLECULE_GOOD_KINDS && kind < MOLECULE_REFUSED_END) continue;
        for (int64_t n = 1; n <= 9; n += 4) {
            mixture m = mixture_of_kind((molecule_kind)kind, n, kind == MOLECULE_DENDRIMER ? 2 : 5,
                                        kind == MOLECULE_DENDRIMER ? 2 : 5, ONE_AFTER_THE_OTHER, 4);
            const size_t size = mixture_size(&m), bonds = (size_t)m.n_bonds;
            double *drifted = mixture_drifted(&m, dt), *free_r = copy_of(drifted, size);
            const int unbound = hol_project_positions(m.chains, m.r, free_r, NULL, dt, NULL, 0, NULL, NULL);
            for (int bound = 1; bound <= 12 && unbound != HOL_ERR_NO_CONVERGENCE; ++bound) {
                double *r = copy_of(drifted, size), *lambda = untouched(bonds);
                hol_report report;
                CHECK(hol_chains_set_max_iterations(m.chains, bound));
                const int status = hol_project_positions(m.chains, m.r, r, NULL, dt, lambda, 0, NULL, &report);
                if (report.iterations > bound)
                    fail_msg("%s, %d molecules: %d iterations, bound %d", molecule_kind_name((molecule_kind)kind),
                             (int)n, (int)report.iterations, bound);
                if (hol_chains_n_molecules(m.chains) == 1 && status != HOL_OK) {
                    assert_int_equal(status, HOL_ERR_NO_CONVERGENCE);
                    assert_same_bits(r, drifted, size);
                    assert_untouched(lambda, bonds);
                    ++refused;
                }
                if (status == HOL_OK && unbound == HOL_OK) {
                    hol_worst worst;
                    CHECK(hol_violation(m.chains, r, NULL, &worst));
                    CHECK_AT_MOST(worst.length, 1e-12);
                    ++solved;
                }
                free(r), free(lambda);
            }
            free(drifted), free(free_r);
            mixture_free(&m);
        }
    }
    assert_true(refused > 50 && solved > 200);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(molecules_across_the_boundary_of_a_box_are_solved_by_their_images),
        cmocka_unit_test(positions_use_the_reference_box_for_the_old_bonds),
        cmocka_unit_test(inactive_molecules_are_neither_read_nor_written),
        cmocka_unit_test(new_lengths_and_masses_give_the_bits_of_a_new_handle),
        cmocka_unit_test(wrong_lengths_and_masses_change_nothing),
        cmocka_unit_test(no_molecule_takes_more_iterations_than_the_bound),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
