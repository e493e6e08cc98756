// Forces, given right-hand sides and velocities of molecules by sparse LDL^T: one (V = double), or W of one shape in
// lanes. Each returns the lanes that are flagged, of which nothing has been written.
#pragma once

#include "core/kernels/molecules/solve.hpp"
#include "core/kernels/molecules/sparse_ldl/rates.hpp"
#include "core/kernels/molecules/virial.hpp"

namespace holonomic::HOL_ISA::graph {

// W molecules or one of a shape, and what of theirs the memory has already.
template <class V>
struct LdlBlock {
    const EliminationPlan &elimination;
    const MoleculeLane *lane;
    int used;
    bool packed, masses_known;
    const LongTeam *team;
    Memory<V> &memory;
    LdlLinear<V> linear(const Box &box, const AtomArray &r, const Inputs &in, int terms) const {
        return LdlLinear<V>(*elimination.ldl, lane, used, packed, masses_known, team, box, r, in, terms, memory);
    }
};

// Write value(column) of the bonds, and rows of the atoms, in the lanes of `which`.
template <class V, class Value>
HOL_INLINE void write_bonds(const LdlLinear<V> &x, double *out, unsigned which, const Value &value) {
    x.up([&](const LdlLinear<V> &, const Subtree &subtree) HOL_FORCED {
        for_tiles_up(x.s, subtree, [&](const Tile &tile) HOL_FORCED {
            write_values<V>(x.s.bond_of, x.lane, out, which, tile.first, tile.end, value);
        });
    });
}
template <class V>
static inline void write_multipliers(const LdlLinear<V> &x, double *out, unsigned which) {
    write_bonds(x, out, which, [&](int32_t k) HOL_FORCED { return mul_add(Width<V>::all(0.5), x.t[k], V{}); });
}
template <class V>
static inline void write_tensions(const LdlLinear<V> &x, double *out, unsigned which) {
    write_bonds(x, out, which, [&](int32_t k) HOL_FORCED { return mul_add(x.t[k], x.size[k], V{}); });
}
template <class V>
static inline void write_atoms(const LdlLinear<V> &x, const AtomArray &to, const Rows<V> &from, bool add,
                               unsigned which) {
    for_atoms(x.s, x.team, [&](int32_t first, int32_t end) HOL_FORCED {
        write_vectors(to, x.at.from(first), x.s.place_of + first, end - first, from.slots(),
                      Written<V>{which, nullptr, x.lane, add, first});
    });
}
template <class V>
static inline void add_virial(const LdlLinear<V> &x, unsigned which, Tally &tally) {
    share_out(x.team, x.s.n_tiles, tally, [&](int32_t i, Tally &part) HOL_FORCED {
        const Tile &tile = x.s.tile[i];
        MoleculesVirial<V> virial;
        for (int32_t k = tile.first; k < tile.end; ++k) {
            const Vector3<V> bond = vector_of(x.d_of(tile)[k - tile.first]);
            virial.add(bond, x.t[k] * bond);
        }
        virial.count(which, 1, part);
    });
}

// Call: of forces, of given right-hand sides, or with kept factors. `good`: the lanes that are solved.
template <class V, class Call>
static inline unsigned write_by_ldl(const Call &call, const LdlLinear<V> &x, unsigned good, Tally &tally) {
    if (good && call.lambda) write_multipliers(x, call.lambda, good);
    if (good && call.tension) write_tensions(x, call.tension, good);
    if (good && call.virial) add_virial(x, good, tally);
    if (good && call.g.x) write_atoms(x, call.g, x.pull, call.add, good);
    return bits(x.in_use()) & ~good;
}

template <class V>
static inline unsigned solve_by_ldl(const ForcesCall &call, const LdlBlock<V> &block, Tally &tally) {
    const Inputs in = {&call.v, &call.f, nullptr, false};
    const int terms = (call.v.x ? squares : 0) | (call.f.x ? pulls : 0);
    const LdlLinear<V> x = block.linear(call.box, call.r, in, terms);
    return write_by_ldl(call, x, solve_and_refine(x), tally);
}

template <class V>
static inline unsigned solve_by_ldl(const SolveCall &call, const LdlBlock<V> &block, Tally &tally) {
    const Inputs in = {nullptr, nullptr, call.rhs, false};
    const LdlLinear<V> x = block.linear(call.box, call.r, in, given);
    return write_by_ldl(call, x, solve_and_refine(x), tally);
}

template <class V>
static inline unsigned solve_by_ldl(const VelocitiesCall &call, const LdlBlock<V> &block, Tally &tally) {
    const Inputs in = {&call.v, nullptr, nullptr, true, call.strain};
    const LdlLinear<V> x = block.linear(call.box, call.r, in, rates);
    const unsigned good = solve_and_refine(x);
    if (!good) return bits(x.in_use());
    if (call.lambda) write_multipliers(x, call.lambda, good);
    if (call.virial) add_virial(x, good, tally);
    // Nothing reads v any more, so that tiles of one molecule write it as they come.
    const bool tile_by_tile = LdlLinear<V>::step == 4 && x.with_rates && !x.lane[0].shared;
    if (x.with_rates) take_rates(x, tile_by_tile ? &call.v : nullptr);
    if (!tile_by_tile) write_atoms(x, call.v, x.a, false, good);
    return bits(x.in_use()) & ~good;
}

}  // namespace holonomic::HOL_ISA::graph
