// Finds the elements of A^-1 of bonds that share an atom. The Fixman force needs them (theory (60)).
#pragma once

#include "core/kernels/extended/system.hpp"

namespace holonomic::HOL_ISA::extended {

// Of arms a and b of atom i at [start[i] + a n + b]; none of an atom of a tree with many arms.
struct Neighbours {
    int64_t *start;       // [n_atoms + 1]
    Wide *H;              //
    Wide *diagonal;       // [n_bonds]
    Wide *lower, *pivot;  // of the core's inverse, where its factor has elements
};

HOL_NOINLINE Neighbours take_neighbours(const ExtendedPlan &plan, ByteArena &memory) {
    Neighbours x;
    x.start = memory.take<int64_t>(plan.n_atoms + 1);
    x.start[0] = 0;
    for (int32_t i = 0; i < plan.n_atoms; ++i) {
        const int64_t n = plan.arm_start[i + 1] - plan.arm_start[i];
        x.start[i + 1] = x.start[i] + (n > most_arms && is_tree(plan) ? 0 : n * n);
    }
    x.H = memory.take<Wide>(x.start[plan.n_atoms]);
    x.diagonal = memory.take<Wide>(plan.n_bonds);
    x.lower = memory.take<Wide>(plan.column_start[plan.n_core]);
    x.pivot = memory.take<Wide>(plan.n_core);
    return x;
}

// Trees: they are the rows of the inverse of S over all bonds of each atom.
HOL_NOINLINE void find_neighbours(const ExtendedPlan &plan, const Tree &tree, const Neighbours &x) {
    for (int32_t i = 0; i < plan.n_atoms; ++i) {
        const int n = plan.arm_start[i + 1] - plan.arm_start[i];
        if (n > most_arms) continue;
        for (int a = 0; a < n; ++a) {
            const int32_t k = plan.arms[plan.arm_start[i] + a];
            const Wide r = wide(1) / (tree.up[k] + tree.down[k]);
            const int64_t row = x.start[i] + a * n, of_L = plan.table_start[i] + a * n;
            for (int b = 0; b < n; ++b) x.H[row + b] = b == a ? r : -(tree.L[of_L + b] * r);
        }
    }
}

// Returns the element of the core's inverse for two rows that couple somewhere in the factor.
HOL_INLINE Wide core_element(const ExtendedPlan &plan, const Neighbours &x, int32_t a, int32_t b) {
    if (a == b) return x.pivot[a];
    return x.lower[a > b ? element(plan, a, b) : element(plan, b, a)];
}

// Finds the core's inverse where the factor has elements, from the last column back.
HOL_NOINLINE void invert(const Core &core, const Neighbours &x) {
    const ExtendedPlan &plan = *core.plan;
    for (int32_t c = plan.n_core; c-- > 0;) {
        const int32_t first = plan.column_start[c], end = plan.column_start[c + 1];
        Wide sum = wide(1) / core.diagonal[c];
        for (int32_t e = first; e < end; ++e) {
            Wide value = wide(0);
            for (int32_t s = first; s < end; ++s)
                value -= core.lower[s] * core_element(plan, x, plan.rows[e], plan.rows[s]);
            x.lower[e] = value;
        }
        for (int32_t e = first; e < end; ++e) sum -= core.lower[e] * x.lower[e];
        x.pivot[c] = sum;
    }
}

// Goes from the arms of atom i that are no children to those that are.
HOL_NOINLINE void hand_down(const ScaledMolecule &m, const Graph &g, const Neighbours &x, int32_t i) {
    const ExtendedPlan &plan = m.plan;
    const int32_t *const arms = plan.arms + plan.arm_start[i];
    const int n = plan.arm_start[i + 1] - plan.arm_start[i];
    Wide *const H = x.H + x.start[i], *const table = g.L + plan.table_start[i];
    const auto outward = [&](int a) { return m.outward(m.d, arms[a], i); };
    const auto L = [&](int e, int a) {
        return n > most_arms ? multiplier_of_many(table, n, e, a, outward, outward) : table[e * n + a];
    };
    const auto child = [&](int a) { return is_child(plan, i, arms[a]); };
    for (int c = 0; c < n; ++c) {
        if (!child(c)) continue;
        for (int b = 0; b < n; ++b) {
            if (child(b)) continue;
            Wide sum = wide(0);
            for (int e = 0; e < n; ++e)
                if (!child(e)) sum -= L(e, c) * H[e * n + b];
            H[c * n + b] = H[b * n + c] = sum;
        }
    }
    for (int c = 0; c < n; ++c) {
        if (!child(c)) continue;
        const Wide r = wide(1) / g.pivot[arms[c]];
        for (int b = 0; b < n; ++b) {
            if (!child(b)) continue;
            Wide sum = b == c ? r : -(L(c, b) * r);
            for (int e = 0; e < n; ++e)
                if (!child(e)) sum -= L(e, c) * H[e * n + b];
            H[c * n + b] = sum;
        }
        x.diagonal[arms[c]] = H[c * n + c];
    }
}

HOL_NOINLINE void find_neighbours(const ScaledMolecule &m, const Graph &g, const Neighbours &x) {
    const ExtendedPlan &plan = m.plan;
    invert(g.core, x);
    from_the_root(plan, [&](int32_t i) {
        const int32_t *const arms = plan.arms + plan.arm_start[i];
        const int n = plan.arm_start[i + 1] - plan.arm_start[i];
        Wide *const H = x.H + x.start[i];
        for (int a = 0; a < n; ++a)
            for (int b = 0; b < n; ++b) {
                if (arms[a] == plan.parent[i] && a == b)
                    H[a * n + b] = x.diagonal[arms[a]];
                else if (plan.column_of[arms[a]] >= 0 && plan.column_of[arms[b]] >= 0)
                    H[a * n + b] = core_element(plan, x, plan.column_of[arms[a]], plan.column_of[arms[b]]);
            }
        hand_down(m, g, x, i);
        return true;
    });
}

// A ring: each row couples to the next and to the last. `lower` is taken for the elements beside the last row.
HOL_NOINLINE void find_neighbours(const ExtendedPlan &plan, const Ring &ring, const Neighbours &x) {
    const int32_t last = ring.n - 1;
    Wide beside = wide(1) / ring.P[last], diagonal = beside;  // (k, last) and (k, k)
    const auto put = [&](int32_t k, int32_t l, const Wide &value) {
        const int32_t bk = plan.ring[k], bl = plan.ring[l];
        const Wide h = value / (ring.length[k] * ring.length[l]);
        for (int side = 0; side < 2; ++side) {
            const int32_t end = side == 0 ? plan.atom_i[bk] : plan.atom_j[bk];
            if (end == plan.atom_i[bl] || end == plan.atom_j[bl]) x.H[x.start[end] + 1] = x.H[x.start[end] + 2] = h;
        }
    };
    const Wide corner = diagonal;
    for (int32_t k = last; k-- > 0;) {
        // Row k of the inverse from rows k + 1 and last: with their elements (k+1, k+1), (k+1, last), (last, last).
        const Wide to_last = k + 1 == last ? ring.l[k] * corner : ring.l[k] * beside + ring.l_last[k] * corner;
        const Wide to_next = k + 1 == last ? to_last : ring.l[k] * diagonal + ring.l_last[k] * beside;
        put(k, k + 1, to_next);
        diagonal = wide(1) / ring.P[k] + ring.l[k] * to_next;
        if (k + 1 < last) diagonal += ring.l_last[k] * to_last;
        beside = to_last;
    }
    put(0, last, beside);
}

HOL_NOINLINE void find_neighbours(const ScaledMolecule &m, const ExtendedSystem &system, const Neighbours &x) {
    const ExtendedPlan &plan = m.plan;
    if (is_tree(plan)) return find_neighbours(plan, system.tree, x);
    if (is_ring(plan)) return find_neighbours(plan, system.ring, x);
    find_neighbours(m, system.graph, x);
}

}  // namespace holonomic::HOL_ISA::extended
