// What multipliers leave of all equations of a network, in twice the precision, taken up at once. What bonds at nodes
// leave is added up where these are unknowns; atoms between nodes, and strands, are gone through once.
#pragma once

#include "core/kernels/molecules/network/equations.hpp"
#include "core/kernels/molecules/network/factor.hpp"

namespace holonomic::HOL_ISA::graph {

template <class V>
HOL_INLINE Pair<double> lane_of(const Pair<V> &a, int i) {
    return {Width<V>::get(a.hi, i), Width<V>::get(a.lo, i)};
}
template <class V>
HOL_INLINE Pair3<double> lane_of(const Pair3<V> &a, int i) {
    return {lane_of(a.x, i), lane_of(a.y, i), lane_of(a.z, i)};
}
template <class V>
HOL_INLINE void set_lane(Pair3<V> &a, int i, const Pair3<double> &one) {
    const auto set = [i](Pair<V> &to, const Pair<double> &from) HOL_FORCED {
        Width<V>::set(to.hi, i, from.hi);
        Width<V>::set(to.lo, i, from.lo);
    };
    set(a.x, one.x);
    set(a.y, one.y);
    set(a.z, one.z);
}

// The vectors that the iteration works with are free until it begins.
struct NetResiduals {
    const NetEquations &e;
    const NetFactor &factor;
    const double *solution;
    const Net &net = e.net;
    const NetworkPlan &s = e.s;
    const Unknowns &at_end = factor.unknowns;
    const Net3 low = {at_end.p, at_end.p_node, at_end.v};  // of a bond at an end, beside its D
    double *const multiplier = at_end.t;
    double *const left_hi = at_end.r, *const left_lo = at_end.shadow;  // of its equation, but for what nodes do
    Pair3<double> *const a = e.a - s.first_node;                       // of the rest, by site

