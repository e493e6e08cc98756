// The plan of a molecule whose elimination plan is known. Few molecules ever need one: it is made on the spot.
#pragma once

#include "core/kernels/extended/molecule.hpp"
#include "core/plan/elimination.hpp"

namespace holonomic::HOL_ISA::extended {

// Lists the bonds of each atom, ascending.
HOL_NOINLINE void list_arms(ExtendedPlan &plan, ByteArena &memory) {
    int32_t *const start = memory.take<int32_t>(plan.n_atoms + 1), *const arms = memory.take<int32_t>(2 * plan.n_bonds);
    int64_t *const table = memory.take<int64_t>(plan.n_atoms + 1);
    for (int32_t i = 0; i <= plan.n_atoms; ++i) start[i] = 0;
    for (int32_t k = 0; k < plan.n_bonds; ++k) {
        ++start[plan.atom_i[k]];
        ++start[plan.atom_j[k]];
    }
    table[0] = 0;
    for (int32_t i = 0, end = 0; i < plan.n_atoms; ++i) {
        const int32_t n = start[i];
        plan.most_arms = n > plan.most_arms ? n : plan.most_arms;
        table[i + 1] = table[i] + table_values(n);
        start[i] = end += n;
    }
    for (int32_t k = plan.n_bonds; k-- > 0;) {
        arms[--start[plan.atom_i[k]]] = k;
        arms[--start[plan.atom_j[k]]] = k;
    }
    start[plan.n_atoms] = 2 * plan.n_bonds;
    plan.arm_start = start;
    plan.arms = arms;
    plan.table_start = table;
}

// Takes what extended_plan_bytes() says (scratch.hpp).
HOL_NOINLINE ExtendedPlan plan_of(const EliminationPlan &s, ByteArena &memory) {
    ExtendedPlan plan = {};
    plan.n_atoms = s.n_atoms;
    plan.n_bonds = s.n_bonds;
    plan.atom_i = s.atom_i;
    plan.atom_j = s.atom_j;
    plan.n_hanging = s.n_tree;
    plan.hanging = s.atom_of;
    plan.n_core = s.n_core;
    plan.core = s.bond_of + s.n_tree;
    plan.column_start = s.column_start;
    plan.rows = s.row;
    const bool round = s.type == EliminationPlan::triangle || s.type == EliminationPlan::ring;
    plan.ring = round && s.n_tree == 0 ? s.bond_of : nullptr;
    list_arms(plan, memory);
    int32_t *const parent = memory.take<int32_t>(s.n_atoms), *const column_of = memory.take<int32_t>(s.n_bonds);
    for (int32_t index = 0; index < s.n_atoms; ++index)
        parent[s.atom_of[index]] = index < s.n_tree ? s.bond_of[index] : -1;
    for (int32_t p = 0; p < s.n_bonds; ++p) column_of[s.bond_of[p]] = p < s.n_tree ? -1 : p - s.n_tree;
    plan.parent = parent;
    plan.column_of = column_of;
    return plan;
}

}  // namespace holonomic::HOL_ISA::extended
