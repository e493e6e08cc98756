// Solves the equations A t = b of one molecule as its shape allows: as a tree, a bare ring, or anything else.
#pragma once

#include "core/kernels/extended/graph.hpp"
#include "core/kernels/extended/ring.hpp"
#include "core/kernels/extended/trees.hpp"

namespace holonomic::HOL_ISA::extended {

HOL_INLINE bool is_tree(const ExtendedPlan &plan) { return plan.n_core == 0; }
HOL_INLINE bool is_ring(const ExtendedPlan &plan) { return plan.ring != nullptr; }

struct ExtendedSystem {
    Joint joint;
    Tree tree;            // one of the three
    Ring ring;            //
    Graph graph;          //
    Wide *rest, *change;  // [n_bonds] for refinement
    Wide3 *pull;          // [n_atoms]
    int32_t bad;          // a bond that depends on others, where factorize() fails
};

HOL_NOINLINE ExtendedSystem take_system(const ScaledMolecule &m, ByteArena &memory) {
    ExtendedSystem x = {};
    x.bad = -1;
    x.joint = take_joint(m.plan.most_arms, false, memory);
    x.rest = memory.take<Wide>(m.plan.n_bonds);
    x.change = memory.take<Wide>(m.plan.n_bonds);
    x.pull = memory.take<Wide3>(m.plan.n_atoms);
    if (is_tree(m.plan))
        x.tree = take_tree(m.plan, memory);
    else if (is_ring(m.plan))
        x.ring = take_ring(m.plan, memory);
    else
        x.graph = take_graph(m.plan, m.d, m.d, memory);
    return x;
}

HOL_NOINLINE bool factorize(const ScaledMolecule &m, ExtendedSystem &x) {
    if (is_tree(m.plan)) return factorize(m, x.tree, x.joint, x.bad);
    if (is_ring(m.plan)) return factorize(m, x.ring, x.bad);
    return factorize(m, x.graph, x.joint, x.bad);
}

// Finds the pull on each atom: the sum over its bonds of t times the vector away from it, times the bond's unit of t.
HOL_NOINLINE void pulls(const ScaledMolecule &m, const Wide3 *d, const Wide *t, Wide3 *pull) {
    for (int32_t i = 0; i < m.plan.n_atoms; ++i) pull[i] = Wide3{};
    for (int32_t k = 0; k < m.plan.n_bonds; ++k) {
        const Wide3 p = t[k] * d[k];
        pull[m.plan.atom_i[k]] = pull[m.plan.atom_i[k]] + p;
        pull[m.plan.atom_j[k]] = pull[m.plan.atom_j[k]] - p;
    }
}

// Finds rest = b - A t from the accelerations of the atoms.
HOL_NOINLINE void residual(const ScaledMolecule &m, const ExtendedSystem &x, const Wide *b, const Wide *t) {
    pulls(m, m.d, t, x.pull);
    for (int32_t k = 0; k < m.plan.n_bonds; ++k) {
        const int32_t i = m.plan.atom_i[k], j = m.plan.atom_j[k];
        x.rest[k] = b[k] - dot(m.d[k], m.w[i] * x.pull[i] - m.w[j] * x.pull[j]);
    }
}

// Solves A t = b. Hanging trees beside cycles are eliminated from one side alone, which may lose digits. So the
// solution is refined until a correction changes nothing that is kept. If none is as small, that is a loss.
HOL_NOINLINE void solve(const ScaledMolecule &m, const ExtendedSystem &x, const Wide *b, Wide *t) {
    if (is_tree(m.plan)) return solve(m, x.tree, b, t);
    if (is_ring(m.plan)) return solve(m, x.ring, b, t);
    solve(m, x.graph, b, t);
    bool small = false;
    for (int pass = 0; pass < 3 && !small; ++pass) {
        residual(m, x, b, t);
        solve(m, x.graph, x.rest, x.change);
        small = true;
        for (int32_t k = 0; k < m.plan.n_bonds; ++k) {
            small = small && abs(x.change[k].hi) <= 0x1p-60 * abs(t[k].hi);
            t[k] += x.change[k];
        }
    }
    if (!small) x.joint.loss.note(1, wide(0));
}

}  // namespace holonomic::HOL_ISA::extended
