/** The independent solutions for molecules obey the equations that they claim to solve, and the reference files agree.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

/* which needs the four above */
#include <cmocka.h>

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "chain.h"
#include "molecule.h"
#include "molecule_file.h"
#include "molecule_solution.h"
#include "solution.h"

/* Results have the digits of a long double, in sums of a few terms. */
static long double rounding(void)
{
    volatile long double eps = 1, sum = 2; /* that of double under valgrind, whatever LDBL_EPSILON says */
    while (sum != 1) {
        eps /= 2;
        sum = 1 + eps;
    }
    return 2 * eps;
}

static void assert_close(long double value, long double reference, long double allowed)
{
    if (!(fabsl(value - reference) <= allowed)) {
        print_error("%.21Lg instead of %.21Lg, allowed %Lg\n", value, reference, allowed);
        fail();
    }
}

static int64_t size_of_kind(int kind)
{
    return kind == MOLECULE_DENDRIMER || kind == MOLECULE_PEPTIDE ? 2 : 9;
}

static long double component(const double *array, int64_t i, int x)
{
    return array ? (long double)array[3 * i + x] : 0;
}

static void accelerations_obey_the_constraints(void **state)
{
    (void)state;
    for (int kind = 0; kind < MOLECULE_GOOD_KINDS; ++kind) {
        molecule m = molecule_make((molecule_kind)kind, size_of_kind(kind), 3);
        const molecule_problem p = molecule_problem_of(&m);
        molecule_solution s;
        assert_int_equal(molecule_forces(&p, &s), 0);
        for (int64_t k = 0; k < m.n_bonds; ++k) {
            const int64_t i = m.pairs[2 * k], j = m.pairs[2 * k + 1];
            long double sum = 0, size = 0;
            if (m.inverse_mass[i] == 0 && m.inverse_mass[j] == 0) continue;
            for (int x = 0; x < 3; ++x) {
                const long double d = component(m.r, j, x) - component(m.r, i, x);
                const long double dv = component(m.v, j, x) - component(m.v, i, x);
                const long double ai = m.inverse_mass[i] * (component(m.f, i, x) + s.g[3 * i + x]);
                const long double aj = m.inverse_mass[j] * (component(m.f, j, x) + s.g[3 * j + x]);
                sum += d * (aj - ai) + dv * dv;
                size += fabsl(d) * (m.inverse_mass[i] * s.g_scale[i] + m.inverse_mass[j] * s.g_scale[j] + fabsl(ai) +
                                    fabsl(aj)) +
                        dv * dv;
            }
            assert_close(sum, 0, 32 * rounding() * size);
        }
        molecule_solution_free(&s);
        molecule_free(&m);
    }
}

static void velocities_obey_the_constraints(void **state)
{
    (void)state;
    for (int kind = 0; kind < MOLECULE_GOOD_KINDS; ++kind) {
        molecule m = molecule_make((molecule_kind)kind, size_of_kind(kind), 4);
        const molecule_problem p = molecule_problem_of(&m);
        molecule_solution s;
        assert_int_equal(molecule_velocities(&p, &s), 0);
        for (int64_t k = 0; k < m.n_bonds; ++k) {
            const int64_t i = m.pairs[2 * k], j = m.pairs[2 * k + 1];
            long double sum = 0, size = 0;
            for (int x = 0; x < 3; ++x) {
                const long double d = component(m.r, j, x) - component(m.r, i, x);
                sum += d * (s.moved[3 * j + x] - s.moved[3 * i + x]);
                size += fabsl(d) * (s.moved_scale[i] + s.moved_scale[j]);
            }
            assert_close(sum, 0, 32 * rounding() * size);
        }
        molecule_solution_free(&s);
        molecule_free(&m);
    }
}

