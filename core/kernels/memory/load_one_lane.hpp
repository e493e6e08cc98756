// Bond vectors and right-hand sides of a chain that comes alone, in sets of one lane: four bonds at a time. Each
// function returns how many bonds it has done; in other sets none.
#pragma once

#include "core/kernels/memory/fours.hpp"
#include "core/kernels/memory/load.hpp"

namespace holonomic::HOL_ISA {

#if HOL_FOURS
// Differences of a vector per atom, of the twelve components of four bonds.
HOL_INLINE four difference(const double *x) { return load_any<four>(x + 3) - load_any<four>(x); }

// What load_chunks() of load.cpp does.
template <int terms, bool uniform, bool boxed>
HOL_INLINE long load_in_fours(const Reader &in, const double *r, const double *v, const double *f, long k0, long end,
                              vec3 *D, vec *B) {
    const long first = k0;
    for (; k0 + 4 <= end; k0 += 4, D += 4) {
        four p[3];
        HOL_UNROLL
        for (int j = 0; j < 3; ++j) {
            const long at = 3 * k0 + 4 * j;
            four e = difference(r + at), dv = {}, df = {}, vv = {};
            if (boxed)
                e = mul_add(round(e * load_any<four>(in.box.per_side + j)), load_any<four>(in.box.minus_side + j), e);
            if (terms & (velocity_squared | rate)) dv = difference(v + at);
            if (terms & velocity_squared) vv = square(terms, four{} + in.block.mass.element, dv);
            if (terms & force_difference) {
                const double *const w = uniform ? nullptr : in.block.w3[0] + at;
                df = uniform ? difference(f + at)
                             : load_any<four>(w + 3) * load_any<four>(f + at + 3) -
                                   load_any<four>(w) * load_any<four>(f + at);
            }
            if (terms & products) p[j] = product(terms, e, dv, df, vv);
            store_any(&D->x.element + 4 * j, e);
        }
        if (!(terms & products) && !(in.terms == none_ && B)) continue;
        four sum = {};
        if (terms & products) {
            const Vector3<four> part = as_vectors(p);
            sum = (part.x + part.y) + part.z;
        }
        store_any(&B->element, sum);
        B += 4;
    }
    return k0 - first;
}

// Differences of the vectors of n + 1 atoms.
HOL_INLINE long subtract_in_fours(const double *x, long n, vec3 *out) {
    long k = 0;
    for (; k + 4 <= n; k += 4) {
        HOL_UNROLL
        for (int j = 0; j < 3; ++j) store_any(&out[k].x.element + 4 * j, difference(x + 3 * k + 4 * j));
    }
    return k;
}

// Rates of n bonds, and the velocities of the atoms behind them.
HOL_INLINE long load_rates_in_fours(const double *v, long n, const vec3 *D, vec *B, vec3 *behind) {
    const long done = n / 4 * 4;
    for (long k = 0; k < done; k += 4) store_any(&B[k].element, rates_of_four(k, D, v));
    __builtin_memcpy(behind, v + 3, static_cast<unsigned long>(done) * sizeof(vec3));
    return done;
}
#else
template <int terms, bool uniform, bool boxed>
HOL_INLINE long load_in_fours(const Reader &, const double *, const double *, const double *, long, long, vec3 *,
                              vec *) {
    return 0;
}
HOL_INLINE long subtract_in_fours(const double *, long, vec3 *) { return 0; }
HOL_INLINE long load_rates_in_fours(const double *, long, const vec3 *, vec *, vec3 *) { return 0; }
#endif

}  // namespace holonomic::HOL_ISA