    // Into t, taken up. Before that keep(width, bond_index, bond, mass, tensions): the sums over the bond's atoms of
    // inverse masses, and of these times |t| |d| of all their bonds, which `tension` has of the rest.
    template <class Keep>
    __attribute__((noinline)) void find(const double *tension, const Keep &keep) const {
        net.for_parts([&](const NetPart &part) { find(part, tension, keep); });
        accelerate_rest();
        net.for_all(s.first_tree_bond, s.n_bonds, [&](auto width, int32_t k) HOL_FORCED {
            typedef decltype(width) V;
            const int32_t *const from = s.from + k, *const to = s.to + k;
            const Pair3<V> bond = e.unrounded_between(gather<V>(e.r, from), gather<V>(e.r, to));
            const V w = gather<V>(net.w, from), wn = gather<V>(net.w, to);
            keep(width, k, bond, w + wn, mul_add(w, gather<V>(tension, from), wn * gather<V>(tension, to)));
            Pair<V> sum = dot_pairs(bond, subtract_pairs(of_rest<V>(to), of_rest<V>(from)));
            if (e.has(squares)) sum = add_pairs(sum, square_of(gather<V>(e.v, from), gather<V>(e.v, to)));
            add_given(sum, k);
            store_any(e.t + k, sum.hi + sum.lo);
        });
        factor.take_up_rest(e.t);
        net.for_all(0, s.n_unknowns, [&](auto width, int32_t u) HOL_FORCED {
            typedef decltype(width) V;
            const Pair<V> so_far = {load_any<V>(left_hi + u), load_any<V>(left_lo + u)},
                          sum = subtract_pairs(so_far, dot_pairs(bond_at<V>(u), of_nodes<V>(u)));
            store_any(at_end.y + u, load_any<V>(at_end.y + u) + (sum.hi + sum.lo));
        });
        factor.add_pushes();
    }

private:
    template <class V>
    HOL_FORCED Pair3<V> bond_at(int32_t u) const {
        return pairs_of(at_end.D.get<V>(u), low.get<V>(u));
    }
    template <class V>
    HOL_FORCED Pair3<V> of_rest(const int32_t *site) const {
        Pair3<V> all = {};
        for (int i = 0; i < Width<V>::lanes; ++i) set_lane(all, i, a[site[i]]);
        return all;
    }
    // The node of an unknown, less the one where it is foreign.
    template <class V>
    HOL_FORCED Pair3<V> of_nodes(int32_t u) const {
        Pair3<V> all = {};
        for (int i = 0; i < Width<V>::lanes; ++i) {
            const int32_t other = s.other_node[u + i];
            const Pair3<double> &own = e.a[s.node_of[u + i]];
            set_lane(all, i, other < 0 ? own : subtract_pairs(own, e.a[other]));
        }
        return all;
    }
    template <class V>
    HOL_STATIC Pair<V> square_of(const Vector3<V> &from, const Vector3<V> &to) {
        const Pair3<V> change = difference_of(from, to);
        return dot_pairs(change, change);
    }
    template <class V>
    HOL_FORCED void add_given(Pair<V> &sum, int32_t bond_index) const {
        if (e.in.rhs || e.in.strain) sum = add_pairs(sum, Pair<V>{e.given_to<V>(bond_index), V{}});
    }
    // Nodes and atoms of trees.
    __attribute__((noinline)) void accelerate_rest() const {
        const Vector3<double> zero = {};
        net.for_ranges(s.first_node, s.n_atoms, [&](int32_t first, int32_t end) {
            if (e.has(pulls))
                net.for_all(first, end, [&](auto width, int32_t i) HOL_FORCED {
                    e.f.set(i, net.read_at<decltype(width)>(*e.in.f, i));
                });
            for (int32_t i = first; i < end; ++i) a[i] = pairs_of(e.has(pulls) ? e.f.get<double>(i) : zero, zero);
        });
        net.for_all(0, s.n_unknowns, [&](auto width, int32_t u) HOL_FORCED {
            typedef decltype(width) V;
            const Pair3<V> pull = scale_pairs(load_any<V>(multiplier + u), bond_at<V>(u));
            for (int i = 0; i < Width<V>::lanes; ++i) pull_apart(pull, i, s.node_of[u + i], s.other_node[u + i]);
        });
        net.for_all(s.first_tree_bond, s.n_bonds, [&](auto width, int32_t k) HOL_FORCED {
            typedef decltype(width) V;
            const int32_t *const from = s.from + k, *const to = s.to + k;
            const Pair3<V> pull =
                scale_pairs(load_any<V>(solution + k), e.unrounded_between(gather<V>(e.r, from), gather<V>(e.r, to)));
            for (int i = 0; i < Width<V>::lanes; ++i) pull_apart(pull, i, from[i] - s.first_node, to[i] - s.first_node);
        });
        net.for_ranges(s.first_node, s.n_atoms, [&](int32_t first, int32_t end) {
            for (int32_t i = first; i < end; ++i) {
                a[i] = scale_pairs(net.w[i], a[i]);
                if (e.has(rates)) a[i] = add_pairs(a[i], pairs_of(e.v.get<double>(i), zero));
            }
        });
    }
    // What a bond in lane i does to these of the rest; -1: to one alone.
    template <class V>
    HOL_FORCED void pull_apart(const Pair3<V> &pull, int i, int32_t from, int32_t to) const {
        const Pair3<double> one = lane_of(pull, i);
        e.a[from] = add_pairs(e.a[from], one);
        if (to >= 0) e.a[to] = subtract_pairs(e.a[to], one);
    }
    // Of a part, taken up: of bonds at ends, what is left with their nodes at rest.
    template <class Keep>
    __attribute__((noinline)) void find(const NetPart &part, const double *tension, const Keep &keep) const {
        net.for_strands(part, [&](auto width, const NetStrands &g) HOL_FORCED {
            typedef decltype(width) V;
            const auto site_of = [&](int32_t k) { return g.site + k * g.step; };
            const auto behind = [&](int32_t k, const Net3 &of, const AtomArray &from) HOL_FORCED {  // bond k
                return k + 1 < g.length ? net.read_at<V>(from, site_of(k)) : net.at_node<V>(g, 1, of);
            };
            const Vector3<V> zero = {};
            Vector3<V> at_atom = behind(0, e.r, e.coordinates),
                       speed = e.has(squares) ? net.at_node<V>(g, 0, e.v) : zero;
            Pair3<V> from = {}, bond = e.unrounded_between(net.at_node<V>(g, 0, e.r), at_atom),
                     pull = scale_pairs(load_any<V>(solution + g.bond_index), bond);
            V w = net.at_node<V>(g, 0, net.w), T = net.at_node<V>(g, 0, tension), own = size_of(pull);
            for (int32_t k = 0; k < g.length; ++k) {
                const bool last = k + 1 == g.length;
                const int32_t bond_index = g.bond_index + k * g.step;
                const V t = load_any<V>(solution + bond_index);
                Pair3<V> to = {}, next = bond;
                V wn, Tn;
                if (!last) {
                    const Vector3<V> beyond = behind(k + 1, e.r, e.coordinates);
                    next = e.unrounded_between(at_atom, beyond);
                    at_atom = beyond;
                    to =
                        subtract_pairs(pairs_of(e.has(pulls) ? net.read_at<V>(*e.in.f, site_of(k)) : zero, zero), pull);
                    pull = scale_pairs(load_any<V>(solution + bond_index + g.step), next);
                    wn = load_any<V>(net.w + site_of(k));
                    to = scale_pairs(wn, add_pairs(to, pull));
                    if (e.has(rates)) to = add_pairs(to, pairs_of(e.v.get<V>(site_of(k)), zero));
                    const V one = size_of(pull);
                    Tn = own + one;
                    own = one;
                } else {
                    wn = net.at_node<V>(g, 1, net.w);
                    Tn = net.at_node<V>(g, 1, tension);
                }
                keep(width, bond_index, bond, w + wn, mul_add(w, T, wn * Tn));
                w = wn;
                T = Tn;
                Pair<V> sum = dot_pairs(bond, subtract_pairs(to, from));
                if (e.has(squares)) {
                    const Vector3<V> faster = behind(k, e.v, *e.in.v);
                    sum = add_pairs(sum, square_of(speed, faster));
                    speed = faster;
                }
                add_given(sum, bond_index);
                const bool is_end = k == 0 || last;
                if (is_end) set_end(g, k == 0 ? 0 : 1, bond_index, bond, t, sum);
                store_any(e.t + bond_index, is_end ? V{} : sum.hi + sum.lo);
                from = to;
                bond = next;
            }
        });
        factor.take_up(part, e.t);
    }
    template <class V>
    HOL_FORCED void set_end(const NetStrands &g, int end, int32_t bond_index, const Pair3<V> &bond, const V &t,
                            const Pair<V> &sum) const {
        const V sign = Width<V>::all(end == 0 ? 1 : -1);
        const Vector3<V> hi = {bond.x.hi, bond.y.hi, bond.z.hi}, lo = {bond.x.lo, bond.y.lo, bond.z.lo};
        net.to_end(g, end, sign * ((hi - e.d.get<V>(bond_index)) + lo), low);
        net.to_end(g, end, t, multiplier);
        net.to_end(g, end, sum.hi, left_hi);
        net.to_end(g, end, sum.lo, left_lo);
    }
    template <class V>
    HOL_STATIC V size_of(const Pair3<V> &a) {
        return sqrt(mul_add(a.x.hi, a.x.hi, mul_add(a.y.hi, a.y.hi, a.z.hi * a.z.hi)));
    }
};

}  // namespace holonomic::HOL_ISA::graph
