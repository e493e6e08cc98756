/**
 * @file random.h
 * Reproducible random numbers for the tests: the same on every machine and in every run.
 */
#ifndef REFERENCE_RANDOM_H
#define REFERENCE_RANDOM_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** State of one stream; a stream starts with random_seed. */
typedef struct random_stream {
    uint64_t state;
} random_stream;

random_stream random_seed(uint64_t seed);

/** 64 random bits (the splitmix64 sequence). */
uint64_t random_bits(random_stream *stream);

/** Uniform in (0, 1). */
double random_uniform(random_stream *stream);

/** Uniform whole number in [low, high]. */
int64_t random_integer(random_stream *stream, int64_t low, int64_t high);

/** Normal with mean 0 and variance 1. */
double random_normal(random_stream *stream);

/** A direction, uniform on the unit sphere. */
void random_direction(random_stream *stream, double u[3]);

#ifdef __cplusplus
}
#endif
#endif
