// Position level of a network, a gel or a lattice: one molecule of strands that meet at nodes (plan.hpp). A way of
// position_level.hpp that reads bonds strand by strand in lanes; newton.hpp has its equations (theory (58)).
#pragma once

#include "core/kernels/atom.hpp"
#include "core/kernels/molecules/network/newton.hpp"
#include "core/kernels/molecules/position_level.hpp"
#include "core/kernels/molecules/twice.hpp"

namespace holonomic::HOL_ISA::graph {

struct NetPositions : PositionWay<double> {
    const unsigned char *fixed;  // by local atom
    NetNewton newton;
    double *largest;  // [n_shares + 1] of parts: coordinates, then squares of lengths, then their inverses

    static int64_t values(const NetworkPlan &s) { return NetNewton::values(s) + 3 * in_fours(s.n_shares + 1); }

    NetPositions(const PositionsCall &c, const NetworkPlan &plan, const unsigned char *held, const MoleculeLane &l,
                 bool packed, const LongTeam *team, Memory<double> memory, Tally &sum)
        : PositionWay<double>{c, &l, sum}, fixed(held), newton(plan, l, packed, team, memory),
          largest(memory.next + NetNewton::values(plan)) {}

    // The largest of what is read in lanes, and of what is left of them.
    struct Largest {
        vec lanes{};
        double rest = 0;
        HOL_FORCED void take(const vec &a) { lanes = max(a, lanes); }
        HOL_FORCED void take(double a) { rest = max(a, rest); }
    };
    void keep(const NetPart &part, const Largest &coordinate) const {
        const int32_t n = newton.s.n_shares + 1, n_indices = part.end_index - part.first_index;
        double most = coordinate.rest;
        for (int i = 0; i < W; ++i) most = max(Width<vec>::get(coordinate.lanes, i), most);
        largest[part.share] = most;
        largest[n + part.share] = largest_of(newton.a2 + part.first_index, n_indices);
        largest[2 * n + part.share] = largest_of(newton.per_a2 + part.first_index, n_indices);
    }
    // An atom, before and now.
    template <class V>
    struct Atom {
        Vector3<V> reference, r;
    };
    template <class V>
    HOL_FORCED Atom<V> read_atom(int32_t site) const {
        const auto read = newton.net.reader<V>(site);
        newton.net.read_masses<V>(site);
        return {read(call.r_ref), read(call.r)};
    }
    // What is known of a bond; returns its error.
    template <class V>
    HOL_FORCED V read_bond(int32_t bond_index, const Atom<V> &from, const Atom<V> &to) const {
        const Net &net = newton.net;
        const Vector3<V> bond = net.bond_between(call.box, from.r, to.r);
        newton.b.set(bond_index, net.bond_between(call.box_ref, from.reference, to.reference));
        newton.D.set(bond_index, bond);
        const V a = gather<V>(net.lane.length, newton.s.bond_of + bond_index), a2 = a * a;
        store_any(newton.a2 + bond_index, a2);
        store_any(newton.per_a2 + bond_index, Width<V>::all(1) / a2);
        store_any(newton.tau + bond_index,
                  call.guess ? Width<V>::all(tau_of_lambda()) * net.of_bonds<V>(call.lambda, bond_index) : V{});
        return newton.measure<true>(bond_index, bond);
    }
    // Reference positions stand where moves will.
    void read_rest() const {
        const NetworkPlan &s = newton.s;
        const NetPart rest = newton.net.rest();
        newton.net.for_ranges(rest.first_site, rest.end_site, [&](int32_t first, int32_t end) {
            newton.net.for_all(first, end, [&](auto width, int32_t i) HOL_FORCED {
                const auto atom = read_atom<decltype(width)>(i);
                newton.moves.set(i, atom.reference);
                newton.r.set(i, atom.r);
            });
        });
        Largest coordinate;
        const double *const components[] = {newton.r.x, newton.r.y, newton.r.z};
        for (const double *x : components)
            coordinate.take(largest_of(x + rest.first_site, rest.end_site - rest.first_site));
        newton.worst[rest.share] = newton.largest_error([&](const auto &note) HOL_FORCED {
            const auto atom = [&](int32_t i) {
                return Atom<double>{newton.moves.get<double>(i), newton.r.get<double>(i)};
            };
            for (int32_t k = rest.first_index; k < rest.end_index; ++k)
                note(read_bond<double>(k, atom(s.from[k]), atom(s.to[k])));
        });
        keep(rest, coordinate);
        newton.factor.factorize_rest(newton.D, newton.t);
    }
    __attribute__((noinline)) void read_strands(const NetPart &part) const {
        const Net &net = newton.net;
        Largest coordinate;
        newton.worst[part.share] = newton.largest_error([&](const auto &note) HOL_FORCED {
            net.for_strands(part, [&](auto width, const NetStrands &g) HOL_FORCED {
                typedef decltype(width) V;
                const auto at_node = [&](int end) HOL_FORCED {
                    return Atom<V>{net.at_node<V>(g, end, newton.moves), net.at_node<V>(g, end, newton.r)};
                };
                net.for_bonds(
                    g, [&]() HOL_FORCED { return at_node(0); },
                    [&](int32_t site, int32_t) HOL_FORCED {
                        const Atom<V> atom = read_atom<V>(site);
                        const Vector3<V> sizes = absolute(atom.r);
                        coordinate.take(max(sizes.x, max(sizes.y, sizes.z)));
                        return atom;
                    },
                    [&]() HOL_FORCED { return at_node(1); },
                    [&](int32_t bond_index, const Atom<V> &from, const Atom<V> &to)
                        HOL_FORCED { note(read_bond<V>(bond_index, from, to)); });
            });
        });
        keep(part, coordinate);
        newton.factor.factorize(part, newton.D, newton.t);  // with a guess, too: moves need what this keeps of the ends
    }
    __attribute__((noinline)) Extent<double> load() {
        const NetworkPlan &s = newton.s;
        read_rest();
        newton.net.for_parts([&](const NetPart &part) { read_strands(part); });
        newton.opening = newton.worst_of_all();
        const int32_t n = s.n_shares + 1;
        return {largest_of(largest, n), 1 / sqrt(largest_of(largest + 2 * n, n)), sqrt(largest_of(largest + n, n))};
    }
    static double largest_of(const double *x, int32_t n) {
        vec most = {};
        int32_t i = 0;
        for (; i + W <= n; i += W) most = max(abs(load_any<vec>(x + i)), most);
        double all = 0;
        for (int j = 0; j < W; ++j) all = max(Width<vec>::get(most, j), all);
        for (; i < n; ++i) all = max(abs(x[i]), all);
        return all;
    }

