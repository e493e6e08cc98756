// The strands and nodes of a network in lanes, and what is found for all its atoms and bonds.
#pragma once

#include "core/kernels/molecules/image.hpp"
#include "core/kernels/molecules/network/fronts.hpp"
#include "core/kernels/molecules/network/sites.hpp"
#include "core/kernels/molecules/share_out.hpp"

namespace holonomic::HOL_ISA::graph {

struct Net : NetSites {
    const LongTeam *team;
    double *buffer;  // of this thread; those of the others stand at the beginning of their working arrays, too
    mutable bool backwards = false;

    static int64_t values_of_factor(const NetworkPlan &s) { return in_fours(s.n_atoms); }
    static int64_t values(const NetworkPlan &s) { return values_of_buffer(s) + in_fours(s.n_atoms); }
    // memory: all of a thread's. of_factor: what is kept with a factor; it may be the same.
    Net(const NetworkPlan &plan, const MoleculeLane &l, bool packed, const LongTeam *threads, Memory<double> &of_factor,
        Memory<double> &memory)
        : NetSites(plan, l, packed), team(threads), buffer(memory.values(values_of_buffer(plan))) {
        w = of_factor.values(in_fours(plan.n_atoms));
    }

    static int64_t values_of_buffer(const NetworkPlan &s) {
        int32_t most = s.n_bonds - s.first_tree_bond;
        for (int32_t i = 0, before = 0; i < s.n_shares; ++i) {
            const int32_t end = i + 1 < s.n_shares ? s.bundle[s.bundle_start[i + 1]].first_index : s.first_tree_bond;
            most = end - before > most ? end - before : most;
            before = end;
        }
        const int64_t of_part = NetPart::values_of_place * in_fours(most),
                      of_fronts = Fronts::values_of_buffer(s.fronts);
        return of_part > of_fronts ? of_part : of_fronts;
    }

    NetPart part(int32_t share, double *of_thread) const {
        const int32_t end = s.bundle_start[share + 1];
        const NetworkPlan::Bundle &b = s.bundle[s.bundle_start[share]];
        NetPart p = {share,         s.bundle_start[share], end,      b.first_site, s.first_node,
                     b.first_index, s.first_tree_bond,     of_thread};
        if (share + 1 == s.n_shares) return p;
        p.end_site = s.bundle[end].first_site;
        p.end_index = s.bundle[end].first_index;
        return p;
    }
    NetPart rest() const { return {s.n_shares, 0, 0, s.first_node, s.n_atoms, s.first_tree_bond, s.n_bonds, buffer}; }
    bool is_rest(const NetPart &part) const { return part.share == s.n_shares; }

    // Calls body(part) for all but the rest, on the threads that there are. One thread begins where it ended the last
    // time, with what is in its cache; of several each has its own parts, and a cache that holds more of them.
    template <class Body>
    HOL_FORCED void for_parts(const Body &body) const {
        const bool from_last = backwards && !team;
        backwards = !backwards;
        share_out(team, buffer, s.n_shares,
                  [&](int32_t i, double *of_thread) { body(part(from_last ? s.n_shares - 1 - i : i, of_thread)); });
    }
    template <class Body>
    HOL_FORCED void for_rest_and_parts(const Body &body) const {
        body(rest());
        for_parts(body);
    }
    // Calls body(share) for all shares of nodes. A thread is not worth waiting for where these are few.
    template <class Body>
    HOL_FORCED void for_node_shares(const Body &body) const {
        constexpr int32_t many_unknowns = 16384;
        share_out(s.n_unknowns < many_unknowns ? nullptr : team, s.n_node_shares, body);
    }
    // Calls body(value of the width, nodes) for those of a share.
    template <class Body>
    HOL_FORCED void for_nodes(int32_t share, const Body &body) const {
        for (int32_t i = s.nodes_start[share]; i < s.nodes_start[share + 1]; ++i) {
            const NetworkPlan::Nodes &n = s.nodes[i];
            int32_t j = 0;
            const auto nodes = [&] { return NetNodes{n.first_node + j, n.n_own, n.first_unknown + j, n.count}; };
            for (; j + W <= n.count; j += W) body(vec{}, nodes());
            for (; j < n.count; ++j) body(double{}, nodes());
        }
    }
    // Calls body(value of the width, unknown) for those of a share.
    template <class Body>
    HOL_FORCED void for_unknowns(int32_t share, const Body &body) const {
        for_all(s.unknown_start[share], s.unknown_start[share + 1], body);
    }
    // Calls each(unknown) for those of a node.
    template <class Each>
    HOL_FORCED void for_own(int32_t node, const Each &each) const {
        const NetworkPlan::Nodes &n = s.nodes[s.nodes_of[node]];
        for (int32_t i = 0; i < n.n_own; ++i) each(n.first_unknown + i * n.count + node - n.first_node);
    }
    // Calls body(first, end) for ranges of these numbers.
    template <class Body>
    HOL_FORCED void for_ranges(int32_t begin, int32_t end, const Body &body) const {
        constexpr int32_t step = 4096;
        share_out(end - begin > 4 * step ? team : nullptr, (end - begin + step - 1) / step, [&](int32_t i) {
            const int32_t first = begin + i * step;
            body(first, end - first < step ? end : first + step);
        });
    }
    // Calls body(value of the width, strands) for those of a part, which is not the rest.
    template <class Body>
    HOL_FORCED void for_strands(const NetPart &part, const Body &body) const {
        for (int32_t i = part.first_bundle; i < part.end_bundle; ++i) {
            const NetworkPlan::Bundle &b = s.bundle[i];
            int32_t j = 0;
            const auto strands = [&] {
                return NetStrands{b.length, b.first_index + j, b.first_site + j, b.first_strand + j, b.width};
            };
            for (; j + W <= b.width; j += W) body(vec{}, strands());
            for (; j < b.width; ++j) body(double{}, strands());
        }
    }

