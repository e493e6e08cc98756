// Newton's method for the positions of a network (theory (15)-(17)), as sparse_ldl/newton.hpp has it; but each
// step's equations, with the matrix of (58), are solved by factor.hpp, in part by iteration. Such a solve may be
// incomplete: the next step's errors of lengths are exact whatever it was.
#pragma once

#include "core/kernels/molecules/iterate.hpp"
#include "core/kernels/molecules/network/factor.hpp"

namespace holonomic::HOL_ISA::graph {

struct NetNewton {
    // Of right-hand sides that a solve leaves: little beside what Newton's method does, which is some twentieth of the
    // largest error.
    static constexpr double least_left = 1e-4, most_left = 0.01, left_of_error = 0.02;

    const Net net;
    const NetworkPlan &s;
    Net3 r, moves;  // of the rest
    Net3 b, D;
    double *tau, *t, *a2, *per_a2, *stretch;
    double *worst;  // [n_shares + 1] of parts
    mutable Net3 moves_of_worst{};
    NetFactor factor;
    double opening = 0;
    // found: the unknowns have been, and all else has yet to follow.
    bool found = false, moved = false, failed = false;

    static int32_t n_rest(const NetworkPlan &s) { return s.n_nodes + s.n_tree; }
    static int64_t values(const NetworkPlan &s) {
        return Net::values(s) + 6 * in_fours(n_rest(s)) + 11 * in_fours(s.n_bonds) + in_fours(s.n_shares + 1) +
               NetFactor::values(s, false);
    }
    NetNewton(const NetworkPlan &plan, const MoleculeLane &lane, bool packed, const LongTeam *team,
              Memory<double> memory)
        : net(plan, lane, packed, team, memory, memory), s(plan), r(Net3::take(memory, n_rest(s), s.first_node)),
          moves(Net3::take(memory, n_rest(s), s.first_node)), b(Net3::take(memory, s.n_bonds)),
          D(Net3::take(memory, s.n_bonds)), tau(memory.values(in_fours(s.n_bonds))),
          t(memory.values(in_fours(s.n_bonds))), a2(memory.values(in_fours(s.n_bonds))),
          per_a2(memory.values(in_fours(s.n_bonds))), stretch(memory.values(in_fours(s.n_bonds))),
          worst(memory.values(in_fours(s.n_shares + 1))), factor(net, b, false, memory, memory) {}

    // What is left of bonds' lengths: |D| - a, times |D_0| of the bonds D_0 that the factors are made of.
    template <bool fresh, class V>
    HOL_FORCED V measure(int32_t k, const Vector3<V> &bond) const {
        net.fetch_ahead(k, a2, per_a2, stretch, t);
        const V sigma = excess(bond, load_any<V>(a2 + k)), e = sigma * load_any<V>(per_a2 + k);
        const V one = Width<V>::all(1);
        if (fresh) {
            const V root = sqrt(one + e);
            store_any(stretch + k, root);
            store_any(t + k, sigma * (root / (one + root)));
        } else {
            const V near = max(min(e, Width<V>::all(0.5)), Width<V>::all(-0.5));
            store_any(t + k,
                      (0.5 * load_any<V>(stretch + k)) *
                          (sigma * mul_add(near, mul_add(near, Width<V>::all(0.125), Width<V>::all(-0.25)), one)));
        }
        return abs(e);
    }
    // Of a part, the largest error that each(note) tells by note(error). A NaN stays.
    template <class Each>
    HOL_FORCED static double largest_error(const Each &each) {
        vec most = {}, sum = {};
        double most_of_rest = 0;
        each([&](const auto &error) HOL_FORCED { take(error, most, sum, most_of_rest); });
        most = most + 0 * sum;
        for (int i = 0; i < W; ++i) most_of_rest = larger(Width<vec>::get(most, i), most_of_rest);
        return most_of_rest;
    }
    HOL_FORCED static void take(const vec &error, vec &most, vec &sum, double &) {
        most = max(error, most);
        sum = sum + error;
    }
    HOL_FORCED static void take(double error, vec &, vec &, double &most_of_rest) {
        most_of_rest = larger(error, most_of_rest);
    }
    static double larger(double error, double than) { return than < error || error != error ? error : than; }
    double worst_of_all() const { return largest_in(worst, s.n_shares + 1); }
    // Calls each(first bond index, end) for the parts whose largest error is that of all; then error_of() knows their
    // moves.
    template <class Each>
    void for_worst_parts(double error, const Each &each) const {
        for (int32_t i = 0; i <= s.n_shares; ++i) {
            if (!(worst[i] >= error)) continue;
            const NetPart part = i < s.n_shares ? net.part(i, net.buffer) : net.rest();
            moves_of_worst = part.of_sites();
            if (moved && !net.is_rest(part))
                net.for_strands(part, [&](auto width, const NetStrands &g) HOL_FORCED {
                    for_moves(width, g,
                              [&](auto, int32_t site, const auto &move) HOL_FORCED { moves_of_worst.set(site, move); });
                });
            each(part.first_index, part.end_index);
        }
    }