static void positions_have_their_lengths_and_move_along_the_old_bonds(void **state)
{
    (void)state;
    const double dt = 1e-3;
    for (int kind = 0; kind < MOLECULE_GOOD_KINDS; ++kind) {
        if (kind == MOLECULE_LIGHT_JOINTS || kind == MOLECULE_LARIAT || kind == MOLECULE_TAUT) continue; /* too far */
        if (kind == MOLECULE_COLLAPSED_RING || kind == MOLECULE_BENT || kind == MOLECULE_TRIANGLES_179) continue;
        molecule m = molecule_make((molecule_kind)kind, size_of_kind(kind), 5);
        const molecule_problem p = molecule_problem_of(&m);
        double *drifted = molecule_drifted(&m, dt);
        molecule_solution s;
        assert_int_equal(molecule_positions(&p, drifted, NULL, m.length, dt, &s), 0);
        for (int64_t k = 0; k < m.n_bonds; ++k) {
            const int64_t i = m.pairs[2 * k], j = m.pairs[2 * k + 1];
            long double square = 0;
            if (m.inverse_mass[i] == 0 && m.inverse_mass[j] == 0) continue;
            for (int x = 0; x < 3; ++x) {
                const long double d = s.moved[3 * j + x] - s.moved[3 * i + x];
                square += d * d;
            }
            assert_close(sqrtl(square), m.length[k], 16 * rounding() * (s.moved_scale[i] + s.moved_scale[j]));
        }
        for (int64_t i = 0; i < 3 * m.n_atoms; ++i) {
            const long double expected = drifted[i] + (long double)dt * dt * m.inverse_mass[i / 3] * s.g[i];
            assert_close(s.moved[i], expected, 16 * rounding() * s.moved_scale[i / 3]);
        }
        free(drifted);
        molecule_solution_free(&s);
        molecule_free(&m);
    }
}

static void fixman_forces_are_differences_of_the_determinant(void **state)
{
    (void)state;
    const double step = 0x1p-14;
    for (int kind = 0; kind < MOLECULE_GOOD_KINDS; ++kind) {
        molecule m =
            molecule_make((molecule_kind)kind, kind == MOLECULE_PEPTIDE || kind == MOLECULE_DENDRIMER ? 1 : 4, 6);
        const molecule_problem p = molecule_problem_of(&m);
        molecule_metric at, side;
        assert_int_equal(molecule_metric_make(&p, &at), 0);
        /* what is nearly singular, or planar to 0.02, changes within the step */
        if (at.condition < 1e3)
            for (int64_t i = 0; i < 3 * m.n_atoms; i += 7) {
                long double log_det[4];
                const double here = m.r[i];
                for (int n = 0; n < 4; ++n) {
                    m.r[i] = here + (n < 2 ? n - 2 : n - 1) * step;
                    assert_int_equal(molecule_metric_make(&p, &side), 0);
                    log_det[n] = side.log_det;
                    molecule_metric_free(&side);
                }
                m.r[i] = here;
                const long double slope = (8 * (log_det[2] - log_det[1]) - log_det[3] + log_det[0]) / (12 * step);
                assert_close(at.fixman_force[i], -slope / 2, 1e-6L * (1 + at.fixman_scale[i / 3]));
            }
        molecule_metric_free(&at);
        molecule_free(&m);
    }
}

static void inverse_times_matrix_is_one(void **state)
{
    (void)state;
    for (int kind = 0; kind < MOLECULE_GOOD_KINDS; ++kind) {
        molecule m = molecule_make((molecule_kind)kind, size_of_kind(kind), 7);
        const molecule_problem p = molecule_problem_of(&m);
        molecule_metric metric;
        assert_int_equal(molecule_metric_make(&p, &metric), 0);
        double *rhs = calloc((size_t)m.n_bonds, sizeof *rhs);
        for (int64_t l = 0; l < m.n_bonds; l += 5) { /* Z lambda = e_l gives Z^-1_kl = Z~^-1_kl / sqrt(Z_kk Z_ll) */
            molecule_solution s;
            long double z[2];
            rhs[l] = 1;
            assert_int_equal(molecule_solve(&p, rhs, &s), 0);
            rhs[l] = 0;
            for (int64_t k = 0; k < m.n_bonds; ++k) {
                for (int n = 0; n < 2; ++n) {
                    const int64_t *pair = m.pairs + 2 * (n ? l : k);
                    long double q = 0;
                    for (int x = 0; x < 3; ++x) q += powl(component(m.r, pair[1], x) - component(m.r, pair[0], x), 2);
                    z[n] = 4 * q * ((long double)m.inverse_mass[pair[0]] + m.inverse_mass[pair[1]]);
                }
                if (z[0] == 0 || z[1] == 0) continue;
                const long double expected = metric.inverse[k * m.n_bonds + l] / sqrtl(z[0] * z[1]);
                assert_close(s.lambda[k], expected, 16 * rounding() * fabsl(expected));
            }
            molecule_solution_free(&s);
        }
        free(rhs);
        molecule_metric_free(&metric);
        molecule_free(&m);
    }
}

