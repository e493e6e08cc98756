// Kept factors of rigid water and other triangles, in registers: bonds and the inverse of theory (56) are kept.
// triangle/linear.hpp has the equations and the test that plain products will do.
#pragma once

#include "core/kernels/kept/flagged.hpp"
#include "core/kernels/molecules/triangle/blocks.hpp"

namespace holonomic::HOL_ISA::graph {

// A kept triangle: bonds, inverse, and which lanes are kept.
template <class V>
struct KeptTriangle {
    double lanes[most_lanes];  // the first one, bit by bit
    V d[9], adj[6], r;
    TriangleInverse<V> inverse() const {
        TriangleInverse<V> m;
        for (int k = 0, e = 0; k < 3; ++k)
            for (int l = k; l < 3; ++l, ++e) m.adj[k][l] = m.adj[l][k] = adj[e];
        m.r = r;
        return m;
    }
};

struct KeepTriangles : OneWay {
    const KeepCall &call;
    explicit KeepTriangles(const KeepCall &c) : call(c) {}
    void solve_extended(const EliminationPlan &, const MoleculeLane *lane, unsigned rest, double *) const {
        leave(lane, rest, call.left);
    }
    template <Inlined where, class V, class Lanes>
    inline HOL_FORCED unsigned solve(const Lanes &lanes, int used, const Atoms<V> &at,
                                     const TriangleKind<V> &kind) const {
        typedef KeptTriangle<V> Stored;
        double *const room =
            call.kept->room(call.kept->owner, lanes.molecule(0), static_cast<int64_t>(sizeof(Stored) / sizeof(double)));
        if (!room) return 0;
        Stored &to = *reinterpret_cast<Stored *>(room);
        Vector3<V> r[3];
        read_all<where, 3>(call.r, at, r);
        const Triangle<V> x = triangle_of(call.box, r);
        const TriangleInverse<V> m = invert_triangle(kind.masses, x);
        V left = Width<V>::all(1);  // as in solve_triangles()
        for (int k = 0; k < 3; ++k) {
            const int l = (k + 1) % 3;
            left = min(mul_add(Width<V>::all(-0.4), kind.masses.s[l] * x.X, abs(m.adj[k][l])), left);
        }
        for (int k = 0, e = 0; k < 3; ++k) {
            put(*reinterpret_cast<Vector3<V> *>(to.d + 3 * k), x.d[k]);
            for (int l = k; l < 3; ++l, ++e) to.adj[e] = m.adj[k][l];
        }
        to.r = m.r;
        const unsigned good = bits(Width<V>::first(used) & x.closed & m.is_ordinary() & less_equal(V{}, left));
        to.lanes[0] = static_cast<double>(good);
        return good;
    }
};

struct SolveTriangles : OneWay {
    const KeptCall &call;
    Tally &tally;
    SolveTriangles(const KeptCall &c, Tally &t) : call(c), tally(t) {}
    void solve_extended(const EliminationPlan &s, const MoleculeLane *lane, unsigned rest, double *scratch) const {
        graph::solve_extended(call, s, lane, rest, scratch, tally);
    }
    template <Inlined where, class V, class Lanes>
    inline HOL_FORCED unsigned solve(const Lanes &lanes, int used, const Atoms<V> &at,
                                     const TriangleKind<V> &kind) const {
        const double *const from = call.kept->block[lanes.molecule(0)];
        if (!from) return (1u << used) - 1;  // they are left already
        const KeptTriangle<V> &kept = *reinterpret_cast<const KeptTriangle<V> *>(from);
        Vector3<V> d[3];
        for (int k = 0; k < 3; ++k) d[k] = {kept.d[3 * k], kept.d[3 * k + 1], kept.d[3 * k + 2]};
        V t[3], y[3];
        const Box no_box = {};
        const TriangleCall rhs = {call.g,      call.v,       call.f,   call.rhs,    call.g,
                                  call.lambda, call.tension, call.add, call.virial, no_box};
        triangle_rhs<where>(rhs, at, kind.masses, d, y);
        TriangleInverse<V>::solve(kept.inverse(), y, t);
        const unsigned of_kept = static_cast<unsigned>(kept.lanes[0]), others = ((1u << used) - 1) & ~of_kept,
                       good = bits(Width<V>::first(used) & finite(t[0] + (t[1] + t[2]))) & of_kept;
        if (!good) return others;
        if (call.lambda) write_triangle_bonds<where>(at, t, Width<V>::all(0.5), call.lambda, good);
        if (call.tension) {
            V T[3];
            for (int k = 0; k < 3; ++k) T[k] = t[k] * sqrt(dot(d[k], d[k]));
            write_triangle_bonds<where>(at, T, Width<V>::all(1), call.tension, good);
        }
        if (call.virial) add_bonds_virial<3>(d, t, 1, good, tally);
        if (!call.g.x) return good | others;
        Vector3<V> g[3], before[3];
        for (int i = 0; i < 3; ++i) g[i] = triangle_pull(d, t, i);
        if (call.add) {
            read_all<where, 3>(call.g, at, before);
            for (int i = 0; i < 3; ++i) g[i] = before[i] + g[i];
        }
        write_all<where, 3>(call.g, at, g, good);
        return good | others;
    }
};

}  // namespace holonomic::HOL_ISA::graph
