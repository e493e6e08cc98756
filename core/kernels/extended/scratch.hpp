// The most memory that the extended-precision solver takes: the sum of what its parts take of `Memory`, whatever the
// verb.
#pragma once

#include "core/kernels/extended/plan.hpp"
#include "core/plan/elimination.hpp"

namespace holonomic {

inline constexpr int64_t extended_scratch_bytes(int64_t n_atoms, int64_t n_bonds, int64_t most_arms, int64_t table,
                                                int64_t n_core, int64_t fill) {
    const int64_t wide = n_bonds > most_quad_double ? 16 : 32, vector = 3 * wide, most_arrays = 64;
    const int64_t per_bond = 4 * vector + 14 * wide + 40, per_atom = 2 * vector + 24;
    const int64_t in_table = most_arms > most_in_table ? most_in_table : most_arms;
    const int64_t joint = most_arms * (2 * vector + wide + 32) + 2 * (vector + 8) * (in_table * in_table) +
                          (most_arms > most_in_table ? 19 * wide * most_arms : 0);
    return per_bond * n_bonds + per_atom * n_atoms + joint + wide * (2 * table + 5 * n_core + 3 * fill) +
           8 * (n_core + fill) + 64 * most_arrays;
}

// What plan_of() takes.
inline int64_t extended_plan_bytes(const EliminationPlan &s) {
    return 16 * static_cast<int64_t>(s.n_atoms) + 12 * static_cast<int64_t>(s.n_bonds) + 64 * 6;
}

// Of a plan and a verb; more_of_metric: what a metric takes beside that.
inline int64_t extended_scratch_bytes(const EliminationPlan &s, int64_t &more_of_metric) {
    int64_t most_arms = 0, table = 0;
    more_of_metric = 0;
    for (int32_t index = 0; index < s.n_atoms; ++index) {
        const int32_t c = index - s.n_tree;
        const int64_t above = c < 0           ? 1
                              : s.n_core == 0 ? 0
                                              : s.meet_start[c + 1] - s.meet_start[c],
                      arms = s.child_start[index + 1] - s.child_start[index] + above;
        most_arms = arms > most_arms ? arms : most_arms;
        table += table_values(arms);
        if (arms > most_in_table && s.n_core > 0) more_of_metric += 32 * arms * arms;
    }
    return extended_plan_bytes(s) +
           extended_scratch_bytes(s.n_atoms, s.n_bonds, most_arms, table, s.n_core, s.column_start[s.n_core]);
}

}  // namespace holonomic
