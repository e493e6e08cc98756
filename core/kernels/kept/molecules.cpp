// Trees and rings in lanes, and triangles: their elimination kept, and solves with it.
#include "core/kernels/kept/trees.hpp"
#include "core/kernels/molecules/blocks.hpp"
#include "core/kernels/molecules/load.hpp"
#include "core/kernels/molecules/solve.hpp"
#include "core/kernels/molecules/star/linear.hpp"
#include "core/kernels/molecules/store.hpp"
#include "core/kernels/molecules/triangle/blocks.hpp"
#include "core/kernels/tally.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

using namespace graph;

bool is_kept(const EliminationPlan &s) {
    return s.way.given == Way::triangle || (!s.alone && (s.way.given == Way::tree || s.way.given == Way::ring));
}

static bool is_star(const EliminationPlan &s) { return s.way.forces == Way::star; }

static void leave(const MoleculeLane *lane, unsigned which, unsigned char *left) {
    for (; which; which &= which - 1) left[lane[__builtin_ctz(which)].molecule] = 1;
}

// Molecules that are kept, but one of whose bonds is cancelling, are solved in twice the precision. What it does not
// answer for is left.
HOL_NOINLINE void solve_extended(const KeptCall &call, const EliminationPlan &s, const MoleculeLane *lane,
                                 unsigned which, double *memory, Tally &tally) {
    for (; which; which &= which - 1) {
        const unsigned of = which & -which;
        Tally one = empty_tally();
        if (call.rhs)
            solve_flagged(
                SolveCall{call.r, call.g, call.rhs, call.lambda, call.tension, call.add, call.virial, call.box}, s,
                lane, of, memory, one);
        else
            solve_flagged(ForcesCall{call.r, call.v, call.f, call.g, call.lambda, call.tension, call.add, call.virial,
                                     call.box},
                          s, lane, of, memory, one);
        if (one.n_bad > 0)
            leave(lane, of, call.left);
        else
            add(tally, one);
    }
}

struct KeepTrees {
    const KeepCall &call;
    const EliminationPlan &elimination;

    template <class V>
    void block(const MoleculeLane *lane, int used, bool, double *scratch) const {
        typedef KeptTrees<V> Stored;
        double *const to = call.kept->room(call.kept->owner, lane[0].molecule, Stored::doubles(elimination));
        if (!to) return leave(lane, (1u << used) - 1, call.left);
        Memory<V> memory = {scratch};
        Linear<V> z(elimination, lane, used, true, call.box, call.r, memory);
        z.x.in = {};
        const unsigned good = load_and_solve(z, 0, false);
        Stored(elimination, to).keep(z, good);
        leave(lane, bits(z.x.in_use()) & ~good, call.left);
    }
};

// As for_each_block() goes through a unit. What the next block has in common with the last one is not found again.
struct SolveTrees {
    const KeptCall &call;
    const MoleculeUnit &unit;
    double *const scratch;
    Tally &tally;
    const EliminationPlan &s;
    const double per_cancelled2;

    SolveTrees(const KeptCall &c, const MoleculeUnit &u, double *memory, Tally &t)
        : call(c), unit(u), scratch(memory), tally(t), s(*u.elimination),
          per_cancelled2(1 / most_cancelled2(s.n_bonds)) {}

    void solve() const {
        MoleculeLane lane[W];
        int64_t first = 0;
        if (unit.count >= W) {
            Atoms<vec> at = atoms<vec>(lane, 0, W);
            for (;;) {
                block(at, lane, first, W);
                first += W;
                if (unit.count - first < W) break;
                if (unit.regular && at.layout == rows_in_order)
                    at.advance(s.n_atoms, s.n_bonds);
                else
                    at = atoms<vec>(lane, first, W);
            }
        }
        const int left = static_cast<int>(unit.count - first);
        if (left > 1) block(atoms<vec>(lane, first, left), lane, first, left);
        if (left == 1) block(atoms<double>(lane, first, 1), lane, first, 1);
    }

private:
    template <class V>
    Atoms<V> atoms(MoleculeLane *lane, int64_t first, int used) const {
        for (int i = 0; i < used; ++i) lane[i] = molecule_of(unit, first + i);
        return Atoms<V>(lane, used, true);
    }

