// Forces, given right-hand sides and velocities of rigid water and other triangles: A t = b (theory (51)) by the
// inverse in closed form (56), solution.hpp. A t that is a small difference of adj b is told by the size of its
// terms; such lanes go to the extended-precision solver.
#pragma once

#include "core/kernels/arithmetic/thresholds.hpp"
#include "core/kernels/molecules/store.hpp"
#include "core/kernels/molecules/triangle/solution.hpp"

namespace holonomic::HOL_ISA::graph {

// What a linear solve reads and writes; absent arrays have x == nullptr.
struct TriangleCall {
    const AtomArray &r, &v, &f;
    const double *rhs;
    const AtomArray &g;
    double *lambda, *tension;
    bool add, virial;
    const Box &box;
};

// Right-hand sides as load.hpp makes them.
template <Inlined where, class V>
HOL_INLINE void triangle_rhs(const TriangleCall &call, const Atoms<V> &at, const TriangleMasses<V> &m,
                             const Vector3<V> *d, V *y) {
    Vector3<V> a[3];
    for (int k = 0; k < 3; ++k) y[k] = V{};
    if (call.v.x) {
        read_all<where, 3>(call.v, at, a);
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) {
            const Vector3<V> dv = a[(k + 1) % 3] - a[k];
            y[k] = dot(dv, dv);
        }
    }
    if (call.f.x) {
        read_all<where, 3>(call.f, at, a);
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) a[k] = m.w[k] * a[k];
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) y[k] = y[k] + dot(d[k], a[(k + 1) % 3] - a[k]);
    }
    if (call.rhs) read_triangle_bonds(at, call.rhs, 0.5, y);
}

// The terms of the elements of bonds k and k + 1, in absolute values.
template <class V>
HOL_INLINE V terms_of(const TriangleMasses<V> &m, const TriangleInverse<V> &inverse, V X, int k) {
    const V apart = m.s[(k + 1) % 3] * X;
    return abs(inverse.adj[k][(k + 1) % 3] + apart) + apart;
}

// Returns the lanes in which that is so of each multiplier: where elements have cancelled, others may be larger, or the
// side that an element multiplies small. By value: what they are made of stays in registers where this is not asked.
template <class V>
HOL_NOINLINE MaskOf<V> bearable(const TriangleMasses<V> &m, const TriangleInverse<V> inverse, V X,
                                const Vector3<V> rhs) {
    const V terms[3] = {terms_of(m, inverse, X, 0), terms_of(m, inverse, X, 1), terms_of(m, inverse, X, 2)},
            y[3] = {abs(rhs.x), abs(rhs.y), abs(rhs.z)};
    V least = {};
    for (int k = 0; k < 3; ++k) {
        const int l = (k + 1) % 3, o = (k + 2) % 3;
        const V size = mul_add(inverse.adj[k][k], y[k],
                               mul_add(abs(inverse.adj[k][l]), y[l], abs(inverse.adj[k][o]) * y[o])),
                error = mul_add(terms[k], y[l], terms[o] * y[o]);
        least = min(mul_add(Width<V>::all(most_cancelled_there), size, -error), least);
    }
    return less_equal(V{}, least);
}

// Returns the lanes that are done.
template <Inlined where, class V>
HOL_INLINE unsigned solve_triangles(const TriangleCall &call, int used, const Atoms<V> &at, const TriangleMasses<V> &m,
                                    Tally &tally) {
    Vector3<V> r[3];
    V t[3], y[3], left = Width<V>::all(1);
    read_all<where, 3>(call.r, at, r);
    const Triangle<V> x = triangle_of(call.box, r);
    triangle_rhs<where>(call, at, m, x.d, y);
    const TriangleInverse<V> inverse = invert_triangle(m, x);
    TriangleInverse<V>::solve(inverse, y, t);
    MaskOf<V> right = x.closed & finite(t[0] + (t[1] + t[2])) & inverse.is_ordinary();
    HOL_UNROLL
    for (int k = 0; k < 3; ++k) {  // terms a + p and p are at most 6 |a| in all if p <= 5/2 |a|
        const int l = (k + 1) % 3;
        left = min(mul_add(Width<V>::all(-0.4), m.s[l] * x.X, abs(inverse.adj[k][l])), left);
    }
    if (__builtin_expect(any(less(left, V{})), 0))
        right = right & bearable<V>(m, inverse, x.X, Vector3<V>{y[0], y[1], y[2]});
    const unsigned good = bits(Width<V>::first(used) & right);
    if (!good) return good;
    if (call.lambda) write_triangle_bonds<where>(at, t, Width<V>::all(0.5), call.lambda, good);
    if (call.tension) {
        const V T[3] = {t[0] * sqrt(x.q[0]), t[1] * sqrt(x.q[1]), t[2] * sqrt(x.q[2])};
        write_triangle_bonds<where>(at, T, Width<V>::all(1), call.tension, good);
    }
    if (call.virial) add_bonds_virial<3>(x.d, t, 1, good, tally);
    if (!call.g.x) return good;
    Vector3<V> g[3], before[3];
    HOL_UNROLL
    for (int i = 0; i < 3; ++i) g[i] = triangle_pull(x.d, t, i);
    if (call.add) {
        read_all<where, 3>(call.g, at, before);
        HOL_UNROLL
        for (int i = 0; i < 3; ++i) g[i] = before[i] + g[i];
    }
    write_all<where, 3>(call.g, at, g, good);
    return good;
}

// The velocity level: twice, as linear_level.hpp says.
template <Inlined where, class V>
HOL_INLINE unsigned project_triangles(const VelocitiesCall &call, int used, const Atoms<V> &at,
                                      const TriangleMasses<V> &m, Tally &tally) {
    Vector3<V> r[3], v[3];
    V t[3];
    read_all<where, 3>(call.r, at, r);
    read_all<where, 3>(call.v, at, v);
    const Triangle<V> x = triangle_of(call.box, r);
    const TriangleInverse<V> inverse = invert_triangle(m, x);
    V left[3];
    const auto measure = [&]() HOL_FORCED {  // the largest rate at which a bond changes
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) left[k] = dot(x.d[k], v[(k + 1) % 3] - v[k]);
        for (int k = 0; k < 3 && call.strain; ++k) left[k] = left[k] + stretching(call.strain, x.d[k]);
        return max(abs(left[0]), max(abs(left[1]), abs(left[2])));
    };
    const auto project = [&](MaskOf<V> which) HOL_FORCED {
        TriangleInverse<V>::solve(inverse, left, t);
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) t[k] = keep(which, t[k]);
        HOL_UNROLL
        for (int i = 0; i < 3; ++i) v[i] = add_times(v[i], m.w[i], triangle_pull(x.d, t, i));
    };
    const V before = measure();
    project(~Width<V>::none());
    const unsigned good = bits(Width<V>::first(used) & x.closed & finite(t[0] + (t[1] + t[2])) & inverse.is_ordinary());
    if (!good) return good;
    if (call.lambda) write_triangle_bonds<where>(at, t, Width<V>::all(0.5), call.lambda, good);
    if (call.virial) add_bonds_virial<3>(x.d, t, 1, good, tally);
    if (!call.v.is_float) {
        // In a nearly straight triangle the first solve may leave as much as there was. That is rounding, and the
        // second solve would only enlarge it.
        const V after = measure();
        project(less(after, 0.25 * before));
    }
    write_all<where, 3>(call.v, at, v, good);
    return good;
}

}  // namespace holonomic::HOL_ISA::graph
