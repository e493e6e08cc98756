// Equations of the axes of rigid bodies of one kind, W of them side by side.
//
// Vectors are numbered k = 0 .. R: that of the centre, and those of the axes u_p (core/rigid/body.hpp). With U the
// 3 x R matrix of the u_p, S = U^T U, which is all but diagonal, and a symmetric Lambda:
//
//     forces       U'' = W/M - U Lambda,       S Lambda + Lambda S = U^T W/M + (..)^T + 2 U'^T U'
//     velocities   U'  = U'_in - U Lambda,     S Lambda + Lambda S = U^T U'_in + (..)^T
//
// positions: turn.hpp.
#ifndef HOLONOMIC_KERNELS_BODIES_FRAME_HPP
#define HOLONOMIC_KERNELS_BODIES_FRAME_HPP

#include "core/kernels/arithmetic/exact.hpp"
#include "core/kernels/bodies/kind.hpp"
#include "core/kernels/call.hpp"

namespace holonomic::HOL_ISA {

// Component by component: a whole vector in space the compiler copies in halves of lanes, and what is loaded next waits
// for these.
HOL_INLINE void put(vec3 &to, const vec3 &from) {
    to.x = from.x;
    to.y = from.y;
    to.z = from.z;
}

// A vector for the centre and R for the axes: of positions, velocities or forces.
template <int R>
struct Frame {
    vec3 of[1 + R];

    Frame() = default;
    HOL_FORCED Frame(const Frame &from) { *this = from; }
    HOL_FORCED Frame &operator=(const Frame &from) {
        HOL_UNROLL_FEW
        for (int k = 0; k <= R; ++k) put(of[k], from.of[k]);
        return *this;
    }
    // Not by `= {}`, which the compiler makes a loop of microcode.
    HOL_FORCED void clear() {
        HOL_UNROLL_FEW
        for (int k = 0; k <= R; ++k) of[k].x = of[k].y = of[k].z = vec{};
    }
    HOL_FORCED vec3 &operator[](int k) { return of[k]; }
    HOL_FORCED const vec3 &operator[](int k) const { return of[k]; }