    // Values of the nodes at the ends of strands, by their sites.
    template <class V>
    HOL_FORCED V at_node(const NetStrands &g, int end, const double *value) const {
        V a = {};
        for (int i = 0; i < Width<V>::lanes; ++i)
            Width<V>::set(a, i, value[s.first_node + s.strand_node[2 * (g.strand + i) + end]]);
        return a;
    }
    template <class V>
    HOL_FORCED Vector3<V> at_node(const NetStrands &g, int end, const Net3 &value) const {
        return {at_node<V>(g, end, value.x), at_node<V>(g, end, value.y), at_node<V>(g, end, value.z)};
    }
    // To their unknowns.
    template <class V>
    HOL_FORCED void to_end(const NetStrands &g, int end, const V &a, double *value) const {
        for (int i = 0; i < Width<V>::lanes; ++i)
            value[s.strand_unknown[2 * (g.strand + i) + end]] = Width<V>::get(a, i);
    }
    template <class V>
    HOL_FORCED void to_end(const NetStrands &g, int end, const Vector3<V> &a, const Net3 &value) const {
        to_end(g, end, a.x, value.x);
        to_end(g, end, a.y, value.y);
        to_end(g, end, a.z, value.z);
    }

    // Calls body(V, i) for all from `first` on.
    template <class Body>
    HOL_FORCED static void for_all(int32_t first, int32_t end, const Body &body) {
        int32_t i = first;
        for (; i + W <= end; i += W) body(vec{}, i);
        for (; i < end; ++i) body(double{}, i);
    }
    // Along strands: calls body(bond_index, from, to) for each bond, with values at its atoms, first() and last() of
    // the nodes, between(site, bond_index) of the atom before the bond at that index.
    template <class First, class Between, class Last, class Body>
    HOL_FORCED static void for_bonds(const NetStrands &g, const First &first, const Between &between, const Last &last,
                                     const Body &body) {
        auto from = first();
        for (int32_t k = 0; k < g.length; ++k) {
            const int32_t bond_index = g.bond_index + k * g.step;
            const auto to = k + 1 < g.length ? between(g.site + k * g.step, bond_index + g.step) : last();
            body(bond_index, from, to);
            from = to;
        }
    }
    template <class V>
    HOL_FORCED Vector3<V> bond_between(const Box &box, const Vector3<V> &from, const Vector3<V> &to) const {
        Vector3<V> bond = to - from, unused = {};
        take_image<false>(box, bond, unused);
        return bond;
    }

    // Calls each(bond_index, sign) for the bonds of a node or, after the nodes, of a tree's atom, but for the own ends
    // of a node; sign: 1 where they begin there, else -1.
    template <class Each>
    HOL_FORCED void for_other_bonds(int32_t number, const Each &each) const {
        if (number < s.n_nodes)
            for (int32_t f = s.foreign_start[number]; f < s.foreign_start[number + 1]; ++f)
                each(s.bond_index_of[s.foreign[f]], -1.0);
        else
            each(s.first_tree_bond + number - s.n_nodes, -1.0);
        for (int32_t c = s.child_start[number]; c < s.child_start[number + 1]; ++c)
            each(s.first_tree_bond + s.child[c], 1.0);
    }
    // Of any site, all of them.
    template <class Each>
    HOL_FORCED void for_bonds_of(int32_t site, const Each &each) const {
        if (site >= s.first_node) {
            const int32_t number = site - s.first_node;
            if (number < s.n_nodes) for_own(number, [&](int32_t u) { each(s.bond_index_of[u], s.sign[u]); });
            return for_other_bonds(number, each);
        }
        int32_t bundle = 0, end = s.bundle_start[s.n_shares];
        while (end - bundle > 1) {
            const int32_t middle = bundle + (end - bundle) / 2;
            (s.bundle[middle].first_site <= site ? bundle : end) = middle;
        }
        const NetworkPlan::Bundle &b = s.bundle[bundle];
        each(b.first_index + site - b.first_site, -1.0);
        each(b.first_index + site - b.first_site + b.width, 1.0);
    }
};

// Along strands, what multipliers t of bonds d do to the atoms between these.
template <class V>
struct StrandPulls {
    const Net &net;
    const double *const t;
    const Net3 &d;
    Vector3<V> of_bond;
    HOL_FORCED StrandPulls(const Net &of, const double *multipliers, const Net3 &bonds, int32_t bond_index)
        : net(of), t(multipliers), d(bonds), of_bond(load_any<V>(t + bond_index) * d.get<V>(bond_index)) {}
    // Of the atom before the bond at this index, which is the next one.
    HOL_FORCED Vector3<V> before(int32_t bond_index) {
        const Vector3<V> last = of_bond;
        net.fetch_ahead(bond_index, t, d.x, d.y, d.z);
        of_bond = load_any<V>(t + bond_index) * d.get<V>(bond_index);
        return of_bond - last;
    }
    // Calls each(site, pull) for all of these atoms.
    template <class Each>
    HOL_FORCED void for_sites(const NetStrands &g, const Each &each) {
        for (int32_t k = 1; k < g.length; ++k) each(g.site + (k - 1) * g.step, before(g.bond_index + k * g.step));
    }
};

HOL_INLINE double largest_in(const double *values, int32_t n) {
    double most = 0, sum = 0;  // a maximum may lose a NaN, the sum keeps it
    for (int32_t i = 0; i < n; ++i) {
        most = max(values[i], most);
        sum += values[i];
    }
    return most + 0 * sum;
}

}  // namespace holonomic::HOL_ISA::graph
