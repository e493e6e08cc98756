// Positions of rigid bodies: U = U_in - A Lambda, U^T U = L^2, with the axes A of the reference.
//
// Lambda is symmetric, so that the same angular momentum has gone from A to U_in as goes from A to U (the discrete
// equation of Moser and Veselov). U is A turned. In the frame of A, with the matrix of the turn 1 + D and
// K = L^-1 (A^T (U_in - A)) L:
//
//     D L^2 - L^2 D^T = K - K^T,    D = 2 (g^ + g^ g^) / (1 + g.g),    g^ x = g cross x
//
// Three equations for Gibbs' vector g, along the axis, the tangent of half the angle:
//
//     g_i + b_i g_j g_k = a_i (1 + g.g),  a_i = (K_kj - K_jk) / (2 (L_j^2 + L_k^2)),  b_i = (L_j^2 - L_k^2) / (L_j^2 +
//     L_k^2)
//
// with i, j, k in cyclic order. A plane's third axis is its normal, of length 0. U - A comes out relative to itself:
// what is rounded in A does not enter the velocities.
#ifndef HOLONOMIC_KERNELS_BODIES_TURN_HPP
#define HOLONOMIC_KERNELS_BODIES_TURN_HPP

#include "core/kernels/bodies/frame.hpp"

namespace holonomic::HOL_ISA {

struct Turned {
    mask good;
    int rounds[W];
};

// Makes axes orthogonal and as long as L: to the rounding, if they all but were so. away: what that takes from them;
// off: how far they were from it.
template <int R>
HOL_INLINE mask make_orthogonal(const BodyKind &kind, Frame<R> &a, Frame<R> &away, vec &off) {
    mask bad = ~none();
    for (int pass = 0; pass < 4; ++pass) {
        const Symmetric<R> e = errors_of(kind, a);
        Symmetric<R> lambda = by_the_diagonal(kind, e);
        for (int p = 0; p < R && pass > 0; ++p)
            for (int q = 0; q < R; ++q) lambda.of[p][q] = keep(bad, lambda.of[p][q]);
        const vec error = largest_error(kind, e);
        if (pass == 0) off = error;
        bad = bad & ~less(error, splat(1e-9));
        Frame<R> change;
        change.clear();
        HOL_UNROLL_FEW
        for (int p = 0; p < R; ++p) {
            HOL_UNROLL_FEW
            for (int q = 0; q < R; ++q) change[1 + p] = add_times(change[1 + p], lambda.of[p][q], a[1 + q]);
        }
        HOL_UNROLL_FEW
        for (int p = 1; p <= R; ++p) {
            a[p] = a[p] - change[p];
            put(away[p], away[p] + change[p]);
        }
        if (__builtin_expect(!any(bad), 1)) break;
    }
    return ~bad;
}

// Gibbs' vector.
HOL_INLINE void solve_turn(const vec *a, const vec *b, int most, Turned &out, vec *g) {
    HOL_UNROLL_FEW
    for (int i = 0; i < 3; ++i) g[i] = a[i];
    mask busy = out.good;
    vec square = mul_add(g[2], g[2], mul_add(g[1], g[1], g[0] * g[0]));
    out.good = out.good & less(square, splat(0.1));
    busy = out.good;
    for (int round = 0; round < most && any(busy); ++round) {
        vec rho[3], step[3];
        const vec w = square + 1.0;
        HOL_UNROLL_FEW
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            rho[i] = mul_add(a[i], w, mul_add(-b[i] * g[j], g[k], -g[i]));
            step[i] = rho[i];
        }
        // (1 - N)^-1 = 1 + N + N^2, N of the order of g.
        HOL_UNROLL_FEW
        for (int pass = 0; pass < 2; ++pass) {
            const vec along = 2.0 * mul_add(g[2], step[2], mul_add(g[1], step[1], g[0] * step[0]));
            vec next[3];
            HOL_UNROLL_FEW
            for (int i = 0; i < 3; ++i) {
                const int j = (i + 1) % 3, k = (i + 2) % 3;
                next[i] = mul_add(a[i], along, mul_add(-b[i], mul_add(g[j], step[k], g[k] * step[j]), rho[i]));
            }
            HOL_UNROLL_FEW
            for (int i = 0; i < 3; ++i) step[i] = next[i];
        }
        const vec size = max(max(abs(rho[0]), abs(rho[1])), abs(rho[2]));
        HOL_UNROLL_FEW
        for (int i = 0; i < 3; ++i) g[i] = g[i] + keep(busy, step[i]);
        const vec before = square;
        square = mul_add(g[2], g[2], mul_add(g[1], g[1], g[0] * g[0]));
        const unsigned moving = bits(busy);
        for (int l = 0; l < W; ++l) out.rounds[l] += static_cast<int>(moving >> l & 1);
        // N^3 of the step is left, and its square, beside a rounding of g.
        const vec left = size * max(8.0 * before * sqrt(before), 4.0 * size);
        busy = busy & ~less_equal(left * left, (0.01 * epsilon * epsilon) * square);
    }
    out.good = out.good & ~busy & less(square, splat(0.1));
}

