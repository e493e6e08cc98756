// Kept factors of trees, rings, stars and triangles in lanes, of molecules by sparse LDL^T, and of networks: the
// elimination of forces is kept, and right-hand sides are solved for with it. Blocks that are flagged keep nothing, and
// go the ordinary way (flagged.hpp).
#include "core/kernels/kept/ldl.hpp"
#include "core/kernels/kept/stars.hpp"
#include "core/kernels/kept/tree_scales.hpp"
#include "core/kernels/kept/triangles.hpp"
#include "core/kernels/molecules/blocks.hpp"
#include "core/kernels/molecules/network/verbs.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

using namespace graph;

bool is_kept(const EliminationPlan &s) {
    return s.way.given == Way::triangle || list_of_kept(s) || s.way.given == Way::ring || s.way.given == Way::network ||
           (!s.alone && s.way.given == Way::tree);
}

int64_t kept_scratch_bytes(const EliminationPlan &s) {
    if (!s.late_ldl) return 0;
    return LdlLinear<double>::values(*s.late_ldl) * static_cast<int64_t>(sizeof(double)) + 64 + s.extended_bytes;
}

// Stars whose closed forms are compiled; others are kept as trees.
static int star_bonds(const EliminationPlan &s) { return !small_set && s.way.forces == Way::star ? s.n_bonds : 0; }

struct KeepTrees {
    const KeepCall &call;
    const EliminationPlan &elimination;

    template <class V>
    void block(const MoleculeLane *lane, int used, bool, double *scratch) const {
        typedef KeptTrees<V> Stored;
        double *const to = call.kept->room(call.kept->owner, lane[0].molecule, Stored::doubles(elimination));
        if (!to) return leave(lane, (1u << used) - 1, call.left);
        Memory<V> memory = {scratch};
        TreeLinear<V> z(elimination, lane, used, true, call.box, call.r, memory);
        z.x.in = {};
        const unsigned good = load_and_solve(z, 0, false);
        Stored(elimination, to).keep(z, good);
        leave(lane, bits(z.x.in_use()) & ~good, call.left);
    }
};

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
        for_each_kept_block(unit,
                            [&](const auto &at, int64_t first, int used) HOL_FORCED { this->block(at, first, used); });
    }

