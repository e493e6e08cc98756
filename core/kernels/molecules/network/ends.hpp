// The equations of a network's unknowns: the ends of strands, coupled at the nodes and from end to end. Their matrix is
// M, which has the ends of each node by themselves, and what strands couple.
#pragma once

#include "core/kernels/molecules/network/fronts.hpp"
#include "core/kernels/molecules/network/strands.hpp"
#include "core/kernels/molecules/network/tensor.hpp"
#include "core/kernels/molecules/twice.hpp"

namespace holonomic::HOL_ISA::graph {

// Tensors of all nodes.
struct NetTensor {
    Net3 row[3];
    template <class V>
    HOL_FORCED Tensor<V> get(int64_t i) const {
        return {{row[0].get<V>(i), row[1].get<V>(i), row[2].get<V>(i)}};
    }
    template <class V>
    HOL_FORCED void set(int64_t i, const Tensor<V> &a) const {
        for (int c = 0; c < 3; ++c) row[c].set(i, a.row[c]);
    }
    static NetTensor take(Memory<double> &memory, int64_t n) {
        NetTensor a;
        for (Net3 &row : a.row) row = Net3::take(memory, n);
        return a;
    }
};

struct Ends {
    const Net &net;
    const NetworkPlan &s;
    double *E, *per_E, *coupling;  // what the far side of an end offers; to the partner's value
    double *y;                     // right-hand sides
    Net3 D, b;                     // as they point away from their own nodes
    Vector3<double> *tree_bond;
    NetTensor mass, with_ends;  // of nodes: inverse, with the trees that hang there; with what own ends offer, too
    Net3 push;                  // from the trees' right-hand sides
    Net3 foreign_a, all_a;      // accelerations by foreign ends, and by all, of a vector that is multiplied
    Fronts fronts;

    static int64_t values(const NetworkPlan &s, bool symmetric) {
        return Fronts::values(s.fronts, symmetric) + 27 * in_fours(s.n_nodes) +
               in_fours(3 * static_cast<int64_t>(s.n_tree)) + 10 * in_fours(s.n_unknowns);
    }
    static int64_t values_of_factor(const NetworkPlan &s) {
        return Fronts::values_of_factor(s.fronts) + 18 * in_fours(s.n_nodes) +
               in_fours(3 * static_cast<int64_t>(s.n_tree)) + 6 * in_fours(s.n_unknowns);
    }
    Ends(const Net &of, bool symmetric, Memory<double> &of_factor, Memory<double> &memory)
        : net(of), s(of.s), D(Net3::take(of_factor, s.n_unknowns)),
          b(symmetric ? D : Net3::take(of_factor, s.n_unknowns)), mass(NetTensor::take(of_factor, s.n_nodes)),
          with_ends(NetTensor::take(of_factor, s.n_nodes)), push(Net3::take(memory, s.n_nodes)),
          foreign_a(Net3::take(memory, s.n_nodes)), all_a(Net3::take(memory, s.n_nodes)),
          fronts(of.s.fronts, symmetric, of.team, of.buffer, of_factor, memory) {
        tree_bond = reinterpret_cast<Vector3<double> *>(of_factor.values(in_fours(3 * static_cast<int64_t>(s.n_tree))));
        double **const arrays[] = {&E, &per_E, &coupling};
        for (double **array : arrays) *array = of_factor.values(in_fours(s.n_unknowns));
        y = memory.values(in_fours(s.n_unknowns));
    }

    // Bonds at an end of strands.
    template <class V>
    HOL_FORCED void set_bonds(const NetStrands &g, int end, const Vector3<V> &new_bond, const Vector3<V> &bond) const {
        const V sign = Width<V>::all(end == 0 ? 1 : -1);
        net.to_end(g, end, sign * new_bond, D);
        if (b.x != D.x) net.to_end(g, end, sign * bond, b);
    }
    // Calls body(unknown, the node where it is foreign) for those of a share.
    template <class Body>
    HOL_FORCED void for_foreign(int32_t share, const Body &body) const {
        if (!s.has_foreign) return;
        for (int32_t u = s.unknown_start[share]; u < s.unknown_start[share + 1]; ++u)
            if (s.other_node[u] >= 0) body(u, s.other_node[u]);
    }

