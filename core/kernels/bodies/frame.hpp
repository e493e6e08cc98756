// Equations of the axes of rigid bodies of one kind, W of them side by side.
//
// Vectors are numbered k = 0 .. R: that of the centre, and those of the axes a_p = u_p / L_p (core/rigid/body.hpp),
// which are orthonormal but for what rounding leaves. With A the 3 x R matrix of the a_p, and Z what forces over masses
// give it,
//
//     forces       A'' = Z - A C,       C + C^T = A^T Z + (..)^T + 2 A'^T A'
//     velocities   A'  = A'_in - A C,   C + C^T = A^T A'_in + (..)^T
//
// where C_pq / C_qp = L_p^2 / L_q^2, as no angular momentum may come of it. As A^T A = 1 + E, what C takes away is
// off by E C + (..)^T, which goes into C to first order. Positions: turn.hpp.
#pragma once

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

// c - s a
HOL_INLINE vec3 less_times(const vec3 &c, vec s, const vec3 &a) {
    return {sub_mul(s, a.x, c.x), sub_mul(s, a.y, c.y), sub_mul(s, a.z, c.z)};
}

// A vector for the centre and R for the axes: of positions, velocities or forces.
template <int R>
struct Frame {
    vec3 of[1 + R];

    Frame() = default;
    HOL_FORCED Frame(const Frame &from) { *this = from; }
    HOL_FORCED Frame &operator=(const Frame &from) {  // NOLINT(bugprone-unhandled-self-assignment): each part by itself
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

    // Adds weights [1 + R] of an atom times its vector, from that of `first` on.
    template <int first>
    HOL_FORCED void add(const double *weights, const vec3 &x) {
        HOL_UNROLL_FEW
        for (int k = first; k <= R; ++k) put(of[k], add_times(of[k], splat(weights[k]), x));
    }
    // Takes them away.
    template <int first>
    HOL_FORCED void take(const double *weights, const vec3 &x) {
        HOL_UNROLL_FEW
        for (int k = first; k <= R; ++k) put(of[k], less_times(of[k], splat(weights[k]), x));
    }
    // The vector at an atom that has these coordinates.
    HOL_FORCED vec3 at(const double *coordinates) const {
        vec x = of[0].x, y = of[0].y, z = of[0].z;
        HOL_UNROLL_FEW
        for (int p = 1; p <= R; ++p) {
            const vec w = splat(coordinates[p]);
            x = mul_add(w, of[p].x, x);
            y = mul_add(w, of[p].y, y);
            z = mul_add(w, of[p].z, z);
        }
        return {x, y, z};
    }
    // Not finite if anything is not.
    HOL_FORCED vec sum() const {
        vec x = of[0].x, y = of[0].y, z = of[0].z;
        HOL_UNROLL_FEW
        for (int k = 1; k <= R; ++k) {
            x = x + of[k].x;
            y = y + of[k].y;
            z = z + of[k].z;
        }
        return x + (y + z);
    }
};

// What shares are too large by, in a frame of what changes: what their rounding leaves off would turn the body in every
// step the same way. All of it in one number, which is rounded but once.
template <int R>
HOL_INLINE void take_excess(const BodyKind &kind, const Frame<R> &from, Frame<R> &__restrict to) {
    HOL_UNROLL_FEW
    for (int k = 0; k <= R; ++k) {
        vec3 more = splat(kind.excess[k][0]) * from[0];
        HOL_UNROLL_FEW
        for (int l = 1; l <= R; ++l) more = add_times(more, splat(kind.excess[k][l]), from[l]);
        put(to[k], from[k] - more);
    }
}

// The upper half of a symmetric matrix; in `Half` half its diagonal.
template <int R>
struct Symmetric {
    vec of[R][R];
};
template <int R>
struct Half : Symmetric<R> {
    HOL_FORCED void clear() {
        HOL_UNROLL_FEW
        for (int p = 0; p < R; ++p) {
            HOL_UNROLL_FEW
            for (int q = p; q < R; ++q) this->of[p][q] = vec{};
        }
    }
};

// A^T A - 1
template <int R>
HOL_INLINE Symmetric<R> errors_of(const Frame<R> &a) {
    Symmetric<R> e;
    HOL_UNROLL_FEW
    for (int p = 0; p < R; ++p) {
        HOL_UNROLL_FEW
        for (int q = p; q < R; ++q) e.of[p][q] = p == q ? excess(a[1 + p], splat(1)) : dot(a[1 + p], a[1 + q]);
    }
    return e;
}

// The square of its norm.
template <int R>
HOL_INLINE vec square_of(const Symmetric<R> &e) {
    vec diagonal = {}, beside = {};
    HOL_UNROLL_FEW
    for (int p = 0; p < R; ++p) {
        HOL_UNROLL_FEW
        for (int q = p; q < R; ++q) {
            vec &sum = p == q ? diagonal : beside;
            sum = mul_add(e.of[p][q], e.of[p][q], sum);
        }
    }
    return mul_add(splat(2), beside, diagonal);
}

template <int R>
HOL_INLINE vec largest_of(const Symmetric<R> &e) {
    vec worst = {};
    for (int p = 0; p < R; ++p)
        for (int q = p; q < R; ++q) worst = max(worst, abs(e.of[p][q]));
    return worst;
}

// 2 A'^T A'
template <int R>
HOL_INLINE void twice_products(const Frame<R> &rate, Half<R> &to) {
    HOL_UNROLL_FEW
    for (int p = 0; p < R; ++p) {
        HOL_UNROLL_FEW
        for (int q = p; q < R; ++q) {
            const vec product = dot(rate[1 + p], rate[1 + q]);
            to.of[p][q] = p == q ? product : product + product;
        }
    }
}

// A^T Z + (..)^T + more
template <int R>
HOL_INLINE Half<R> both_products(const Frame<R> &a, const Frame<R> &z, const Half<R> &more) {
    const auto add_product = [](const vec3 &u, const vec3 &v, vec sum)
                                 HOL_FORCED { return mul_add(u.z, v.z, mul_add(u.y, v.y, mul_add(u.x, v.x, sum))); };
    Half<R> b;
    HOL_UNROLL_FEW
    for (int p = 0; p < R; ++p) {
        HOL_UNROLL_FEW
        for (int q = p; q < R; ++q) {
            b.of[p][q] = add_product(a[1 + p], z[1 + q], more.of[p][q]);
            if (p != q) b.of[p][q] = b.of[p][q] + dot(a[1 + q], z[1 + p]);
        }
    }
    return b;
}

// Z - A C, C + C^T = b
template <int R>
HOL_INLINE void take_away(const BodyKind &kind, const Frame<R> &a, const Half<R> &b, Frame<R> &z) {
    HOL_UNROLL_FEW
    for (int q = 0; q < R; ++q) {
        vec3 x = less_times(z[1 + q], b.of[q][q], a[1 + q]);
        HOL_UNROLL_FEW
        for (int p = 0; p < R; ++p)
            if (p != q) x = less_times(x, splat(kind.part[p][q]) * b.of[p < q ? p : q][p < q ? q : p], a[1 + p]);
        put(z[1 + q], x);
    }
}

template <int R>
HOL_NOINLINE void take_more(const BodyKind &kind, const Frame<R> &a, const Half<R> &b, Frame<R> &z) {
    take_away(kind, a, b, z);
}

// Takes from b what C, C + C^T = b, takes away too much as A^T A = 1 + E, to first order: E C + (..)^T.
template <int R>
HOL_INLINE void correct_for(const Symmetric<R> &e, const BodyKind &kind, Half<R> &b) {
    const Half<R> all = b;
    const auto c = [&](int p, int q) HOL_FORCED {
        return p == q ? all.of[p][p] : splat(kind.part[p][q]) * all.of[p < q ? p : q][p < q ? q : p];
    };
    const auto error = [&](int p, int q) HOL_FORCED { return e.of[p < q ? p : q][p < q ? q : p]; };
    HOL_UNROLL_FEW
    for (int p = 0; p < R; ++p) {
        HOL_UNROLL_FEW
        for (int q = p; q < R; ++q) {
            HOL_UNROLL_FEW
            for (int k = 0; k < R; ++k) {
                b.of[p][q] = sub_mul(error(p, k), c(k, q), b.of[p][q]);
                if (p != q) b.of[p][q] = sub_mul(error(q, k), c(k, p), b.of[p][q]);
            }
        }
    }
}

// Goes on where A is far from orthonormal. What is left is less by the root of `square`, at least, each time; returns
// the lanes for which it does not come to an end.
template <int R>
HOL_NOINLINE mask project_more(const BodyKind &kind, const Frame<R> &a, const Half<R> &more, mask busy, vec square,
                               Frame<R> &z, Frame<R> *taken) {
    vec left = square * square;
    for (int pass = 0; pass < 24 && any(busy); ++pass) {
        Half<R> b = both_products(a, z, more);
        for (int p = 0; p < R; ++p)
            for (int q = p; q < R; ++q) b.of[p][q] = keep(busy, b.of[p][q]);
        if (taken) take_away(kind, a, b, *taken);
        take_away(kind, a, b, z);
        left = left * square;
        busy = busy & ~less(left, splat(1e-4 * epsilon * epsilon));
    }
    return busy;
}

// z: becomes what obeys the equations. taken: less what that takes, where it is wanted. The lanes for which it comes to
// an end.
template <int R>
HOL_NOINLINE mask project(const BodyKind &kind, const Frame<R> &__restrict a, const Half<R> &__restrict more,
                          Frame<R> &__restrict z, Frame<R> *taken) {
    const Symmetric<R> e = errors_of(a);
    Half<R> b = both_products(a, z, more);
    correct_for(e, kind, b);
    take_away(kind, a, b, z);
    if (__builtin_expect(taken != nullptr, 0)) {
        const Half<R> copy = b;
        take_more(kind, a, copy, *taken);
    }
    const vec square = 4.0 * square_of(e);
    mask busy = ~less(square, splat(1e-18));
    if (__builtin_expect(any(busy), 0)) busy = project_more(kind, a, more, busy, square, z, taken);
    return ~busy & finite(z.sum());
}

// M L_p^2 a_p (x) t_p, t: what is added to the axes.
template <int R>
HOL_NOINLINE void write_virial(const BodyKind &kind, const Frame<R> &a, const Frame<R> &t, double factor, int count,
                               BodyResult *results) {
    int i = 0;
    for (int x = 0; x < 3; ++x)
        for (int y = x; y < 3; ++y, ++i) {
            vec sum = {};
            for (int p = 1; p <= R; ++p) sum = mul_add((&a[p].x)[x] * splat(kind.square[p - 1]), (&t[p].x)[y], sum);
            for (int l = 0; l < count; ++l) results[l].virial[i] = (factor * kind.mass) * sum[l];
        }
}

}  // namespace holonomic::HOL_ISA
