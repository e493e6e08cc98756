// Where the arms of a large molecule (core/plan/elimination.hpp) are kept while it is solved: each as a chain inside of
// it.
#pragma once

#include "core/kernels/eliminate/segment.hpp"
#include "core/kernels/molecules/scratch.hpp"
#include "core/plan/elimination.hpp"

namespace holonomic::HOL_ISA::graph {

struct Arms {
    double *store;         // of all arms, one behind the other; nullptr: there are none
    unsigned char *alone;  // [n_arms] arms that are worked on atom by atom, because segments can't answer for them
    double *work;          // of the calling thread, whose scratch the molecule has
    const double *scratch;
};

// Its last bond is the separator behind its last segment.
HOL_INLINE Cut cut_of(const EliminationPlan::Arm &arm) { return Cut(arm.n_bonds - 1, segment_bonds, true); }

// In molecules of more than these, the arm before is fetched early (verbs/segments.cpp).
constexpr int64_t bonds_of_cache = 65536;

constexpr int64_t blocks_of_arm = (longest_arm - 2) / segment_bonds + 1;

// Doubles of the store for so many arms with so many bonds in their segments.
HOL_INLINE int64_t arm_store_values(int64_t arms, int64_t bonds) {
    constexpr int64_t summary = sizeof(Summary) / sizeof(double), kept = sizeof(SegmentBond) / sizeof(double);
    return arms * ((blocks_of_arm + 1) * summary + (Cut::longest_step + 1) * kept) + bonds / W * kept;
}
HOL_INLINE int64_t inner_bonds(const EliminationPlan &s) {
    return s.n_arms == 0 ? 0 : s.arm[s.n_arms - 1].inner_before + s.arm[s.n_arms - 1].n_bonds - 1;
}
HOL_INLINE double *store_of(const EliminationPlan &s, const Arms &arms, int32_t a) {
    return arms.store + arm_store_values(a, s.arm[a].inner_before);
}

// The same, with what is needed to go through all arms in order, and back.
HOL_INLINE Cut cut_in_order(const EliminationPlan &s, const Arms &arms, int32_t a) {
    const EliminationPlan::Arm &arm = s.arm[a];
    Cut cut = cut_of(arm);
    cut.bonds_behind = inner_bonds(s) - arm.inner_before - cut.n_bonds;
    if (a == 0 || s.n_bonds <= bonds_of_cache) return cut;
    cut.to_atoms_before = 3 * (s.arm[a - 1].first_atom - arm.first_atom);
    cut.to_kept_before = store_of(s, arms, a - 1) - store_of(s, arms, a);
    return cut;
}

constexpr int64_t doubles_of_line = W > 8 ? W : 8;

// Doubles of all, wherever the memory for them begins.
HOL_INLINE int64_t arm_values(const EliminationPlan &s) {
    if (s.n_arms == 0) return 0;
    return doubles_of_line + arm_store_values(s.n_arms, inner_bonds(s)) + scratch_doubles(longest_cut) +
           s.n_arms / static_cast<int64_t>(sizeof(double)) + 1;
}
HOL_INLINE Arms take_arms(const EliminationPlan &s, const double *scratch, Memory<double> &memory) {
    if (s.n_arms == 0) return {};
    while ((memory.next - scratch) % doubles_of_line != 0) ++memory.next;
    Arms arms = {};
    arms.store = memory.values(arm_store_values(s.n_arms, inner_bonds(s)));
    arms.work = memory.values(scratch_doubles(longest_cut));
    arms.alone = reinterpret_cast<unsigned char *>(memory.values(s.n_arms / static_cast<int64_t>(sizeof(double)) + 1));
    arms.scratch = scratch;
    return arms;
}

}  // namespace holonomic::HOL_ISA::graph
