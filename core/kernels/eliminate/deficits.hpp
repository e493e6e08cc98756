// Metric determinant and Fixman force of a block of chains, theory (24)-(31): elimination on unit bonds. It carries the
// deficits e and f, which the bonds on either side leave of a row, instead of the diagonal. So it subtracts nothing.
// Deficits are fractions, so that no bond waits for a quotient. Products are always compensated, because determinants
// and the inverse have no componentwise scale that would forgive their rounding.
#pragma once

#include "core/kernels/arithmetic/log_sum.hpp"
#include "core/kernels/eliminate/measure_one_lane.hpp"
#include "core/kernels/memory/arena.hpp"
#include "core/kernels/memory/block.hpp"
#include "core/kernels/memory/load.hpp"

namespace holonomic::HOL_ISA {

// Per bond k of a block; joint k lies between bonds k-1 and k.
struct Geometry {
    vec3 *u, *low;    // bond vector, then unit vector, then Fixman's phi; low words of the bond vector
    vec3 *normal;     // u_{k-1} x u_k, then h_k times it
    vec *cosine;      // of joint k: c
    vec *reciprocal;  // 1 / |d|
    vec *square;      // d.d over `scale` squared
    vec *scale;       // a power of two
    vec *p, *side;    // coupling of bonds k-1 and k, w |c|; what rows k-1 and k have beyond it, w (1 - |c|)
    vec *e, *t;       // e: numerators of the deficits from the left, with a place before the first; their denominators:
    vec *per_e;       // in the place of `low`
    vec *f, *per_f;   // of those from behind, where they are kept, until t is needed
    Geometry(long n, Arena &arena)  // with room for a whole group behind the last bond
        : u(vectors(n, arena)), low(vectors(n, arena)), normal(vectors(n, arena)), cosine(values(n, arena)),
          reciprocal(values(n, arena)), square(values(n, arena)), scale(values(n, arena)), p(values(n, arena)),
          side(values(n, arena)), e(values(n, arena) + 1), t(values(n, arena)), per_e(&low->x + 1), f(t),
          per_f(per_e + n) {}
    // What row k has beyond its neighbours.
    HOL_FORCED vec delta(long k) const { return side[k] + side[k + 1]; }
    static vec *values(long n, Arena &arena) { return arena.vecs(n + group); }
    static vec3 *vectors(long n, Arena &arena) { return reinterpret_cast<vec3 *>(arena.vecs(3 * (n + group))); }
};

// The reciprocal of the power of two just below a > 0.
HOL_INLINE vec reciprocal_scale(vec a) {
#if HOL_FOURS  // of one element, too, in the registers of vectors
    const __m128i exponent = _mm_and_si128(_mm_castpd_si128(_mm_set1_pd(a.element)), _mm_set1_epi64x(exponent_bits));
    return {_mm_cvtsd_f64(_mm_castsi128_pd(_mm_sub_epi64(_mm_set1_epi64x(2 * exponent_of_one), exponent)))};
#else
    return as_vec((mask{} + 2 * exponent_of_one) - (as_mask(a) & (mask{} + exponent_bits)));
#endif
}

// Bonds, the joints between them, and what couples these.
#if HOL_FOURS
template <bool uniform>
static inline void measure_joints(const Block &block, const Box &box, const Packed &r, const Geometry &x, bool turns) {
    turns ? measure_in_fours<uniform, true>(box, r.lane[0], block.w, block.n, x)
          : measure_in_fours<uniform, false>(box, r.lane[0], block.w, block.n, x);
}
#else
template <bool uniform>
static inline void measure_joints(const Block &block, const Box &box, const Packed &r, const Geometry &x, bool) {
    Reader(block, box, none_, r, r, r, true).load(0, block.n, x.u, x.low, nullptr);
    vec3 d0 = {}, low0 = {};
    vec r0 = {};
    for (long k = 0; k < block.n; ++k) {
        const vec s = reciprocal_scale(max(max(abs(x.u[k].x), abs(x.u[k].y)), abs(x.u[k].z)));
        const vec3 d = s * x.u[k], low = s * x.low[k];
        const vec q = square_of(d, low), r1 = splat(1.0) / sqrt(q);
        x.u[k] = r1 * d;
        x.square[k] = q;
        x.scale[k] = s;
        x.reciprocal[k] = r1 * s;
        if (k > 0) {
            const vec f = r0 * r1, w = w_at<uniform>(block, k);
            vec c = dot_compensated(d0, low0, d, low) * f;
            vec3 normal = f * cross_compensated(d0, low0, d, low);
            const vec size = abs(c);
            vec complement = select(less(size, splat(0.5)), 1.0 - size, dot(normal, normal) / (1.0 + size));
            if (k >= block.n_min) {
                const mask m = joint(block, k);
                c = keep(m, c);
                normal = {keep(m, normal.x), keep(m, normal.y), keep(m, normal.z)};
                complement = select(m, complement, splat(1.0));
            }
            x.cosine[k] = c;
            x.normal[k] = normal;
            x.p[k] = w * abs(c);
            x.side[k] = w * complement;
        }
        d0 = d;
        low0 = low;
        r0 = r1;
    }
}
#endif

template <bool uniform>
static inline void measure(const Block &block, const Box &box, const Packed &r, const Geometry &x, bool turns) {
    const long n = block.n;
    measure_joints<uniform>(block, box, r, x, turns);
    x.p[0] = x.p[n] = x.cosine[0] = x.cosine[n] = x.side[n + 1] = vec{};
    x.side[0] = w_at<uniform>(block, 0);
    x.side[n] = w_at<uniform>(block, n);
    x.normal[0] = x.normal[n] = vec3{};
}

HOL_INLINE mask between(long k, vec first, vec end) {
    const vec v = splat(static_cast<double>(k));
    return less_equal(first, v) & less(v, end);
}

struct MetricSums {
    vec log_det, log_det_z;
};

// The deficit that is left of a row, e = A / F. With coupling p to the next row, whose own is delta,
//     F' = m (p F + A) = m P F,   A' = delta F' + m p A
// for any power of two m: theory (26), (27) without a quotient. Where a chain has equal masses m is 1, else F' is in
// [1, 2), however unequal the masses are. A rounded number would add up along a rod, in which e is small and the same
// at each joint.
template <bool uniform>
struct Deficit {
    vec A, F = splat(1.0);

