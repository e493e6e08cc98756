// Positions of triangles: Newton's method with the closed form of its matrix's inverse.
#ifndef HOLONOMIC_KERNELS_GRAPH_TRIANGLE_POSITIONS_HPP
#define HOLONOMIC_KERNELS_GRAPH_TRIANGLE_POSITIONS_HPP

#include "core/kernels/graph/iterate.hpp"
#include "core/kernels/graph/triangle_linear.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

template <class V>
struct TriangleLengths {
    V a2[3], per_a2[3], a_min, a_max;
    void set(const MoleculeLane *lane, int used, const Schedule &s) {
        a_min = Width<V>::all(1e300);
        a_max = V{};
        for (int k = 0; k < 3; ++k) {
            V a = {};
            for (int i = 0; i < Width<V>::lanes; ++i) Width<V>::set(a, i, lane[i < used ? i : 0].length[s.bond_of[k]]);
            a_min = min(a, a_min);
            a_max = max(a, a_max);
            a2[k] = a * a;
            per_a2[k] = Width<V>::all(1) / a2[k];
        }
    }
};

// The system that iterate() solves. Bond k changes by w_i (pull at its end) - w_j (pull at its start), i.e. by
// - (w_k + w_{k+1}) tau_k b_k + w_{k+1} tau_{k+1} b_{k+1} + w_k tau_{k-1} b_{k-1}.
template <class V>
struct TriangleNewton {
    const TriangleMasses<V> &m;
    const TriangleLengths<V> &a;
    Vector3<V> b[3], D[3], now[3];
    V tau[3], left[3];
    TriangleInverse<V> inverse;

    inline HOL_FORCED V measure() {
        V size[3];
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) {
            const Vector3<V> d = now[k];
            const V sigma = mul_add(d.z, d.z, mul_add(d.y, d.y, mul_add(d.x, d.x, -a.a2[k])));
            size[k] = abs(sigma) * a.per_a2[k];
            left[k] = 0.5 * sigma;
        }
        // max() may lose a NaN, the sum keeps it
        return mul_add(left[0] + (left[1] + left[2]), V{}, max(size[0], max(size[1], size[2])));
    }
    inline HOL_FORCED V open() {
        for (int k = 0; k < 3; ++k) now[k] = D[k];
        return measure();
    }
    inline HOL_FORCED void forget(MaskOf<V> which) {
        for (int k = 0; k < 3; ++k) tau[k] = select(which, V{}, tau[k]);
    }
    inline HOL_FORCED void factorize(MaskOf<V> which) {
        V g[3][3];
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) {
            HOL_UNROLL
            for (int l = 0; l < 3; ++l) g[k][l] = dot(now[k], b[l]);
        }
        const V X = dot(cross(now[1], now[2]), cross(b[1], b[2]));
        const TriangleInverse<V> fresh = invert_triangle<false>(m, g, X);
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) {
            HOL_UNROLL
            for (int l = 0; l < 3; ++l) inverse.e[k][l] = select(which, fresh.e[k][l], inverse.e[k][l]);
        }
    }
    inline HOL_FORCED void solve(MaskOf<V> active) {
        V change[3];
        TriangleInverse<V>::solve(inverse, left, change);
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) tau[k] = tau[k] + keep(active, change[k]);
    }
    inline HOL_FORCED V move() {
        Vector3<V> pull[3];
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) pull[k] = tau[k] * b[k];
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) {
            const int next = (k + 1) % 3, before = (k + 2) % 3;
            now[k] = add_times(add_times(add_times(D[k], -(m.w[k] + m.w[next]), pull[k]), m.w[next], pull[next]),
                               m.w[k], pull[before]);
        }
        return measure();
    }
    inline HOL_FORCED Vector3<V> moved(int i) const { return m.w[i] * triangle_pull(b, tau, i); }

    // Lanes in which pulls on an atom are so large that their rounding is more than the coordinates'.
    MaskOf<V> coarse_moves(V largest_coordinate) const {
        const V p0 = max(m.w[0], m.w[1]) * abs(tau[0]), p1 = max(m.w[1], m.w[2]) * abs(tau[1]),
                p2 = max(m.w[2], m.w[0]) * abs(tau[2]);
        return less(0.25 * (largest_coordinate + a.a_min), max(p0, max(p1, p2)) * a.a_max);
    }
};

