// Computes products of nearly orthogonal bonds anew from the coordinates.
#ifndef HOLONOMIC_KERNELS_ELIMINATE_EXACT_JOINTS_HPP
#define HOLONOMIC_KERNELS_ELIMINATE_EXACT_JOINTS_HPP

#include "core/kernels/arithmetic/image.hpp"
#include "core/kernels/memory/block.hpp"

namespace holonomic::HOL_ISA {

// Where the coordinates of a block are: in lanes, or anywhere in the array `base`.
struct Source {
    const Packed *r;
    const double *base;
    const int64_t *const *atoms;
    const Box *box;
    const long *len;              // of lanes that may end before the joints that are asked for; or nullptr
    const Lane *lanes = nullptr;  // of at most three bonds each, anywhere in the array `base`
    const double *atom(int lane, long k) const {
        if (lanes) return base + lanes[lane].element[k];
        return atoms ? base + 3 * atoms[lane][k] : r->lane[lane] + 3 * k;
    }
};

// g = d . d' of nearly orthogonal bonds cancels. The loss shows if the right-hand sides of the two bonds differ by
// orders of magnitude. Below this cosine g is computed anew from the coordinates: at a few in a hundred joints of a
// coil.
constexpr double small_cosine = 1.0 / 32;

// The sign bit is set if |cos| is below that; X = q q' (1 - cos^2).
HOL_INLINE vec not_orthogonal(vec g2, vec X, double cosine = small_cosine) {
    return mul_sub(splat(1 / (cosine * cosine)), g2, X);
}

HOL_INLINE mask nearly_orthogonal(vec g, vec X, double cosine = small_cosine) {
    return less(not_orthogonal(g * g, X, cosine), vec{});
}

// g of joint k in one lane, with compensated products of unrounded differences.
#if HOL_LANES != 4
HOL_NOINLINE double exact_dot(const Source &source, int lane, long k) {
    Vector3<double> d[2], low[2];
    for (int b = 0; b < 2; ++b)
        unrounded_bond(*source.box, source.atom(lane, k - 1 + b), source.atom(lane, k + b), d[b], low[b]);
    const Pair<double> x = two_product(d[0].x, d[1].x), y = two_product(d[0].y, d[1].y),
                       z = two_product(d[0].z, d[1].z);
    const double hi[3] = {x.hi, y.hi, z.hi};
    const double lo[3] = {mul_add(d[0].x, low[1].x, mul_add(low[0].x, d[1].x, x.lo)),
                          mul_add(d[0].y, low[1].y, mul_add(low[0].y, d[1].y, y.lo)),
                          mul_add(d[0].z, low[1].z, mul_add(low[0].z, d[1].z, z.lo))};
    return sum_compensated(hi, lo);
}

#else
HOL_INLINE double exact_dot(const Box &box, const double *p0, const double *p1, const double *p2) {
    const vec r0 = {p0[0], p0[1], p0[2], 0}, r1 = {p1[0], p1[1], p1[2], 0}, r2 = {p2[0], p2[1], p2[2], 0};
    const Pair<vec> a = unrounded_bond(box, r0, r1), b = unrounded_bond(box, r1, r2), hi = two_product<vec>(a.hi, b.hi);
    return sum_compensated(hi.hi, mul_add(a.hi, b.lo, mul_add(a.lo, b.hi, hi.lo)));
}
#endif

// The lanes in `which` of g, for joint k.
HOL_NOINLINE vec exact_dots(const Source &source, long k, mask which, vec g) {
    for (unsigned left = bits(which); left; left &= left - 1) {
        const int i = __builtin_ctz(left);
        if (source.len && k >= source.len[i]) continue;
#if HOL_LANES == 4
        g[i] = exact_dot(*source.box, source.atom(i, k - 1), source.atom(i, k), source.atom(i, k + 1));
#else
        g[i] = exact_dot(source, i, k);
#endif
    }
    return g;
}

}  // namespace holonomic::HOL_ISA
#endif