    void factorize_nodes() const {
        net.for_node_shares([&](int32_t share) {
            for_foreign(share, [&](int32_t u, int32_t other) {
                // Taken off again in products, so that it needs not be exact; what is held fixed offers nothing.
                const Vector3<double> bond = b.get<double>(u), new_bond = D.get<double>(u);
                E[u] = max(dot(new_bond, mass.get<double>(other) * bond),
                           least_of_own * dot(new_bond, mass.get<double>(s.node_of[u]) * bond));
                coupling[u] = 0;
            });
            net.for_nodes(share, [&](auto width, const NetNodes &g) HOL_FORCED {
                typedef decltype(width) V;
                Tensor<V> left = mass.get<V>(g.node);
                for (int32_t i = 0, u = g.unknown; i < g.n_own; ++i, u += g.step) {
                    const V offer = load_any<V>(E + u);
                    store_any(per_E + u, Width<V>::all(1) / offer);
                    add_offer(left, offer, b.get<V>(u), D.get<V>(u));
                }
                with_ends.set(g.node, left);
            });
        });
    }
    // What trees at the nodes give to right-hand sides.
    void add_pushes() const {
        if (s.n_tree == 0) return;
        net.for_node_shares([&](int32_t share) {
            net.for_nodes(share, [&](auto width, const NetNodes &g) HOL_FORCED {
                typedef decltype(width) V;
                const Vector3<V> a = mass.get<V>(g.node) * push.get<V>(g.node);
                for (int32_t i = 0, u = g.unknown; i < g.n_own; ++i, u += g.step)
                    store_any(y + u, load_any<V>(y + u) - dot(D.get<V>(u), a));
            });
            for_foreign(share, [&](int32_t u, int32_t other) {
                y[u] += dot(D.get<double>(u), mass.get<double>(other) * push.get<double>(other));
            });
        });
    }
    // What a node's trees give beside what has been added.
    void add_push(int32_t n, const Vector3<double> &more) const {
        net.for_own(n, [&](int32_t u) { y[u] -= dot(D.get<double>(u), more); });
        for (int32_t f = s.foreign_start[n]; f < s.foreign_start[n + 1]; ++f)
            y[s.foreign[f]] += dot(D.get<double>(s.foreign[f]), more);
    }
    // What the ends at a node do to it, by these values.
    Pair3<double> pull_of(int32_t n, const double *of) const {
        Pair3<double> sum_of = {};
        net.for_own(n, [&](int32_t u) { sum_of = add_pairs(sum_of, product_pairs(of[u], b.get<double>(u))); });
        for (int32_t f = s.foreign_start[n]; f < s.foreign_start[n + 1]; ++f)
            sum_of = add_pairs(sum_of, product_pairs(-of[s.foreign[f]], b.get<double>(s.foreign[f])));
        return sum_of;
    }
    // Of a node with its trees, by these values of the ends.
    Vector3<double> acceleration_of(int32_t n, const double *of) const {
        Vector3<double> sum_of = push.get<double>(n);
        net.for_own(n, [&](int32_t u) { sum_of = add_times(sum_of, of[u], b.get<double>(u)); });
        return mass.get<double>(n) * (sum_of + by_foreign(n, of));
    }
    Vector3<double> by_foreign(int32_t n, const double *of) const {
        Vector3<double> sum_of = {};
        for (int32_t f = s.foreign_start[n]; f < s.foreign_start[n + 1]; ++f)
            sum_of = add_times(sum_of, -of[s.foreign[f]], b.get<double>(s.foreign[f]));
        return sum_of;
    }

