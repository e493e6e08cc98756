// Goes through units of triangles, block by block, at each level.
#ifndef HOLONOMIC_KERNELS_GRAPH_TRIANGLE_BLOCKS_HPP
#define HOLONOMIC_KERNELS_GRAPH_TRIANGLE_BLOCKS_HPP

#include "core/kernels/graph/blocks.hpp"
#include "core/kernels/graph/doubtful.hpp"
#include "core/kernels/graph/triangle_linear.hpp"
#include "core/kernels/graph/triangle_positions.hpp"
#include "core/kernels/graph/twin.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

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

template <class Verb, class Call>
struct TriangleWork {
    const Verb &verb;
    const Call &call;
    const Schedule &schedule;
    const bool packed;
    Tally &tally;
    TriangleKind<vec> known;
    TriangleKind<double> known_one;
    TriangleKind<vec> &kind_for(vec *) { return known; }
    TriangleKind<double> &kind_for(double *) { return known_one; }

    TriangleWork(const Verb &v, const Call &c, const Schedule &s, bool is_packed, Tally &t)
        : verb(v), call(c), schedule(s), packed(is_packed), tally(t) {}

    template <class Lanes>
    HOL_NOINLINE void solve_carefully(const TriangleWork &work, const Lanes &lanes, unsigned rest, double *scratch) {
        MoleculeLane lane[2 * W];
        for (int i = 0; i < 2 * W; ++i)
            if (rest >> i & 1) lane[i] = lanes.get(i);
        solve_doubtful(work.call, work.schedule, lane, rest, scratch, work.tally);
    }

    // Apart from block(), which then has one call for each layout.
    template <Layout layout, class V, class Lanes>
    HOL_NOINLINE unsigned solve(const TriangleWork &work, const Lanes &lanes, int used, const Atoms<V> &at,
                                const TriangleKind<V> &kind) {
        return work.verb.template solve<layout>(lanes, used, at, kind);
    }

    template <class V>
    void block(const MoleculeLane *lane, int used, bool same, double *scratch) {
        TriangleKind<V> &kind = kind_for(static_cast<V *>(nullptr));
        if (!same) kind.set(lane, used, Verb::with_lengths);
        const Atoms<V> at(lane, Width<V>::lanes);
        const TrianglesGiven lanes = {lane};
        const unsigned good = with_layout(
            at, packed, [&](auto layout) { return solve<decltype(layout)::value>(*this, lanes, used, at, kind); });
        const unsigned rest = bits(Width<V>::first(used)) & ~good;
        if (__builtin_expect(rest != 0, 0)) solve_carefully(*this, lanes, rest, scratch);
    }

    // Molecules of one kind, one behind the other, from number `first` on as long as there are enough of them for all
    // lanes of V; returns how many are done.
    template <class V>
    __attribute__((noinline)) int64_t run(const MoleculeUnit &unit, int64_t first, double *scratch) {
        constexpr int lanes = Width<V>::lanes;
        constexpr unsigned all = (1u << lanes) - 1;
        TrianglesOfUnit molecules = {unit, first};
        if (unit.count - first < lanes) return first;
        MoleculeLane lane[lanes];
        for (int i = 0; i < lanes; ++i) lane[i] = molecules.get(i);
        TriangleKind<V> kind;
        kind.set(lane, lanes, Verb::with_lengths);
        Atoms<V> at(lane, lanes);
        for (; molecules.first + lanes <= unit.count; molecules.first += lanes) {
            const unsigned good = verb.template solve<rows_adjacent>(molecules, lanes, at, kind);
            if (__builtin_expect(good != all, 0)) solve_carefully(*this, molecules, all & ~good, scratch);
            at.advance(3, 3);
        }
        return molecules.first;
    }
    int64_t run(const MoleculeUnit &unit, double *scratch) {
        int64_t done = 0;
        if constexpr (twins && Verb::in_steps) done = run<Twin>(unit, 0, scratch);
        return run<vec>(unit, done, scratch);
    }
};

template <class Verb, class Call>
static inline void for_each_triangle(const Verb &verb, const Call &call, const MoleculeUnit &unit, bool packed,
                                     double *scratch, Tally &tally) {
    TriangleWork<Verb, Call> work(verb, call, *unit.schedule, packed, tally);
    const int64_t done = unit.regular && packed && !unit.lanes[0].atoms ? work.run(unit, scratch) : 0;
    if (done == unit.count) return;
    const MoleculeLane next = molecule_of(unit, done);
    for_each_block(
        MoleculeUnit{unit.schedule, done > 0 ? &next : unit.lanes, unit.count - done, unit.regular, unit.large},
        scratch, work);
}

struct TriangleLinearVerb {
    static constexpr bool with_lengths = false, in_steps = false;
    const TriangleCall &call;
    Tally &tally;
    template <Layout layout, class V, class Lanes>
    inline HOL_FORCED unsigned solve(const Lanes &, int used, const Atoms<V> &at, const TriangleKind<V> &kind) const {
        return solve_triangles<layout>(call, used, at, kind.masses, tally);
    }
};

struct TriangleVelocitiesVerb {
    static constexpr bool with_lengths = false, in_steps = false;
    const VelocitiesCall &call;
    Tally &tally;
    template <Layout layout, class V, class Lanes>
    inline HOL_FORCED unsigned solve(const Lanes &, int used, const Atoms<V> &at, const TriangleKind<V> &kind) const {
        return project_triangles<layout>(call, used, at, kind.masses, tally);
    }
};

struct TrianglePositionsVerb {
    static constexpr bool with_lengths = true, in_steps = true;
    const PositionsCall &call;
    Tally &tally;
    template <Layout layout, class V, class Lanes>
    inline HOL_FORCED unsigned solve(const Lanes &lanes, int used, const Atoms<V> &at,
                                     const TriangleKind<V> &kind) const {
        return move_triangles<layout>(call, lanes, used, at, kind.masses, kind.lengths, tally);
    }
};

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