private:
    template <class V>
    inline HOL_FORCED void block(const Atoms<V> &at, int64_t first, int used) const {
        double *const from = const_cast<double *>(call.kept->block[number_of(unit, first)]);
        if (!from) return;
        const KeptTrees<V> kept(s, from);
        Memory<V> memory = {scratch};
        const KeptTreesSolve<V> x(s, kept, memory, per_cancelled2);
        up(x, at, memory);
        Vector3<V> *const pull = memory.vectors(call.g.x ? s.n_atoms : 0);
        const unsigned in_use = (1u << used) - 1, kept_lanes = static_cast<unsigned>(from[0]);
        const Found found = call.g.x ? x.template down<true>(pull) : x.template down<false>(pull);
        unsigned good = kept_lanes & in_use & found.finite;
        MoleculeLane lane[Width<V>::lanes];
        if (__builtin_expect(found.n_flagged > 0, 0)) {
            for (int i = 0; i < used; ++i) lane[i] = molecule_of(unit, first + i);
            const Box no_box = {};
            const Molecules<V> m = {s,
                                    lane,
                                    used,
                                    at,
                                    &no_box,
                                    nullptr,
                                    kept.w,
                                    nullptr,
                                    nullptr,
                                    Width<V>::all(1),
                                    {&call.v, &call.f, call.rhs, false},
                                    per_cancelled2};
            good &= look_again(x, m, found.n_flagged, memory);
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
            write_vectors(call.g, at, s.index_of, s.n_atoms, ByIndex<V>(pull),
                          Written<V>{good, nullptr, nullptr, call.add});
    }
    template <class V>
    inline HOL_FORCED void up(const KeptTreesSolve<V> &x, const Atoms<V> &at, Memory<V> &memory) const {
        if (call.rhs) return up_given(x, call.rhs, at);
        const auto read = [&](const AtomArray &array) {
            Vector3<V> *const to = memory.vectors(array.x ? s.n_atoms : 0);
            if (array.x) read_vectors(array, at, s.index_of, s.n_atoms, ByIndex<V>(to));
            return to;
        };
        const Vector3<V> *const v = read(call.v), *const f = read(call.f);
        choose([&](auto has_v, auto has_f) { up_forces<has_v, has_f>(x, v, f); }, call.v.x != nullptr,
               call.f.x != nullptr);
    }
    template <bool has_v, bool has_f, class V>
    static inline __attribute__((noinline)) void up_forces(const KeptTreesSolve<V> &x, const Vector3<V> *v,
                                                           const Vector3<V> *f) {
        const KeptTreesSolve<V> y = x;
        y.up([&](int32_t bond_index, int32_t from, int32_t to) HOL_FORCED {
            V b = {};
            if (has_v) {
                const Vector3<V> dv = v[to] - v[from];
                b = dot(dv, dv);
            }
            const V *const w = y.kept.w;
            return has_f ? Loader<V>::with_pull(y.kept.bond[bond_index].d, w[from], f[from], w[to], f[to], b) : b;
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
        y.up([&](int32_t bond_index, int32_t, int32_t) HOL_FORCED {
            V b = {};
            HOL_UNROLL
            for (int i = 0; i < Width<V>::lanes; ++i) Width<V>::set(b, i, rhs[i][bond_of[bond_index]]);
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

static void keep_networks(const KeepCall &call, const MoleculeUnit &unit, double *scratch) {
    for (int64_t i = 0; i < unit.count; ++i) {
        const MoleculeLane lane = molecule_of(unit, i);
        if (!HOL_NETWORKS::keep_network(call, *unit.elimination, lane, unit.team, scratch)) leave(&lane, 1, call.left);
    }
}

void keep_molecules(const KeepCall &call, const MoleculeUnit &unit, double *scratch, Tally &) {
    if (unit.elimination->way.given == Way::triangle)
        return for_each_triangle(KeepTriangles(call), unit, true, scratch);
    if (unit.elimination->way.given == Way::network) return keep_networks(call, unit, scratch);
    NextMolecules ahead;
    if (const LdlPlan *const list = list_of_kept(*unit.elimination)) {
        KeepByLdl work = {call, unit, *list};
        return for_each_block(unit, scratch, ahead, work);
    }
    const LeaveStars rest = {call.left, ahead};
    if (star_bonds(*unit.elimination) == 3 && do_stars<3>(KeepStars<3>{call}, rest, unit, scratch)) return;
    if (star_bonds(*unit.elimination) == 4 && do_stars<4>(KeepStars<4>{call}, rest, unit, scratch)) return;
    KeepTrees work = {call, *unit.elimination};
    for_each_block(unit, scratch, ahead, work);
}

static void solve_kept_networks(const KeptCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    for (int64_t i = 0; i < unit.count; ++i) {
        const MoleculeLane lane = molecule_of(unit, i);
        if (!HOL_NETWORKS::solve_kept_network(call, *unit.elimination, lane, unit.team, scratch, tally))
            leave(&lane, 1, call.left);
    }
}

static void solve_kept_molecules(const KeptCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    if (unit.elimination->way.given == Way::triangle)
        return for_each_triangle(SolveTriangles(call, tally), unit, true, scratch);
    if (unit.elimination->way.given == Way::network) return solve_kept_networks(call, unit, scratch, tally);
    const int bonds_of_star = star_bonds(*unit.elimination);
    if (bonds_of_star == 3) return SolveStars<3>{call, unit, scratch, tally}.solve();
    if (bonds_of_star == 4) return SolveStars<4>{call, unit, scratch, tally}.solve();
    SolveTrees(call, unit, scratch, tally).solve();
}

void solve_kept_molecules(const KeptCall *calls, int n, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    if (const LdlPlan *const list = list_of_kept(*unit.elimination)) {
        NextMolecules ahead;
        SolveByLdl work = {calls, n, unit, *list, tally};
        return for_each_block(unit, scratch, ahead, work);
    }
    for (int i = 0; i < n; ++i) solve_kept_molecules(calls[i], unit, scratch, tally);
}

}  // namespace holonomic::HOL_ISA
