// The equations of a network: strands and trees are eliminated, from what is left between the nodes its unknowns are
// found by iteration (unknowns.hpp). The matrix is w D . b, of new bonds D and reference bonds b; at the levels of
// forces and velocities these are the same.
#pragma once

#include "core/kernels/molecules/network/stiff_joint.hpp"
#include "core/kernels/molecules/network/unknowns.hpp"

namespace holonomic::HOL_ISA::graph {

// What offers less than this part of an inverse mass is taken to offer so much: the end of a strand; a bond of a tree
// below an atom with several, whose multiplier is a difference that is divided by it. The factors need not be exact, as
// what they leave is corrected.
constexpr double least_offer = 1e-10;

struct NetFactor {
    const Net &net;
    const NetworkPlan &s;
    Net3 b;  // of all bonds; D is given to factorize()
    double *to_last,
        *from_last;  // multipliers of a strand's next bond: what it gives to this one's t, and gets of its y
    double *to_first, *from_first;  // the same of the first bond
    double *per_pivot;              // 1 / P; of trees: of a bond below an atom with several E, else 1 / P
    Tensor<double> *joint;          // [n_tree] of atoms with several children: the inverse mass that they leave
    Vector3<double> *push;          // [n_tree] of those: from their y
    StiffJoints stiff;              // of nodes, then of atoms of trees
    Unknowns unknowns;

    static int64_t values(const NetworkPlan &s, bool symmetric) {
        return 5 * in_fours(s.n_bonds) + in_fours(9 * static_cast<int64_t>(s.n_tree)) +
               in_fours(3 * static_cast<int64_t>(s.n_tree)) + StiffJoints::values(s.n_nodes + s.n_tree) +
               Unknowns::values(s, symmetric);
    }
    // What is kept of a symmetric one.
    static int64_t values_of_factor(const NetworkPlan &s) {
        return 3 * in_fours(s.n_bonds) + in_fours(9 * static_cast<int64_t>(s.n_tree)) +
               StiffJoints::values_of_factor(s.n_nodes + s.n_tree) + Unknowns::values_of_factor(s);
    }
    // D != b: a matrix that is not symmetric. What solves only read is in the memory of the factor, what they write in
    // the other one.
    NetFactor(const Net &of, const Net3 &bonds, bool symmetric, Memory<double> &of_factor, Memory<double> &memory)
        : net(of), s(of.s), b(bonds), stiff(s.n_nodes + s.n_tree, of_factor, memory),
          unknowns(of, symmetric, of_factor, memory) {
        const int64_t n = in_fours(s.n_bonds), n_tree = s.n_tree;
        to_last = of_factor.values(n);
        from_last = symmetric ? to_last : of_factor.values(n);
        to_first = of_factor.values(n);
        from_first = symmetric ? to_first : of_factor.values(n);
        per_pivot = of_factor.values(n);
        joint = reinterpret_cast<Tensor<double> *>(of_factor.values(in_fours(9 * n_tree)));
        push = reinterpret_cast<Vector3<double> *>(memory.values(in_fours(3 * n_tree)));
    }

