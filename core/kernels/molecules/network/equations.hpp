// The linear equations of a network: their bonds, their right-hand sides, and what multipliers leave of them in twice
// the precision.
#pragma once

#include "core/kernels/molecules/load.hpp"
#include "core/kernels/molecules/network/strands.hpp"
#include "core/kernels/molecules/twice.hpp"

namespace holonomic::HOL_ISA::graph {

// What right-hand sides are made of, of an atom: velocity, and force times inverse mass.
template <class V>
struct NetTerms {
    Vector3<V> v, f;
};

struct NetEquations {
    const Net net;
    const NetworkPlan &s;
    const Box &box;
    const AtomArray &coordinates;
    const Inputs &in;
    const int terms;
    Net3 r, f, G;                   // of the rest: positions, w f, pulls
    Net3 v, d;                      // velocities: of the rest, too, if they are not `rates`; bonds
    double *t, *rhs, *size_of_rhs;  // multipliers; right-hand sides, and the sizes of their terms
    Pair3<double> *a;               // of nodes and atoms of trees, in twice the precision

    static int64_t values_of_factor(const NetworkPlan &s) {
        return Net::values_of_factor(s) + 3 * in_fours(n_rest(s)) + 3 * in_fours(s.n_bonds);
    }
    static int64_t values(const NetworkPlan &s) {
        return Net::values(s) + 15 * in_fours(n_rest(s)) + 3 * in_fours(s.n_atoms) + 6 * in_fours(s.n_bonds);
    }
    NetEquations(const NetworkPlan &plan, const MoleculeLane &l, bool packed, const LongTeam *team, const Box &b,
                 const AtomArray &positions, const Inputs &inputs, int rhs_terms, Memory<double> &of_factor,
                 Memory<double> &memory)
        : net(plan, l, packed, team, of_factor, memory), s(plan), box(b), coordinates(positions), in(inputs),
          terms(rhs_terms), r(Net3::take(of_factor, n_rest(s), s.first_node)),
          f(Net3::take(memory, n_rest(s), s.first_node)), G(Net3::take(memory, n_rest(s), s.first_node)),
          v(Net3::take(memory, s.n_atoms)), d(Net3::take(of_factor, s.n_bonds)), t(memory.values(in_fours(s.n_bonds))),
          rhs(memory.values(in_fours(s.n_bonds))), size_of_rhs(memory.values(in_fours(s.n_bonds))),
          a(reinterpret_cast<Pair3<double> *>(memory.values(6 * in_fours(n_rest(s))))) {}

    bool has(int wanted) const { return (terms & wanted) != 0; }

    static int32_t n_rest(const NetworkPlan &s) { return s.n_nodes + s.n_tree; }

    // Reads what right-hand sides are made of. Velocities that will be projected are kept.
    template <class V>
    HOL_FORCED NetTerms<V> read_terms(const NetSites::SiteReader<V> &read, const V &mass) const {
        const Vector3<V> none = {}, velocity = has(squares | rates) ? read(*in.v) : none,
                         push = has(pulls) ? mass * read(*in.f) : none;
        if (has(rates)) v.set(read.site, velocity);
        return {velocity, push};
    }
    template <class V>
    HOL_FORCED NetTerms<V> terms_at_node(const NetStrands &g, int end) const {
        const Vector3<V> none = {}, velocity = has(squares | rates) ? net.at_node<V>(g, end, v) : none,
                         push = has(pulls) ? net.at_node<V>(g, end, f) : none;
        return {velocity, push};
    }
    // Of the rest.
    __attribute__((noinline)) void read_atoms(int32_t first, int32_t end) const {
        net.for_all(first, end, [&](auto width, int32_t i) HOL_FORCED {
            typedef decltype(width) V;
            const auto read = net.reader<V>(i);
            const NetTerms<V> atom = read_terms<V>(read, net.read_masses<V>(i));
            r.set(i, read(coordinates));
            v.set(i, atom.v);
            f.set(i, atom.f);
        });
    }
    void find_equations_of_trees() const {
        for (int32_t k = s.first_tree_bond; k < s.n_bonds; ++k) {
            const Vector3<double> bond = net.bond_between(box, r.get<double>(s.from[k]), r.get<double>(s.to[k]));
            d.set(k, bond);
            find_rhs_of_tree(k, bond);
        }
    }
    HOL_FORCED void find_rhs_of_tree(int32_t k, const Vector3<double> &bond) const {
        const int32_t i = s.from[k], j = s.to[k];
        find_rhs<double>(k, bond, {v.get<double>(i), f.get<double>(i)}, {v.get<double>(j), f.get<double>(j)});
    }
    // Of strands, as the caller has their atoms.
    template <class V>
    HOL_FORCED void find_equations(const NetStrands &g) const {
        struct Atom {
            Vector3<V> r;
            NetTerms<V> terms;
        };
        const auto at_node = [&](int end) HOL_FORCED {
            return Atom{net.at_node<V>(g, end, r), terms_at_node<V>(g, end)};
        };
        net.for_bonds(
            g, [&]() HOL_FORCED { return at_node(0); },
            [&](int32_t site, int32_t) HOL_FORCED {
                const auto read = net.reader<V>(site);
                return Atom{read(coordinates), read_terms<V>(read, net.read_masses<V>(site))};
            },
            [&]() HOL_FORCED { return at_node(1); },
            [&](int32_t bond_index, const Atom &from, const Atom &to) HOL_FORCED {
                const Vector3<V> bond = net.bond_between(box, from.r, to.r);
                d.set(bond_index, bond);
                find_rhs<V>(bond_index, bond, from.terms, to.terms);
            });
    }
    // Right-hand sides alone, where bonds, inverse masses and positions of the rest are kept: of the rest; of strands.
    __attribute__((noinline)) void find_rhs_of_rest() const {
        if (has_terms_of_atoms())
            net.for_ranges(s.first_node, s.n_atoms, [&](int32_t first, int32_t end) {
                net.for_all(first, end, [&](auto width, int32_t i) HOL_FORCED {
                    const auto atom = kept_terms_at<decltype(width)>(i);
                    v.set(i, atom.v);
                    f.set(i, atom.f);
                });
            });
        for (int32_t k = s.first_tree_bond; k < s.n_bonds; ++k) find_rhs_of_tree(k, d.get<double>(k));
    }
    template <class V>
    HOL_FORCED void find_rhs_of_strands(const NetStrands &g) const {
        net.for_bonds(
            g, [&]() HOL_FORCED { return terms_at_node<V>(g, 0); },
            [&](int32_t site, int32_t) HOL_FORCED { return kept_terms_at<V>(site); },
            [&]() HOL_FORCED { return terms_at_node<V>(g, 1); },
            [&](int32_t bond_index, const NetTerms<V> &from, const NetTerms<V> &to)
                HOL_FORCED { find_rhs<V>(bond_index, d.get<V>(bond_index), from, to); });
    }
    template <class V>
    HOL_FORCED NetTerms<V> kept_terms_at(int32_t site) const {
        return has_terms_of_atoms() ? read_terms<V>(net.reader<V>(site), load_any<V>(net.w + site)) : NetTerms<V>{};
    }
    bool has_terms_of_atoms() const { return has(squares | rates | pulls); }

