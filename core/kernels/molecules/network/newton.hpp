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
    bool found = false, displaced = false, moved = false, taken_up = false, failed = false;

    static int64_t values(const NetworkPlan &s) {
        return Net::values(s) + 6 * in_fours(s.n_atoms) + 16 * in_fours(s.n_bonds) + in_fours(s.n_shares + 1) +
               NetFactor::values(s);
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
    // Returns the largest error of a part. A NaN stays.
    template <bool fresh>
    __attribute__((noinline)) double measure_all(const NetPart &part, const Net3 &bonds) const {
        vec most = {}, sum = {};
        int32_t k = part.first_place;
        for (; k + W <= part.end_place; k += W) {
            const vec error = measure<fresh>(k, bonds.get<vec>(k));
            most = max(error, most);
            sum = sum + error;
        }
        most = most + 0 * sum;
        double worst_of = 0;
        for (int i = 0; i < W; ++i) worst_of = larger(Width<vec>::get(most, i), worst_of);
        for (; k < part.end_place; ++k) worst_of = larger(measure<fresh>(k, bonds.get<double>(k)), worst_of);
        return worst_of;
    }
    static double larger(double error, double than) { return error <= than ? than : error; }
    double worst_of_all() const { return largest_in(worst, s.n_shares + 1); }
    // Calls body(part), first for the rest.
    template <class Body>
    HOL_FORCED void for_all_parts(const Body &body) const {
        body(net.rest());
        net.for_parts(body);
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
            factor.unknowns.for_each([&](int32_t u) { tau[s.place_of[u]] += t[s.place_of[u]]; });
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
            net.find_pulls_of_rest(tau, b, moves, nullptr);
        else
            net.find_pulls(part, tau, b, moves, nullptr);
        for (int32_t i = part.first_site; i < part.end_site; ++i) moves.set(i, net.w[i] * moves.get<double>(i));
    }
    __attribute__((noinline)) void displace() {
        if (!displaced) for_all_parts([&](const NetPart &part) { displace(part); });
        displaced = true;
        found = false;
    }
    __attribute__((noinline)) double move() {
        for_all_parts([&](const NetPart &part) {
            if (!displaced) displace(part);
            net.for_bonds(part, moves, [&](auto width, int32_t k, const auto &from, const auto &to) HOL_FORCED {
                typedef decltype(width) V;
                new_D.set(k, D.get<V>(k) + (to - from));
            });
            worst[part.share] = measure_all<false>(part, new_D);
        });
        displaced = moved = true;
        found = taken_up = false;
        return failed ? __builtin_nan("") : worst_of_all();
    }
    double error_of(int32_t k) const { return abs(excess((moved ? new_D : D).get<double>(k), a2[k])) * per_a2[k]; }

    void factorize_part(const NetPart &part, const Net3 &bonds) const {
        if (part.share == s.n_shares)
            factor.factorize_rest(bonds, t);
        else
            factor.factorize(part, bonds, t);
    }
    // Without a guess, each part's factors have been made when it was read.
    void first_factors() {
        factor.close(D);
        taken_up = true;
    }
    void factorize(Flag) {
        const Net3 &bonds = moved ? new_D : D;
        for_all_parts([&](const NetPart &part) {
            measure_all<true>(part, bonds);
            factorize_part(part, bonds);
        });
        factor.close(bonds);
        taken_up = true;
    }
    __attribute__((noinline)) void solve(Flag) {
        if (!taken_up) factor.take_up_all(t);
        taken_up = false;
        failed = failed || factor.unknowns.solve(part_left, nullptr) < 0;
        found = true;
        displaced = false;
    }
};

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