    // Makes the factors, and takes the right-hand sides y up: of the rest, of each part, then of what is left.
    __attribute__((noinline)) void factorize(const NetPart &part, const Net3 &D, double *y) const {
        net.for_strands(
            part, [&](auto width, const NetStrands &g) HOL_FORCED { factorize_strands<decltype(width)>(g, D, y); });
    }
    void close() const {
        add_pushes();
        unknowns.factorize();
    }
    // What trees at the nodes give to right-hand sides.
    void add_pushes() const {
        unknowns.add_pushes();
        for (int32_t n = 0; n < s.n_nodes && s.n_tree > 0; ++n)
            if (stiff.is[n])
                unknowns.add_push(
                    n, rounded(stiff.acceleration(n)) - unknowns.mass.get<double>(n) * unknowns.push.get<double>(n));
    }
    // Other right-hand sides.
    void take_up_rest(double *y) const {
        for (int32_t i = 0; i < s.n_tree; ++i) take_up_tree(i, y);
        take_up_nodes(y);
    }
    __attribute__((noinline)) void take_up(const NetPart &part, double *y) const {
        net.for_strands(part, [&](auto width, const NetStrands &g) HOL_FORCED { take_up<decltype(width)>(g, y); });
    }
    template <class V>
    HOL_FORCED void take_up(const NetStrands &g, double *y) const {
        V last = {}, first = load_any<V>(y + g.bond_index), before = {}, share = {};
        for (int32_t k = 1; k < g.length; ++k) {
            const int32_t bond_index = g.bond_index + k * g.step;
            last = mul_add(share, before, load_any<V>(y + bond_index));
            if (k + 1 == g.length) break;
            store_any(y + bond_index, last);
            first = first - load_any<V>(from_first + bond_index) * last;
            share = load_any<V>(from_last + bond_index);
            before = last;
        }
        net.to_end(g, 0, first, unknowns.y);
        if (g.length > 1) net.to_end(g, 1, last, unknowns.y);
    }
    // From the unknowns, down to all bonds: y becomes t. The rest: ends of strands, and trees.
    __attribute__((noinline)) void take_down_rest(double *y) const {
        for (int32_t u = 0; u < s.n_unknowns; ++u) y[s.bond_index_of[u]] = unknowns.x[u];
        for (int32_t n = 0; n < s.n_nodes && s.n_tree > 0; ++n) {
            if (s.child_start[n] == s.child_start[n + 1]) continue;
            if (stiff.is[n])
                solve_stiff_children(n, stiff.acceleration(n, unknowns.pull_of(n, unknowns.x)), y);
            else
                solve_children(n, unknowns.acceleration_of(n, unknowns.x), y);
        }
        for (int32_t i = s.n_tree; i-- > 0;) take_down_tree(i, y);
    }
    __attribute__((noinline)) void take_down(const NetPart &part, double *y) const {
        net.for_strands(part, [&](auto width, const NetStrands &g) HOL_FORCED { take_down<decltype(width)>(g, y); });
    }
    template <class V>
    HOL_FORCED void take_down(const NetStrands &g, double *y) const {
        const V first = load_any<V>(y + g.bond_index);
        V next = load_any<V>(y + g.bond_index + (g.length - 1) * g.step);
        for (int32_t k = g.length - 2; k > 0; --k) {
            const int32_t bond_index = g.bond_index + k * g.step;
            net.fetch_ahead(bond_index, y, per_pivot, to_last, to_first);
            next = mul_add(load_any<V>(to_last + bond_index), next,
                           load_any<V>(y + bond_index) * load_any<V>(per_pivot + bond_index) -
                               load_any<V>(to_first + bond_index) * first);
            store_any(y + bond_index, next);
        }
    }

    // What multipliers do to nodes and atoms of trees: G, and where `tension` is wanted the sum of |t| |d|; G is right
    // to a rounding of itself then, with room for low words. Of strands t at their ends is enough.
    void find_pulls_of_rest(const double *t, const Net3 &G, double *tension = nullptr, const Net3 &low = {}) const {
        net.for_node_shares([&](int32_t share) {
            unknowns.find_pulls(share, t, G, tension, low);
            if (!s.has_foreign && s.n_tree == 0) return;
            const int32_t last = s.nodes_start[share + 1] - 1;
            add_pulls(s.nodes[s.nodes_start[share]].first_node, s.nodes[last].first_node + s.nodes[last].count, t, G,
                      tension, low);
        });
        for (int32_t i = s.first_tree; i < s.n_atoms; ++i) {
            G.set(i, Vector3<double>{});
            if (tension) tension[i] = 0;
            if (tension) low.set(i, Vector3<double>{});
        }
        add_pulls(s.n_nodes, s.n_nodes + s.n_tree, t, G, tension, low);
    }
    // By bonds that are no own ends of a node.
    __attribute__((noinline)) void add_pulls(int32_t first, int32_t end, const double *t, const Net3 &G,
                                             double *tension, const Net3 &low) const {
        for (int32_t n = first; n < end; ++n) {
            const int32_t site = s.first_node + n;
            const Vector3<double> zero = {};
            Pair3<double> sum = pairs_of(G.get<double>(site), tension ? low.get<double>(site) : zero);
            net.for_other_bonds(n, [&](int32_t bond_index, double sign) HOL_FORCED {
                const Vector3<double> bond = b.get<double>(bond_index);
                sum = add_pairs(sum, product_pairs(sign * t[bond_index], bond));
                if (tension) tension[site] += abs(t[bond_index]) * sqrt(dot(bond, bond));
            });
            G.set(site, rounded(sum));
        }
    }

