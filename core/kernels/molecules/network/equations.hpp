// The linear equations of a network: their bonds, their right-hand sides, and what multipliers leave of them in twice
// the precision.
#pragma once

#include "core/kernels/molecules/load.hpp"
#include "core/kernels/molecules/network/strands.hpp"
#include "core/kernels/molecules/twice.hpp"

namespace holonomic::HOL_ISA::graph {

struct NetEquations {
    const Net net;
    const NetworkPlan &s;
    const Box &box;
    const AtomArray &coordinates;
    const Inputs &in;
    const int terms;
    Net3 r, f, G;                     // of the rest: positions, w f, pulls
    Net3 v, d;                        // velocities: of the rest, too, if they are not `rates`; bonds
    double *t, *side, *size_of_side;  // multipliers; right-hand sides, and the sizes of their terms
    Pair3<double> *a;                 // of nodes and atoms of trees, in twice the precision

    static int64_t values(const NetworkPlan &s) {
        return Net::values(s) + 15 * in_fours(n_rest(s)) + 3 * in_fours(s.n_atoms) + 6 * in_fours(s.n_bonds);
    }
    NetEquations(const NetworkPlan &plan, const MoleculeLane &l, bool packed, const LongTeam *team, const Box &b,
                 const AtomArray &positions, const Inputs &inputs, int sides, Memory<double> &memory)
        : net(plan, l, packed, team, memory), s(plan), box(b), coordinates(positions), in(inputs), terms(sides),
          r(Net3::take(memory, n_rest(s), s.first_node)), f(Net3::take(memory, n_rest(s), s.first_node)),
          G(Net3::take(memory, n_rest(s), s.first_node)), v(Net3::take(memory, s.n_atoms)),
          d(Net3::take(memory, s.n_bonds)), t(memory.values(in_fours(s.n_bonds))),
          side(memory.values(in_fours(s.n_bonds))), size_of_side(memory.values(in_fours(s.n_bonds))),
          a(reinterpret_cast<Pair3<double> *>(memory.values(6 * in_fours(n_rest(s))))) {}

    bool has(int wanted) const { return (terms & wanted) != 0; }

    static int32_t n_rest(const NetworkPlan &s) { return s.n_nodes + s.n_tree; }
    Net3 r_of(const NetPart &part) const { return net.is_rest(part) ? r : part.of_sites(0); }
    Net3 v_of(const NetPart &part) const { return net.is_rest(part) || has(rates) ? v : part.of_sites(1); }
    Net3 f_of(const NetPart &part) const { return net.is_rest(part) ? f : part.of_sites(2); }

    void read_atoms(const NetPart &part, int32_t first, int32_t end) const {
        NetReading all[3] = {{&coordinates, r_of(part), false}};
        int n = 1;
        if (has(squares | rates)) all[n++] = {in.v, v_of(part), false};
        if (has(pulls)) all[n++] = {in.f, f_of(part), true};
        net.read_sites(first, end, all, n);
    }
    void find_equations(const NetPart &part) const {
        net.find_bonds(part, box, r, r_of(part), d);
        find_sides(part);
    }
    // Right-hand sides, and the sum of their terms' sizes.
    __attribute__((noinline)) void find_sides(const NetPart &part) const {
        if (!has(pulls | squares | rates))
            for (int32_t k = part.first_place; k < part.end_place; ++k) side[k] = size_of_side[k] = 0;
        if (has(pulls)) add_products(part, f, f_of(part), false);
        if (has(rates)) add_products(part, v, v_of(part), false);
        if (has(squares)) add_products(part, v, v_of(part), true);
        for (int32_t k = part.first_place; (in.rhs || in.strain) && k < part.end_place; ++k) {
            const double value =
                in.rhs ? 0.5 * in.rhs[net.lane.first_bond + s.bond_of[k]] : stretching(in.strain, d.get<double>(k));
            side[k] += value;
            size_of_side[k] += abs(value);
        }
        for (int32_t k = part.first_place; k < part.end_place; ++k) t[k] = side[k];
    }
    // d.(x_j - x_i), the first of the terms where there are two, or |x_j - x_i|^2.
    void add_products(const NetPart &part, const Net3 &of_rest, const Net3 &of_part, bool square) const {
        const bool more = square && has(pulls);
        net.for_bonds(part, of_rest, of_part, [&](auto width, int32_t k, const auto &from, const auto &to) HOL_FORCED {
            typedef decltype(width) V;
            const Vector3<V> change = to - from, bond = d.get<V>(k);
            V value = square ? dot(change, change) : dot(bond, change),
              size = square ? value : dot(absolute(bond), absolute(from) + absolute(to));
            if (more) {
                value = value + load_any<V>(side + k);
                size = size + load_any<V>(size_of_side + k);
            }
            store_any(side + k, value);
            store_any(size_of_side + k, size);
        });
    }

    Pair3<double> exact(int32_t k) const { return pairs_of(d.get<double>(k), Vector3<double>{}); }
    template <class V>
    __attribute__((noinline)) Pair3<V> unrounded_between(const Vector3<V> &from, const Vector3<V> &to) const {
        Vector3<V> bond, low;
        unrounded_bond(box, from, to, bond, low);
        return pairs_of(bond, low);
    }
    Pair3<double> unrounded(int32_t k) const {
        return unrounded_between(read(coordinates, net.at, s.atom_of[s.from[k]]),
                                 read(coordinates, net.at, s.atom_of[s.to[k]]));
    }
    // In twice the precision: of an atom with these multipliers; and what is left of a bond's equation.
    Pair3<double> acceleration_of(int32_t site, const double *solution, bool low) const {
        const Vector3<double> zero = {};
        Pair3<double> sum = pairs_of(has(pulls) ? read(*in.f, net.at, s.atom_of[site]) : zero, zero);
        net.for_bonds_of(site, [&](int32_t k, double sign) {
            sum = add_pairs(sum, scale_pairs(sign * solution[k], low ? unrounded(k) : exact(k)));
        });
        sum = scale_pairs(net.w[site], sum);
        return has(rates) ? add_pairs(sum, pairs_of(v.get<double>(site), zero)) : sum;
    }
    double residual_of(int32_t k, const Pair3<double> &bond, const Pair3<double> &from, const Pair3<double> &to) const {
        Pair<double> sum = dot_pairs(bond, subtract_pairs(to, from));
        if (has(squares)) {
            const Pair3<double> dv =
                difference_of(read(*in.v, net.at, s.atom_of[s.from[k]]), read(*in.v, net.at, s.atom_of[s.to[k]]));
            sum = add_pairs(sum, dot_pairs(dv, dv));
        }
        if (in.rhs) sum = add_pairs(sum, {0.5 * in.rhs[net.lane.first_bond + s.bond_of[k]], 0.0});
        if (in.strain) sum = add_pairs(sum, {stretching(in.strain, d.get<double>(k)), 0.0});
        return sum.hi + sum.lo;
    }
    template <class V>
    __attribute__((noinline)) V given_to(int32_t place) const {
        V all = {};
        for (int i = 0; i < Width<V>::lanes; ++i)
            Width<V>::set(all, i,
                          in.rhs ? 0.5 * in.rhs[net.lane.first_bond + s.bond_of[place + i]]
                                 : stretching(in.strain, d.get<double>(place + i)));
        return all;
    }
};

}  // namespace holonomic::HOL_ISA::graph
