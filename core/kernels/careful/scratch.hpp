// The most memory that the careful solver takes: the sum of what its parts take of `Memory`, whatever the verb.
#pragma once

#include "core/kernels/careful/plan.hpp"

namespace holonomic {

inline constexpr int64_t careful_scratch_bytes(int64_t n_atoms, int64_t n_bonds, int64_t most_arms, int64_t table,
                                               int64_t n_core, int64_t fill) {
    const int64_t wide = n_bonds > most_fourfold ? 16 : 32, vector = 3 * wide, most_arrays = 64;
    const int64_t per_bond = 4 * vector + 14 * wide + 40, per_atom = 2 * vector + 16;
    const int64_t joint =
        most_arms * (2 * vector + wide + 32) + 2 * (vector + 8) * (most_arms > 64 ? 0 : most_arms * most_arms);
    return per_bond * n_bonds + per_atom * n_atoms + joint + wide * (2 * table + 5 * n_core + 3 * fill) +
           8 * (n_core + fill) + 64 * most_arrays;
}

inline int64_t careful_scratch_bytes(const CarefulPlan &plan) {
    return careful_scratch_bytes(plan.n_atoms, plan.n_bonds, plan.most_arms, plan.table_start[plan.n_atoms],
                                 plan.n_core, plan.column_start[plan.n_core]);
}

}  // namespace holonomic