    // E of the bonds above trees' atoms stand in to_first until they are used, and 1 / P or E in per_pivot.
    void factorize_rest(const Net3 &D, double *y) const {
        factorize_trees(D, y);
        factorize_nodes(D);
        take_up_nodes(y);
    }

private:
    // From the first to the last bond, those between being eliminated. What the far side offers to the last one is
    // found as in trees, without a subtraction. To the first one it is what the first bond's own atom does, times what
    // each pivot loses when it is eliminated before and not after those between: P' / P.
    template <class V>
    HOL_FORCED void factorize_strands(const NetStrands &g, const Net3 &D, double *y) const {
        Vector3<V> Dk = D.get<V>(g.bond_index), bk = b.get<V>(g.bond_index);
        V first = load_any<V>(y + g.bond_index);
        unknowns.set_bonds(g, 0, Dk, bk);
        if (g.length == 1) return net.to_end(g, 0, first, unknowns.y);
        V w = load_any<V>(net.w + g.site);
        const Vector3<V> D0 = Dk, b0 = bk;
        Dk = D.get<V>(g.bond_index + g.step);
        bk = b.get<V>(g.bond_index + g.step);
        const V whole = w * dot(D0, b0), one = Width<V>::all(1);
        V E0 = whole, row = -(w * dot(D0, bk)), column = -(w * dot(Dk, b0)), q = dot(Dk, bk), E = w * q,
          beyond = w * dot(cross(D0, Dk), cross(b0, bk)) / dot(D0, b0), yk = load_any<V>(y + g.bond_index + g.step);
        for (int32_t k = 1; k + 1 < g.length; ++k) {
            const int32_t bond_index = g.bond_index + k * g.step;
            w = load_any<V>(net.w + g.site + k * g.step);
            const Vector3<V> Dn = D.get<V>(bond_index + g.step), bn = b.get<V>(bond_index + g.step);
            net.fetch_ahead(bond_index, per_pivot, to_last, to_first);
            const V P_beyond = mul_add(w, q, beyond);
            const V per = one / mul_add(w, q, E), next = dot(Dn, bn), part = w * per;
            const V up = part * dot(Dn, bk), down = part * dot(Dk, bn), from = row * per, to = column * per;
            const V X = w * dot(cross(Dk, Dn), cross(bk, bn));
            E0 = E0 * (P_beyond * per);
            beyond = w * mul_add(next, beyond, X) / P_beyond;
            first = first - from * yk;
            store_any(y + bond_index, yk);
            store_any(per_pivot + bond_index, per);
            store_any(to_last + bond_index, down);
            store_any(to_first + bond_index, to);
            store_any(from_last + bond_index, up);
            store_any(from_first + bond_index, from);
            yk = mul_add(up, yk, load_any<V>(y + bond_index + g.step));
            row = row * down;
            column = column * up;
            E = part * mul_add(next, E, X);
            Dk = Dn;
            bk = bn;
            q = next;
        }
        unknowns.set_bonds(g, 1, Dk, bk);
        net.to_end(g, 0, max(E0, Width<V>::all(least_offer) * whole), unknowns.E);
        net.to_end(g, 1, max(E, Width<V>::all(least_offer) * (w * q)), unknowns.E);
        net.to_end(g, 0, row, unknowns.coupling);
        net.to_end(g, 1, column, unknowns.coupling);
        net.to_end(g, 0, first, unknowns.y);
        net.to_end(g, 1, yk, unknowns.y);
    }

    int32_t first_child(int32_t joint_number) const { return s.child_start[joint_number]; }
    int32_t n_children(int32_t number) const { return s.child_start[number + 1] - s.child_start[number]; }

    void factorize_trees(const Net3 &D, double *y) const {
        for (int32_t i = 0; i < s.n_tree; ++i) {
            const int32_t e = s.first_tree_bond + i, n = n_children(s.n_nodes + i);
            const Vector3<double> De = D.get<double>(e), be = b.get<double>(e);
            const double w = net.w[s.first_tree + i], q = dot(De, be);
            if (n == 0) {
                to_first[e] = w * q;
            } else if (n == 1) {
                const int32_t c = s.first_tree_bond + s.child[first_child(s.n_nodes + i)];
                const Vector3<double> Dc = D.get<double>(c), bc = b.get<double>(c);
                const double E = to_first[c], per = 1 / mul_add(w, dot(Dc, bc), E), part = w * per;
                per_pivot[c] = per;
                from_last[c] = part * dot(De, bc);
                to_last[c] = part * dot(Dc, be);
                to_first[e] = part * mul_add(q, E, w * dot(cross(Dc, De), cross(bc, be)));
            } else {
                joint[i] = mass_with_children(s.n_nodes + i, w, D);
                to_first[e] = stiff.is[s.n_nodes + i] ? stiff.offered(s.n_nodes + i, De, be) : dot(De, joint[i] * be);
            }
            keep_new_bond(i, De);
            take_up_tree(i, y);
        }
    }
    void factorize_nodes(const Net3 &D) const {
        for (int32_t n = 0; n < s.n_nodes; ++n) {
            const double w = net.w[s.first_node + n];
            unknowns.mass.set(n, mass_with_children(n, w, D));
        }
    }
    // D of the bonds of trees, for other right-hand sides.
    void keep_new_bond(int32_t i, const Vector3<double> &D) const { unknowns.tree_bond[i] = D; }

