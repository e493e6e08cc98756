/**
 * A host with threads of its own, of OpenMP as the library's: those that a call has started have the environment of the
 * caller, as if the host had started them, and calls leave each thread's as it is.
 */
#define _GNU_SOURCE
#include <fenv.h>

#include "check.h"
#include "molecule.h"

#ifdef _OPENMP
#include <omp.h>
#endif

#if defined(__GLIBC__) && (defined(__x86_64__) || defined(__i386__))
static const int traps = FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW;
#else
static const int traps = 0;
#define feenableexcept(what) (void)(what)
#define fegetexcept() 0
#endif

enum { THREADS = 2, WATERS = 6000 };

static hol_chains *waters(double *lambda)
{
    const molecule m = molecule_make(MOLECULE_WATER, 1, 1);
    double *mass = untouched(3 * WATERS), *r = untouched(9 * WATERS), *f = untouched(9 * WATERS);
    for (int i = 0; i < WATERS; ++i) {
        memcpy(mass + 3 * i, m.mass, 3 * sizeof *mass);
        memcpy(r + 9 * i, m.r, 9 * sizeof *r), memcpy(f + 9 * i, m.f, 9 * sizeof *f);
    }
    hol_chains *h;
    CHECK(hol_chains_create(3 * WATERS, mass, &h));
    CHECK(hol_chains_add_molecules(h, WATERS, 3, 0, 3, m.pairs, m.length));
    CHECK(hol_chains_set_threads(h, THREADS));
    CHECK(hol_forces(h, r, NULL, f, lambda, NULL, NULL, HOL_WRITE, NULL));
    free(mass), free(r), free(f);
    molecule tidy = m;
    molecule_free(&tidy);
    return h;
}

/** The first test, before anything else has started threads. */
static void threads_of_a_call_inherit_from_the_caller(void **state)
{
    (void)state;
#if !defined(_OPENMP) || defined(_WIN32) /* where threads begin with the default one, whatever starts them */
    skip();
#else
    double *lambda = untouched(3 * WATERS);
    int trapped[THREADS] = {0}, rounding[THREADS] = {0}, n = 0;
    fesetround(FE_UPWARD);
    feenableexcept(traps);
    hol_chains *h = waters(lambda);
#pragma omp parallel num_threads(THREADS)
    {
        const int t = omp_get_thread_num();
        trapped[t] = fegetexcept(), rounding[t] = fegetround();
#pragma omp atomic
        ++n;
    }
    fesetenv(FE_DFL_ENV);
    assert_int_equal(n, THREADS);
    for (int t = 0; t < THREADS; ++t) {
        assert_int_equal(trapped[t], traps);
        assert_int_equal(rounding[t], FE_UPWARD);
    }
    hol_chains_destroy(h);
    free(lambda);
#endif
}

static void each_thread_of_the_host_keeps_its_own(void **state)
{
    (void)state;
#ifndef _OPENMP
    skip();
#else
    double *lambda = untouched(3 * WATERS), *expected = untouched(3 * WATERS);
    hol_chains_destroy(waters(expected));
    int rounding[THREADS] = {0}, before[THREADS] = {0};
#pragma omp parallel num_threads(THREADS)
    {
        fesetround(omp_get_thread_num() == 0 ? FE_TONEAREST : FE_DOWNWARD);
        feclearexcept(FE_ALL_EXCEPT);
    }
    hol_chains *h = waters(lambda);
#pragma omp parallel num_threads(THREADS)
    {
        const int t = omp_get_thread_num();
        rounding[t] = fegetround(), before[t] = fetestexcept(FE_ALL_EXCEPT & ~FE_INEXACT);
        fesetenv(FE_DFL_ENV);
    }
    for (int t = 0; t < THREADS; ++t) {
        assert_int_equal(rounding[t], t == 0 ? FE_TONEAREST : FE_DOWNWARD);
        assert_int_equal(before[t], 0);
    }
    assert_same_bits(lambda, expected, 3 * WATERS);
    hol_chains_destroy(h);
    free(lambda), free(expected);
#endif
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(threads_of_a_call_inherit_from_the_caller),
        cmocka_unit_test(each_thread_of_the_host_keeps_its_own),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
