/**
 * Mean of a correlated series with its statistical error by block averaging (Flyvbjerg and Petersen 1989): neighbours
 * are averaged in pairs again and again; the error of the mean grows until the blocks are longer than the correlation.
 */
#ifndef SAMPLING_BLOCK_AVERAGE_H
#define SAMPLING_BLOCK_AVERAGE_H

#include <math.h>
#include <stdlib.h>

typedef struct estimate {
    double mean, error;
} estimate;

/** series [n] is overwritten. The largest error over all levels that leave 32 blocks or more: cautious. */
static inline estimate block_average(double *series, long n)
{
    estimate e = {0, 0};
    for (long i = 0; i < n; ++i) e.mean += series[i] / (double)n;
    for (; n >= 32; n /= 2) {
        double variance = 0, mean = 0;
        for (long i = 0; i < n; ++i) mean += series[i] / (double)n;
        for (long i = 0; i < n; ++i) variance += (series[i] - mean) * (series[i] - mean);
        const double error = sqrt(variance / ((double)n * (double)(n - 1)));
        if (error > e.error) e.error = error;
        for (long i = 0; i < n / 2; ++i) series[i] = (series[2 * i] + series[2 * i + 1]) / 2;
    }
    return e;
}

#endif
