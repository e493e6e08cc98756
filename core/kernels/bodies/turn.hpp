// Positions of rigid bodies: A = A_in - A_ref C, A^T A = 1, with the axes A_ref of the reference.
//
// C_pq / C_qp = L_p^2 / L_q^2 (frame.hpp), so that the same angular momentum has gone from A_ref to A_in as goes from
// A_ref to A (the discrete equation of Moser and Veselov). A is A_ref turned. In the frame of A_ref, with the matrix of
// the turn 1 + D and X = A_ref^T (A_in - A_ref):
//
//     D L^2 - L^2 D^T = X L^2 - L^2 X^T,    D = 2 (g^ + g^ g^) / (1 + g.g),    g^ x = g cross x
//
// Three equations for Gibbs' vector g, along the axis, the tangent of half the angle:
//
//     g_i + b_i g_j g_k = a_i (1 + g.g),  a_i = (X_kj L_j^2 - X_jk L_k^2) / (2 (L_j^2 + L_k^2)),
//     b_i = (L_j^2 - L_k^2) / (L_j^2 + L_k^2)
//
// with i, j, k in cyclic order. A plane's third axis is its normal, of length 0. A - A_ref comes out relative to
// itself: what is rounded in A_ref does not enter the velocities.
#pragma once

#include "core/kernels/bodies/frame.hpp"

namespace holonomic::HOL_ISA {

// What is known of a turn: prepare(), solve_turn() and finish() in this order. Each is a chain of operations that wait
// for each other; those of two blocks go side by side.
template <int R>
struct Turn {
    vec3 axis[3], away[R];  // of the reference, orthonormal, in a plane with its normal; what that took from them
    vec x[3][R], off;       // off: the square of how far the reference was from it
    vec a[3], g[3];
    mask good;
    vec rounds;
};

// Takes from axes by how much they are not orthonormal, to first order, and adds it to `away`. Returns the square of
// what that was.
template <int R>
HOL_INLINE vec take_errors(const BodyKind &kind, mask lanes, Frame<R> &a, Frame<R> &away) {
    const Symmetric<R> e = errors_of(a);
    Half<R> b;
    HOL_UNROLL_FEW
    for (int p = 0; p < R; ++p) {
        HOL_UNROLL_FEW
        for (int q = p; q < R; ++q) b.of[p][q] = keep(lanes, p == q ? 0.5 * e.of[p][q] : e.of[p][q]);
    }
    Frame<R> change;
    change.clear();
    take_away(kind, a, b, change);
    HOL_UNROLL_FEW
    for (int p = 1; p <= R; ++p) {
        put(a[p], a[p] + change[p]);
        put(away[p], away[p] - change[p]);
    }
    return square_of(e);
}
template <int R>
HOL_NOINLINE mask take_more_errors(const BodyKind &kind, mask bad, Frame<R> &a, Frame<R> &away) {
    for (int pass = 0; pass < 3 && any(bad); ++pass) bad = bad & ~less(take_errors(kind, bad, a, away), splat(1e-18));
    return bad;
}

// Gibbs' vector: Newton's method with the matrix of the first guess, which is right to the third order.
HOL_NOINLINE mask solve_turn(const BodyKind &kind, const vec *of, int most, mask good, vec *to, vec &rounds_to) {
    vec a[3], b[3], g[3], rounds = {};
    HOL_UNROLL_FEW
    for (int i = 0; i < 3; ++i) {
        a[i] = of[i];
        b[i] = splat(kind.skew[i]);
    }
    const auto square_of = [](const vec *x)
                               HOL_FORCED { return mul_add(x[2], x[2], mul_add(x[1], x[1], x[0] * x[0])); };
    // a_i (1 + x.x) - b_i x_j x_k
    const vec one = splat(1);
    const auto next = [&](const vec *x, vec *y) HOL_FORCED {
        const vec w = mul_add(x[0], x[0], one) + mul_add(x[1], x[1], x[2] * x[2]);
        HOL_UNROLL_FEW
        for (int i = 0; i < 3; ++i) y[i] = mul_sub(a[i], w, b[i] * x[(i + 1) % 3] * x[(i + 2) % 3]);
    };
    vec start[3], m[3][3], inverse[3][3];
    next(a, start);
    next(start, g);
    HOL_UNROLL_FEW
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const vec twice = a[i] + a[i];
        m[i][i] = sub_mul(twice, g[i], one);
        m[i][j] = mul_sub(b[i], g[k], twice * g[j]);
        m[i][k] = mul_sub(b[i], g[j], twice * g[k]);
    }
    HOL_UNROLL_FEW
    for (int i = 0; i < 3; ++i) {
        HOL_UNROLL_FEW
        for (int j = 0; j < 3; ++j) {
            const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            inverse[j][i] = mul_sub(m[i1][j1], m[i2][j2], m[i1][j2] * m[i2][j1]);
        }
    }
    const vec per = 1.0 / mul_add(m[0][2], inverse[2][0], mul_add(m[0][1], inverse[1][0], m[0][0] * inverse[0][0]));
    vec square = square_of(g), first = {};
    good = good & less(square, splat(0.1));
    mask busy = good;
    for (int round = 0; round < most && any(busy); ++round) {
        vec rest[3], step[3];
        next(g, rest);
        HOL_UNROLL_FEW
        for (int i = 0; i < 3; ++i) rest[i] = rest[i] - g[i];
        HOL_UNROLL_FEW
        for (int i = 0; i < 3; ++i) {
            step[i] = per * mul_add(inverse[i][2], rest[2], mul_add(inverse[i][1], rest[1], inverse[i][0] * rest[0]));
            g[i] = g[i] + keep(busy, step[i]);
        }
        square = square_of(g);
        rounds = rounds + keep(busy, one);
        // By the first step the matrix is off, at most 2.5 times: that part of a later one is left. It comes into a
        // turn as the square of g.
        const vec size = square_of(step);
        if (round == 0) first = size;
        busy = busy & ~less_equal((7.0 * first) * size, splat(0.01 * epsilon * epsilon));
    }
    HOL_UNROLL_FEW
    for (int i = 0; i < 3; ++i) to[i] = g[i];
    rounds_to = rounds;
    return good & ~busy & less(square, splat(0.1));
}