    // A right-hand side d.(x_j - x_i) + |v_j - v_i|^2, and the sum of its terms' sizes.
    template <class V>
    HOL_FORCED void find_rhs(int32_t bond_index, const Vector3<V> &bond, const NetTerms<V> &from,
                             const NetTerms<V> &to) const {
        V value = {}, size = {};
        if (has(pulls | rates)) {
            const Vector3<V> &x = has(pulls) ? from.f : from.v, &y = has(pulls) ? to.f : to.v;
            value = dot(bond, y - x);
            size = dot(absolute(bond), absolute(x) + absolute(y));
        }
        if (has(squares)) {
            const Vector3<V> change = to.v - from.v;
            const V square = dot(change, change);
            value = square + value;
            size = square + size;
        }
        if (in.rhs || in.strain) {
            const V more = given_to<V>(bond_index);
            value = value + more;
            size = size + abs(more);
        }
        net.fetch_ahead(bond_index, rhs, size_of_rhs, t, d.x, d.y, d.z);
        store_any(rhs + bond_index, value);
        store_any(size_of_rhs + bond_index, size);
        store_any(t + bond_index, value);
    }
    // Of velocities that have been changed since.
    template <class V>
    HOL_FORCED void find_rate(int32_t bond_index, const Vector3<V> &from, const Vector3<V> &to) const {
        const V value = dot(d.get<V>(bond_index), to - from);
        store_any(t + bond_index, in.strain ? value + given_to<V>(bond_index) : value);
    }

    template <class V>
    __attribute__((noinline)) Pair3<V> unrounded_between(const Vector3<V> &from, const Vector3<V> &to) const {
        Vector3<V> bond, low;
        unrounded_bond(box, from, to, bond, low);
        return pairs_of(bond, low);
    }
    Vector3<double> position_of(int32_t site) const {
        return site < s.first_node ? read(coordinates, net.at, s.atom_of[site]) : r.get<double>(site);
    }
    Pair3<double> exact(int32_t k) const { return unrounded_between(position_of(s.from[k]), position_of(s.to[k])); }
    // An atom's acceleration, or velocity, before bonds do something to it.
    Vector3<double> input_of(int32_t site) const {
        const Vector3<double> zero = {};
        return has(pulls)   ? net.w[site] * read(*in.f, net.at, s.atom_of[site])
               : has(rates) ? v.get<double>(site)
                            : zero;
    }
    // In twice the precision: of an atom with these multipliers; and what is left of a bond's equation.
    Pair3<double> acceleration_of(int32_t site, const double *solution) const {
        const Vector3<double> zero = {};
        Pair3<double> sum = pairs_of(has(pulls) ? read(*in.f, net.at, s.atom_of[site]) : zero, zero);
        net.for_bonds_of(
            site, [&](int32_t k, double sign)
                      __attribute__((noinline)) { sum = add_pairs(sum, scale_pairs(sign * solution[k], exact(k))); });
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
        if (in.rhs) sum = add_pairs(sum, {0.5 * in.rhs[net.number_of_bond(k)], 0.0});
        if (in.strain) sum = add_pairs(sum, {stretching(in.strain, d.get<double>(k)), 0.0});
        return sum.hi + sum.lo;
    }
    template <class V>
    __attribute__((noinline)) V given_to(int32_t bond_index) const {
        if (in.rhs) return 0.5 * net.of_bonds<V>(in.rhs, bond_index);
        V all = {};
        for (int i = 0; i < Width<V>::lanes; ++i)
            Width<V>::set(all, i, stretching(in.strain, d.get<double>(bond_index + i)));
        return all;
    }
};

}  // namespace holonomic::HOL_ISA::graph