    // M^-1: the ends of each node by themselves.
    __attribute__((noinline)) void solve_nodes(int32_t share, const double *of, double *to) const {
        net.for_nodes(share, [&](auto width, const NetNodes &g) HOL_FORCED {
            typedef decltype(width) V;
            Vector3<V> pull = {};
            for (int32_t i = 0, u = g.unknown; i < g.n_own; ++i, u += g.step)
                pull = add_times(pull, load_any<V>(of + u) * load_any<V>(per_E + u), b.get<V>(u));
            const Vector3<V> a = with_ends.get<V>(g.node) * pull;
            for (int32_t i = 0, u = g.unknown; i < g.n_own; ++i, u += g.step)
                store_any(to + u, (load_any<V>(of + u) - dot(D.get<V>(u), a)) * load_any<V>(per_E + u));
        });
    }
    // Of a vector, by its own ends at a node and by foreign ones: what product() needs of it.
    __attribute__((noinline)) void accelerate_nodes(const double *of) const {
        net.for_node_shares([&](int32_t share) {
            net.for_nodes(share, [&](auto width, const NetNodes &g) HOL_FORCED {
                typedef decltype(width) V;
                Vector3<V> by_own = {};
                for (int32_t i = 0, u = g.unknown; i < g.n_own; ++i, u += g.step)
                    by_own = add_times(by_own, load_any<V>(of + u), b.get<V>(u));
                Vector3<V> a = mass.get<V>(g.node) * by_own;
                for (int32_t i = 0; i < Width<V>::lanes && s.has_foreign; ++i) {
                    const int32_t n = g.node + i;
                    foreign_a.set(n, mass.get<double>(n) * by_foreign(n, of));
                }
                if (s.has_foreign) a = a + foreign_a.get<V>(g.node);
                all_a.set(g.node, a);
            });
        });
    }
    // The product of the matrix with `of`, after accelerate_nodes(); or, with `own`, which is that of M with it, after
    // that too if there are foreign ends: M leaves out what strands couple, and what bonds do where they are foreign.
    __attribute__((noinline)) void multiply(int32_t share, const double *own, const double *of, double *to) const {
        const auto couple = [&](auto width, int32_t u, const auto &value) HOL_FORCED {
            typedef decltype(width) V;
            store_any(to + u, mul_add(load_any<V>(coupling + u), gather<V>(of, s.partner + u), value));
        };
        if (own && !s.has_foreign)
            return net.for_unknowns(
                share, [&](auto width, int32_t u) HOL_FORCED { couple(width, u, load_any<decltype(width)>(own + u)); });
        net.for_nodes(share, [&](auto width, const NetNodes &g) HOL_FORCED {
            typedef decltype(width) V;
            const Vector3<V> a = (own ? foreign_a : all_a).get<V>(g.node);
            for (int32_t i = 0, u = g.unknown; i < g.n_own; ++i, u += g.step)
                couple(width, u,
                       (own ? load_any<V>(own + u) : load_any<V>(E + u) * load_any<V>(of + u)) + dot(D.get<V>(u), a));
        });
        for_foreign(share, [&](int32_t u, int32_t other) {
            const Vector3<double> bond = D.get<double>(u), beyond = all_a.get<double>(other);
            if (own)
                to[u] -= mul_add(E[u], of[u], dot(bond, beyond));
            else
                to[u] = dot(bond, all_a.get<double>(s.node_of[u]) - beyond);
        });
    }

    // What multipliers t do to the nodes of a share, but for their trees and for foreign ends. Where `tension` is
    // wanted, too, in twice the precision.
    __attribute__((noinline)) void find_pulls(int32_t share, const double *t, const Net3 &G, double *tension,
                                              const Net3 &low) const {
        net.for_nodes(share, [&](auto width, const NetNodes &g) HOL_FORCED {
            typedef decltype(width) V;
            const int32_t site = s.first_node + g.node;
            Pair3<V> sum = {};
            V size = {};
            for (int32_t i = 0, u = g.unknown; i < g.n_own; ++i, u += g.step) {
                const Pair3<V> pull = product_pairs(gather<V>(t, s.bond_index_of + u), b.get<V>(u));
                sum = add_pairs(sum, pull);
                size = size + sqrt(mul_add(pull.x.hi, pull.x.hi, mul_add(pull.y.hi, pull.y.hi, pull.z.hi * pull.z.hi)));
            }
            const Vector3<V> all = rounded(sum);
            G.set(site, all);
            if (!tension) return;
            store_any(tension + site, size);
            low.set(site, rounded(subtract_pairs(sum, pairs_of(all, Vector3<V>{}))));
        });
    }

    // False where a pivot is next to nothing.
    __attribute__((noinline)) bool factorize_fronts() const {
        return fronts.factorize(
            least_share,
            [&](const FrontPlan::Front &f, const Dense &a) {
                add_terms(f, a);
                add_spokes(f, a);
            },
            [&](int32_t u) {
                return s.fronts.n_hubs > 0 ? diagonal_beside_hubs(u) : E[u] + offered_by(s.node_of[u], u);
            });
    }
    // of, to: with room for what hubs add.
    void solve_fronts(const double *of, double *to) const {
        for (int32_t u = 0; u < s.n_unknowns; ++u) to[u] = of[u];
        for (int32_t u = s.n_unknowns; u < s.n_unknowns + 3 * s.fronts.n_hubs; ++u) to[u] = 0;
        fronts.solve(to);
    }

private:
    static constexpr double least_share = 16 * epsilon, least_of_own = 1e-5;

