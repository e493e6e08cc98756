/** Metric determinants, Fixman forces and inverses of molecules of any shape. */
#include "check.h"
#include "mixture.h"
#include "molecule_solution.h"

/** Values per molecule of the library, summed over the molecules that a part is to it. */
static long double of_part(const mixture *m, int64_t part, const double *per_molecule)
{
    int64_t *molecules = calloc((size_t)m->n_bonds, sizeof *molecules);
    char *seen = calloc((size_t)hol_chains_n_molecules(m->chains) + 1, 1);
    long double sum = 0;
    CHECK(hol_chains_molecules_of_bonds(m->chains, molecules));
    for (int64_t k = m->first_bond[part]; k < m->first_bond[part + 1]; ++k) {
        const int64_t c = molecules[m->bonds[k]];
        if (c >= 0 && !seen[c]++) sum += per_molecule[c];
    }
    free(molecules), free(seen);
    return sum;
}

static void metric_agrees_with_a_dense_solution(void **state)
{
    (void)state;
    mixture m = mixture_of_all(quick_run() ? 1 : 3, MIXED, 1);
    const size_t n = (size_t)hol_chains_n_molecules(m.chains);
    const double kT = 1.5;
    double *log_det = untouched(n), *log_det_z = untouched(n), *force = untouched(mixture_size(&m)), energy;
    long double sum = 0, size = 0;
    CHECK(hol_metric(m.chains, m.r, kT, log_det, log_det_z, &energy, force, HOL_WRITE));
    for (int64_t p = 0; p < m.n_parts; ++p) {
        const molecule *part = m.parts + p;
        const molecule_problem problem = molecule_problem_of(part);
        const long double unit = oracle_bound(part->n_bonds) * DBL_EPSILON;
        double *got = untouched(3 * (size_t)part->n_atoms);
        molecule_metric exact;
        assert_int_equal(molecule_metric_make(&problem, &exact), 0);
        mixture_take(&m, p, force, got);
        CHECK_AT_MOST(fabsl(of_part(&m, p, log_det) - exact.log_det), unit * fabsl(exact.log_det));
        CHECK_AT_MOST(fabsl(of_part(&m, p, log_det_z) - exact.log_det_z), unit * exact.log_det_z_scale);
        for (int64_t i = 0; i < 3 * part->n_atoms; ++i)
            if (exact.fixman_scale[i / 3] > 0)
                CHECK_AT_MOST(fabsl(got[i] - kT * exact.fixman_force[i]), 2.2L * kT * unit * exact.fixman_scale[i / 3]);
        sum += kT / 2 * exact.log_det;
        size += fabsl(exact.log_det);
        free(got);
        molecule_metric_free(&exact);
    }
    CHECK_AT_MOST(fabsl(energy - sum), 64 * DBL_EPSILON * size);
    free(log_det), free(log_det_z), free(force);
    mixture_free(&m);
}

/** - kT/2 d(ln det)/dr by central differences of fourth order: it knows nothing of the formula for the gradient. */
static void fixman_forces_are_differences_of_the_energy(void **state)
{
    (void)state;
    static const molecule_kind kinds[] = {MOLECULE_WATER,   MOLECULE_NEOPENTANE, MOLECULE_TREE, MOLECULE_FIXED_ATOMS,
                                          MOLECULE_RING,    MOLECULE_TRIANGLES,  MOLECULE_CUBE, MOLECULE_FUSED_RINGS,
                                          MOLECULE_BENZENE, MOLECULE_DENDRIMER,  MOLECULE_STAR};
    const double step = 0x1p-10; /* truncation of step^4 over lengths of 1: 1e-12; rounding of 1e-16 over step: 1e-12 */
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; ++k) {
        mixture m = mixture_of_kind(kinds[k], 1, kinds[k] == MOLECULE_DENDRIMER ? 1 : 5, 5, ONE_AFTER_THE_OTHER, 2 + k);
        double *force = untouched(mixture_size(&m)), total[3] = {0};
        CHECK(hol_metric(m.chains, m.r, 1, NULL, NULL, NULL, force, HOL_WRITE));
        for (size_t i = 0; i < mixture_size(&m); i += quick_run() ? 7 : 1) {
            const double here = m.r[i];
            double energy[4];
            for (int n = 0; n < 4; ++n) {
                m.r[i] = here + (n < 2 ? n - 2 : n - 1) * step;
                CHECK(hol_metric(m.chains, m.r, 1, NULL, NULL, energy + n, NULL, HOL_WRITE));
            }
            m.r[i] = here;
            const double slope = (8 * (energy[2] - energy[1]) - energy[3] + energy[0]) / (12 * step);
            CHECK_AT_MOST(fabs(force[i] + slope), 1e-8);
            total[i % 3] += force[i];
        }
        for (int x = 0; x < 3 && !quick_run(); ++x) CHECK_AT_MOST(fabs(total[x]), 256 * DBL_EPSILON);
        free(force);
        mixture_free(&m);
    }
}

