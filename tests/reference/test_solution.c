/** The independent solutions reproduce the reference files: so both are what they claim to be. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

/* which needs the four above */
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "oracle_file.h"
#include "solution.h"

/* References are printed with 25 digits, read with 64 bits. The solutions lose up to 1e15, the largest condition number
   among the files, from 113 bits: 1e-34 * 1e15 * a few. */
static const long double close_enough = 1e-17L;
/* Scales are printed with six digits. */
static const long double six_digits = 6e-6L;

static void assert_close(long double value, long double reference, long double scale, long double tolerance)
{
    if (!(fabsl(value - reference) <= tolerance * scale)) {
        print_error("%.21Lg instead of %.21Lg\n", value, reference);
        fail();
    }
}

static void check_linear(const oracle_case *c, const solution_problem *p)
{
    solution s;
    assert_int_equal(solution_forces(p, &s), 0);
    for (int64_t k = 0; k < c->n_bonds; ++k) {
        assert_close(s.lambda[k], c->lambda[k], s.lambda_scale[k], close_enough);
        assert_close(s.lambda_scale[k], c->lambda_scale[k], c->lambda_scale[k], six_digits);
    }
    for (int64_t i = 0; i <= c->n_bonds; ++i) {
        for (int x = 0; x < 3; ++x) assert_close(s.g[3 * i + x], c->g[3 * i + x], s.g_scale[i], close_enough);
        assert_close(s.g_scale[i], c->g_scale[i], c->g_scale[i], six_digits);
    }
    for (int i = 0; i < 9; ++i) assert_close(s.virial[i], c->virial[i], s.virial_scale, close_enough);
    solution_free(&s);
}

static void check_metric(const oracle_case *c, const solution_problem *p)
{
    solution_metric m;
    assert_int_equal(solution_metric_make(p, &m), 0);
    assert_close(m.log_det, c->lndet, fabsl(c->lndet), close_enough);
    assert_close(m.condition, c->condition, m.condition, six_digits);
    for (int64_t i = 0; i <= c->n_bonds; ++i) {
        for (int x = 0; x < 3; ++x)
            assert_close(m.fixman_force[3 * i + x], c->fixman_force[3 * i + x], m.fixman_scale[i], close_enough);
        assert_close(m.fixman_scale[i], c->fixman_scale[i], c->fixman_scale[i], six_digits);
    }
    solution_metric_free(&m);
    long double *column = malloc(sizeof *column * (size_t)c->n_bonds);
    for (int64_t e = 0; e < c->n_zinv; ++e) {
        assert_int_equal(solution_inverse_column(p, c->zinv[e].j - 1, column), 0);
        const long double value = column[c->zinv[e].i - 1];
        assert_close(value, c->zinv[e].value, fabsl(c->zinv[e].value), close_enough);
    }
    free(column);
}

static void check_file(const char *name)
{
    char path[1024], message[1400];
    oracle_case c;
    snprintf(path, sizeof path, "%s/%s", ORACLE_DIR, name);
    if (oracle_read(path, &c, message, sizeof message)) fail_msg("%s", message);
    const solution_problem p = {c.n_bonds, NULL, c.w, c.r, c.v, c.f, NULL};
    print_message("%s\n", name);
    check_linear(&c, &p);
    check_metric(&c, &p);
    oracle_free(&c);
}

static void independent_solutions_reproduce_every_reference_file(void **state)
{
    (void)state;
    char line[256];
    int count = 0;
    FILE *index = fopen(ORACLE_DIR "/INDEX", "r");
    assert_non_null(index);
    while (fgets(line, sizeof line, index)) {
        line[strcspn(line, "\r\n")] = 0;
        if (!line[0]) continue;
        check_file(line);
        ++count;
    }
    fclose(index);
    assert_int_equal(count, 26);
}

static void positions_solution_puts_bonds_on_their_lengths_and_forces_along_the_old_bonds(void **state)
{
    (void)state;
    const double mass[3] = {1, 2, 3}, r[9] = {0, 0, 0, 1, 0, 0, 1, 1, 0}, length[2] = {1, 1}, dt = 0.5;
    const double drifted[9] = {0.1, 0, 0, 1, 0.05, 0.1, 0.9, 1, 0};
    const solution_problem p = {2, mass, NULL, r, NULL, NULL, NULL};
    solution s;
    long double q[9];
    assert_true(solution_positions(&p, drifted, length, dt, q, &s) > 0);
    for (int k = 0; k < 2; ++k) {
        long double square = 0;
        for (int x = 0; x < 3; ++x) square += (q[3 * k + 3 + x] - q[3 * k + x]) * (q[3 * k + 3 + x] - q[3 * k + x]);
        assert_close(square, 1, 1, 8 * 1.1e-19L); /* the positions are returned with 64 bits */
    }
    for (int i = 0; i < 3; ++i)
        for (int x = 0; x < 3; ++x) {
            long double g = 0;
            if (i < 2) g += 2 * s.lambda[i] * (r[3 * i + 3 + x] - r[3 * i + x]);
            if (i > 0) g -= 2 * s.lambda[i - 1] * (r[3 * i + x] - r[3 * i - 3 + x]);
            assert_close(q[3 * i + x], drifted[3 * i + x] + dt * dt / mass[i] * g, 1, 8 * 1.1e-19L);
        }
    solution_free(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(independent_solutions_reproduce_every_reference_file),
        cmocka_unit_test(positions_solution_puts_bonds_on_their_lengths_and_forces_along_the_old_bonds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