    double offered_by(int32_t n, int32_t u) const {
        return dot(D.get<double>(u), mass.get<double>(n) * b.get<double>(u));
    }
    double diagonal_beside_hubs(int32_t u) const {
        if (u >= s.n_unknowns) return -1;
        const int32_t from = s.node_of[u], to = s.other_node[u];
        const double by_from = offered_by(from, u), by_to = to < 0 ? E[u] : offered_by(to, u);
        const double left = (s.fronts.hub_of[from] < 0 ? by_from : 0) + (to < 0 || s.fronts.hub_of[to] < 0 ? by_to : 0);
        return left > 0 ? left : by_from + by_to;
    }
    // Calls each(unknown, row, sign) for all whose bonds meet at a node.
    template <class Each>
    HOL_FORCED void for_unknowns_at(int32_t n, const Each &each) const {
        net.for_own(n, [&](int32_t u) HOL_FORCED { each(u, s.fronts.own_row[u], 1.0); });
        for (int32_t f = s.foreign_start[n]; f < s.foreign_start[n + 1]; ++f)
            each(s.foreign[f], s.fronts.foreign_row[f], -1.0);
    }
    // What the nodes of a leaf, and the strands whose last ends are there, add to its matrix.
    __attribute__((noinline)) void add_terms(const FrontPlan::Front &front, const Dense &a) const {
        const auto add = [&](int32_t row, int32_t column, double value) HOL_FORCED {
            if (row >= column || !a.symmetric()) Fronts::element(front, a, row, column) += value;
        };
        for (int32_t i = front.first_node; i < front.end_node; ++i) {
            const int32_t n = s.fronts.node[i];
            const Tensor<double> inverse = mass.get<double>(n);
            for_unknowns_at(n, [&](int32_t by, int32_t column, double sign) HOL_FORCED {
                const Vector3<double> push_of = inverse * (sign * b.get<double>(by));
                for_unknowns_at(n, [&](int32_t on, int32_t row, double sign_of_row)
                                       HOL_FORCED { add(row, column, sign_of_row * dot(D.get<double>(on), push_of)); });
            });
            net.for_own(n, [&](int32_t u) HOL_FORCED {
                const int32_t row = s.fronts.own_row[u], other = s.fronts.partner_row[u];
                if (s.other_node[u] < 0) add(row, row, E[u]);
                if (other < 0) return;
                add(row, other, coupling[u]);
                add(other, row, coupling[s.partner[u]]);
            });
        }
    }
    // What hubs add to it.
    __attribute__((noinline)) void add_spokes(const FrontPlan::Front &front, const Dense &a) const {
        const auto add = [&](int32_t row, int32_t column, double value) {
            if (row >= column || !a.symmetric()) Fronts::element(front, a, row, column) += value;
        };
        for (int32_t i = front.first_spoke; i < front.end_spoke; ++i) {
            const FrontPlan::Spoke &spoke = s.fronts.spoke[i];
            const int32_t u = spoke.unknown;
            const TensorFactors<double> factors = factors_of(mass.get<double>(s.fronts.hub[spoke.hub]));
            const Vector3<double> of_row = static_cast<double>(spoke.sign) * (D.get<double>(u) * factors.lower),
                                  of_column = static_cast<double>(spoke.sign) * (factors.upper * b.get<double>(u));
            const double rows[3] = {of_row.x, of_row.y, of_row.z}, columns[3] = {of_column.x, of_column.y, of_column.z};
            for (int32_t c = 0; c < 3; ++c) {
                const int32_t h = spoke.hub_row + c;
                add(spoke.row, h, rows[c]);
                add(h, spoke.row, columns[c]);
                if (spoke.is_first) add(h, h, -1);
            }
            if (spoke.sign > 0 && s.other_node[u] < 0) add(spoke.row, spoke.row, E[u]);
            if (spoke.partner_row < 0) continue;
            add(spoke.row, spoke.partner_row, coupling[u]);
            add(spoke.partner_row, spoke.row, coupling[s.partner[u]]);
        }
    }
};

}  // namespace holonomic::HOL_ISA::graph
