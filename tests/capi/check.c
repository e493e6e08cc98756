#include "check.h"

static const uint64_t pattern = UINT64_C(0x7ff4dead0000beef); /* a NaN with marks, to show whatever reads it */

double *untouched(size_t n)
{
    double *a = malloc(sizeof *a * (n + 1));
    if (!a) abort();
    for (size_t i = 0; i <= n; ++i) memcpy(a + i, &pattern, sizeof pattern);
    return a;
}

void assert_untouched(const double *a, size_t n)
{
    for (size_t i = 0; i < n; ++i)
        if (memcmp(a + i, &pattern, sizeof pattern) != 0) fail_msg("element %zu was written: %g", i, a[i]);
}

void assert_same_bits(const double *a, const double *b, size_t n)
{
    for (size_t i = 0; i < n; ++i)
        if (memcmp(a + i, b + i, sizeof *a) != 0) fail_msg("element %zu: %.17g and %.17g", i, a[i], b[i]);
}

double *copy_of(const double *a, size_t n)
{
    double *b = malloc(sizeof *b * (n + 1));
    if (!b) abort();
    memcpy(b, a, sizeof *b * n);
    return b;
}

void assert_message_names(const char *words)
{
    if (!strstr(hol_error_message(), words)) fail_msg("'%s' does not name '%s'", hol_error_message(), words);
}

long double long_double_rounding(void)
{
    volatile long double eps = 1, sum = 2;
    while (sum != 1) {
        eps /= 2;
        sum = 1 + eps;
    }
    return 2 * eps;
}

int quick_run(void)
{
    const char *value = getenv("HOLONOMIC_TESTS_QUICK");
    return value && value[0] && strcmp(value, "0") != 0;
}

long double oracle_bound(int64_t n_bonds)
{
    return 16 + sqrtl((long double)n_bonds);
}
