// The most memory that the careful solver takes: the sum of what its parts take of `Memory`, whatever the verb.
#ifndef HOLONOMIC_KERNELS_CAREFUL_SCRATCH_HPP
#define HOLONOMIC_KERNELS_CAREFUL_SCRATCH_HPP

#include "core/kernels/careful/plan.hpp"

namespace holonomic {

inline int64_t careful_scratch_bytes(const CarefulPlan &plan) {
    const int64_t wide = plan.n_bonds > most_fourfold ? 16 : 32, vector = 3 * wide, most_arrays = 64;
    const int64_t fill = plan.column_start[plan.n_core], arms = plan.most_arms;
    const int64_t per_bond = 4 * vector + 14 * wide + 32, per_atom = 2 * vector + 16;
    const int64_t joint = arms * (2 * vector + wide + 16) + 2 * vector * (arms > 64 ? 0 : arms * arms);
    return per_bond * plan.n_bonds + per_atom * plan.n_atoms + joint + wide * 2 * plan.table_start[plan.n_atoms] +
           wide * (5 * plan.n_core + 3 * fill) + 64 * most_arrays;
}

}  // namespace holonomic
#endif
