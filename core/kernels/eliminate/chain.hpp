// The recursion without subtractions (theory (9)-(12)): pivots P, multipliers l of the elimination, and the two sweeps.
//
//   E_1 = w_0 q_1,  P_k = E_k + w_k q_k,  E_{k+1} = w_k (q_{k+1} E_k + w_k X_{k+1}) / P_k,  l_{k+1} = w_k g_{k+1} / P_k
//   y_1 = b_1,  y_{k+1} = b_{k+1} + l_{k+1} y_k,  t_N = y_N / P_N,  t_k = y_k / P_k + l_{k+1} t_{k+1}
//
// Here bond k = 0 .. n-1 lies between atoms k and k+1; joint k is the one between bonds k-1 and k, at atom k, and L[k]
// its multiplier. Inverse masses are in the lane's unit; with equal ones, t is unit * 2 lambda for a right-hand side as
// it is, and 2 lambda for one that has been divided by the unit.
#pragma once

#include "core/kernels/eliminate/effective_mass.hpp"
#include "core/kernels/memory/arena.hpp"
#include "core/kernels/memory/load.hpp"

namespace holonomic::HOL_ISA {

// Interleaved working arrays of a linear solve, with room for W bonds more in what is read from memory.
struct ChainSystem {
    vec3 *D, *D_low;
    vec *t, *L;   // t: right-hand side, then u = y / P, then the solution; L[0 .. n]: L[0] and L[n] are of no joint
    vec *pivots;  // 1 / P
    ChainSystem(long n, Arena &arena)
        : D(reinterpret_cast<vec3 *>(arena.vecs(3 * (n + W)))),
          D_low(reinterpret_cast<vec3 *>(arena.vecs(3 * (n + W)))), t(arena.vecs(n + W)), L(arena.vecs(n + 1)),
          pivots(arena.vecs(n)) {}
    ChainSystem(vec3 *bonds, vec *values, vec *multipliers, vec *reciprocals)
        : D(bonds), D_low(nullptr), t(values), L(multipliers), pivots(reciprocals) {}
};

// Plain forward sweep, a bond at a time. It turns right-hand sides into u = y / P and keeps the multipliers. Over four
// bonds it carries E as a fraction A / F, so that no division waits for the one before.
template <bool uniform, bool keep_pivots, class Where = Source>
struct Sweep {
    const Block &block;
    const Where &source;
    const ChainSystem s;
    vec3 d = {};  // the bond before
    vec q = {};
    Fraction e = {splat(1.0), vec{}};  // E
    vec F1 = {}, rF = splat(1.0);      // P = F1 / F of the bond before; rF = 1 / F1
    vec rP = {}, y = {};
    vec margin = {};  // negative where the cheap tests failed
    // Sum of |u|, q, 1 / P and w. With kept pivots |u| is left out: the end of the second solve shows an overflow.
    vec size = {};

    // b(): the right-hand side; asked for when it is needed, so that it waits in no register.
    template <class Rhs>
    inline HOL_FORCED void step(long k, const Rhs &b, bool starts_group, bool ragged) {
        const vec w = w_at<uniform>(block, k), w1 = w_at<uniform>(block, k + 1);
        const vec3 d1 = s.D[k];
        const vec q1 = dot(d1, d1);
        if (__builtin_constant_p(k) && k == 0) {  // what the rest comes to without a bond before
            y = b() + 0.0;
            e = {w * q1, splat(1.0)};
            return finish_step(k, d1, q1, w1, true);
        }
        vec g = dot(d, d1), g2 = g * g, X = q * q1 - g2;
        if (ragged) {
            const mask m = joint(block, k);
            g = keep(m, g);
            g2 = keep(m, g2);
            X = keep(m, X);
        }
        const vec little_left = spare(e, F1, 1 / least_effective_mass);
        const mask signs = as_mask(not_orthogonal(g2, X)) | as_mask(little_left);
        if (__builtin_expect(any(signs), 0)) delicate_joint(k, d1, little_left, ragged, g, X);
        const vec l = (w * g) * rP;
        y = mul_add(l, y, b());
        s.L[k] = l;
        e.pass(F1, (w * w) * X, w * q1);
        if (starts_group) e = {e.A * rF, splat(1.0)};
        finish_step(k, d1, q1, w1, starts_group);
    }

    inline HOL_FORCED void finish_step(long k, const vec3 &d1, vec q1, vec w1, bool starts_group) {
        F1 = starts_group ? w1 * q1 + e.A : e.next(w1 * q1);
        rF = splat(1.0) / F1;
        rP = starts_group ? rF : e.F * rF;
        const vec u = y * rP;
        s.t[k] = u;
        if (keep_pivots) s.pivots[k] = rP;
        size = size + (keep_pivots ? q1 + rP : (abs(u) + q1) + rP);
        if (!uniform) size = size + w1;
        d = d1;
        q = q1;
    }

    // For joints of nearly orthogonal bonds, and joints with little of E left before them. A call in its place took 10
    // instructions a bond more, because of the registers that it may change.
    inline HOL_FORCED void delicate_joint(long k, const vec3 &d1, vec little_left, bool ragged, vec &g, vec &X) {
        mask little = less(little_left, vec{});
        if (ragged) little = little & joint(block, k);
        if (any(little)) {
            const vec3 c = cross(d, d1);
            X = select(little, dot(c, c), X);
            margin = min(margin, keep(little, spare(e, F1, spare_of_cross_products)));
        }
        const mask orthogonal = nearly_orthogonal(g, X);
        if (any(orthogonal)) {
            const Where copy = source;  // so that it is not kept in memory for this
            g = exact_dots(copy, k, orthogonal, g);
        }
    }

