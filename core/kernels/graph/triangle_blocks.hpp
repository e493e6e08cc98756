// Units of triangles, a block after the other, at each level.
#ifndef HOLONOMIC_KERNELS_GRAPH_TRIANGLE_BLOCKS_HPP
#define HOLONOMIC_KERNELS_GRAPH_TRIANGLE_BLOCKS_HPP

#include "core/kernels/graph/blocks.hpp"
#include "core/kernels/graph/doubtful.hpp"
#include "core/kernels/graph/triangle_linear.hpp"
#include "core/kernels/graph/triangle_positions.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

// The masses of a block, kept for the next one where that has the same.
struct KnownTriangles {
    TriangleMasses<vec> masses;
    TriangleMasses<double> masses_of_one;
    TriangleLengths<vec> lengths;
    TriangleLengths<double> lengths_of_one;
    TriangleMasses<vec> &masses_for(vec *) { return masses; }
    TriangleMasses<double> &masses_for(double *) { return masses_of_one; }
    TriangleLengths<vec> &lengths_for(vec *) { return lengths; }
    TriangleLengths<double> &lengths_for(double *) { return lengths_of_one; }
};

template <class Verb, class Call>
struct TriangleWork {
    const Verb &verb;
    const Call &call;
    const Schedule &schedule;
    const bool packed;
    Tally &tally;
    KnownTriangles known;

    template <class V>
    void block(const MoleculeLane *lane, int used, bool same, double *scratch) {
        TriangleMasses<V> &masses = known.masses_for(static_cast<V *>(nullptr));
        if (!same) {
            masses.set(lane, used);
            if (Verb::with_lengths) known.lengths_for(static_cast<V *>(nullptr)).set(lane, used);
        }
        const Atoms<V> at(lane, Width<V>::lanes);
        const TriangleLengths<V> &lengths = known.lengths_for(static_cast<V *>(nullptr));
        unsigned good;
        switch (layout_of(at, packed)) {
            case rows_in_order:
                good = verb.template solve<rows_in_order, V>(lane, used, at, masses, lengths);
                break;
            case rows_listed:
                good = verb.template solve<rows_listed, V>(lane, used, at, masses, lengths);
                break;
            default:
                good = verb.template solve<elements, V>(lane, used, at, masses, lengths);
        }
        const unsigned rest = bits(Width<V>::first(used)) & ~good;
        if (__builtin_expect(rest != 0, 0)) solve_doubtful(call, schedule, lane, rest, scratch, tally);
    }
};

template <class Verb, class Call>
static inline void for_each_triangle(const Verb &verb, const Call &call, const MoleculeUnit &unit, bool packed,
                                     double *scratch, Tally &tally) {
    TriangleWork<Verb, Call> work = {verb, call, *unit.schedule, packed, tally, {}};
    for_each_block(unit, scratch, work);
}

struct TriangleLinearVerb {
    static constexpr bool with_lengths = false;
    const TriangleCall &call;
    Tally &tally;
    template <Layout layout, class V>
    __attribute__((noinline)) unsigned solve(const MoleculeLane *lane, int used, const Atoms<V> &at,
                                             const TriangleMasses<V> &m, const TriangleLengths<V> &) const {
        return solve_triangles<layout>(call, lane, used, at, m, tally);
    }
};

struct TriangleVelocitiesVerb {
    static constexpr bool with_lengths = false;
    const VelocitiesCall &call;
    Tally &tally;
    template <Layout layout, class V>
    __attribute__((noinline)) unsigned solve(const MoleculeLane *lane, int used, const Atoms<V> &at,
                                             const TriangleMasses<V> &m, const TriangleLengths<V> &) const {
        return project_triangles<layout>(call, lane, used, at, m, tally);
    }
};

struct TrianglePositionsVerb {
    static constexpr bool with_lengths = true;
    const PositionsCall &call;
    Tally &tally;
    template <Layout layout, class V>
    __attribute__((noinline)) unsigned solve(const MoleculeLane *lane, int used, const Atoms<V> &at,
                                             const TriangleMasses<V> &m, const TriangleLengths<V> &a) const {
        return move_triangles<layout>(call, lane, used, at, m, a, tally);
    }
};

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
