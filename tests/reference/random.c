#include "random.h"

#include <math.h>

random_stream random_seed(uint64_t seed)
{
    random_stream s = {seed * UINT64_C(0x9e3779b97f4a7c15) + UINT64_C(0x1234567)};
    random_bits(&s);
    return s;
}

uint64_t random_bits(random_stream *s)
{
    s->state += UINT64_C(0x9e3779b97f4a7c15);
    uint64_t z = s->state;
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

double random_uniform(random_stream *s)
{
    return ((double)(random_bits(s) >> 12) + 0.5) * 0x1p-52;
}

int64_t random_integer(random_stream *s, int64_t low, int64_t high)
{
    return low + (int64_t)(random_bits(s) % (uint64_t)(high - low + 1));
}

double random_normal(random_stream *s)
{
    /* polar method: only sqrt and log, and log is the one function whose last bit may depend on the C library */
    for (;;) {
        const double x = 2 * random_uniform(s) - 1, y = 2 * random_uniform(s) - 1, q = x * x + y * y;
        if (q > 0 && q < 1) return x * sqrt(-2 * log(q) / q);
    }
}

void random_direction(random_stream *s, double u[3])
{
    double q;
    do {
        q = 0;
        for (int x = 0; x < 3; ++x) {
            u[x] = 2 * random_uniform(s) - 1;
            q += u[x] * u[x];
        }
    } while (q > 1 || q < 1e-4);
    q = sqrt(q);
    for (int x = 0; x < 3; ++x) u[x] /= q;
}