    double open() const { return opening; }
    void forget(ScalarMask which) {
        if (!which.set) return;
        for (int32_t k = 0; k < s.n_bonds; ++k) tau[k] = 0;
    }
    // If the unknowns have just been found, all bonds' corrections: of the rest, of strands.
    void correct_rest() const {
        if (!found) return;
        factor.take_down_rest(t);
        for (int32_t k = s.first_tree_bond; k < s.n_bonds; ++k) tau[k] += t[k];
        for (int32_t u = 0; u < s.n_unknowns; ++u) tau[s.bond_index_of[u]] += t[s.bond_index_of[u]];
    }
    template <class V>
    HOL_FORCED void correct(const NetStrands &g) const {
        if (!found) return;
        factor.take_down<V>(g, t);
        for (int32_t k = 1; k + 1 < g.length; ++k) {
            const int32_t bond_index = g.bond_index + k * g.step;
            store_any(tau + bond_index, load_any<V>(tau + bond_index) + load_any<V>(t + bond_index));
        }
    }
    void correct() {
        correct_rest();
        for_all_strands([&](auto width, const NetStrands &g) HOL_FORCED { correct<decltype(width)>(g); });
        found = false;
    }
    template <class Each>
    HOL_FORCED void for_all_strands(const Each &each) const {
        net.for_parts([&](const NetPart &part) { net.for_strands(part, each); });
    }
    // What tau does to atoms: of the rest, where it is kept; between the ends of strands, for each(width, site, move).
    __attribute__((noinline)) void find_moves_of_rest() const {
        factor.find_pulls_of_rest(tau, moves, nullptr);
        for (int32_t i = s.first_node; i < s.n_atoms; ++i) moves.set(i, net.w[i] * moves.get<double>(i));
    }
    template <class V, class Each>
    HOL_FORCED void for_moves(const V &width, const NetStrands &g, const Each &each) const {
        StrandPulls<V>(net, tau, b, g.bond_index).for_sites(g, [&](int32_t site, const Vector3<V> &pull) HOL_FORCED {
            each(width, site, load_any<V>(net.w + site) * pull);
        });
    }
    // Calls each(bond_index, bond) for bonds as tau moves them.
    template <class V, class Each>
    HOL_FORCED void for_moved_bonds(const NetStrands &g, const Each &each) const {
        StrandPulls<V> along(net, tau, b, g.bond_index);
        net.for_bonds(
            g, [&]() HOL_FORCED { return net.at_node<V>(g, 0, moves); },
            [&](int32_t site, int32_t bond_index)
                HOL_FORCED { return load_any<V>(net.w + site) * along.before(bond_index); },
            [&]() HOL_FORCED { return net.at_node<V>(g, 1, moves); },
            [&](int32_t bond_index, const Vector3<V> &from, const Vector3<V> &to)
                HOL_FORCED { each(bond_index, moved_bond(bond_index, from, to)); });
    }
    template <class Each>
    HOL_FORCED void for_moved_bonds_of_trees(const Each &each) const {
        for (int32_t k = s.first_tree_bond; k < s.n_bonds; ++k)
            each(k, moved_bond(k, moves.get<double>(s.from[k]), moves.get<double>(s.to[k])));
    }
    template <class V>
    HOL_FORCED Vector3<V> moved_bond(int32_t k, const Vector3<V> &from, const Vector3<V> &to) const {
        net.fetch_ahead(k, D.x, D.y, D.z);
        return D.get<V>(k) + (to - from);
    }
    // What is left is taken up at once, while it is in cache.
    __attribute__((noinline)) double move() {
        correct_rest();
        find_moves_of_rest();
        worst[s.n_shares] = largest_error([&](const auto &note) HOL_FORCED {
            for_moved_bonds_of_trees([&](int32_t k, const auto &bond) HOL_FORCED { note(measure<false>(k, bond)); });
        });
        factor.take_up_rest(t);
        net.for_parts([&](const NetPart &part) { worst[part.share] = move_strands(part); });
        factor.add_pushes();
        moved = true;
        found = false;
        return failed ? __builtin_nan("") : worst_of_all();
    }
    // One thing after the other for all strands of a part: those of few bonds would wait for themselves.
    __attribute__((noinline)) double move_strands(const NetPart &part) const {
        net.for_strands(part, [&](auto width, const NetStrands &g) HOL_FORCED { correct<decltype(width)>(g); });
        const double error = largest_error([&](const auto &note) HOL_FORCED {
            net.for_strands(part, [&](auto width, const NetStrands &g) HOL_FORCED {
                for_moved_bonds<decltype(width)>(
                    g, [&](int32_t k, const auto &bond) HOL_FORCED { note(measure<false>(k, bond)); });
            });
        });
        factor.take_up(part, t);
        return error;
    }
    double error_of(int32_t k) const {
        const auto move_at = [&](int32_t site) {
            return moved ? (site < s.first_node ? moves_of_worst : moves).get<double>(site) : Vector3<double>{};
        };
        return abs(excess(moved_bond(k, move_at(s.from[k]), move_at(s.to[k])), a2[k])) * per_a2[k];
    }