    // Adds weights [1 + R] of an atom times its vector.
    template <int first = 0>
    HOL_FORCED void add(const double *weights, const vec3 &x) {
        HOL_UNROLL_FEW
        for (int k = first; k <= R; ++k) put(of[k], add_times(of[k], splat(weights[k]), x));
    }
    // The vector at an atom that has these weights.
    HOL_FORCED vec3 at(const double *weights) const {
        vec x = of[0].x, y = of[0].y, z = of[0].z;
        HOL_UNROLL_FEW
        for (int p = 1; p <= R; ++p) {
            const vec w = splat(weights[p]);
            x = mul_add(w, of[p].x, x);
            y = mul_add(w, of[p].y, y);
            z = mul_add(w, of[p].z, z);
        }
        return {x, y, z};
    }
    // Zero if all is finite, else not a number.
    HOL_FORCED vec nothing() const {
        vec sum = {};
        HOL_UNROLL_FEW
        for (int k = 0; k <= R; ++k)
            sum = mul_add(of[k].z, vec{}, mul_add(of[k].y, vec{}, mul_add(of[k].x, vec{}, sum)));
        return sum;
    }
};

// What the rounding of shares and places leaves off in a frame of what changes: it would turn the body, in every step
// the same way.
template <int R>
HOL_INLINE void take_excess(const BodyKind &kind, Frame<R> &change) {
    Frame<R> more;
    more.clear();
    HOL_UNROLL_FEW
    for (int k = 0; k <= R; ++k) {
        HOL_UNROLL_FEW
        for (int l = 0; l <= R; ++l) more[k] = add_times(more[k], splat(kind.excess[k][l]), change[l]);
    }
    HOL_UNROLL_FEW
    for (int k = 0; k <= R; ++k) change[k] = change[k] - more[k];
}

// A symmetric matrix, its lower half a copy of the upper one.
template <int R>
struct Symmetric {
    vec of[R][R];
};

template <int R>
HOL_INLINE Symmetric<R> products(const Frame<R> &u) {
    Symmetric<R> s;
    HOL_UNROLL_FEW
    for (int p = 0; p < R; ++p) {
        HOL_UNROLL_FEW
        for (int q = p; q < R; ++q) s.of[p][q] = s.of[q][p] = dot(u[1 + p], u[1 + q]);
    }
    return s;
}

// u.v + v.u
template <int R>
HOL_INLINE Symmetric<R> both_products(const Frame<R> &u, const Frame<R> &v) {
    Symmetric<R> s;
    HOL_UNROLL_FEW
    for (int p = 0; p < R; ++p) {
        HOL_UNROLL_FEW
        for (int q = p; q < R; ++q) s.of[p][q] = s.of[q][p] = dot(u[1 + p], v[1 + q]) + dot(u[1 + q], v[1 + p]);
    }
    return s;
}

// By how much the axes' products are off L^2.
template <int R>
HOL_INLINE Symmetric<R> errors_of(const BodyKind &kind, const Frame<R> &u) {
    Symmetric<R> e = products(u);
    HOL_UNROLL_FEW
    for (int p = 0; p < R; ++p) e.of[p][p] = e.of[p][p] - splat(kind.square[p]);
    return e;
}

// At most, relative to the axes.
template <int R>
HOL_INLINE vec largest_error(const BodyKind &kind, const Symmetric<R> &e) {
    vec worst = {};
    HOL_UNROLL_FEW
    for (int p = 0; p < R; ++p) {
        HOL_UNROLL_FEW
        for (int q = p; q < R; ++q) worst = max(worst, abs(e.of[p][q]) * splat(kind.per_size[p][q]));
    }
    return worst;
}

// X of L^2 X + X L^2 = b.
template <int R>
HOL_INLINE Symmetric<R> by_the_diagonal(const BodyKind &kind, const Symmetric<R> &b) {
    Symmetric<R> x;
    HOL_UNROLL_FEW
    for (int p = 0; p < R; ++p) {
        HOL_UNROLL_FEW
        for (int q = p; q < R; ++q) x.of[p][q] = x.of[q][p] = b.of[p][q] * splat(kind.per_sum[p][q]);
    }
    return x;
}

// What e is short of being solved: b' of the next correction by the diagonal, if this was the last one.
template <int R>
HOL_INLINE Symmetric<R> rest_after(const Symmetric<R> &e, const Symmetric<R> &last) {
    Symmetric<R> b;
    HOL_UNROLL_FEW
    for (int p = 0; p < R; ++p) {
        HOL_UNROLL_FEW
        for (int q = p; q < R; ++q) {
            vec sum = e.of[p][0] * last.of[0][q];
            HOL_UNROLL_FEW
            for (int s = 1; s < R; ++s) sum = mul_add(e.of[p][s], last.of[s][q], sum);
            HOL_UNROLL_FEW
            for (int s = 0; s < R; ++s) sum = mul_add(last.of[p][s], e.of[s][q], sum);
            b.of[p][q] = b.of[q][p] = sum;
        }
    }
    return b;
}

template <int R>
HOL_INLINE void add(Symmetric<R> &a, const Symmetric<R> &b) {
    HOL_UNROLL_FEW
    for (int p = 0; p < R; ++p) {
        HOL_UNROLL_FEW
        for (int q = p; q < R; ++q) a.of[p][q] = a.of[q][p] = a.of[p][q] + b.of[p][q];
    }
}

// Further corrections, where the first two are not enough. `good` is left to lanes for which that comes to an end.
template <int R>
HOL_NOINLINE void correct_more(const BodyKind &kind, const Symmetric<R> &e, Symmetric<R> change, vec rate, mask &good,
                               Symmetric<R> &sum) {
    vec left = rate * rate;
    mask busy = good & ~less(left, splat(0.01 * epsilon));
    double sign = -1;
    for (int pass = 0; pass < 24 && any(busy); ++pass) {
        change = by_the_diagonal(kind, rest_after(e, change));
        for (int p = 0; p < R; ++p)
            for (int q = 0; q < R; ++q) sum.of[p][q] = sum.of[p][q] - sign * keep(busy, change.of[p][q]);
        sign = -sign;
        left = left * rate;
        busy = busy & ~less(left, splat(0.01 * epsilon));
    }
    good = good & ~busy;
}

// Lambda of S Lambda + Lambda S = b, S = L^2 + e: to the last digit. Each correction makes the error smaller by a
// factor that is known beforehand.
template <int R>
HOL_INLINE Symmetric<R> solve(const BodyKind &kind, const Symmetric<R> &e, const Symmetric<R> &b, mask &good) {
    Symmetric<R> lambda = by_the_diagonal(kind, b);
    const Symmetric<R> change = by_the_diagonal(kind, rest_after(e, lambda));
    HOL_UNROLL_FEW
    for (int p = 0; p < R; ++p) {
        HOL_UNROLL_FEW
        for (int q = p; q < R; ++q) lambda.of[p][q] = lambda.of[q][p] = lambda.of[p][q] - change.of[p][q];
    }
    const vec rate = 2.0 * R * largest_error(kind, e);
    const mask slow = ~less(rate, splat(1e-9));
    if (__builtin_expect(any(slow & good), 0)) {
        Symmetric<R> sum = lambda;
        correct_more(kind, e, change, rate, good, sum);
        lambda = sum;
    }
    return lambda;
}

// The axes of `u` less the sum of Lambda_pq of `v`.
template <int R>
HOL_INLINE void take_away(Frame<R> &u, const Frame<R> &v, const Symmetric<R> &lambda) {
    HOL_UNROLL_FEW
    for (int p = 0; p < R; ++p) {
        HOL_UNROLL_FEW
        for (int q = 0; q < R; ++q) {
            u[1 + p].x = mul_add(-v[1 + q].x, lambda.of[p][q], u[1 + p].x);
            u[1 + p].y = mul_add(-v[1 + q].y, lambda.of[p][q], u[1 + p].y);
            u[1 + p].z = mul_add(-v[1 + q].z, lambda.of[p][q], u[1 + p].z);
        }
    }
}

// factor u_p (x) t_p, t: what is added to the axes. By value: what they are made of stays in registers where no virial
// is wanted.
template <int R>
HOL_NOINLINE void write_virial(Frame<R> u, Frame<R> t, double factor, int count, BodyResult *results) {
    int i = 0;
    for (int a = 0; a < 3; ++a)
        for (int b = a; b < 3; ++b, ++i) {
            vec sum = {};
            for (int p = 1; p <= R; ++p) sum = mul_add((&u[p].x)[a], (&t[p].x)[b], sum);
            for (int l = 0; l < count; ++l) results[l].virial[i] = factor * sum[l];
        }
}
template <int R>
HOL_NOINLINE void write_virial(Frame<R> u, Symmetric<R> lambda, double factor, int count, BodyResult *results) {
    Frame<R> t{};
    take_away(t, u, lambda);
    write_virial(u, t, factor, count, results);
}

}  // namespace holonomic::HOL_ISA
#endif