static void chains_agree_with_the_solution_for_chains(void **state)
{
    (void)state;
    enum { N = 12 };
    for (int kind = 0; kind < CHAIN_KINDS; ++kind) {
        chain c = chain_make((chain_kind)kind, N, 8);
        int64_t pairs[2 * N];
        double w[N + 1];
        for (int k = 0; k < 2 * N; ++k) pairs[k] = (k + 1) / 2;
        for (int i = 0; i <= N; ++i) w[i] = c.mass[i] > 0 ? 1 / c.mass[i] : 0;
        const molecule_problem p = {N + 1, N, pairs, w, c.r, c.v, c.f, NULL};
        const solution_problem q = {N, NULL, w, c.r, c.v, c.f, NULL};
        molecule_solution s;
        solution t;
        assert_int_equal(molecule_forces(&p, &s), 0);
        assert_int_equal(solution_forces(&q, &t), 0);
        /* the latter has 113 bits, of which it loses up to 1e15 */
        for (int k = 0; k < N; ++k)
            assert_close(s.lambda[k], t.lambda[k], 1e-17L * s.lambda_scale[k] + rounding() * fabsl(t.lambda[k]));
        for (int i = 0; i < 9; ++i) assert_close(s.virial[i], t.virial[i], (1e-17L + 4 * rounding()) * s.virial_scale);
        molecule_solution_free(&s);
        solution_free(&t);
        chain_free(&c);
    }
}

static void check_file(const molecule_file *c)
{
    const molecule_problem p = {c->n_atoms, c->n_bonds, c->pairs, c->w, c->r, c->v, c->f, NULL};
    const long double unit = 4 * rounding();
    molecule_metric m;
    molecule_solution s, v, q;
    if (c->degenerate) {
        assert_int_equal(molecule_forces(&p, &s), -1);
        assert_int_equal(molecule_metric_make(&p, &m), -1);
        return;
    }
    assert_int_equal(molecule_metric_make(&p, &m), 0);
    assert_int_equal(molecule_forces(&p, &s), 0);
    assert_int_equal(molecule_velocities(&p, &v), 0);
    assert_close(m.log_det, c->lndet, unit * fabsl(c->lndet));
    assert_close(m.log_det_z, c->lndetz, unit * m.log_det_z_scale);
    for (int64_t k = 0; k < c->n_bonds; ++k) {
        assert_close(s.lambda[k], c->lambda[k], unit * c->lambda_scale[k]);
        assert_close(v.lambda[k], c->mu[k], unit * c->mu_scale[k]);
        assert_close(s.lambda_scale[k], c->lambda_scale[k], 1e-5L * c->lambda_scale[k]);
    }
    for (int64_t i = 0; i < 3 * c->n_atoms; ++i) {
        assert_close(s.g[i], c->g[i], unit * c->g_scale[i / 3]);
        assert_close(m.fixman_force[i], c->fixman_force[i], unit * c->fixman_scale[i / 3]);
        assert_close(v.moved[i], c->velocity[i], unit * c->v_scale[i / 3]);
    }
    if (c->has_positions) {
        assert_int_equal(molecule_positions(&p, c->drifted, NULL, c->length, c->dt, &q), 0);
        for (int64_t i = 0; i < 3 * c->n_atoms; ++i) assert_close(q.moved[i], c->position[i], unit * c->r_scale[i / 3]);
        molecule_solution_free(&q);
    }
    molecule_metric_free(&m);
    molecule_solution_free(&s);
    molecule_solution_free(&v);
}

static void reference_files_agree(void **state)
{
    (void)state;
    char line[256], path[1024], message[1400];
    int count = 0;
    FILE *index = fopen(MOLECULES_DIR "/INDEX", "r");
    assert_non_null(index);
    while (fgets(line, sizeof line, index)) {
        molecule_file c;
        line[strcspn(line, "\r\n")] = 0;
        snprintf(path, sizeof path, MOLECULES_DIR "/%s", line);
        assert_true(is_molecule_file(path));
        if (molecule_file_read(path, &c, message, sizeof message)) fail_msg("%s", message);
        print_message("%s\n", c.name);
        check_file(&c);
        molecule_file_free(&c);
        ++count;
    }
    fclose(index);
    assert_true(count >= 12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(accelerations_obey_the_constraints),
        cmocka_unit_test(velocities_obey_the_constraints),
        cmocka_unit_test(positions_have_their_lengths_and_move_along_the_old_bonds),
        cmocka_unit_test(fixman_forces_are_differences_of_the_determinant),
        cmocka_unit_test(inverse_times_matrix_is_one),
        cmocka_unit_test(chains_agree_with_the_solution_for_chains),
        cmocka_unit_test(reference_files_agree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