    // Factors have been made when atoms were read.
    void first_factors() { factor.close(); }
    __attribute__((noinline)) void factorize(ScalarMask) {
        if (moved) find_moves_of_rest();
        const NetPart rest = net.rest();
        const Net3 of_trees = moved ? rest.by_bond_index() : D;
        if (moved) for_moved_bonds_of_trees([&](int32_t k, const auto &bond) HOL_FORCED { of_trees.set(k, bond); });
        for (int32_t k = s.first_tree_bond; k < s.n_bonds; ++k) measure<true>(k, of_trees.get<double>(k));
        factor.factorize_rest(of_trees, t);
        net.for_parts([&](const NetPart &part) { factorize_strands(part, moved ? part.by_bond_index() : D); });
        factor.close();
    }
    __attribute__((noinline)) void factorize_strands(const NetPart &part, const Net3 &bonds) const {
        net.for_strands(part, [&](auto width, const NetStrands &g) HOL_FORCED {
            typedef decltype(width) V;
            if (moved) for_moved_bonds<V>(g, [&](int32_t k, const Vector3<V> &bond) HOL_FORCED { bonds.set(k, bond); });
            for (int32_t k = 0; k < g.length; ++k) {
                const int32_t bond_index = g.bond_index + k * g.step;
                measure<true>(bond_index, bonds.get<V>(bond_index));
            }
        });
        factor.factorize(part, bonds, t);
    }
    __attribute__((noinline)) void solve(ScalarMask) {
        const double left = max(min(left_of_error * worst_of_all(), most_left), least_left);
        failed = failed || factor.unknowns.solve(left, nullptr) < 0;
        found = true;
    }
};

}  // namespace holonomic::HOL_ISA::graph
