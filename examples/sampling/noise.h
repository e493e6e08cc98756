/** Random numbers: the same sequence for the same seed on every machine. */
#ifndef SAMPLING_NOISE_H
#define SAMPLING_NOISE_H

#include <math.h>
#include <stdint.h>

typedef struct noise {
    uint64_t state;
    double spare; /* the second number of a pair of normal ones */
    int has_spare;
} noise;

static inline noise noise_start(uint64_t seed)
{
    const noise n = {seed * 0x9e3779b97f4a7c15u + 1, 0, 0};
    return n;
}

/** Uniform in (0, 1): splitmix64 (Steele, Lea and Flood 2014). */
static inline double noise_uniform(noise *n)
{
    uint64_t z = n->state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return ((double)((z ^ (z >> 31)) >> 11) + 0.5) * 0x1p-53;
}

/** Normal with mean 0 and variance 1, by Marsaglia's polar method. */
static inline double noise_normal(noise *n)
{
    if (n->has_spare) {
        n->has_spare = 0;
        return n->spare;
    }
    double x, y, s;
    do {
        x = 2 * noise_uniform(n) - 1;
        y = 2 * noise_uniform(n) - 1;
        s = x * x + y * y;
    } while (s >= 1 || s == 0);
    const double factor = sqrt(-2 * log(s) / s);
    n->spare = y * factor;
    n->has_spare = 1;
    return x * factor;
}

/** A direction, uniform on the sphere. */
static inline void noise_direction(noise *n, double *u)
{
    const double z = 2 * noise_uniform(n) - 1, angle = 6.283185307179586 * noise_uniform(n), s = sqrt(1 - z * z);
    u[0] = s * cos(angle);
    u[1] = s * sin(angle);
    u[2] = z;
}

#endif