    Tensor<double> mass_with_children(int32_t number, double w, const Net3 &D) const {
        Tensor<double> mass = diagonal_tensor(w);
        bool is_stiff = false;
        for (int32_t j = s.child_start[number]; j < s.child_start[number + 1]; ++j) {
            const int32_t c = s.first_tree_bond + s.child[j];
            const Vector3<double> Dc = D.get<double>(c), bc = b.get<double>(c);
            const double E = to_first[c];
            is_stiff = is_stiff || E < stiff_offer * (w * dot(Dc, bc));
            per_pivot[c] = 1 / E;
            add_offer(mass, E, bc, Dc);
        }
        stiff.is[number] = is_stiff;
        return is_stiff ? mass_of_stiff(number, w, D) : mass;
    }
    __attribute__((noinline)) Tensor<double> mass_of_stiff(int32_t number, double w, const Net3 &D) const {
        stiff.begin(number, w);
        for (int32_t j = s.child_start[number]; j < s.child_start[number + 1]; ++j) {
            const int32_t c = s.first_tree_bond + s.child[j];
            const Vector3<double> Dc = D.get<double>(c), bc = b.get<double>(c);
            const double E = max(to_first[c], least_stiff_offer * (w * dot(Dc, bc)));
            per_pivot[c] = 1 / E;
            stiff.add_offer(number, E, bc, Dc);
        }
        return stiff.mass(number);
    }
    // sum b y / E over children.
    Vector3<double> push_of(int32_t number, const double *y) const {
        Vector3<double> sum = {};
        for (int32_t j = s.child_start[number]; j < s.child_start[number + 1]; ++j) {
            const int32_t c = s.first_tree_bond + s.child[j];
            sum = add_times(sum, y[c] * per_pivot[c], b.get<double>(c));
        }
        if (stiff.is[number]) push_stiff(number, y);
        return sum;
    }
    __attribute__((noinline)) void push_stiff(int32_t number, const double *y) const {
        Pair3<double> sum = {};
        for (int32_t j = s.child_start[number]; j < s.child_start[number + 1]; ++j) {
            const int32_t c = s.first_tree_bond + s.child[j];
            sum = add_pairs(sum, product_pairs(y[c] * per_pivot[c], b.get<double>(c)));
        }
        stiff.set_push(number, sum);
    }
    void take_up_tree(int32_t i, double *y) const {
        const int32_t e = s.first_tree_bond + i, n = n_children(s.n_nodes + i);
        if (n == 1) {
            const int32_t c = s.first_tree_bond + s.child[first_child(s.n_nodes + i)];
            y[e] = mul_add(from_last[c], y[c], y[e]);
        } else if (n > 1) {
            push[i] = push_of(s.n_nodes + i, y);
            y[e] += dot(unknowns.tree_bond[i],
                        stiff.is[s.n_nodes + i] ? rounded(stiff.acceleration(s.n_nodes + i)) : joint[i] * push[i]);
        }
    }
    void take_up_nodes(const double *y) const {  // what their trees give
        for (int32_t n = 0; n < s.n_nodes; ++n) unknowns.push.set(n, push_of(n, y));
    }
    // t of the children of an atom that is accelerated so much.
    void solve_children(int32_t number, const Vector3<double> &a, double *t) const {
        for (int32_t j = s.child_start[number]; j < s.child_start[number + 1]; ++j) {
            const int32_t i = s.child[j], c = s.first_tree_bond + i;
            t[c] = (t[c] - dot(unknowns.tree_bond[i], a)) * per_pivot[c];
        }
    }
    __attribute__((noinline)) void solve_stiff_children(int32_t number, const Pair3<double> &a, double *t) const {
        for (int32_t j = s.child_start[number]; j < s.child_start[number + 1]; ++j) {
            const int32_t i = s.child[j], c = s.first_tree_bond + i;
            t[c] = left_of(t[c], unknowns.tree_bond[i], a) * per_pivot[c];
        }
    }
    void take_down_tree(int32_t i, double *t) const {
        const int32_t e = s.first_tree_bond + i, n = n_children(s.n_nodes + i);
        if (n == 1) {
            const int32_t c = s.first_tree_bond + s.child[first_child(s.n_nodes + i)];
            t[c] = mul_add(to_last[c], t[e], t[c] * per_pivot[c]);
        } else if (n > 1 && stiff.is[s.n_nodes + i]) {
            solve_stiff_children(s.n_nodes + i,
                                 stiff.acceleration(s.n_nodes + i, product_pairs(-t[e], b.get<double>(e))), t);
        } else if (n > 1) {
            solve_children(s.n_nodes + i, joint[i] * (push[i] - t[e] * b.get<double>(e)), t);
        }
    }
};

}  // namespace holonomic::HOL_ISA::graph
