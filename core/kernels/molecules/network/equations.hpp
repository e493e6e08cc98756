// The linear equations of a network: their bonds, their right-hand sides, and what multipliers leave of them in twice
// the precision.
#pragma once

#include "core/kernels/molecules/cycles/residual.hpp"
#include "core/kernels/molecules/load.hpp"
#include "core/kernels/molecules/network/strands.hpp"

namespace holonomic::HOL_ISA::graph {

template <class V>
HOL_INLINE void set_lane(Vector3<V> &a, int i, const Vector3<double> &one) {
    Width<V>::set(a.x, i, one.x);
    Width<V>::set(a.y, i, one.y);
    Width<V>::set(a.z, i, one.z);
}
template <class V>
HOL_INLINE void set_lane(Pair<V> &a, int i, const Pair<double> &one) {
    Width<V>::set(a.hi, i, one.hi);
    Width<V>::set(a.lo, i, one.lo);
}
template <class V>
HOL_INLINE Pair<double> lane_of(const Pair<V> &a, int i) {
    return {Width<V>::get(a.hi, i), Width<V>::get(a.lo, i)};
}
// Of a list of which every `step`-th is taken.
template <class V>
HOL_INLINE Pair3<V> gather_pairs(const Pair3<double> *values, const int32_t *place, int step) {
    Pair3<V> all = {};
    for (int i = 0; i < Width<V>::lanes; ++i) {
        const Pair3<double> &one = values[place[step * i]];
        set_lane(all.x, i, one.x);
        set_lane(all.y, i, one.y);
        set_lane(all.z, i, one.z);
    }
    return all;
}

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
    // What the multipliers of `solution` leave, into t; before a bond's own is written keep(width, place, bond, mass,
    // tensions): the sums over its atoms of inverse masses, and of these times |t| |d| of all their bonds, `tension` in
    // the rest.
    template <class Keep>
    __attribute__((noinline)) void find_residuals(const double *solution, const double *tension,
                                                  const Keep &keep) const {
        find_accelerations(solution);
        net.for_all(s.first_tree_place, s.n_bonds, [&](auto width, int32_t k) HOL_FORCED {
            typedef decltype(width) V;
            const int32_t *const from = s.from + k, *const to = s.to + k;
            const Pair3<double> *const of_site = a - s.first_node;
            const Pair3<V> bond = unrounded_between(gather<V>(r, from), gather<V>(r, to));
            const V w = gather<V>(net.w, from), wn = gather<V>(net.w, to);
            keep(width, k, bond, w + wn, mul_add(w, gather<V>(tension, from), wn * gather<V>(tension, to)));
            Pair<V> sum =
                dot_pairs(bond, subtract_pairs(gather_pairs<V>(of_site, to, 1), gather_pairs<V>(of_site, from, 1)));
            if (has(squares)) {
                const Pair3<V> change = difference_of(gather<V>(v, from), gather<V>(v, to));
                sum = add_pairs(sum, dot_pairs(change, change));
            }
            if (in.rhs || in.strain) sum = add_pairs(sum, Pair<V>{given_to<V>(k), V{}});
            store_any(t + k, sum.hi + sum.lo);
        });
        net.for_parts([&](const NetPart &part) { find_residuals(part, solution, tension, keep); });
    }
    // Of nodes and atoms of trees, in twice the precision.
    __attribute__((noinline)) void find_accelerations(const double *solution) const {
        const Vector3<double> zero = {};
        Pair3<double> *const of_site = a - s.first_node;
        net.for_ranges(s.first_node, s.n_atoms, [&](int32_t first, int32_t end) {
            for (int32_t i = first; i < end; ++i)
                of_site[i] = pairs_of(has(pulls) ? read(*in.f, net.at, s.atom_of[i]) : zero, zero);
        });
        net.for_all(0, s.n_unknowns, [&](auto width, int32_t u) HOL_FORCED {
            add_pulls(width, solution, [&](int i) { return s.place_of[u + i]; });
        });
        net.for_all(s.first_tree_place, s.n_bonds, [&](auto width, int32_t k) HOL_FORCED {
            add_pulls(width, solution, [&](int i) { return k + i; });
        });
        net.for_ranges(s.first_node, s.n_atoms, [&](int32_t first, int32_t end) {
            for (int32_t i = first; i < end; ++i) {
                of_site[i] = scale_pairs(net.w[i], of_site[i]);
                if (has(rates)) of_site[i] = add_pairs(of_site[i], pairs_of(v.get<double>(i), zero));
            }
        });
    }
    // By the bonds at place(lane).
    template <class V, class Place>
    HOL_FORCED void add_pulls(const V &, const double *solution, const Place &place) const {
        Vector3<V> from = {}, to = {};
        V multiplier = {};
        for (int i = 0; i < Width<V>::lanes; ++i) {
            const int32_t k = place(i);
            Width<V>::set(multiplier, i, solution[k]);
            set_lane(from, i, read(coordinates, net.at, s.atom_of[s.from[k]]));
            set_lane(to, i, read(coordinates, net.at, s.atom_of[s.to[k]]));
        }
        const Pair3<V> pull = scale_pairs(multiplier, unrounded_between(from, to));
        Pair3<double> *const of_site = a - s.first_node;
        for (int i = 0; i < Width<V>::lanes; ++i) {
            const int32_t k = place(i), begin = s.from[k], end = s.to[k];
            const Pair3<double> one = {lane_of(pull.x, i), lane_of(pull.y, i), lane_of(pull.z, i)};
            if (begin >= s.first_node) of_site[begin] = add_pairs(of_site[begin], one);
            if (end >= s.first_node) of_site[end] = subtract_pairs(of_site[end], one);
        }
    }
    template <class Keep>
    __attribute__((noinline)) void find_residuals(const NetPart &part, const double *solution, const double *tension,
                                                  const Keep &keep) const {
        NetReading all[3] = {{&coordinates, r_of(part), false}};
        int n = 1;
        if (has(squares)) all[n++] = {in.v, v_of(part), false};
        if (has(pulls)) all[n++] = {in.f, f_of(part), false};
        net.read_sites(part.first_site, part.end_site, all, n);
        net.for_strands(part, [&](auto width, const NetStrands &g) HOL_FORCED {
            typedef decltype(width) V;
            const auto site_of = [&](int32_t k) { return g.site + k * g.step; };
            const auto behind = [&](int32_t k, const Net3 &of, const Net3 &of_part)
                                    HOL_FORCED {  // the atom behind bond k
                                        return k + 1 < g.length ? of_part.get<V>(site_of(k)) : net.at_node<V>(g, 1, of);
                                    };
            const Vector3<V> zero = {};
            Vector3<V> at_atom = behind(0, r, r_of(part)), speed = has(squares) ? net.at_node<V>(g, 0, v) : zero;
            Pair3<V> from = at_node<V>(g, 0), bond = unrounded_between(net.at_node<V>(g, 0, r), at_atom),
                     pull = scale_pairs(load_any<V>(solution + g.place), bond);
            V w = net.at_node<V>(g, 0, net.w), T = net.at_node<V>(g, 0, tension), own = size_of(pull);
            for (int32_t k = 0; k < g.length; ++k) {
                const int32_t place = g.place + k * g.step;
                Pair3<V> to, next = bond;
                V wn, Tn;
                if (k + 1 < g.length) {
                    const Vector3<V> beyond = behind(k + 1, r, r_of(part));
                    next = unrounded_between(at_atom, beyond);
                    at_atom = beyond;
                    to = subtract_pairs(pairs_of(has(pulls) ? f_of(part).get<V>(site_of(k)) : zero, zero), pull);
                    pull = scale_pairs(load_any<V>(solution + place + g.step), next);
                    wn = load_any<V>(net.w + site_of(k));
                    to = scale_pairs(wn, add_pairs(to, pull));
                    if (has(rates)) to = add_pairs(to, pairs_of(v.get<V>(site_of(k)), zero));
                    const V one = size_of(pull);
                    Tn = own + one;
                    own = one;
                } else {
                    to = at_node<V>(g, 1);
                    wn = net.at_node<V>(g, 1, net.w);
                    Tn = net.at_node<V>(g, 1, tension);
                }
                keep(width, place, bond, w + wn, mul_add(w, T, wn * Tn));
                w = wn;
                T = Tn;
                Pair<V> sum = dot_pairs(bond, subtract_pairs(to, from));
                if (has(squares)) {
                    const Vector3<V> faster = behind(k, v, v_of(part));
                    const Pair3<V> change = difference_of(speed, faster);
                    sum = add_pairs(sum, dot_pairs(change, change));
                    speed = faster;
                }
                if (in.rhs || in.strain) sum = add_pairs(sum, Pair<V>{given_to<V>(place), V{}});
                store_any(t + place, sum.hi + sum.lo);
                from = to;
                bond = next;
            }
        });
    }
    template <class V>
    HOL_STATIC V size_of(const Pair3<V> &a) {
        return sqrt(mul_add(a.x.hi, a.x.hi, mul_add(a.y.hi, a.y.hi, a.z.hi * a.z.hi)));
    }
    // Of the nodes at the ends of strands.
    template <class V>
    HOL_FORCED Pair3<V> at_node(const NetStrands &g, int end) const {
        return gather_pairs<V>(a, s.strand_node + 2 * g.strand + end, 2);
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