    // Lanes in which the backward sweep can't overflow: |t_k| |d_k| <= sum_j |u_j| |d_j|, because |l_k| |d_{k-1}| <=
    // |d_k|, and |t_k| <= |u_k| + |l_{k+1} t_{k+1}|, |l_{k+1}| <= w |d_k| |d_{k+1}| / P_k. There no product of five
    // pivots, as A is, has lost digits by underflow either.
    mask calm() const { return less(size, splat(largest_calm)); }
    // Lanes that need extended arithmetic.
    mask flag() const {
        const mask failed = less(margin, vec{}), wild = ~calm();
        if (__builtin_expect(!any(failed | wild), 1)) return none();
        const mask flagged =
            flagged_joints<uniform>(block, s.D, 1, block.n - 1, w_at<uniform>(block, 0) * dot(s.D[0], s.D[0])) & failed;
        return any(wild) ? flagged | (extreme_pivots<uniform>(block, s.D) & wild) : flagged;
    }
};

// Loads the bonds of a block, stage by stage, and eliminates: t becomes u. With kept pivots velocities are kept, too.
// Returns the lanes that plain arithmetic can answer for, and in `calm` those in which nothing can overflow from here
// on.
template <bool uniform, bool keep_pivots>
HOL_NOINLINE mask forward(const Block &block, const Reader &in, const ChainSystem &s, vec3 *velocities, mask &calm) {
    const Source source = in.source();
    Sweep<uniform, keep_pivots> sweep{block, source, s};
    for (long k0 = 0; k0 < block.n; k0 += stage_bonds) {
        const long end = k0 + stage_bonds < block.n ? k0 + stage_bonds : block.n;
        const long full = (end < block.n_min ? end : block.n_min) - 3;
        in.load(k0, end, s.D + k0, nullptr, s.t + k0, velocities);
        long k = k0;
        for (; k < full; k += 4) {
            HOL_UNROLL
            for (int i = 0; i < 4; ++i)
                sweep.step(
                    k + i, [&]() HOL_FORCED { return s.t[k + i]; }, i == 0, false);
        }
        for (; k < end; ++k)
            sweep.step(
                k, [&]() HOL_FORCED { return s.t[k]; }, k % 4 == 0, k >= block.n_min);
    }
    calm = sweep.calm();
    return ~sweep.flag();
}

// Products of two pivots don't underflow if their reciprocals are below this.
constexpr double largest_reciprocal = 1e140;

// The same with bond vectors D + D_low and compensated products, and a division per bond. It is right for any chain
// whose numbers don't overflow or underflow; if they do, u_0 becomes NaN. `overflow` looks at q as well: a last bond of
// infinite q would pass for one without tension.
template <bool uniform>
HOL_NOINLINE void forward_extended(const Block &block, const ChainSystem &s) {
    const long n = block.n;
    vec size = {}, overflow = {};  // of reciprocals of pivots; NaN if any q or E is infinite
    vec q = dot(s.D[0], s.D[0]), E = w_at<uniform>(block, 0) * q, y = s.t[0];
    for (long k = 0; k < n; ++k) {
        overflow = overflow + ((q - q) + (E - E));
        const vec w = w_at<uniform>(block, k + 1), P = mul_add(w, q, E);
        s.t[k] = y / P;
        s.pivots[k] = splat(1.0) / P;
        size = size + s.pivots[k];
        if (k + 1 == n) break;
        const vec3 c = cross_compensated(s.D[k], s.D_low[k], s.D[k + 1], s.D_low[k + 1]);
        vec g = dot_compensated(s.D[k], s.D_low[k], s.D[k + 1], s.D_low[k + 1]), X = dot(c, c);
        if (k + 1 >= block.n_min) {
            const mask m = joint(block, k + 1);
            g = keep(m, g);
            X = keep(m, X);
        }
        const vec q1 = dot(s.D[k + 1], s.D[k + 1]), wP = w / P;
        s.L[k + 1] = wP * g;
        y = mul_add(s.L[k + 1], y, s.t[k + 1]);
        E = wP * mul_add(w, X, q1 * E);
        q = q1;
    }
    s.t[0] = select(less(size, splat(largest_reciprocal)), s.t[0] + overflow, splat(__builtin_nan("")));
}

// Backward sweep over the bonds from .. n-1: u becomes t. The last u is added to zero, so that a chain's zeros have the
// same sign whether or not inert bonds follow.
HOL_INLINE void backward(long from, long n, vec *u, const vec *L) {
    vec t = u[n - 1] + 0.0;
    u[n - 1] = t;
    for (long k = n - 2; k >= from; --k) {
        t = mul_add(L[k + 1], t, u[k]);
        u[k] = t;
    }
}

// The forward sweep for another right-hand side, with 1 / P and L of an earlier elimination.
HOL_INLINE void substitute(long n, const ChainSystem &s) {
    vec y = s.t[0];
    s.t[0] = y * s.pivots[0];
#pragma GCC unroll 4
    for (long k = 1; k < n; ++k) {
        y = mul_add(s.L[k], y, s.t[k]);
        s.t[k] = y * s.pivots[k];
    }
}

}  // namespace holonomic::HOL_ISA
