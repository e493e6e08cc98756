// Rigid bodies of one kind side by side: reading and writing their atoms, and the equations of their axes.
//
// Vectors are numbered k = 0 .. R: that of the centre, and those of the axes u_p (core/rigid/body.hpp). With U the
// 3 x R matrix of the u_p, S = U^T U, which is all but diagonal, and a symmetric Lambda:
//
//     forces       U'' = W/M - U Lambda,       S Lambda + Lambda S = U^T W/M + (..)^T + 2 U'^T U'
//     velocities   U'  = U'_in - U Lambda,     S Lambda + Lambda S = U^T U'_in + (..)^T
//     positions    U   = U_in - U_ref Lambda,  U^T U = L^2
#ifndef HOLONOMIC_KERNELS_BODIES_FRAME_HPP
#define HOLONOMIC_KERNELS_BODIES_FRAME_HPP

#include "core/kernels/arithmetic/exact.hpp"
#include "core/kernels/arithmetic/image.hpp"
#include "core/kernels/atom.hpp"
#include "core/kernels/bodies/kind.hpp"
#include "core/kernels/call.hpp"

namespace holonomic::HOL_ISA {

// A vector per atom, from the caller's memory to lanes.
HOL_NOINLINE void read_bodies(const AtomArray &array, const BodyUnit &unit, vec3 *x) {
    vec *const to = &x->x;
    const long n = 3L * unit.kind->n_atoms;
    if (array.packed && unit.consecutive && n >= W) {
        const double *from[W];
        for (int l = 0; l < W; ++l) from[l] = reinterpret_cast<const double *>(array.x) + 3 * unit.atoms[l][0];
        const auto turn = [&](long k) HOL_FORCED {
            vec rows[W];
            HOL_UNROLL
            for (int l = 0; l < W; ++l) rows[l] = load(from[l] + k);
            transpose(rows);
            HOL_UNROLL
            for (int l = 0; l < W; ++l) to[k + l] = rows[l];
        };
        for (long k = 0; k + W <= n; k += W) turn(k);
        if (n % W) turn(n - W);
        return;
    }
    for (int l = 0; l < W; ++l)
        for (long a = 0; a < unit.kind->n_atoms; ++a) {
            double one[3];
            read_atom(array, unit.atoms[l][a], one);
            for (int c = 0; c < 3; ++c) to[3 * a + c][l] = one[c];
        }
}

HOL_NOINLINE void write_bodies(const AtomArray &array, const BodyUnit &unit, const vec3 *x, unsigned lanes) {
    const vec *const from = &x->x;
    const long n = 3L * unit.kind->n_atoms;
    if (array.packed && unit.consecutive && n >= W && lanes == all_lanes) {
        double *to[W];
        for (int l = 0; l < W; ++l) to[l] = reinterpret_cast<double *>(array.x) + 3 * unit.atoms[l][0];
        const auto turn = [&](long k) HOL_FORCED {
            vec rows[W];
            HOL_UNROLL
            for (int l = 0; l < W; ++l) rows[l] = from[k + l];
            transpose(rows);
            HOL_UNROLL
            for (int l = 0; l < W; ++l) store(to[l] + k, rows[l]);
        };
        for (long k = 0; k + W <= n; k += W) turn(k);
        if (n % W) turn(n - W);
        return;
    }
    for (int l = 0; l < W; ++l)
        for (long a = 0; a < unit.kind->n_atoms && (lanes >> l & 1); ++a) {
            const double one[3] = {x[a].x[l], x[a].y[l], x[a].z[l]};
            write_atom(array, unit.atoms[l][a], one);
        }
}

// Coordinates from the first atom's, images taken.
HOL_NOINLINE void unfold(const BodyKind &kind, const Box &box, const vec3 *raw, vec3 *x) {
    if (box.shape == Box::none) {
        const vec3 first = raw[0];
        for (long a = 0; a < kind.n_atoms; ++a) x[a] = raw[a] - first;
        return;
    }
    x[0] = raw[0] - raw[0];
    for (long k = 0; k + 1 < kind.n_atoms; ++k) {
        const long to = kind.steps[2 * k], from = kind.steps[2 * k + 1];
        vec3 d = raw[to] - raw[from], unused = {};
        if (box.shape == Box::triclinic)
            d = triclinic_image(box, d);
        else
            wrap<false>(box, d, unused);
        x[to] = x[from] + d;
    }
}

// A vector for the centre and R for the axes: of positions, velocities or forces.
template <int R>
struct Frame {
    vec3 of[1 + R];