    double largest_pull(bool exact) const {
        const NetworkPlan &s = newton.s;
        if (!exact) return largest_of(newton.net.w, s.n_atoms) * largest_of(newton.tau, s.n_bonds);
        double pull = 0;
        for (int32_t k = 0; k < s.n_bonds; ++k)
            pull = max(max(newton.net.w[s.from[k]], newton.net.w[s.to[k]]) * abs(newton.tau[k]), pull);
        return pull;
    }
    // What the last solve has left to be done comes first.
    ScalarMask rejected(ScalarMask) {
        newton.correct();
        return ScalarMask{newton.failed};
    }
    void note_worst(unsigned which, double error) const {
        note_worst_bond(
            newton.s, which, error, lane, [&](int32_t k) { return newton.error_of(k); },
            [&](const auto &each) { newton.for_worst_parts(error, each); }, tally);
    }
    void write_multipliers(unsigned) const {
        newton.net.for_ranges(0, newton.s.n_bonds, [&](int32_t first, int32_t end) {
            for (int32_t k = first; k < end; ++k)
                call.lambda[newton.net.number_of_bond(k)] = mul_add(newton.tau[k], lambda_of_tau(), 0.0);
        });
    }
    void add_virial(unsigned which) const {
        graph::add_virial<double>(
            0, newton.s.n_bonds, [&](int32_t k) { return newton.b.get<double>(k); },
            [&](int32_t k) { return newton.tau[k]; }, per_dt2(), which, tally);
    }
    void write_moves(unsigned, unsigned) const {
        const double per_dt = 1 / call.dt;
        const auto write = [&](auto width, int32_t i, const auto &move) HOL_FORCED {
            typedef decltype(width) V;
            newton.net.write_at<V>(call.r, i, fixed, true, move);
            if (call.v.x) newton.net.write_at<V>(call.v, i, fixed, true, Width<V>::all(per_dt) * move);
        };
        newton.find_moves_of_rest();
        newton.net.for_all(newton.s.first_node, newton.s.n_atoms, [&](auto width, int32_t i) HOL_FORCED {
            write(width, i, newton.moves.get<decltype(width)>(i));
        });
        newton.for_all_strands([&](auto width, const NetStrands &g) HOL_FORCED { newton.for_moves(width, g, write); });
    }
};

}  // namespace holonomic::HOL_ISA::graph