// The same for three equal axes: b = 0 but for rounding.
HOL_NOINLINE mask turn_sphere(const vec *a, mask good, vec *g) {
    const vec aa = mul_add(a[2], a[2], mul_add(a[1], a[1], a[0] * a[0])), one = splat(1);
    const vec w = 2.0 / (one + sqrt(sub_mul(splat(4), aa, one)));
    HOL_UNROLL_FEW
    for (int i = 0; i < 3; ++i) g[i] = w * a[i];
    return good & less(w * w * aa, splat(0.1));
}

// The same for a plane, whose normal has the length 0: b_0 = 1, b_1 = -1, and with complex numbers
//
//     (g_0 + i g_1) (1 - i g_2) = (a_0 + i a_1) (1 + g.g)
//
// So 1 + g.g = w (1 + g_2^2) with w = 1 + (a_0^2 + a_1^2) w^2, g_0 + i g_1 = w (a_0 + i a_1) (1 + i g_2), and the third
// equation is a quadratic one for g_2.
HOL_NOINLINE mask turn_plane(const BodyKind &kind, const vec *a, mask good, vec *g) {
    const vec one = splat(1), a0 = a[0], a1 = a[1];
    const vec w = 2.0 / (one + sqrt(sub_mul(splat(4), mul_add(a0, a0, a1 * a1), one))), bw = kind.skew[2] * (w * w);
    const vec p = w * a[2], q = bw * (a0 * a1);
    const vec half = 0.5 * mul_add(bw, (a0 - a1) * (a0 + a1), one);  // g_2^2 (p + q) - 2 half g_2 + p - q = 0
    const vec g2 = (p - q) / (half + sqrt(sub_mul(p + q, p - q, half * half)));
    g[0] = w * sub_mul(a1, g2, a0);
    g[1] = w * mul_add(a0, g2, a1);
    g[2] = g2;
    return good & less(mul_add(g2, g2, mul_add(g[1], g[1], g[0] * g[0])), splat(0.1));
}