// change: of the axes since the reference `from`; becomes that to U. Lambda acts along axes that have been made
// orthogonal; where that makes a difference of more than `slack`, relative to L, the body is not done.
template <int R>
HOL_INLINE void restore(const BodyKind &kind, const Frame<R> &from, Frame<R> &change, int most, double slack,
                        Turned &out) {
    for (int l = 0; l < W; ++l) out.rounds[l] = 0;
    if constexpr (R == 1) {
        // |A + t - lambda A|^2 = L^2
        const vec3 u = from[1], t = change[1];
        const vec aa = dot(u, u), bb = dot(u, u + t), square = splat(kind.square[0]);
        const vec c = (aa - square) + dot(t, (u + u) + t);
        const vec root = bb * bb - aa * c;
        const vec lambda = c / (bb + sqrt(root));
        out.good = less(0.3 * square, bb) & less(0.25 * bb * bb, root) & less(abs(aa - square), 0.01 * square);
        change[1] = add_times(t, -lambda, u);
        for (int l = 0; l < W; ++l) out.rounds[l] = 1;
    } else {
        Frame<R> a = from, away;
        away.clear();
        vec error = {};
        out.good = make_orthogonal(kind, a, away, error);
        vec3 d[R], axis[3];
        HOL_UNROLL_FEW
        for (int p = 0; p < R; ++p) {
            d[p] = change[1 + p] + away[1 + p];
            axis[p] = a[1 + p];
        }
        if (R == 2) axis[2] = cross(axis[0], axis[1]);
        vec turn[3], b[3], g[3], x[3][3];  // x: A^T (U_in - A)
        HOL_UNROLL_FEW
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            vec off = {};
            if (j < R) {
                x[k][j] = dot(axis[k], d[j < R ? j : 0]);
                off = splat(kind.ratio[k][j]) * x[k][j];
            }
            if (k < R) {
                x[j][k] = dot(axis[j], d[k < R ? k : 0]);
                off = mul_add(splat(-kind.ratio[j][k]), x[j][k], off);
            }
            turn[i] = off * splat(0.5 * kind.per_sum[j][k]);
            b[i] = splat((kind.square[j] - kind.square[k]) * kind.per_sum[j][k]);
        }
        solve_turn(turn, b, most, out, g);
        const vec square = mul_add(g[2], g[2], mul_add(g[1], g[1], g[0] * g[0])), s = 2.0 / (1.0 + square);
        vec largest = {};  // of Lambda, relative to L
        HOL_UNROLL_FEW
        for (int q = 0; q < R; ++q) {
            const int r = (q + 1) % 3, t = (q + 2) % 3;
            const vec sq = s * g[q];
            const vec diagonal = sq * g[q] - s * square, beside = mul_add(sq, g[r], s * g[t]);
            largest = max(largest, abs(mul_add(dot(axis[q], d[q]), splat(kind.per_size[q][q]), -diagonal)));
            if (r < R) largest = max(largest, abs(mul_add(x[r][q], splat(kind.per_size[r][q]), -beside)));
            // D_qq, D_rq, D_tq
            const vec m[3] = {diagonal, splat(kind.ratio[r][q]) * beside,
                              splat(kind.ratio[t][q]) * mul_add(sq, g[t], -(s * g[r]))};
            change[1 + q] = add_times(add_times(m[2] * axis[t] - away[1 + q], m[1], axis[r]), m[0], axis[q]);
        }
        out.good = out.good & less_equal(error * largest, splat(slack));
    }
}

}  // namespace holonomic::HOL_ISA
#endif
