// Newton's method for the positions of a network, as flat_newton.hpp has it for molecules along a list.
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
        : net(plan, lane, packed, team, memory), s(plan), r(Net3::take(memory, n_rest(s), s.first_node)),
          moves(Net3::take(memory, n_rest(s), s.first_node)), b(Net3::take(memory, s.n_bonds)),
          D(Net3::take(memory, s.n_bonds)), tau(memory.values(in_fours(s.n_bonds))),
          t(memory.values(in_fours(s.n_bonds))), a2(memory.values(in_fours(s.n_bonds))),
          per_a2(memory.values(in_fours(s.n_bonds))), stretch(memory.values(in_fours(s.n_bonds))),
          worst(memory.values(in_fours(s.n_shares + 1))), factor(net, b, false, memory) {}

    // What is left of bonds' lengths: |D| - a, times |D_0| of the bonds D_0 that the factors are made of.
    template <bool fresh, class V>
    HOL_FORCED V measure(int32_t k, const Vector3<V> &bond) const {
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
    __attribute__((noinline)) double measure_fresh(const NetPart &part, const Net3 &bonds) const {
        return largest_error([&](const auto &note) HOL_FORCED {
            net.for_all(part.first_place, part.end_place, [&](auto width, int32_t k) HOL_FORCED {
                note(measure<true>(k, bonds.get<decltype(width)>(k)));
            });
        });
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
    // Calls body(part), first for the rest.
    template <class Body>
    HOL_FORCED void for_all_parts(const Body &body) const {
        body(net.rest());
        net.for_parts(body);
    }

    // Calls each(first place, end) for the parts whose largest error is that of all; then error_of() knows their moves.
    template <class Each>
    void for_worst_parts(double error, const Each &each) const {
        for (int32_t i = 0; i <= s.n_shares; ++i) {
            if (!(worst[i] >= error)) continue;
            const NetPart part = i < s.n_shares ? net.part(i, net.buffer) : net.rest();
            if (moved) find_moves(part);
            moves_of_worst = moves_of(part);
            each(part.first_place, part.end_place);
        }
    }

    double open() const { return opening; }
    void forget(Flag which) {
        if (!which.set) return;
        for (int32_t k = 0; k < s.n_bonds; ++k) tau[k] = 0;
    }
    Net3 moves_of(const NetPart &part) const { return net.is_rest(part) ? moves : part.of_sites(0); }
    // If the unknowns have just been found, all bonds' corrections.
    void correct(const NetPart &part) const {
        if (!found) return;
        if (net.is_rest(part)) {
            factor.take_down_rest(t);
            for (int32_t k = part.first_place; k < part.end_place; ++k) tau[k] += t[k];
            for (int32_t u = 0; u < s.n_unknowns; ++u) tau[s.place_of[u]] += t[s.place_of[u]];
            return;
        }
        factor.take_down(part, t);
        net.for_strands(part, [&](auto width, const NetStrands &g) HOL_FORCED {
            typedef decltype(width) V;
            for (int32_t k = 1; k + 1 < g.length; ++k) {
                const int32_t place = g.place + k * g.step;
                store_any(tau + place, load_any<V>(tau + place) + load_any<V>(t + place));
            }
        });
    }
    void correct() {
        for_all_parts([&](const NetPart &part) { correct(part); });
        found = false;
    }
    // What tau does to the sites of a part.
    __attribute__((noinline)) void find_moves(const NetPart &part) const {
        const Net3 to = moves_of(part);
        if (!net.is_rest(part)) return net.find_pulls(part, tau, b, to, true, nullptr);
        factor.find_pulls_of_rest(tau, to, nullptr);
        for (int32_t i = part.first_site; i < part.end_site; ++i) to.set(i, net.w[i] * to.get<double>(i));
    }
    // As tau moves a bond.
    template <class V>
    HOL_FORCED Vector3<V> moved_bond(int32_t k, const Vector3<V> &from, const Vector3<V> &to) const {
        return D.get<V>(k) + (to - from);
    }
    // What is left is taken up at once, while it is in cache.
    __attribute__((noinline)) double move() {
        for_all_parts([&](const NetPart &part) {
            correct(part);
            find_moves(part);
            worst[part.share] = measure_moved(part);
            if (net.is_rest(part))
                factor.take_up_rest(t);
            else
                factor.take_up(part, t);
        });
        factor.unknowns.add_pushes();
        moved = true;
        found = false;
        return failed ? __builtin_nan("") : worst_of_all();
    }
    __attribute__((noinline)) double measure_moved(const NetPart &part) const {
        return largest_error([&](const auto &note) HOL_FORCED {
            for_moved_bonds(part, [&](auto, int32_t k, const auto &bond) HOL_FORCED { note(measure<false>(k, bond)); });
        });
    }
    template <class Body>
    HOL_FORCED void for_moved_bonds(const NetPart &part, const Body &body) const {
        net.for_bonds(part, moves, moves_of(part),
                      [&](auto width, int32_t k, const auto &from, const auto &to)
                          HOL_FORCED { body(width, k, moved_bond(k, from, to)); });
    }
    double error_of(int32_t k) const {
        const auto move_at = [&](int32_t site) {
            return moved ? (site < s.first_node ? moves_of_worst : moves).get<double>(site) : Vector3<double>{};
        };
        return abs(excess(moved_bond(k, move_at(s.from[k]), move_at(s.to[k])), a2[k])) * per_a2[k];
    }

    void factorize_part(const NetPart &part, const Net3 &bonds) const {
        if (part.share == s.n_shares)
            factor.factorize_rest(bonds, t);
        else
            factor.factorize(part, bonds, t);
    }
    // Without a guess, each part's factors have been made when it was read.
    void first_factors() { factor.close(); }
    void factorize(Flag) {
        for_all_parts([&](const NetPart &part) {
            const Net3 bonds = moved ? part.of_places(1) : D;
            if (moved) {
                find_moves(part);
                for_moved_bonds(part, [&](auto, int32_t k, const auto &bond) HOL_FORCED { bonds.set(k, bond); });
            }
            measure_fresh(part, bonds);
            factorize_part(part, bonds);
        });
        factor.close();
    }
    __attribute__((noinline)) void solve(Flag) {
        const double left = max(min(left_of_error * worst_of_all(), most_left), least_left);
        failed = failed || factor.unknowns.solve(left, nullptr) < 0;
        found = true;
    }
};

}  // namespace holonomic::HOL_ISA::graph
