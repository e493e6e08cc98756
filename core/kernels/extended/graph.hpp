// Solves any molecule: hanging trees by theory (52)-(54), the core by its factors, and (55) between them. The matrix is
// symmetric, or has D on the left and B on the right for Newton's method.
#pragma once

#include "core/kernels/extended/core.hpp"
#include "core/kernels/extended/joint.hpp"
#include "core/kernels/extended/trees.hpp"

namespace holonomic::HOL_ISA::extended {

// Eliminates the children of every atom, the arms that lead away from the core.
struct Graph {
    const Wide3 *D, *B;  // [n_bonds], the same if symmetric
    Wide *up;            // [n_bonds] inverse mass that the far side of a hanging bond offers
    double *loss;        // [n_bonds] and what it has lost (digits_lost.hpp)
    Wide *pivot;         // [n_bonds] pivot of a hanging bond when S over its siblings has been eliminated
    Wide *L;             // multipliers of the children of atom i, a row for each arm e (without e, if it is a child)
    Wide *y;             // [n_bonds] right-hand sides as a solve passes them on
    Wide *core_y;        // [n_core]
    Core core;
};

HOL_NOINLINE Graph take_graph(const ExtendedPlan &plan, const Wide3 *D, const Wide3 *B, ByteArena &memory) {
    Graph x;
    x.D = D;
    x.B = B;
    x.up = memory.take<Wide>(plan.n_bonds);
    x.loss = memory.take<double>(plan.n_bonds);
    x.pivot = memory.take<Wide>(plan.n_bonds);
    x.L = memory.take<Wide>(plan.table_start[plan.n_atoms]);
    x.y = memory.take<Wide>(plan.n_bonds);
    x.core_y = memory.take<Wide>(plan.n_core);
    x.core = take_core(plan, D != B, memory);
    return x;
}

HOL_INLINE bool is_child(const ExtendedPlan &plan, int32_t i, int32_t k) {
    return plan.column_of[k] < 0 && plan.parent[i] != k;
}

HOL_NOINLINE bool eliminate_children(const ExtendedPlan &plan, Joint &x, int32_t i, int target) {
    x.n_others = 0;
    for (int a = 0; a < x.n; ++a)
        if (a != target && is_child(plan, i, plan.arms[plan.arm_start[i] + a])) x.others[x.n_others++] = a;
    return eliminate_arms(x);
}

// The same table as of a tree (many.hpp): pivots of the children, and what is offered to the bond above.
HOL_NOINLINE bool reduce_many(const ScaledMolecule &m, const Graph &g, Joint &x, int32_t i, int32_t &bad) {
    const ExtendedPlan &plan = m.plan;
    const int32_t *const arms = plan.arms + plan.arm_start[i];
    bool all = true;
    x.n_others = 0;
    for (int a = 0; a < x.n; ++a)
        if (is_child(plan, i, arms[a])) x.others[x.n_others++] = a;
    reduce_many(x, g.L + plan.table_start[i], [&](int e, const Wide &E, bool good) {
        if (arms[e] == plan.parent[i]) g.up[arms[e]] = E;
        if (is_child(plan, i, arms[e])) {
            g.pivot[arms[e]] = g.up[arms[e]] + E;
            good = good && abs(g.pivot[arms[e]].hi) > vanishing * (m.w[i] + m.w[m.other(arms[e], i)]);
        }
        if (!good && all) bad = arms[e];
        all = all && good;
    });
    return all;
}

// Adds what atom i gives to the elements of its core bonds, once its children are eliminated.
HOL_NOINLINE void add_to_core(const ScaledMolecule &m, const Graph &g, const Joint &x, int32_t i, const Wide *L) {
    const int32_t *const arms = m.plan.arms + m.plan.arm_start[i];
    for (int e = 0; e < x.n; ++e) {
        if (m.plan.column_of[arms[e]] < 0) continue;
        for (int f = 0; f < x.n; ++f) {
            if (m.plan.column_of[arms[f]] < 0) continue;
            const Wide value = offered(x, e, f);
            const double size = x.loss.largest * abs(value.hi);
            if (e != f) {
                add_element(g.core, arms[e], arms[f], value, size);
                continue;
            }
            const int32_t at = m.plan.column_of[arms[e]];
            g.core.diagonal[at] += value;
            g.core.size_of_diagonal[at] += size;
            g.core.full[at] += x.w * dot(x.D[e], x.B[e]);
            if (x.n > most_arms) multipliers(x, e, x.row);
            g.core.removed[at] += taken(x, x.n > most_arms ? x.row : L + e * x.n, e);
        }
    }
}

// Eliminates the children of atom i: all of them for its other arms, and its siblings for each child.
HOL_NOINLINE bool factorize_joint(const ScaledMolecule &m, const Graph &g, Joint &x, int32_t i, int32_t &bad) {
    const ExtendedPlan &plan = m.plan;
    const int32_t *const arms = plan.arms + plan.arm_start[i];
    Wide *const L = g.L + plan.table_start[i];
    open_joint(m, g.D, g.B, i, x);
    for (int a = 0; a < x.n; ++a)
        if (is_child(plan, i, arms[a])) set_arm(x, a, g.up[arms[a]]);
    if (x.n > most_arms && !reduce_many(m, g, x, i, bad)) return false;
    for (int e = 0; e < x.n && x.n <= most_arms; ++e) {
        if (!is_child(plan, i, arms[e])) continue;
        if (!eliminate_children(plan, x, i, e)) {
            bad = arms[stiffest(x)];
            return false;
        }
        multipliers(x, e, L + e * x.n);
        g.pivot[arms[e]] = g.up[arms[e]] + offered(x, e, e);
        const double diagonal = m.w[i] + m.w[m.other(arms[e], i)];
        bad = arms[e];
        if (!(abs(g.pivot[arms[e]].hi) > vanishing * diagonal)) return false;
    }
    if (!eliminate_children(plan, x, i, -1)) {
        bad = arms[stiffest(x)];
        return false;
    }
    for (int e = 0; e < x.n && x.n <= most_arms; ++e) {
        if (is_child(plan, i, arms[e])) continue;
        multipliers(x, e, L + e * x.n);
        if (arms[e] == plan.parent[i]) g.up[arms[e]] = offered(x, e, e);
    }
    add_to_core(m, g, x, i, L);
    return true;
}

// The same, with what is lost at this atom, and has been on the way to it, counted apart: the core multiplies it.
HOL_NOINLINE bool factorize_atom(const ScaledMolecule &m, const Graph &g, Joint &x, int32_t i, int32_t &bad) {
    const double so_far = x.loss.largest;
    x.loss.largest = 1;
    for (int64_t a = m.plan.arm_start[i]; a < m.plan.arm_start[i + 1]; ++a)
        if (is_child(m.plan, i, m.plan.arms[a])) x.loss.note(g.loss[m.plan.arms[a]]);
    const bool good = factorize_joint(m, g, x, i, bad);
    if (m.plan.parent[i] >= 0) g.loss[m.plan.parent[i]] = x.loss.largest;
    x.loss.note(so_far);
    return good;
}

// Returns false if a bond depends on others, and sets its number.
HOL_NOINLINE bool factorize(const ScaledMolecule &m, const Graph &g, Joint &x, int32_t &bad) {
    const ExtendedPlan &plan = m.plan;
    clear(g.core);
    for (int32_t s = 0; s < plan.n_hanging; ++s)
        if (!factorize_atom(m, g, x, plan.hanging[s], bad)) return false;
    for (int32_t i = 0; i < plan.n_atoms; ++i)
        if (plan.parent[i] < 0 && !factorize_atom(m, g, x, i, bad)) return false;
    return factorize(g.core, x.loss, bad);
}

// Sums of y over the children of an atom of many arms, to each(e, sum): for other arms all, for a child its siblings.
template <class Each>
HOL_NOINLINE void sum_many(const ScaledMolecule &m, const Graph &g, int32_t i, const Each &each) {
    const int32_t *const arms = m.plan.arms + m.plan.arm_start[i];
    sum_many(
        g.L + m.plan.table_start[i], m.plan.arm_start[i + 1] - m.plan.arm_start[i], -1,
        [&](int a) { return g.y[arms[a]]; }, [&](int a) { return m.outward(g.D, arms[a], i); },
        [&](int a) { return m.outward(g.B, arms[a], i); }, each);
}

// Takes what the children of atom i pass on from y of its other arms.
HOL_NOINLINE void pass_on(const ScaledMolecule &m, const Graph &g, int32_t i) {
    const ExtendedPlan &plan = m.plan;
    const int32_t *const arms = plan.arms + plan.arm_start[i];
    const int n = plan.arm_start[i + 1] - plan.arm_start[i];
    if (n > most_arms)
        return sum_many(m, g, i, [&](int e, const Wide &sum) {
            if (!is_child(plan, i, arms[e])) g.y[arms[e]] -= sum;
        });
    for (int e = 0; e < n; ++e) {
        if (is_child(plan, i, arms[e])) continue;
        for (int a = 0; a < n; ++a)
            if (is_child(plan, i, arms[a])) g.y[arms[e]] -= g.L[plan.table_start[i] + e * n + a] * g.y[arms[a]];
    }
}

// Finds t of the children of atom i from t of its other arms.
HOL_NOINLINE void solve_children(const ScaledMolecule &m, const Graph &g, int32_t i, Wide *t) {
    const ExtendedPlan &plan = m.plan;
    const int32_t *const arms = plan.arms + plan.arm_start[i];
    const int n = plan.arm_start[i + 1] - plan.arm_start[i];
    Wide3 pull = {};  // of the arms known
    for (int e = 0; e < n; ++e)
        if (!is_child(plan, i, arms[e])) pull = pull + t[arms[e]] * m.outward(g.B, arms[e], i);
    for (int e = 0; e < n; ++e)
        if (is_child(plan, i, arms[e])) g.y[arms[e]] -= m.w[i] * dot(m.outward(g.D, arms[e], i), pull);
    if (n > most_arms)
        return sum_many(m, g, i, [&](int e, const Wide &sum) {
            if (is_child(plan, i, arms[e])) t[arms[e]] = (g.y[arms[e]] - sum) / g.pivot[arms[e]];
        });
    for (int e = 0; e < n; ++e) {
        if (!is_child(plan, i, arms[e])) continue;
        Wide sum = g.y[arms[e]];
        for (int a = 0; a < n; ++a)
            if (a != e && is_child(plan, i, arms[a])) sum -= g.L[plan.table_start[i] + e * n + a] * g.y[arms[a]];
        t[arms[e]] = sum / g.pivot[arms[e]];
    }
}

// Solves A t = b with the factors.
HOL_NOINLINE void solve(const ScaledMolecule &m, const Graph &g, const Wide *b, Wide *t) {
    const ExtendedPlan &plan = m.plan;
    for (int32_t k = 0; k < plan.n_bonds; ++k) g.y[k] = b[k];
    for (int32_t s = 0; s < plan.n_hanging; ++s) pass_on(m, g, plan.hanging[s]);
    for (int32_t i = 0; i < plan.n_atoms; ++i)
        if (plan.parent[i] < 0) pass_on(m, g, i);
    for (int32_t c = 0; c < plan.n_core; ++c) g.core_y[c] = g.y[plan.core[c]];
    solve(g.core, g.core_y);
    for (int32_t c = 0; c < plan.n_core; ++c) t[plan.core[c]] = g.core_y[c];
    from_the_root(plan, [&](int32_t i) {
        solve_children(m, g, i, t);
        return true;
    });
}

}  // namespace holonomic::HOL_ISA::extended
