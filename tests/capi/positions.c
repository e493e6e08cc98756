#include "positions.h"

#include "check.h"

double *drift(assembly *a, double dt, int consistent)
{
    if (consistent) CHECK(hol_project_velocities(a->chains, a->r, a->v, NULL, NULL));
    double *r = copy_of(a->r, assembly_size(a));
    for (size_t i = 0; i < assembly_size(a); ++i) r[i] += dt * a->v[i];
    return r;
}

long double rounding_of_a_bond(long double extent, long double a)
{
    return DBL_EPSILON * (2 * sqrtl(3) * extent / a + 8);
}

assembly short_or_long(chain_kind kind, int is_long, arrangement how, uint64_t seed)
{
    return is_long ? assembly_of_kind(kind, 3, 4000, 9000, how, seed) : assembly_of_kind(kind, 40, 1, 60, how, seed);
}
