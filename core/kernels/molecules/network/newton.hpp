// Newton's method for the positions of a network, as flat_newton.hpp has it for molecules along a list.
#ifndef HOLONOMIC_KERNELS_MOLECULES_NETWORK_NEWTON_HPP
#define HOLONOMIC_KERNELS_MOLECULES_NETWORK_NEWTON_HPP

#include "core/kernels/molecules/iterate.hpp"
#include "core/kernels/molecules/network/factor.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

struct NetNewton {
    static constexpr double part = 1e-4;  // of right-hand sides that a solve leaves

    const Net net;
    const NetworkPlan &s;
    Net3 r, moves, b, D, new_D;
    double *tau, *t, *a2, *per_a2, *stretch;
    double *worst;  // [n_shares + 1] of shares
    NetFactor factor;
    double opening = 0;
    bool displaced = false, moved = false, taken_up = false, failed = false;

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
    template <class V>
    HOL_FORCED void note(int32_t share, const V &error) const {
        for (int i = 0; i < Width<V>::lanes; ++i) {
            const double one = Width<V>::get(error, i);
            if (!(one <= worst[share])) worst[share] = one;
        }
    }
    void clear_worst() const {
        for (int32_t i = 0; i <= s.n_shares; ++i) worst[i] = 0;
    }
    template <bool fresh>
    __attribute__((noinline)) double measure_all(const Net3 &bonds) const {
        clear_worst();
        net.for_strands([&](auto width, const NetStrands &g, int32_t share) HOL_FORCED {
            typedef decltype(width) V;
            V most = {}, sum = {};
            for (int32_t k = 0; k < g.length; ++k) {
                const int32_t place = g.place + k * g.step;
                const V error = measure<fresh>(place, bonds.get<V>(place));
                most = max(error, most);
                sum = sum + error;
            }
            note(share, most + 0 * sum);
        });
        for (int32_t k = s.first_tree_place; k < s.n_bonds; ++k)
            note(s.n_shares, measure<fresh>(k, bonds.get<double>(k)));
        return largest_in(worst, s.n_shares + 1);
    }

    double open() const { return opening; }
    void forget(Flag which) {
        if (!which.set) return;
        for (int32_t k = 0; k < s.n_bonds; ++k) tau[k] = 0;
        displaced = false;
    }
    __attribute__((noinline)) void displace() {
        if (displaced) return;
        displaced = true;
        net.find_pulls(tau, b, moves, nullptr);
        net.for_ranges_of(s.n_atoms, [&](int32_t first, int32_t end) {
            for (int32_t i = first; i < end; ++i) moves.set(i, net.w[i] * moves.get<double>(i));
        });
    }
    __attribute__((noinline)) double move() {
        displace();
        net.for_bonds(moves, [&](auto width, int32_t k, const auto &from, const auto &to, int32_t) HOL_FORCED {
            typedef decltype(width) V;
            new_D.set(k, D.get<V>(k) + (to - from));
        });
        moved = true;
        taken_up = false;
        const double error = measure_all<false>(new_D);
        return failed ? __builtin_nan("") : error;
    }
    double error_of(int32_t k) const { return abs(excess((moved ? new_D : D).get<double>(k), a2[k])) * per_a2[k]; }

    void first_factors() { factorize({true}); }
    void factorize(Flag) {
        const Net3 &bonds = moved ? new_D : D;
        measure_all<true>(bonds);
        factor.factorize(bonds, t);
        taken_up = true;
    }
    __attribute__((noinline)) void solve(Flag) {
        if (!taken_up) factor.take_up(t);
        taken_up = false;
        failed = failed || factor.unknowns.solve(part) < 0;
        factor.take_down(t);
        net.for_ranges_of(s.n_bonds, [&](int32_t first, int32_t end) {
            for (int32_t k = first; k < end; ++k) tau[k] += t[k];
        });
        displaced = false;
    }
};

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