/** Z~^-1 in the order of the library's bonds. */
static void inverse_elements_agree_with_the_dense_inverse(void **state)
{
    (void)state;
    for (int kind = 0; kind < MOLECULE_GOOD_KINDS; kind += quick_run() ? 3 : 1) {
        if (kind == MOLECULE_FIXED_ATOMS) continue; /* several molecules */
        mixture m =
            mixture_of_kind((molecule_kind)kind, 1, kind == MOLECULE_DENDRIMER ? 1 : 6, 6, MIXED, 70 + (uint64_t)kind);
        const molecule *part = m.parts;
        const molecule_problem problem = molecule_problem_of(part);
        const int64_t n = part->n_bonds;
        const long double unit = oracle_bound(n) * DBL_EPSILON;
        int64_t *order = calloc((size_t)n, sizeof *order), *back = calloc((size_t)n, sizeof *back);
        double *row = untouched((size_t)n), value, condition;
        hol_inverse *inverse;
        molecule_metric exact;
        assert_int_equal(molecule_metric_make(&problem, &exact), 0);
        CHECK(hol_chains_bonds(m.chains, 0, order));
        for (int64_t k = 0; k < n; ++k) back[m.bonds[k]] = k; /* place in the list -> bond of the part */
        CHECK(hol_inverse_create(m.chains, 0, m.r, &inverse));
        assert_int_equal(hol_inverse_n_bonds(inverse), n);
        for (int64_t i = 0; i < n; ++i) {
            CHECK(hol_inverse_row(inverse, HOL_UNIT_DIAGONAL, i, row));
            for (int64_t j = 0; j < n; ++j) {
                const int64_t a = back[order[i]], b = back[order[j]];
                /* relative to the diagonal, as rounding of the inputs moves small elements by parts of it */
                const long double size = sqrtl(exact.inverse[a * n + a] * exact.inverse[b * n + b]);
                CHECK_AT_MOST(fabsl(row[j] - exact.inverse[a * n + b]), unit * size);
                CHECK(hol_inverse_entry(inverse, HOL_UNIT_DIAGONAL, i, j, &value));
                CHECK_AT_MOST(fabs(value - row[j]), 4 * DBL_EPSILON * size);
            }
        }
        CHECK(hol_inverse_condition(inverse, &condition));
        CHECK_AT_MOST(fabsl(condition - exact.condition), 2 * unit * exact.condition);
        hol_inverse_destroy(inverse);
        free(order), free(back), free(row);
        molecule_metric_free(&exact);
        mixture_free(&m);
    }
}

static void error_bounds_hold_for_the_librarys_multipliers_and_for_spoilt_ones(void **state)
{
    (void)state;
    for (int kind = 0; kind < MOLECULE_GOOD_KINDS; kind += 3) {
        if (kind == MOLECULE_FIXED_ATOMS) continue;
        mixture m =
            mixture_of_kind((molecule_kind)kind, 1, kind == MOLECULE_DENDRIMER ? 1 : 5, 5, ONE_AFTER_THE_OTHER, 90);
        const molecule_problem problem = molecule_problem_of(m.parts);
        const size_t n = (size_t)m.n_bonds;
        double *lambda = untouched(n), *given = untouched(n), *bound = untouched(n), relative;
        int64_t *order = calloc(n, sizeof *order);
        hol_inverse *inverse;
        molecule_solution exact;
        assert_int_equal(molecule_forces(&problem, &exact), 0);
        CHECK(hol_forces(m.chains, m.r, m.v, m.f, lambda, NULL, NULL, HOL_WRITE, NULL));
        CHECK(hol_chains_bonds(m.chains, 0, order));
        CHECK(hol_inverse_create(m.chains, 0, m.r, &inverse));
        for (int spoilt = 0; spoilt < 2; ++spoilt) {
            for (size_t k = 0; k < n; ++k) given[k] = lambda[order[k]] * (spoilt && k == 1 ? 1 + 1e-6 : 1);
            CHECK(hol_inverse_error_bound(inverse, m.v, m.f, given, bound, &relative));
            for (size_t k = 0; k < n; ++k) {
                const long double exactly = exact.lambda[order[k]];
                CHECK_AT_MOST(fabsl(given[k] - exactly), bound[k] + 2 * long_double_rounding() * fabsl(exactly));
            }
            if (!spoilt) CHECK_AT_MOST(relative, 1e-6L);
        }
        hol_inverse_destroy(inverse);
        molecule_solution_free(&exact);
        free(lambda), free(given), free(bound), free(order);
        mixture_free(&m);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(metric_agrees_with_a_dense_solution),
        cmocka_unit_test(fixman_forces_are_differences_of_the_energy),
        cmocka_unit_test(inverse_elements_agree_with_the_dense_inverse),
        cmocka_unit_test(error_bounds_hold_for_the_librarys_multipliers_and_for_spoilt_ones),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