// change: that of the trial since the reference `from`.
template <int R>
HOL_NOINLINE void prepare(const BodyKind &kind, const Frame<R> &__restrict from, const Frame<R> &__restrict change,
                          Turn<R> &__restrict to) {
    Frame<R> a = from, away;
    away.clear();
    to.off = take_errors(kind, ~none(), a, away);
    mask bad = ~less(to.off, splat(1e-18));
    if (__builtin_expect(any(bad), 0)) {
        Frame<R> copy = a, copy_away = away;
        bad = take_more_errors(kind, bad, copy, copy_away);
        a = copy;
        away = copy_away;
    }
    to.good = ~bad;
    vec3 axis[3];
    HOL_UNROLL_FEW
    for (int p = 0; p < R; ++p) {
        put(axis[p], a[1 + p]);
        put(to.axis[p], a[1 + p]);
        put(to.away[p], away[1 + p]);
    }
    if (R == 2) {
        put(axis[2], cross(axis[0], axis[1]));
        put(to.axis[2], axis[2]);
    }
    vec x[3][R];
    HOL_UNROLL_FEW
    for (int q = 0; q < R; ++q) {
        const vec3 d = change[1 + q] + away[1 + q];
        HOL_UNROLL_FEW
        for (int p = 0; p < 3; ++p) to.x[p][q] = x[p][q] = dot(axis[p], d);
    }
    HOL_UNROLL_FEW
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        if (R == 2 && i < 2) {  // the normal weighs nothing
            to.a[i] = i == 0 ? 0.5 * x[2][1] : -0.5 * x[2][0];
            continue;
        }
        // What is rounded in b_i meets a small number.
        const vec plus = x[k][j < R ? j : 0], minus = x[j][k < R ? k : 0];
        to.a[i] = 0.25 * mul_add(splat(kind.skew[i]), plus + minus, plus - minus);
    }
}

// change: becomes that to A. C acts along axes that have been made orthonormal; where that makes a difference of more
// than `margin` the body is not done.
template <int R>
HOL_NOINLINE mask finish(const BodyKind &kind, const Turn<R> &__restrict t, double margin,
                         Frame<R> &__restrict change) {
    vec g[3];
    vec3 axis[3];
    HOL_UNROLL_FEW
    for (int p = 0; p < 3; ++p) {
        g[p] = t.g[p];
        put(axis[p], t.axis[p]);
    }
    // 2 g / (1 + g.g), as 2 (a_i - b_i g_j g_k / (1 + g.g)): what is rounded in g would be the same in each step of a
    // body that turns evenly.
    const vec square = mul_add(g[2], g[2], mul_add(g[1], g[1], g[0] * g[0])), two = 2.0 / (1.0 + square);
    vec s[3];
    HOL_UNROLL_FEW
    for (int p = 0; p < 3; ++p)
        s[p] = sub_mul(splat(kind.skew[p]) * two * g[(p + 1) % 3], g[(p + 2) % 3], t.a[p] + t.a[p]);
    vec largest = {};  // the square of C's norm
    HOL_UNROLL_FEW
    for (int q = 0; q < R; ++q) {
        const int row[3] = {q, (q + 1) % 3, (q + 2) % 3};
        const vec of[3] = {-mul_add(s[row[1]], g[row[1]], s[row[2]] * g[row[2]]), mul_add(s[q], g[row[1]], s[row[2]]),
                           mul_sub(s[q], g[row[2]], s[row[1]])};
        vec3 sum = vec3{} - t.away[q];
        HOL_UNROLL_FEW
        for (int k = 0; k < 3; ++k) {
            const vec c = t.x[row[k]][q] - of[k];
            largest = mul_add(c, c, largest);
            sum = add_times(sum, of[k], axis[row[k]]);
        }
        put(change[1 + q], sum);
    }
    return t.good & less_equal(t.off * largest, splat(margin * margin));
}

// The same for a line: |A + t - c A|^2 = 1.
HOL_NOINLINE mask restore_line(const Frame<1> &from, Frame<1> &change) {
    const vec3 u = {from[1].x, from[1].y, from[1].z}, t = {change[1].x, change[1].y, change[1].z};
    const vec e = excess(u, splat(1)), aa = 1.0 + e, bb = dot(u, u + t);
    const vec c = e + dot(t, (u + u) + t);
    const vec root = sub_mul(aa, c, bb * bb);
    put(change[1], less_times(t, c / (bb + sqrt(root)), u));
    return less(splat(0.3), bb) & less(0.25 * bb * bb, root) & less(abs(e), splat(0.01));
}

}  // namespace holonomic::HOL_ISA
