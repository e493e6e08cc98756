// Trees and rings in lanes, and triangles: their elimination kept, and solves with it.
#include "core/kernels/molecules/blocks.hpp"
#include "core/kernels/molecules/load.hpp"
#include "core/kernels/molecules/solve.hpp"
#include "core/kernels/molecules/store.hpp"
#include "core/kernels/molecules/triangle/blocks.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

using namespace graph;

bool is_kept(const EliminationPlan &s) {
    return s.way.given == Way::triangle || (!s.alone && (s.way.given == Way::tree || s.way.given == Way::ring));
}

static void leave(const MoleculeLane *lane, unsigned which, unsigned char *left) {
    for (; which; which &= which - 1) left[lane[__builtin_ctz(which)].molecule] = 1;
}

// A kept block of trees: which lanes are kept in its first values, then the factors.
template <class V>
static inline V *factors_in(double *block) {
    return reinterpret_cast<V *>(block + most_lanes);
}

struct KeepTrees {
    const KeepCall &call;
    const EliminationPlan &elimination;

    template <class V>
    void block(const MoleculeLane *lane, int used, bool, double *scratch) const {
        Memory<V> memory = {scratch};
        Linear<V> z(elimination, lane, used, true, call.box, call.r, memory);
        const int64_t n = z.n_factors();
        double *const to = call.kept->room(call.kept->owner, lane[0].molecule, most_lanes + n * Width<V>::lanes);
        if (!to) return leave(lane, (1u << used) - 1, call.left);
        z.x.in = {};
        const unsigned good = load_and_solve(z, 0, false);
        to[0] = static_cast<double>(good);
        const V *const from = z.factors();
        for (int64_t i = 0; i < n; ++i) factors_in<V>(to)[i] = from[i];
        leave(lane, bits(z.x.in_use()) & ~good, call.left);
    }
};

struct SolveTrees {
    const KeptCall &call;
    const EliminationPlan &elimination;
    Tally &tally;

    template <class V>
    void block(const MoleculeLane *lane, int used, bool, double *scratch) const {
        const double *const from = call.kept->block[lane[0].molecule];
        if (!from) return;
        Memory<V> memory = {scratch};
        const Box no_box = {};
        Linear<V> z(elimination, lane, used, true, no_box, call.g, memory);
        const V *const kept = factors_in<V>(const_cast<double *>(from));
        __builtin_memcpy(z.factors(), kept, static_cast<unsigned long>(z.n_factors()) * sizeof(V));
        z.x.margin = Width<V>::all(1);
        const unsigned good = static_cast<unsigned>(from[0]) & solve_kept(z, call.v, call.f, call.rhs);
        leave(lane, bits(z.x.in_use()) & ~good, call.left);
        if (call.lambda) write_bonds<false>(z.x, 0.5, call.lambda, good);
        if (call.tension) write_bonds<true>(z.x, 1, call.tension, good);
        if (call.virial) add_pulls_to_virial(z.x, good, tally);
        if (call.g.x)
            write_vectors(call.g, z.x.at, elimination.slot_of, elimination.n_atoms, Slots<V>(z.pulls()),
                          Written<V>{good, nullptr, z.x.lane, call.add});
    }
};

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
    void solve_extended(const EliminationPlan &, const MoleculeLane *lane, unsigned rest, double *) const {
        leave(lane, rest, call.left);
    }
    template <Inlined where, class V, class Lanes>
    inline HOL_FORCED unsigned solve(const Lanes &lanes, int used, const Atoms<V> &at,
                                     const TriangleKind<V> &kind) const {
        const double *const from = call.kept->block[lanes.molecule(0)];
        if (!from) return 0;
        const KeptTriangle<V> &kept = *reinterpret_cast<const KeptTriangle<V> *>(from);
        Vector3<V> d[3];
        for (int k = 0; k < 3; ++k) d[k] = {kept.d[3 * k], kept.d[3 * k + 1], kept.d[3 * k + 2]};
        V t[3], y[3];
        const Box no_box = {};
        const TriangleCall sides = {call.g,      call.v,       call.f,   call.rhs,    call.g,
                                    call.lambda, call.tension, call.add, call.virial, no_box};
        triangle_sides<where>(sides, at, kind.masses, d, y);
        TriangleInverse<V>::solve(kept.inverse(), y, t);
        const unsigned good =
            bits(Width<V>::first(used) & finite(t[0] + (t[1] + t[2]))) & static_cast<unsigned>(kept.lanes[0]);
        if (!good) return good;
        if (call.lambda) write_triangle_bonds<where>(at, t, Width<V>::all(0.5), call.lambda, good);
        if (call.tension) {
            V T[3];
            for (int k = 0; k < 3; ++k) T[k] = t[k] * sqrt(dot(d[k], d[k]));
            write_triangle_bonds<where>(at, T, Width<V>::all(1), call.tension, good);
        }
        if (call.virial) add_bonds_virial<3>(d, t, 1, good, tally);
        if (!call.g.x) return good;
        Vector3<V> g[3], before[3];
        for (int i = 0; i < 3; ++i) g[i] = triangle_pull(d, t, i);
        if (call.add) {
            read_all<where, 3>(call.g, at, before);
            for (int i = 0; i < 3; ++i) g[i] = before[i] + g[i];
        }
        write_all<where, 3>(call.g, at, g, good);
        return good;
    }
};

void keep_molecules(const KeepCall &call, const MoleculeUnit &unit, double *scratch, Tally &) {
    if (unit.elimination->way.given == Way::triangle)
        return for_each_triangle(KeepTriangles(call), unit, true, scratch);
    NextMolecules ahead;
    KeepTrees work = {call, *unit.elimination};
    for_each_block(unit, scratch, ahead, work);
}

void solve_kept_molecules(const KeptCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    if (unit.elimination->way.given == Way::triangle)
        return for_each_triangle(SolveTriangles(call, tally), unit, true, scratch);
    NextMolecules ahead;
    SolveTrees work = {call, *unit.elimination, tally};
    for_each_block(unit, scratch, ahead, work);
}

}  // namespace holonomic::HOL_ISA