// The worst bond of the molecules in `which`, from the errors of all: of a molecule the one with the smallest number.
template <class V>
HOL_NOINLINE void note_worst_triangle(const V *size, const Schedule &s, const MoleculeLane *lane, V error,
                                      unsigned which, Tally &tally) {
    for (int i = 0; i < Width<V>::lanes; ++i) {
        if (!(which >> i & 1)) continue;
        const double e = Width<V>::get(error, i);
        if (!(e > tally.worst || tally.worst_chain < 0 || (e == tally.worst && lane[i].molecule < tally.worst_chain)))
            continue;
        tally.worst = e;
        tally.worst_chain = lane[i].molecule;
        tally.worst_bond = 3;
        for (int k = 0; k < 3; ++k)
            if (Width<V>::get(size[k], i) >= e && s.bond_of[k] < tally.worst_bond) tally.worst_bond = s.bond_of[k];
        if (tally.worst_bond == 3) tally.worst_bond = 0;
    }
}

template <Layout layout, class V>
static inline unsigned move_triangles(const PositionsCall &call, const Schedule &s, const MoleculeLane *lane, int used,
                                      const Atoms<V> &at, const TriangleMasses<V> &m, const TriangleLengths<V> &a,
                                      Tally &tally) {
    Vector3<V> r[3];
    TriangleNewton<V> x = {m, a, {}, {}, {}, {}, {}, {}};
    read_triangle<layout>(call.r_ref, at, s, r);
    for (int k = 0; k < 3; ++k) {
        Vector3<V> unused = {};
        x.b[k] = r[(k + 1) % 3] - r[k];
        take_image<false>(call.box_ref, x.b[k], unused);
    }
    read_triangle<layout>(call.r, at, s, r);
    V size[3];
    for (int k = 0; k < 3; ++k) {
        Vector3<V> unused = {};
        x.D[k] = r[(k + 1) % 3] - r[k];
        take_image<false>(call.box, x.D[k], unused);
        size[k] = max(max(abs(r[k].x), abs(r[k].y)), abs(r[k].z));
    }
    const V largest = max(size[0], max(size[1], size[2]));
    if (call.guess)
        for (int k = 0; k < 3; ++k)
            for (int i = 0; i < Width<V>::lanes; ++i)
                Width<V>::set(x.tau[k], i, 2 * call.dt * call.dt * call.lambda[lane[i].first_bond + s.bond_of[k]]);
    const Limits<V> limits(call, largest, a.a_min);
    const Solved<V> out = iterate<V>(x, limits, call, Width<V>::first(used));
    const unsigned moved = bits(out.converged & ~x.coarse_moves(largest)), good = moved | bits(out.untouched);
    if (call.report) {
        V left[3];
        for (int k = 0; k < 3; ++k) left[k] = abs(2.0 * x.left[k]) * x.a.per_a2[k];
        note_worst_triangle(left, s, lane, out.error, good, tally);
    }
    if (call.lambda) write_triangle_bonds(lane, s, x.tau, Width<V>::all(0.5 / (call.dt * call.dt)), call.lambda, good);
    if (!moved) return good;
    if (call.virial) add_triangle_virial(x.b, x.tau, 1 / (call.dt * call.dt), moved, tally);
    const V per_dt = Width<V>::all(1 / call.dt);
    HOL_UNROLL
    for (int i = 0; i < 3; ++i) {
        const Vector3<V> move = x.moved(i);
        const int32_t atom = s.atom_of[i];
        write<layout>(call.r, at, atom, r[i] + move, moved);
        if (call.v.x) write<layout>(call.v, at, atom, add_times(read<layout>(call.v, at, atom), per_dt, move), moved);
    }
    tally.n_corrected += __builtin_popcount(moved);
    if (out.solves > tally.iterations) tally.iterations = out.solves;
    return good;
}

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
