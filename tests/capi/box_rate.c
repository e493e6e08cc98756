#include "box_rate.h"

#include <math.h>

const double L[9] = {0.11, -0.7, 0.2, 0.35, -0.4, 0.05, -0.15, 0.6, 0.23};

void rate_times(const double *rate, const long double *x, long double *y)
{
    for (int a = 0; a < 3; ++a) y[a] = rate[3 * a] * x[0] + rate[3 * a + 1] * x[1] + rate[3 * a + 2] * x[2];
}

long double rate_of_bond(const double *r, const double *v, int64_t i, int64_t j, const double *box, long double *size)
{
    long double d[3], Ld[3], rate = 0;
    *size = 0;
    for (int x = 0; x < 3; ++x) {
        d[x] = (long double)r[3 * j + x] - r[3 * i + x];
        if (box) d[x] -= box[4 * x] * roundl(d[x] / box[4 * x]);
    }
    rate_times(L, d, Ld);
    for (int x = 0; x < 3; ++x) {
        rate += d[x] * (((long double)v[3 * j + x] - v[3 * i + x]) + Ld[x]);
        *size +=
            fabsl(d[x]) * (fabs(v[3 * j + x]) + fabs(v[3 * i + x]) + 2 * (fabsl(d[0]) + fabsl(d[1]) + fabsl(d[2])));
    }
    return rate;
}
