// Newton's method for the positions of a network, as flat_newton.hpp has it for molecules along a list.
#ifndef HOLONOMIC_KERNELS_MOLECULES_NETWORK_NEWTON_HPP
#define HOLONOMIC_KERNELS_MOLECULES_NETWORK_NEWTON_HPP

#include "core/kernels/molecules/iterate.hpp"
#include "core/kernels/molecules/network/factor.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

struct NetNewton {
    static constexpr double part_left = 1e-4;  // of right-hand sides that a solve leaves

    const Net net;
    const NetworkPlan &s;
    Net3 r, moves, b, D, new_D;
    double *tau, *t, *a2, *per_a2, *stretch;
    double *worst;  // [n_shares + 1] of parts
    NetFactor factor;
    double opening = 0;
    // found: the unknowns have been, and all else has yet to follow; displaced: `moves` are those of tau.
    bool found = false, displaced = false, moved = false, failed = false;

    static int64_t values(const NetworkPlan &s) {
        return Net::values(s) + 6 * in_fours(s.n_atoms) + 16 * in_fours(s.n_bonds) + in_fours(s.n_shares + 1) +
               NetFactor::values(s, false);
    }
    NetNewton(const NetworkPlan &plan, const MoleculeLane &lane, bool packed, const LongTeam *team,
              Memory<double> memory)
        : net(plan, lane, packed, team, memory), s(plan), r(Net3::take(memory, s.n_atoms)),
          moves(Net3::take(memory, s.n_atoms)), b(Net3::take(memory, s.n_bonds)), D(Net3::take(memory, s.n_bonds)),
          new_D(Net3::take(memory, s.n_bonds)), tau(memory.values(in_fours(s.n_bonds))),
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
    // Returns the largest error of a part whose bonds get(V, place, from, to) gives, of values of `of` at their atoms.
    // A NaN stays.
    template <bool fresh, class Get>
    HOL_FORCED double measure_part(const NetPart &part, const Net3 &of, const Get &get) const {
        vec most = {}, sum = {};
        double most_of_rest = 0;
        net.for_bonds(part, of, [&](auto width, int32_t k, const auto &from, const auto &to) HOL_FORCED {
            typedef decltype(width) V;
            const V error = measure<fresh>(k, get(width, k, from, to));
            take(error, most, sum, most_of_rest);
        });
        most = most + 0 * sum;
        for (int i = 0; i < W; ++i) most_of_rest = larger(Width<vec>::get(most, i), most_of_rest);
        return most_of_rest;
    }
    __attribute__((noinline)) double measure_fresh(const NetPart &part, const Net3 &bonds) const {
        return measure_part<true>(part, moves, [&](auto width, int32_t k, const auto &, const auto &) HOL_FORCED {
            return bonds.get<decltype(width)>(k);
        });
    }
    HOL_FORCED static void take(const vec &error, vec &most, vec &sum, double &) {
        most = max(error, most);
        sum = sum + error;
    }
    HOL_FORCED static void take(double error, vec &, vec &, double &most_of_rest) {
        most_of_rest = larger(error, most_of_rest);
    }
    static double larger(double error, double than) { return error <= than ? than : error; }
    double worst_of_all() const { return largest_in(worst, s.n_shares + 1); }
    // Calls body(part), first for the rest.
    template <class Body>
    HOL_FORCED void for_all_parts(const Body &body) const {
        body(net.rest());
        net.for_parts(body);
    }

    // Calls each(first place, end) for the parts whose largest error is that of all.
    template <class Each>
    void for_worst_parts(double error, const Each &each) const {
        for (int32_t i = 0; i <= s.n_shares; ++i) {
            const NetPart part = i < s.n_shares ? net.part(i) : net.rest();
            if (worst[i] >= error) each(part.first_place, part.end_place);
        }
    }

    double open() const { return opening; }
    void forget(Flag which) {
        if (!which.set) return;
        for (int32_t k = 0; k < s.n_bonds; ++k) tau[k] = 0;
        displaced = false;
    }
    // What tau does to the sites of a part; before that, if the unknowns have just been found, all bonds' corrections.
    void displace(const NetPart &part) const {
        const bool rest = part.share == s.n_shares;
        if (found && rest) {
            factor.take_down_rest(t);
            for (int32_t k = part.first_place; k < part.end_place; ++k) tau[k] += t[k];
            for (int32_t u = 0; u < s.n_unknowns; ++u) tau[s.place_of[u]] += t[s.place_of[u]];
        } else if (found) {
            factor.take_down(part, t);
            net.for_strands(part, [&](auto width, const NetStrands &g) HOL_FORCED {
                typedef decltype(width) V;
                for (int32_t k = 1; k + 1 < g.length; ++k) {
                    const int32_t place = g.place + k * g.step;
                    store_any(tau + place, load_any<V>(tau + place) + load_any<V>(t + place));
                }
            });
        }
        if (rest)
            factor.find_pulls_of_rest(tau, moves, nullptr);
        else
            net.find_pulls(part, tau, b, moves, nullptr);
        for (int32_t i = part.first_site; i < part.end_site; ++i) moves.set(i, net.w[i] * moves.get<double>(i));
    }
    __attribute__((noinline)) void displace() {
        if (!displaced) for_all_parts([&](const NetPart &part) { displace(part); });
        displaced = true;
        found = false;
    }
    // As tau moves a bond.
    template <class V>
    HOL_FORCED Vector3<V> moved_bond(int32_t k, const Vector3<V> &from, const Vector3<V> &to) const {
        return D.get<V>(k) + (to - from);
    }
    // What is left is taken up at once, while it is in cache.
    __attribute__((noinline)) double move() {
        for_all_parts([&](const NetPart &part) {
            if (!displaced) displace(part);
            worst[part.share] = measure_moved(part);
            if (part.share == s.n_shares)
                factor.take_up_rest(t);
            else
                factor.take_up(part, t);
        });
        factor.unknowns.add_pushes();
        displaced = moved = true;
        found = false;
        return failed ? __builtin_nan("") : worst_of_all();
    }
    __attribute__((noinline)) double measure_moved(const NetPart &part) const {
        return measure_part<false>(part, moves, [&](auto, int32_t k, const auto &from, const auto &to) HOL_FORCED {
            return moved_bond(k, from, to);
        });
    }
    double error_of(int32_t k) const {
        const Vector3<double> zero = {}, from = moves.get<double>(s.from[k]), to = moves.get<double>(s.to[k]);
        return abs(excess(moved_bond(k, moved ? from : zero, moved ? to : zero), a2[k])) * per_a2[k];
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
            if (moved)
                net.for_bonds(part, moves, [&](auto, int32_t k, const auto &from, const auto &to) HOL_FORCED {
                    new_D.set(k, moved_bond(k, from, to));
                });
            measure_fresh(part, moved ? new_D : D);
            factorize_part(part, moved ? new_D : D);
        });
        factor.close();
    }
    __attribute__((noinline)) void solve(Flag) {
        failed = failed || factor.unknowns.solve(part_left, nullptr) < 0;
        found = true;
        displaced = false;
    }
};

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
