// ln det Z~ is the sum of the logarithms of pivots over their diagonal elements (theory (61)). If elimination has taken
// less than half of a diagonal element, log1p of that part keeps the digits of a small logarithm. The part is what the
// pivot leaves of the element where that has digits enough: what multipliers take may be a small difference of theirs.
#pragma once

#include "core/kernels/extended/system.hpp"

namespace holonomic::HOL_ISA::extended {

HOL_NOINLINE double log_of_ratio(const Wide &removed, const Wide &pivot, const Wide &full) {
    const Wide rest = full - pivot;
    const Wide x = (rest.hi > 0x1p-30 * full.hi ? rest : removed) / full;
    if (x.hi < 0.5) return __builtin_log1p(-x.hi) - beyond_first(x) / (1 - x.hi);
    const Wide ratio = pivot / full;
    return __builtin_log(ratio.hi) + beyond_first(ratio) / ratio.hi;
}

// Returns w d.d, summed over both ends of a bond.
HOL_INLINE Wide full_diagonal(const ScaledMolecule &m, int32_t k) {
    return (wide(m.w[m.plan.atom_i[k]]) + wide(m.w[m.plan.atom_j[k]])) * dot(m.d[k], m.d[k]);
}

// The same of an atom of many arms, all of which give way: with the sum rho B D^T over the children so far.
HOL_NOINLINE Wide log_of_many(const ScaledMolecule &m, const Wide *up, Wide *F, Joint &x, int32_t i) {
    const ExtendedPlan &plan = m.plan;
    const int32_t *const arms = plan.arms + plan.arm_start[i];
    Wide sum = wide(0), so_far[9] = {}, inverse[9];
    double inertia = 0;
    int parent = -1;
    const auto reduce = [&](int a, Wide &left) {  // returns what has been taken
        invert_with_one(so_far, inverse);
        const Wide3 G = from_left(x.D[a], inverse);
        left = x.w * dot(G, x.B[a]);
        return x.w * dot(from_left(G, so_far), x.B[a]);
    };
    for (int a = 0; a < x.n; ++a) {
        if (arms[a] == plan.parent[i]) parent = a;
        if (!is_child(plan, i, arms[a])) continue;
        const int32_t k = arms[a];
        Wide left;
        const Wide removed = F[k] + reduce(a, left);
        sum += wide(log_of_ratio(removed, up[k] + left, full_diagonal(m, k)));
        inertia += abs((x.rho[a] * dot(x.D[a], x.B[a])).hi);
        add_outer(so_far, x.B[a], x.rho[a] * x.D[a]);
    }
    if (inertia >= mild) x.loss.note(1, wide(0));
    Wide left;
    if (parent >= 0) F[arms[parent]] = reduce(parent, left);
    return sum;
}

// Adds the logarithms of the children of atom i, one after the other. F gets what all of them take of its parent bond.
HOL_NOINLINE Wide log_of_children(const ScaledMolecule &m, const Wide *up, Wide *F, Joint &x, Wide *l, int32_t i) {
    const ExtendedPlan &plan = m.plan;
    const int32_t *const arms = plan.arms + plan.arm_start[i];
    Wide sum = wide(0);
    int parent = -1;
    open_joint(m, m.d, m.d, i, x);
    bool gives_way = x.n > most_arms && x.w > 0;
    for (int a = 0; a < x.n && gives_way; ++a) {
        if (!is_child(plan, i, arms[a])) continue;
        set_arm(x, a, up[arms[a]]);
        gives_way = !x.rigid[a];
    }
    if (gives_way) return log_of_many(m, up, F, x, i);
    x.n_others = 0;
    for (int a = 0; a < x.n; ++a) {
        if (arms[a] == plan.parent[i]) parent = a;
        if (!is_child(plan, i, arms[a])) continue;
        const int32_t k = arms[a];
        eliminate_arms(x);
        multipliers(x, a, l);
        const Wide pivot = up[k] + offered(x, a, a), removed = F[k] + taken(x, l, a);
        sum += wide(log_of_ratio(removed, pivot, full_diagonal(m, k)));
        set_arm(x, a, up[k]);
        x.others[x.n_others++] = a;
    }
    if (parent < 0) return sum;
    eliminate_arms(x);
    multipliers(x, parent, l);
    F[arms[parent]] = taken(x, l, parent);
    return sum;
}

HOL_NOINLINE Wide log_of_trees(const ScaledMolecule &m, const Wide *up, Joint &x, ByteArena memory) {
    Wide *const F = memory.take<Wide>(m.plan.n_bonds), *const l = memory.take<Wide>(m.plan.most_arms);
    Wide sum = wide(0);
    for (int32_t s = 0; s < m.plan.n_hanging; ++s) sum += log_of_children(m, up, F, x, l, m.plan.hanging[s]);
    for (int32_t i = 0; i < m.plan.n_atoms; ++i)
        if (m.plan.parent[i] < 0) sum += log_of_children(m, up, F, x, l, i);
    return sum;
}

HOL_NOINLINE Wide log_of_core(const Core &x) {
    Wide sum = wide(0);
    for (int32_t c = 0; c < x.plan->n_core; ++c) sum += wide(log_of_ratio(x.removed[c], x.diagonal[c], x.full[c]));
    return sum;
}

HOL_NOINLINE Wide log_of_ring(const ScaledMolecule &m, const Ring &x) {
    Wide sum = wide(0);
    for (int32_t k = 0; k < x.n; ++k) {
        const int32_t bond = m.plan.ring[k];
        const Wide full = wide(m.w[m.plan.atom_i[bond]]) + wide(m.w[m.plan.atom_j[bond]]);
        sum += wide(log_of_ratio(x.removed[k], x.P[k], full));
    }
    return sum;
}

// Returns ln det Z~ of a molecule that has been factorized.
HOL_NOINLINE Wide log_det(const ScaledMolecule &m, ExtendedSystem &x, const ByteArena &memory) {
    if (is_ring(m.plan)) return log_of_ring(m, x.ring);
    if (is_tree(m.plan)) return log_of_trees(m, x.tree.up, x.joint, memory);
    return log_of_trees(m, x.graph.up, x.joint, memory) + log_of_core(x.graph.core);
}

// Returns the sum of ln Z_kk, where Z_kk = 4 (w_i + w_j) d.d.
HOL_NOINLINE Wide log_of_diagonal(const ScaledMolecule &m) {
    constexpr double ln2 = 0.69314718055994530942;
    Wide sum = wide(0);
    for (int32_t k = 0; k < m.plan.n_bonds; ++k) {
        const Wide full = full_diagonal(m, k);
        const double unit = 4 * m.mass_unit * m.unit[k] * m.unit[k], scaled = 4 * full.hi, z = unit * full.hi;
        const Wide beyond = unit * full - wide(1);  // small where the logarithm is
        if (abs(beyond.hi) < 0.5)
            sum += wide(__builtin_log1p(beyond.hi) + beyond_first(beyond) / (1 + beyond.hi));
        else if (z > 0x1p-1000 && z < 0x1p1000)
            sum += wide(__builtin_log(z));
        else
            sum +=
                wide(__builtin_log(scaled)) + (__builtin_logb(m.mass_unit) + 2 * __builtin_logb(m.unit[k])) * wide(ln2);
    }
    return sum;
}

}  // namespace holonomic::HOL_ISA::extended