    template <class V>
    inline HOL_FORCED void block(const Atoms<V> &at, MoleculeLane *lane, int64_t first, int used) const {
        const int64_t molecule = unit.regular ? unit.lanes[0].molecule + first : unit.lanes[first].molecule;
        double *const from = const_cast<double *>(call.kept->block[molecule]);
        if (!from) return;
        const KeptTrees<V> kept(s, from);
        Memory<V> memory = {scratch};
        const KeptTreesSolve<V> x(s, kept, memory, per_cancelled2);
        up(x, at, memory);
        Vector3<V> *const pull = memory.vectors(call.g.x ? s.n_atoms : 0);
        const unsigned in_use = (1u << used) - 1, kept_lanes = static_cast<unsigned>(from[0]);
        const Found found = call.g.x ? x.template down<true>(pull) : x.template down<false>(pull);
        unsigned good = kept_lanes & in_use & found.finite;
        if (__builtin_expect(found.n_doubtful > 0, 0)) {
            for (int i = 0; i < used; ++i) lane[i] = molecule_of(unit, first + i);
            const Box no_box = {};
            const Molecules<V> m = {s,          lane,    used,    at,      &no_box,
                                    nullptr,    kept.w,  nullptr, nullptr, Width<V>::all(1),
                                    {&call.v, &call.f, call.rhs, false}, per_cancelled2};
            good &= x.look_again(m, found.n_doubtful);
        }
        if (__builtin_expect(good != (in_use & kept_lanes), 0)) {
            for (int i = 0; i < used; ++i) lane[i] = molecule_of(unit, first + i);
            solve_extended(call, s, lane, in_use & kept_lanes & ~good, memory.next, tally);
        }
        if (call.lambda) write(x, at, call.lambda, good, [&](int32_t) HOL_FORCED { return Width<V>::all(0.5); });
        if (call.tension) write(x, at, call.tension, good, [&](int32_t k) HOL_FORCED { return sqrt(kept.bond[k].q); });
        if (call.virial) {
            MoleculesVirial<V> virial;
            for (int32_t k = 0; k < s.n_bonds; ++k) virial.add(kept.bond[k].d, x.value[k].t * kept.bond[k].d);
            virial.count(good, 1, tally);
        }
        if (call.g.x)
            write_vectors(call.g, at, s.slot_of, s.n_atoms, Slots<V>(pull), Written<V>{good, nullptr, nullptr, call.add});
    }
    template <class V>
    inline HOL_FORCED void up(const KeptTreesSolve<V> &x, const Atoms<V> &at, Memory<V> &memory) const {
        if (call.rhs) return up_given(x, call.rhs, at);
        const auto read = [&](const AtomArray &array) {
            Vector3<V> *const to = memory.vectors(array.x ? s.n_atoms : 0);
            if (array.x) read_vectors(array, at, s.slot_of, s.n_atoms, Slots<V>(to));
            return to;
        };
        const Vector3<V> *const v = read(call.v), *const f = read(call.f);
        choose([&](auto has_v, auto has_f) { up_forces<has_v, has_f>(x, v, f); }, call.v.x != nullptr,
               call.f.x != nullptr);
    }
    template <bool has_v, bool has_f, class V>
    static inline __attribute__((noinline)) void up_forces(const KeptTreesSolve<V> &x, const Vector3<V> *v, const Vector3<V> *f) {
        const KeptTreesSolve<V> y = x;
        y.up([&](int32_t place, int32_t from, int32_t to) HOL_FORCED {
            V b = {};
            if (has_v) {
                const Vector3<V> dv = v[to] - v[from];
                b = dot(dv, dv);
            }
            const V *const w = y.kept.w;
            return has_f ? Loader<V>::with_pull(y.kept.bond[place].d, w[from], f[from], w[to], f[to], b) : b;
        });
    }
    template <class V>
    static inline __attribute__((noinline)) void up_given(const KeptTreesSolve<V> &x, const double *given,
                                                          const Atoms<V> &at) {
        const KeptTreesSolve<V> y = x;
        const int32_t *const bond_of = y.s.bond_of;
        const double *rhs[Width<V>::lanes];
        for (int i = 0; i < Width<V>::lanes; ++i) rhs[i] = given + at.bond[i];
        const V half = Width<V>::all(0.5);
        y.up([&](int32_t place, int32_t, int32_t) HOL_FORCED {
            V b = {};
            HOL_UNROLL
            for (int i = 0; i < Width<V>::lanes; ++i) Width<V>::set(b, i, rhs[i][bond_of[place]]);
            return half * b;
        });
    }
    template <class V, class Factor>
    inline HOL_FORCED void write(const KeptTreesSolve<V> &x, const Atoms<V> &at, double *out, unsigned which,
                                 const Factor &factor) const {
        write_values<V>(s.bond_of, at.bond, out, which, 0, s.n_bonds,
                        [&](int32_t k) HOL_FORCED { return mul_add(x.value[k].t, factor(k), V{}); });
    }
};

// A kept star of three bonds.
template <class V>
struct KeptStar {
    double lanes[most_lanes];  // the first one, bit by bit
    V d[9], q[3], adj[6], r;
    void keep(const Star<V> &star, unsigned good) {
        lanes[0] = static_cast<double>(good);
        for (int k = 0, e = 0; k < 3; ++k) {
            put(*reinterpret_cast<Vector3<V> *>(d + 3 * k), star.d[k]);
            q[k] = star.q[k];
            for (int l = k; l < 3; ++l, ++e) adj[e] = star.adj[k][l];
        }
        r = star.r;
    }
    inline HOL_FORCED void take(Star<V> &star) const {
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) {
            star.d[k] = {d[3 * k], d[3 * k + 1], d[3 * k + 2]};
            star.q[k] = q[k];
            HOL_UNROLL
            for (int l = k; l < 3; ++l) star.adj[k][l] = star.adj[l][k] = adj[k == 0 ? l : k + l + 1];
        }
        star.r = r;
        star.margin = V{};
    }
};

