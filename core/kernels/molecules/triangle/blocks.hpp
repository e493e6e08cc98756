// Goes through units of triangles, block by block, at each level.
#pragma once

#include "core/kernels/memory/parts.hpp"
#include "core/kernels/molecules/blocks.hpp"
#include "core/kernels/molecules/flagged.hpp"
#include "core/kernels/molecules/small/twin.hpp"
#include "core/kernels/molecules/triangle/linear.hpp"
#include "core/kernels/molecules/triangle/positions.hpp"

namespace holonomic::HOL_ISA::graph {

// The molecules of a block: given, or those of a unit from number `first` on.
struct TrianglesGiven {
    const MoleculeLane *lane;
    MoleculeLane get(int i) const { return lane[i]; }
    int64_t molecule(int i) const { return lane[i].molecule; }
};
struct TrianglesOfUnit {
    const MoleculeUnit &unit;
    int64_t first;
    MoleculeLane get(int i) const { return molecule_of(unit, first + i); }
    int64_t molecule(int i) const { return unit.lanes[0].molecule + first + i; }
};

// Masses and lengths of a block. The next block keeps them if it has the same.
template <class V>
struct TriangleKind {
    TriangleMasses<V> masses;
    TriangleLengths<V> lengths;
    void set(const MoleculeLane *lane, int used, bool with_lengths) {
        masses.set(lane, used);
        if (with_lengths) lengths.set(lane, used);
    }
};

template <class Verb>
struct TriangleWork {
    const Verb &verb;
    const EliminationPlan &elimination;
    const bool packed;
    TriangleKind<vec> known;
    TriangleKind<double> known_one;
    TriangleKind<vec> &kind_for(vec *) { return known; }
    TriangleKind<double> &kind_for(double *) { return known_one; }

    TriangleWork(const Verb &v, const EliminationPlan &s, bool is_packed)
        : verb(v), elimination(s), packed(is_packed) {}

    // Molecules for which closed forms won't do: the verb's other way, if it has one, and then extended arithmetic.
    template <class Lanes>
    HOL_NOINLINE void solve_rest(const TriangleWork &work, const Lanes &lanes, unsigned rest, double *scratch) {
        MoleculeLane lane[W];
        while (rest) {
            int used = 0;
            for (; rest && used < W; rest &= rest - 1) lane[used++] = lanes.get(__builtin_ctz(rest));
            TriangleKind<vec> kind;
            kind.set(lane, used, Verb::with_lengths);
            const unsigned all = (1u << used) - 1, left = all & ~work.again(lane, used, kind);
            if (left) work.verb.solve_extended(work.elimination, lane, left, scratch);
        }
    }
    unsigned again(const MoleculeLane *lane, int used, const TriangleKind<vec> &kind) const {
        return verb.again(TrianglesGiven{lane}, used, Atoms<vec>(lane, used, packed), kind);
    }

    // Apart from block(), so that what is done in registers has a function of its own.
    template <Inlined where, class V>
    HOL_NOINLINE unsigned solve(const TriangleWork &work, const MoleculeLane *lane, int used, const Atoms<V> &at,
                                const TriangleKind<V> &kind) {
        return work.verb.template solve<where>(TrianglesGiven{lane}, used, at, kind);
    }

    template <class V>
    void block(const MoleculeLane *lane, int used, bool same, double *scratch) {
        TriangleKind<V> &kind = kind_for(static_cast<V *>(nullptr));
        if (!same) kind.set(lane, used, Verb::with_lengths);
        const Atoms<V> at(lane, Width<V>::lanes, packed);
        unsigned rest = (1u << used) - 1;
        if (!verb.other_way())
            rest &= ~where_atoms_are(
                at, [&](auto where) { return solve<decltype(where)::value, V>(*this, lane, used, at, kind); });
        if (__builtin_expect(rest != 0, 0)) solve_rest(*this, TrianglesGiven{lane}, rest, scratch);
    }

