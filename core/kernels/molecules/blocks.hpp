// A unit of molecules, a block after the other: W in lanes while there are two or more left and they are not too large
// for a cache, else one by one.
#pragma once

#include "core/kernels/arithmetic/width.hpp"
#include "core/kernels/memory/prefetch.hpp"
#include "core/plan/elimination.hpp"
#include "core/plan/way.hpp"

namespace holonomic::HOL_ISA::graph {

HOL_INLINE MoleculeLane molecule_of(const MoleculeUnit &unit, int64_t i) {
    if (!unit.regular) return unit.lanes[i];
    MoleculeLane lane = unit.lanes[0];
    lane.first_atom += i * unit.elimination->n_atoms;
    if (lane.atoms) lane.atoms += i * unit.elimination->n_atoms;
    lane.first_bond += i * unit.elimination->n_bonds;
    lane.molecule += i;
    return lane;
}

// The masses and lengths of the block before, which this one may have, too, in the same memory.
template <class V>
struct KnownMasses {
    const double *of[Width<V>::lanes] = {}, *lengths[Width<V>::lanes] = {};
    bool same(const MoleculeLane *lane, int used) {
        bool all = true;
        for (int i = 0; i < Width<V>::lanes; ++i) {
            const MoleculeLane &one = lane[i < used ? i : 0];
            all = all && of[i] == one.w && lengths[i] == one.length;
            of[i] = one.w;
            lengths[i] = one.length;
        }
        return all;
    }
};

// To the next block of molecules that follow each other.
HOL_INLINE void advance(const MoleculeUnit &unit, MoleculeLane *lane) {
    const int64_t atoms = W * static_cast<int64_t>(unit.elimination->n_atoms),
                  bonds = W * static_cast<int64_t>(unit.elimination->n_bonds);
    for (int i = 0; i < W; ++i) {
        lane[i].first_atom += atoms;
        if (lane[i].atoms) lane[i].atoms += atoms;
        lane[i].first_bond += bonds;
        lane[i].molecule += W;
    }
}

// Calls work.template block<V>(lane, used, masses are known, scratch) for all blocks.
template <class Work>
static inline void for_each_block(const MoleculeUnit &unit, double *scratch, NextMolecules &ahead, Work &work) {
    MoleculeLane lane[W];  // those without a molecule repeat the first one
    KnownMasses<vec> known;
    KnownMasses<double> known_one;
    bool full = false;  // the block before was, and lanes follow each other
    const bool small = !unit.elimination->alone;
    int64_t first = 0;
    while (first < unit.count) {
        const int64_t left = unit.count - first;
        const int used = !small || left < 2 ? 1 : left < W ? static_cast<int>(left) : W;
        if (full && used == W)
            advance(unit, lane);
        else
            for (int i = 0; i < W; ++i) lane[i] = molecule_of(unit, first + (i < used ? i : 0));
        if (small && unit.large && left > W) {
            ahead.begin(unit.elimination->n_atoms);
            for (int64_t i = W; i < left && i < 2 * W; ++i) ahead.add(molecule_of(unit, first + i));
        }
        ahead.fetch();
        if (used > 1)
            work.template block<vec>(lane, used, (full && used == W) || known.same(lane, used), scratch);
        else
            work.template block<double>(lane, 1, known_one.same(lane, 1), scratch);
        ahead.fetch_the_rest();
        full = unit.regular && used == W;
        first += used;
    }
}

}  // namespace holonomic::HOL_ISA::graph
