/**
 * Callers that let the processor trap divisions by zero, invalid operations and overflows (-ffpe-trap in Fortran) must
 * be able to call the library with good data of any kind.
 */
#define _GNU_SOURCE
#include <fenv.h>

#include "assembly.h"
#include "check.h"

#if defined(__GLIBC__) && (defined(__x86_64__) || defined(__i386__))
#define TRAPS 1
static void trap(int on)
{
    const int what = FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW;
    feclearexcept(FE_ALL_EXCEPT);
    if (on)
        feenableexcept(what);
    else
        fedisableexcept(what);
}
#else
#define TRAPS 0
static void trap(int on)
{
    (void)on;
}
#endif

static void metric_and_inverse_raise_no_trap(void **state)
{
    (void)state;
    if (!TRAPS) skip();
    for (int kind = 0; kind < CHAIN_KINDS; ++kind)
        for (int64_t longest = 3; longest <= 1200; longest *= 20) {
            if (quick_run() && longest > 100) continue;
            assembly a = assembly_of_kind((chain_kind)kind, 11, 2, longest, IN_ORDER, 3);
            double *log_det = untouched(22), *force = untouched(assembly_size(&a)), energy, value;
            trap(1);
            const int status = hol_metric(a.chains, a.r, 1, log_det, log_det + 11, &energy, force, HOL_WRITE);
            hol_inverse *inverse;
            const int made = hol_inverse_create(a.chains, 10, a.r, &inverse);
            const int asked = hol_inverse_condition(inverse, &value);
            const int bounded = hol_inverse_error_bound(inverse, a.v, a.f, force, NULL, &value);
            trap(0);
            assert_int_equal(status, HOL_OK);
            assert_int_equal(made, HOL_OK);
            assert_int_equal(asked, HOL_OK);
            assert_int_equal(bounded, HOL_OK);
            hol_inverse_destroy(inverse);
            free(log_det), free(force), assembly_free(&a);
        }
}

static void partition_functions_and_the_tridiagonal_algebra_raise_no_trap(void **state)
{
    (void)state;
    if (!TRAPS) skip();
    const double masses[] = {0, 1, 1e6, 1e-9, 0, 2, INFINITY, 3, 1}, gamma[] = {0.5, -0.9, 1e300};
    double he, rigid, volume, x[4];
    trap(1);
    const int status = hol_partition_function(8, masses, &he, &rigid, &volume);
    const int short_one = hol_partition_function(2, masses + 4, &he, &rigid, &volume);
    const int refused = hol_tridiagonal_pivots(4, gamma, x);
    const int solved = hol_tridiagonal_solve(2, gamma, masses, x);
    trap(0);
    assert_int_equal(status, HOL_OK);
    assert_int_equal(short_one, HOL_OK);
    assert_int_equal(refused, HOL_ERR_NOT_DEFINITE);
    assert_int_equal(solved, HOL_OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(metric_and_inverse_raise_no_trap),
        cmocka_unit_test(partition_functions_and_the_tridiagonal_algebra_raise_no_trap),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