    // Molecules of one kind, one behind the other, from number `first` on as long as there are enough of them for all
    // lanes of V; returns how many are done. where: adjacent or in_columns.
    template <Inlined where, class V>
    __attribute__((noinline)) int64_t run(const MoleculeUnit &unit, int64_t first, double *scratch) {
        constexpr int lanes = Width<V>::lanes;
        constexpr unsigned all = (1u << lanes) - 1;
        TrianglesOfUnit molecules = {unit, first};
        if (unit.count - first < lanes) return first;
        MoleculeLane lane[lanes];
        for (int i = 0; i < lanes; ++i) lane[i] = molecules.get(i);
        TriangleKind<V> kind;
        kind.set(lane, lanes, Verb::with_lengths);
        Atoms<V> at(lane, lanes, where == adjacent);
        for (; molecules.first + lanes <= unit.count; molecules.first += lanes) {
            const unsigned good = verb.template solve<where>(molecules, lanes, at, kind);
            if (__builtin_expect(good != all, 0)) solve_rest(*this, molecules, all & ~good, scratch);
            at.advance(3, 3);
        }
        return molecules.first;
    }
    template <Inlined where>
    int64_t run(const MoleculeUnit &unit, double *scratch) {
        if constexpr (small_set)
            return 0;
        else if constexpr (twins && Verb::in_steps)
            return run<where, Twin>(unit, 0, scratch);  // few are left
        else
            return run<where, vec>(unit, 0, scratch);
    }
};

// Whether triangles of a unit are read from columns where arrays are such.
HOL_INLINE bool reads_triangles_in_columns(const MoleculeUnit &unit) {
    return !small_set && !unit.tree_batches && unit.elimination->way.forces == Way::triangle && unit.regular &&
           !unit.lanes[0].atoms;
}

// Does molecules in parts, unless their arrays are read as they stand. blocks(call, unit, tally) does the blocks of
// either.
template <class Call, class Blocks>
static inline void molecules_in_parts(const Call &call, const MoleculeUnit &unit, Tally &tally, const Blocks &blocks) {
    if (call.r.packed || (reads_triangles_in_columns(unit) && reads_columns(call)) ||
        !in_packed_parts(call, unit, tally, blocks))
        blocks(call, unit, tally);
}

template <class Verb>
static inline void for_each_triangle(const Verb &verb, const MoleculeUnit &unit, bool packed, double *scratch,
                                     bool columns = false) {
    TriangleWork<Verb> work(verb, *unit.elimination, packed);
    const bool in_a_row = unit.regular && !unit.lanes[0].atoms && !verb.other_way();
    const int64_t done = !in_a_row ? 0
                         : packed  ? work.template run<adjacent>(unit, scratch)
                         : columns ? work.template run<in_columns>(unit, scratch)
                                   : 0;
    if (done == unit.count) return;
    const MoleculeLane next = molecule_of(unit, done);
    NextMolecules ahead;
    for_each_block(
        MoleculeUnit{unit.elimination, done > 0 ? &next : unit.lanes, unit.count - done, unit.regular, unit.large},
        scratch, ahead, work);
}

// What is done with a block of triangles. again(): for lanes that solve() does not answer for, and for all if
// other_way(). Both return the lanes that are done. solve_extended(): for those that are left.
struct OneWay {
    static constexpr bool with_lengths = false, in_steps = false;
    HOL_FORCED bool other_way() const { return false; }
    HOL_FORCED unsigned again(const TrianglesGiven &, int, const Atoms<vec> &, const TriangleKind<vec> &) const {
        return 0;
    }
};

// Of forces, or for given right-hand sides: one of the two is not nullptr.
struct TriangleLinearVerb : OneWay {
    const TriangleCall &call;
    const ForcesCall *forces;
    const SolveCall *given;
    Tally &tally;
    TriangleLinearVerb(const TriangleCall &c, const ForcesCall *f, const SolveCall *s, Tally &t)
        : call(c), forces(f), given(s), tally(t) {}
    void solve_extended(const EliminationPlan &elimination, const MoleculeLane *lane, unsigned rest,
                        double *scratch) const {
        forces ? solve_flagged(*forces, elimination, lane, rest, scratch, tally)
               : solve_flagged(*given, elimination, lane, rest, scratch, tally);
    }
    template <Inlined where, class V, class Lanes>
    inline HOL_FORCED unsigned solve(const Lanes &, int used, const Atoms<V> &at, const TriangleKind<V> &kind) const {
        return solve_triangles<where>(call, used, at, kind.masses, tally);
    }
};

struct TriangleVelocitiesVerb : OneWay {
    const VelocitiesCall &call;
    Tally &tally;
    TriangleVelocitiesVerb(const VelocitiesCall &c, Tally &t) : call(c), tally(t) {}
    void solve_extended(const EliminationPlan &elimination, const MoleculeLane *lane, unsigned rest,
                        double *scratch) const {
        solve_flagged(call, elimination, lane, rest, scratch, tally);
    }
    template <Inlined where, class V, class Lanes>
    inline HOL_FORCED unsigned solve(const Lanes &, int used, const Atoms<V> &at, const TriangleKind<V> &kind) const {
        return project_triangles<where>(call, used, at, kind.masses, tally);
    }
};

struct TrianglePositionsVerb {
    static constexpr bool with_lengths = true, in_steps = true;
    const PositionsCall &call;
    Tally &tally;
    void solve_extended(const EliminationPlan &elimination, const MoleculeLane *lane, unsigned rest,
                        double *scratch) const {
        solve_flagged(call, elimination, lane, rest, scratch, tally);
    }
    template <Inlined where, class V, class Lanes>
    inline HOL_FORCED unsigned solve(const Lanes &lanes, int used, const Atoms<V> &at,
                                     const TriangleKind<V> &kind) const {
        return TrianglePositions<where, V, Lanes>(call, lanes, at, kind.masses, kind.lengths, tally)
            .solve(Width<V>::first(used));
    }
    HOL_FORCED bool other_way() const { return call.guess; }
    unsigned again(const TrianglesGiven &lanes, int used, const Atoms<vec> &at, const TriangleKind<vec> &kind) const {
        return TrianglePositions<anywhere, vec, TrianglesGiven>(call, lanes, at, kind.masses, kind.lengths, tally)
            .solve_step_by_step((1u << used) - 1);
    }
};

}  // namespace holonomic::HOL_ISA::graph