    // Returns m. If the pivot is 0, F is so from there on.
    HOL_FORCED vec pass(vec p, vec delta) {
        F = mul_add(p, F, A);
        const vec m = uniform ? splat(1.0) : reciprocal_scale(F);
        if (!uniform) F = m * F;
        A = mul_add(delta, F, (uniform ? p : m * p) * A);
        return m;
    }
    // Not by a power of two alone: along a rod A and F hardly change, and neither would what each joint rounds off.
    HOL_FORCED vec rescale() {
        const vec s = 0.6180339887498949 * reciprocal_scale(F);
        A = s * A;
        F = s * F;
        return s;
    }
};
constexpr long rescaled = LogSum<vec>::group;  // so often

// The logarithm of a product of factors P / M = 1 - p^2 / (P_before M), theory (28), from F: a group of factors is the
// quotient of F behind and before it, and what it removes from 1 is a sum of the same terms,
//     1 - f_{k+1} = (1 - f_k) + p_k^2 / (M_{k-1} M_k) f_{k-1},   f = F over the product of m M.
struct Removal {
    vec before = splat(1.0), behind = splat(1.0);  // F
    vec removed = {}, diagonals = splat(1.0);      // times their product
};

// What ln det Z has beside ln det Z~.
HOL_NOINLINE vec log_of_diagonals(const Block &block, const Geometry &x, vec first, vec end) {
    LogSumWide<vec> sum;
    for (long k = 0; k < block.n; ++k) {
        const mask counted = between(k, first, end);
        const vec M = block.uniform_w ? splat(2.0) : block.w[k] + block.w[k + 1];
        sum.multiply(select(counted, 4.0 * (block.unit * M) * x.square[k], splat(1.0)),
                     select(counted, x.scale[k], splat(1.0)));
    }
    return sum.total();
}

// Goes from left to right. Finds e of all bonds if `keep`, and the logarithms over the bonds first .. end-1 of each
// lane; all lanes have the first `whole`, and count them. Takes lanes with a pivot that is not positive out of `good`.
// beside(k) is called for all bonds, for what waits as long and for something else.
template <bool uniform, bool keep_deficits, class Beside>
static inline MetricSums eliminate_metric(const Block &block, const Geometry &x, vec first, vec end, long whole,
                                          const MetricCall &call, mask &good, const Beside &beside) {
    const bool logs = call.log_det || call.sum || call.log_det_z;
    LogSum<vec> det;
    vec size = {}, F_before = {}, passed_before = {};
    if (HOL_FOURS) x.e[-1] = x.per_e[-1] = splat(1.0);  // fours are read from there on
    const vec *const coupling = x.p, *const sides = x.side, *const reciprocal = x.reciprocal;
    vec *const e = x.e, *const per_e = x.per_e;
    Deficit<uniform> left = {x.delta(0)};
    for (long k = 0; k < block.n;) {
        Removal part = {left.F, left.F};
        for (const long stop = k + rescaled < block.n ? k + rescaled : block.n; k < stop; ++k) {
            const vec M = w_at<uniform>(block, k) + w_at<uniform>(block, k + 1), F = left.F;
            if (keep_deficits) {
                e[k] = left.A;
                per_e[k] = F;
            }
            size = size + reciprocal[k];
            const vec p = coupling[k], next_p = coupling[k + 1];
            const vec m = left.pass(next_p, sides[k + 1] + sides[k + 2]);
            Removal next = {part.before, left.F, mul_add(p * m * passed_before, F_before, part.removed * (M * m)),
                            part.diagonals * (M * m)};
            if (k >= whole) {
                const mask early = less(splat(static_cast<double>(k)), first), counted = between(k, first, end);
                next = {select(early, left.F, part.before), select(counted | early, left.F, part.behind),
                        select(counted, next.removed, part.removed), select(counted, next.diagonals, part.diagonals)};
            }
            part = next;
            F_before = F;
            passed_before = next_p * m;
            beside(k);
        }
        if (logs) {
            const vec per = splat(1.0) / (part.before * part.diagonals);
            det.add(part.behind * per, part.removed * per);
        }
        F_before = left.rescale() * F_before;
    }
    const vec headroom = splat(call.force.x ? call.kT * 0x1p300 : 0.0);  // no force overflows
    good = good & less(vec{}, left.F) & finite(size + headroom * size);
    return {det.sum, call.log_det_z ? det.sum + log_of_diagonals(block, x, first, end) : vec{}};
}

// From the joint's two sides: h_k = w_k (M^-1)_{k-1,k}, and h_k n_k in place of n_k. `right` belongs to bond k.
template <bool uniform>
HOL_INLINE void weigh_normal(const Block &block, const Geometry &x, long k, const Deficit<uniform> &right) {
    vec p = x.p[k], A = x.e[k - 1], B = right.A, w = w_at<uniform>(block, k);
    const mask coupled = less(vec{}, p);
    if (!uniform) {  // their products stay in range
        const vec s = reciprocal_scale(max(max(A, B), w));
        p = s * p;
        A = s * A;
        B = s * B;
        w = s * w;
    }
    const vec pF = p * x.per_e[k - 1], pG = p * right.F, whole = mul_add(pG, A, mul_add(pF, B, A * B));
    // The caller may trap divisions by zero.
    const vec size = w * (pF * right.F) / select(coupled, whole, splat(1.0));
    const mask sign = mask{} + (-0x7fffffffffffffffLL - 1);
    const vec h = as_vec(as_mask(size) | (as_mask(x.cosine[k]) & sign));
    x.normal[k] = keep(coupled, h) * x.normal[k];
}

// From bond k to bond k - 1, from behind.
template <bool uniform>
HOL_INLINE void pass_back(const Block &block, const Geometry &x, long k, Deficit<uniform> &right) {
    right.pass(x.p[k], x.delta(k - 1));
    if (k % rescaled == 0) right.rescale();
    if (W == 1) return;
    // The last bond of a lane begins unscaled. Not where k >= n_min alone: gcc 12 at -O3 left it out there with
    // AVX-512's masks.
    const mask inside = joint(block, k);
    right = {select(inside, right.A, x.delta(k - 1)), select(inside, right.F, splat(1.0))};
}

// Writes phi of bond k as t times a vector: the force on atom k is the pull t_k phi_k - t_{k-1} phi_{k-1}. Zeros are
// +0, so that those of a chain's last atom don't depend on whether inert bonds follow.
HOL_INLINE void turn(const Geometry &x, long k, double kT) {
    const vec3 a = x.normal[k], b = x.normal[k + 1];
    const vec3 v = cross(x.u[k], vec3{b.x - a.x, b.y - a.y, b.z - a.z});
    x.u[k] = {v.x + 0.0, v.y + 0.0, v.z + 0.0};
    x.t[k] = kT * x.reciprocal[k];
}

#if HOL_FOURS
// The same of all bonds, weighed before that, from the last one to the first.
template <bool uniform>
static inline void turn_back(const Block &block, const Geometry &x, double kT) {
    const long n = block.n;
    Vector3<FourLanes> behind = {{four{}}, {four{}}, {four{}}};
    long k = (n - 1) / 4 * 4;
    // What has just been stored one by one is read so, too; there is nothing behind the last bond.
    const auto near = [&](const vec *p, long i) HOL_FORCED {
        const auto at = [&](long j) HOL_FORCED { return j < n ? p[j].element : 1.0; };
        return four{p[i].element, at(i + 1), at(i + 2), at(i + 3)};
    };
    turn_in_fours<uniform>(block.w, k, kT, x, {near(x.e, k - 1), near(x.per_e, k - 1)},
                           {near(x.f, k), near(x.per_f, k)}, behind);
    while ((k -= 4) >= 0)
        turn_in_fours<uniform>(block.w, k, kT, x, {load_four(x.e + k - 1), load_four(x.per_e + k - 1)},
                               {load_four(x.f + k), load_four(x.per_f + k)}, behind);
}
#endif

}  // namespace holonomic::HOL_ISA