    HOL_FORCED vec3 &operator[](int k) { return of[k]; }
    HOL_FORCED const vec3 &operator[](int k) const { return of[k]; }

    // Adds weights [1 + R] of an atom times its vector.
    template <int first = 0>
    HOL_FORCED void add(const double *weights, const vec3 &x) {
        HOL_UNROLL_FEW
        for (int k = first; k <= R; ++k) of[k] = add_times(of[k], splat(weights[k]), x);
    }
    // The vector at an atom that has these weights.
    HOL_FORCED vec3 at(const double *weights) const {
        vec3 sum = of[0];
        HOL_UNROLL_FEW
        for (int p = 1; p <= R; ++p) sum = add_times(sum, splat(weights[p]), of[p]);
        return sum;
    }
    // The same for a frame of what changes: a rounding of the weights, the same in every step, would turn the body.
    HOL_FORCED vec3 at(const double *weights, const double *low) const {
        vec3 sum = of[0];
        HOL_UNROLL_FEW
        for (int p = 1; p <= R; ++p) sum = add_times(add_times(sum, splat(low[p]), of[p]), splat(weights[p]), of[p]);
        return sum;
    }
    HOL_FORCED mask is_finite() const {
        vec sum = {};
        HOL_UNROLL_FEW
        for (int k = 0; k <= R; ++k) sum = sum + abs(of[k].x) + abs(of[k].y) + abs(of[k].z);
        return finite(sum);
    }
};

template <int R>
HOL_INLINE Frame<R> frame_of(const BodyKind &kind, const vec3 *x) {
    Frame<R> sum{};
    const double *share = kind.share;
    for (long a = 0; a < kind.n_atoms; ++a, share += 1 + R) sum.add(share, x[a]);
    return sum;
}

// The axes alone, of coordinates that stand in space; in lanes that are not finite they aren't either.
template <int R>
HOL_INLINE Frame<R> axes_of(const BodyKind &kind, const Box &box, const vec3 *raw, vec3 *x) {
    Frame<R> sum{};
    if (box.shape != Box::none) {
        unfold(kind, box, raw, x);
        raw = x;
    }
    const double *share = kind.share;
    const vec3 first = raw[0];
    for (long a = 0; a < kind.n_atoms; ++a, share += 1 + R) sum.template add<1>(share, raw[a] - first);
    return sum;
}

// Velocities of the atoms that have mass; what sites have is not looked at. low: with what rounding left off the
// shares.
template <int R, bool low>
HOL_INLINE Frame<R> rates_of(const BodyKind &kind, const vec3 *v) {
    Frame<R> sum{};
    const double *share = kind.share, *rest = kind.share_low;
    for (long a = 0; a < kind.n_atoms; ++a, share += 1 + R, rest += 1 + R) {
        if (kind.masses[a] == 0) continue;
        if (low) sum.add(rest, v[a]);
        sum.add(share, v[a]);
    }
    return sum;
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

// By how much s is off L^2 at most, relative to the axes.
template <int R>
HOL_INLINE vec largest_error(const BodyKind &kind, const Symmetric<R> &s) {
    vec worst = {};
    HOL_UNROLL_FEW
    for (int p = 0; p < R; ++p) {
        HOL_UNROLL_FEW
        for (int q = p; q < R; ++q) {
            const vec off = p == q ? s.of[p][p] - kind.square[p] : s.of[p][q];
            worst = max(worst, abs(off) * kind.per_size[p][q]);
        }
    }
    return worst;
}

// X Lambda + Lambda X^T = b, X being all but L^2 on a diagonal: first by that diagonal.
template <int R>
HOL_INLINE Symmetric<R> first_solution(const BodyKind &kind, const Symmetric<R> &b) {
    Symmetric<R> lambda;
    HOL_UNROLL_FEW
    for (int p = 0; p < R; ++p) {
        HOL_UNROLL_FEW
        for (int q = p; q < R; ++q) lambda.of[p][q] = lambda.of[q][p] = b.of[p][q] * kind.per_sum[p][q];
    }
    return lambda;
}

// Then by corrections, of lanes that are busy.
template <int R>
HOL_INLINE void correct(const BodyKind &kind, const vec (*x)[R], const Symmetric<R> &b, mask busy,
                        Symmetric<R> &lambda) {
    vec change[R][R];
    HOL_UNROLL_FEW
    for (int p = 0; p < R; ++p) {
        HOL_UNROLL_FEW
        for (int q = p; q < R; ++q) {
            vec rest = b.of[p][q];
            HOL_UNROLL_FEW
            for (int s = 0; s < R; ++s) {
                rest = mul_add(-x[p][s], lambda.of[s][q], rest);
                rest = mul_add(-lambda.of[p][s], x[q][s], rest);
            }
            change[p][q] = keep(busy, rest * kind.per_sum[p][q]);
        }
    }
    HOL_UNROLL_FEW
    for (int p = 0; p < R; ++p) {
        HOL_UNROLL_FEW
        for (int q = p; q < R; ++q) lambda.of[p][q] = lambda.of[q][p] = lambda.of[p][q] + change[p][q];
    }
}

// The same with X = S to the last digit; each correction makes the error smaller by a factor that is known beforehand.
// `good` is left to lanes for which that comes to an end.
template <int R>
HOL_INLINE Symmetric<R> solve(const BodyKind &kind, const Symmetric<R> &s, const Symmetric<R> &b, mask &good) {
    Symmetric<R> lambda = first_solution(kind, b);
    const vec rate = 2.0 * R * largest_error(kind, s);
    vec left = rate;
    mask busy = good;
    for (int pass = 0; pass < 24 && any(busy); ++pass) {
        correct(kind, s.of, b, busy, lambda);
        left = left * rate;
        busy = busy & ~less(left, splat(0.01 * epsilon));
    }
    good = good & ~busy;
    return lambda;
}

// The axes of `u` less the sum of Lambda_pq of `v`.
template <int R>
HOL_INLINE void take_away(Frame<R> &u, const Frame<R> &v, const Symmetric<R> &lambda) {
    HOL_UNROLL_FEW
    for (int p = 0; p < R; ++p) {
        HOL_UNROLL_FEW
        for (int q = 0; q < R; ++q) u[1 + p] = add_times(u[1 + p], -lambda.of[p][q], v[1 + q]);
    }
}

// - factor Lambda_pq u_p (x) u_q. By value: what it is made of stays in registers where no virial is wanted.
template <int R>
HOL_NOINLINE void write_virial(Frame<R> u, Symmetric<R> lambda, double factor, BodyResult *results) {
    Frame<R> t{};
    take_away(t, u, lambda);
    int i = 0;
    for (int a = 0; a < 3; ++a)
        for (int b = a; b < 3; ++b, ++i) {
            vec sum = {};
            for (int p = 1; p <= R; ++p) sum = mul_add((&u[p].x)[a], (&t[p].x)[b], sum);
            for (int l = 0; l < W; ++l) results[l].virial[i] = factor * sum[l];
        }
}

}  // namespace holonomic::HOL_ISA
#endif
