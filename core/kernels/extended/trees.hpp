// Trees in the two-sided form (theory (52), (54), (59)). Over every bond each end sends the other a message: what all
// bonds behind it leave of the inverse mass and of the right-hand sides. Nothing large cancels, whatever the masses
// are.
#pragma once

#include "core/kernels/extended/many.hpp"
#include "core/kernels/extended/molecule.hpp"

namespace holonomic::HOL_ISA::extended {

HOL_NOINLINE Joint take_joint(int32_t most, bool mixed, ByteArena &memory) {
    // Beside an atom of many arms there are others, which have products of pairs.
    const int64_t n = most, in_table = n > most_arms ? most_arms : n, pairs = in_table * in_table;
    Joint x = {};
    x.mixed = mixed;
    x.D = memory.take<Wide3>(n);
    x.B = mixed ? memory.take<Wide3>(n) : x.D;
    x.rho = memory.take<Wide>(n);
    x.rigid = memory.take<bool>(n);
    x.XD = memory.take<Wide3>(pairs);
    x.XB = mixed ? memory.take<Wide3>(pairs) : x.XD;
    x.others = memory.take<int>(n);
    x.sD = memory.take<double>(n);
    x.sB = mixed ? memory.take<double>(n) : x.sD;
    x.sXD = memory.take<double>(pairs);
    x.sXB = mixed ? memory.take<double>(pairs) : x.sXD;
    x.behind = memory.take<Wide>(n > most_arms ? 18 * n : 0);
    x.row = memory.take<Wide>(n > most_arms ? n : 0);
    return x;
}

// The bonds of atom i, pointing away from it.
HOL_NOINLINE void open_joint(const ScaledMolecule &m, const Wide3 *D, const Wide3 *B, int32_t i, Joint &x) {
    const ExtendedPlan &plan = m.plan;
    x.n = plan.arm_start[i + 1] - plan.arm_start[i];
    x.w = m.w[i];
    for (int a = 0; a < x.n; ++a) {
        const int32_t k = plan.arms[plan.arm_start[i] + a];
        x.D[a] = m.outward(D, k, i);
        if (x.mixed) x.B[a] = m.outward(B, k, i);
    }
    prepare(x);
}

// All arms but one are eliminated.
HOL_NOINLINE bool eliminate_others(Joint &x, int target) {
    x.n_others = 0;
    for (int a = 0; a < x.n; ++a)
        if (a != target) x.others[x.n_others++] = a;
    return eliminate_arms(x);
}

// Returns the eliminated arm that gives way least: the last of those that don't at all.
HOL_NOINLINE int stiffest(const Joint &x) {
    int arm = x.n_others > 0 ? x.others[0] : 0;
    for (int o = 0; o < x.n_others; ++o)
        if (x.rigid[x.others[o]]) arm = x.others[o];
    return arm;
}

struct Tree {
    Wide *up, *down;  // [n_bonds] inverse mass offered to the bond from the side away from the root, and from its side
    Wide *L;          // multipliers of arm a in the message along arm e of atom i at [table_start[i] + e n + a], or
                      // what many.hpp has of them
    Wide *y_up, *y_down;  // [n_bonds] what a solve sends
};

HOL_NOINLINE Tree take_tree(const ExtendedPlan &plan, ByteArena &memory) {
    Tree x;
    x.up = memory.take<Wide>(plan.n_bonds);
    x.down = memory.take<Wide>(plan.n_bonds);
    x.L = memory.take<Wide>(plan.table_start[plan.n_atoms]);
    x.y_up = memory.take<Wide>(plan.n_bonds);
    x.y_down = memory.take<Wide>(plan.n_bonds);
    return x;
}

// Calls body(i) for the atoms from the root outwards.
template <class Body>
HOL_INLINE bool from_the_root(const ExtendedPlan &plan, const Body &body) {
    for (int32_t i = 0; i < plan.n_atoms; ++i)
        if (plan.parent[i] < 0 && !body(i)) return false;
    for (int32_t s = plan.n_hanging; s-- > 0;)
        if (!body(plan.hanging[s])) return false;
    return true;
}

// Message of atom i along its arm e.
HOL_NOINLINE bool send(const ScaledMolecule &m, const Tree &tree, Joint &x, int32_t i, int e, Wide &E, int32_t &bad) {
    const int32_t *const arms = m.plan.arms + m.plan.arm_start[i];
    if (!eliminate_others(x, e)) {
        bad = arms[stiffest(x)];
        return false;
    }
    E = offered(x, e, e);
    multipliers(x, e, tree.L + m.plan.table_start[i] + e * x.n);
    return true;
}

// Messages of atom i along all its arms but its parent's, or along that one alone.
HOL_NOINLINE bool send_many(const ScaledMolecule &m, const Tree &tree, Joint &x, int32_t i, bool up, int32_t &bad) {
    const int32_t *const arms = m.plan.arms + m.plan.arm_start[i];
    bool all = true;
    x.n_others = 0;
    for (int a = 0; a < x.n; ++a)
        if (!up || arms[a] != m.plan.parent[i]) x.others[x.n_others++] = a;
    reduce_many(x, tree.L + m.plan.table_start[i], [&](int e, const Wide &E, bool good) {
        if ((arms[e] == m.plan.parent[i]) != up) return;
        (up ? tree.up : tree.down)[arms[e]] = E;
        if (!good && all) bad = arms[e];
        all = all && good;
    });
    return all;
}

// Returns false if a bond depends on others, and sets its number.
HOL_NOINLINE bool factorize(const ScaledMolecule &m, const Tree &tree, Joint &x, int32_t &bad) {
    const ExtendedPlan &plan = m.plan;
    for (int32_t s = 0; s < plan.n_hanging; ++s) {
        const int32_t i = plan.hanging[s], parent = plan.parent[i];
        open_joint(m, m.d, m.d, i, x);
        int e = 0;
        for (int a = 0; a < x.n; ++a) {
            const int32_t k = plan.arms[plan.arm_start[i] + a];
            if (k == parent)
                e = a;
            else
                set_arm(x, a, tree.up[k]);
        }
        if (x.n > most_arms ? !send_many(m, tree, x, i, true, bad) : !send(m, tree, x, i, e, tree.up[parent], bad))
            return false;
    }
    const bool good = from_the_root(plan, [&](int32_t i) {
        open_joint(m, m.d, m.d, i, x);
        for (int a = 0; a < x.n; ++a) {
            const int32_t k = plan.arms[plan.arm_start[i] + a];
            set_arm(x, a, k == plan.parent[i] ? tree.down[k] : tree.up[k]);
        }
        if (x.n > most_arms) return send_many(m, tree, x, i, false, bad);
        for (int a = 0; a < x.n; ++a) {
            const int32_t k = plan.arms[plan.arm_start[i] + a];
            if (k != plan.parent[i] && !send(m, tree, x, i, a, tree.down[k], bad)) return false;
        }
        return true;
    });
    if (!good) return false;
    for (int32_t k = 0; k < plan.n_bonds; ++k) {
        const double diagonal = (m.w[plan.atom_i[k]] + m.w[plan.atom_j[k]]) * dot(m.d[k], m.d[k]).hi;
        bad = k;
        if (!(tree.up[k].hi + tree.down[k].hi > vanishing * diagonal)) return false;
    }
    return true;
}

// Right-hand sides behind the arms of an atom of many, as they pass over it, to each(e, sum); or those behind one arm.
template <class Each>
HOL_NOINLINE void pass_many(const ScaledMolecule &m, const Tree &tree, const Wide *b, int32_t i, int only,
                            const Each &each) {
    const ExtendedPlan &plan = m.plan;
    const int32_t *const arms = plan.arms + plan.arm_start[i];
    const auto outward = [&](int a) { return m.outward(m.d, arms[a], i); };
    sum_many(
        tree.L + plan.table_start[i], plan.arm_start[i + 1] - plan.arm_start[i], only,
        [&](int a) { return b[arms[a]] + (arms[a] == plan.parent[i] ? tree.y_down : tree.y_up)[arms[a]]; }, outward,
        outward, [&](int e, const Wide &sum) { each(e, -sum); });
}

// Returns the right-hand sides behind arm e of atom i, as they pass over it.
HOL_NOINLINE Wide passed(const ExtendedPlan &plan, const Tree &tree, const Wide *b, int32_t i, int e) {
    const int32_t *const arms = plan.arms + plan.arm_start[i];
    const int n = plan.arm_start[i + 1] - plan.arm_start[i];
    const Wide *const L = tree.L + plan.table_start[i] + e * n;
    Wide sum = wide(0);
    for (int a = 0; a < n; ++a) {
        if (a == e) continue;
        const int32_t k = arms[a];
        sum -= L[a] * (b[k] + (k == plan.parent[i] ? tree.y_down[k] : tree.y_up[k]));
    }
    return sum;
}

// Solves A t = b.
HOL_NOINLINE void solve(const ScaledMolecule &m, const Tree &tree, const Wide *b, Wide *t) {
    const ExtendedPlan &plan = m.plan;
    for (int32_t s = 0; s < plan.n_hanging; ++s) {
        const int32_t i = plan.hanging[s];
        const int32_t *const arms = plan.arms + plan.arm_start[i];
        int e = 0;
        while (arms[e] != plan.parent[i]) ++e;
        if (plan.arm_start[i + 1] - plan.arm_start[i] > most_arms) {
            tree.y_down[plan.parent[i]] = wide(0);  // multiplied by nothing
            pass_many(m, tree, b, i, e, [&](int, const Wide &sum) { tree.y_up[plan.parent[i]] = sum; });
            continue;
        }
        tree.y_up[plan.parent[i]] = passed(plan, tree, b, i, e);
    }
    from_the_root(plan, [&](int32_t i) {
        const int32_t *const arms = plan.arms + plan.arm_start[i];
        const int32_t n = plan.arm_start[i + 1] - plan.arm_start[i];
        if (n > most_arms)
            pass_many(m, tree, b, i, -1, [&](int e, const Wide &sum) {
                if (arms[e] != plan.parent[i]) tree.y_down[arms[e]] = sum;
            });
        for (int a = 0; a < n && n <= most_arms; ++a)
            if (arms[a] != plan.parent[i]) tree.y_down[arms[a]] = passed(plan, tree, b, i, a);
        return true;
    });
    for (int32_t k = 0; k < plan.n_bonds; ++k)
        t[k] = (b[k] + tree.y_up[k] + tree.y_down[k]) / (tree.up[k] + tree.down[k]);
}

}  // namespace holonomic::HOL_ISA::extended