struct KeepStars {
    static constexpr bool in_steps = false;
    template <int N, class V>
    using Kind = StarMasses<N, V>;
    const KeepCall &call;

    template <Inlined where, class V>
    __attribute__((noinline)) unsigned solve(const StarAtoms<where, 3, V> &atoms, const MoleculeLane *lane,
                                             const StarMasses<3, V> &m, MaskOf<V> in_use) const {
        typedef KeptStar<V> Stored;
        double *const room = call.kept->room(call.kept->owner, lane[0].molecule,
                                             static_cast<int64_t>(sizeof(Stored) / sizeof(double)));
        if (!room) return 0;
        Vector3<V> r[4];
        const V nothing[3] = {};
        Star<V> star(m);
        atoms.read(call.r, r);
        atoms.take_bonds(r, call.box, star.d);
        star.invert();
        const unsigned good = bits(in_use & star.good(nothing, nothing));
        reinterpret_cast<Stored *>(room)->keep(star, good);
        return good;
    }
};

struct SolveStars {
    static constexpr bool in_steps = false;
    template <int N, class V>
    using Kind = StarMasses<N, V>;
    const KeptCall &call;
    const ForcesCall forces;
    Tally &tally;

    template <Inlined where, class V>
    __attribute__((noinline)) unsigned solve(const StarAtoms<where, 3, V> &atoms, const MoleculeLane *lane,
                                             const StarMasses<3, V> &m, MaskOf<V> in_use) const {
        const double *const from = call.kept->block[lane[0].molecule];
        if (!from) return bits(in_use);  // they are left already
        const KeptStar<V> &kept = *reinterpret_cast<const KeptStar<V> *>(from);
        const StarForcesVerb verb = {forces, tally};
        Star<V> star(m);
        V y[3];
        kept.take(star);
        if (call.rhs) {
            HOL_UNROLL
            for (int k = 0; k < 3; ++k) {
                HOL_UNROLL
                for (int i = 0; i < Width<V>::lanes; ++i) Width<V>::set(y[k], i, call.rhs[atoms.at.bond[i] + k]);
                y[k] = Width<V>::all(0.5) * y[k];
            }
        } else {
            verb.find_sides(atoms, star, y);
        }
        const unsigned lanes = static_cast<unsigned>(kept.lanes[0]);
        return verb.finish(atoms, star, y, in_use & Width<V>::of_bits(lanes)) | (bits(in_use) & ~lanes);
    }
};

// Stars that closed forms don't answer for.
struct LeaveStars {
    unsigned char *const left;
    NextMolecules &ahead;
    static constexpr bool packed = true;
    template <class V>
    void block(const MoleculeLane *lane, int, bool, double *) const {
        leave(lane, 1, left);
    }
};
struct ExtendedStars {
    const KeptCall &call;
    const EliminationPlan &elimination;
    NextMolecules &ahead;
    Tally &tally;
    static constexpr bool packed = true;
    template <class V>
    void block(const MoleculeLane *lane, int, bool, double *scratch) const {
        solve_extended(call, elimination, lane, 1, scratch, tally);
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
    void solve_extended(const EliminationPlan &s, const MoleculeLane *lane, unsigned rest, double *scratch) const {
        HOL_ISA::solve_extended(call, s, lane, rest, scratch, tally);
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
        const TriangleCall sides = {call.g,      call.v,       call.f,   call.rhs,    call.g,
                                    call.lambda, call.tension, call.add, call.virial, no_box};
        triangle_sides<where>(sides, at, kind.masses, d, y);
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

void keep_molecules(const KeepCall &call, const MoleculeUnit &unit, double *scratch, Tally &) {
    if (unit.elimination->way.given == Way::triangle)
        return for_each_triangle(KeepTriangles(call), unit, true, scratch);
    NextMolecules ahead;
    if (is_star(*unit.elimination) &&
        do_stars<3>(KeepStars{call}, LeaveStars{call.left, ahead}, unit, scratch))
        return;
    KeepTrees work = {call, *unit.elimination};
    for_each_block(unit, scratch, ahead, work);
}

void solve_kept_molecules(const KeptCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    if (unit.elimination->way.given == Way::triangle)
        return for_each_triangle(SolveTriangles(call, tally), unit, true, scratch);
    NextMolecules ahead;
    const ForcesCall forces = {call.r,       call.v,   call.f,      call.g, call.lambda,
                               call.tension, call.add, call.virial, call.box};
    if (is_star(*unit.elimination) &&
        do_stars<3>(SolveStars{call, forces, tally}, ExtendedStars{call, *unit.elimination, ahead, tally}, unit, scratch))
        return;
    SolveTrees(call, unit, scratch, tally).solve();
}

}  // namespace holonomic::HOL_ISA
