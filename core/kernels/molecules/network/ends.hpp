// The equations of a network's unknowns: the ends of strands, coupled at the nodes and from end to end. Their matrix is
// M, which has the ends of each node by themselves, and what strands couple.
#ifndef HOLONOMIC_KERNELS_MOLECULES_NETWORK_ENDS_HPP
#define HOLONOMIC_KERNELS_MOLECULES_NETWORK_ENDS_HPP

#include "core/kernels/molecules/network/fronts.hpp"
#include "core/kernels/molecules/network/strands.hpp"
#include "core/kernels/molecules/network/tensor.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

struct NetNode {
    Tensor mass;                   // inverse, with the trees that hang from it
    Tensor with_ends;              // with what its own ends offer, too
    Vector3<double> push;          // from the trees' right-hand sides
    Vector3<double> foreign, all;  // accelerations by foreign ends, and by all, of a vector that is multiplied
};

struct Ends {
    const Net &net;
    const NetworkPlan &s;
    double *E, *per_E, *coupling;  // what the far side of an end offers; to the partner's value
    double *y;                     // right-hand sides
    Vector3<double> *D, *b, *tree_bond;
    NetNode *node;
    Fronts fronts;

    static constexpr int64_t node_values = static_cast<int64_t>(sizeof(NetNode) / sizeof(double));

    static int64_t values(const NetworkPlan &s, bool symmetric) {
        return Fronts::values(s.fronts, symmetric) + in_fours(node_values * static_cast<int64_t>(s.n_nodes)) +
               in_fours(3 * static_cast<int64_t>(s.n_tree)) + 2 * in_fours(3 * static_cast<int64_t>(s.n_unknowns)) +
               4 * in_fours(s.n_unknowns);
    }
    Ends(const Net &of, bool symmetric, Memory<double> &memory)
        : net(of), s(of.s), fronts(of.s.fronts, symmetric, memory) {
        node = reinterpret_cast<NetNode *>(memory.values(in_fours(node_values * static_cast<int64_t>(s.n_nodes))));
        tree_bond = reinterpret_cast<Vector3<double> *>(memory.values(in_fours(3 * static_cast<int64_t>(s.n_tree))));
        D = reinterpret_cast<Vector3<double> *>(memory.values(in_fours(3 * static_cast<int64_t>(s.n_unknowns))));
        b = reinterpret_cast<Vector3<double> *>(memory.values(in_fours(3 * static_cast<int64_t>(s.n_unknowns))));
        double **const arrays[] = {&E, &per_E, &coupling, &y};
        for (double **array : arrays) *array = memory.values(in_fours(s.n_unknowns));
    }

    // Calls body(u) for all unknowns, node by node.
    template <class Body>
    HOL_FORCED void for_each(const Body &body) const {
        net.for_nodes([&](int32_t first, int32_t end, int32_t) {
            for (int32_t u = s.own_start[first]; u < s.own_start[end]; ++u) body(u);
        });
    }

    // Bonds of the ends, and what trees at the nodes give to right-hand sides.
    void open(const Net3 &new_D, const Net3 &ref) const {
        for_each([&](int32_t u) {
            D[u] = new_D.get<double>(s.place_of[u]);
            b[u] = ref.get<double>(s.place_of[u]);
            const int32_t other = s.other_node[u];
            if (other < 0) return;
            // Taken off again in products, so that it needs not be exact; what is held fixed offers nothing.
            E[u] = max(dot(D[u], node[other].mass * b[u]), least_of_own * dot(D[u], node[s.node_of[u]].mass * b[u]));
            coupling[u] = 0;
        });
        add_pushes();
    }
    void add_pushes() const {
        if (s.n_tree == 0) return;
        for_each([&](int32_t u) {
            const NetNode &own = node[s.node_of[u]];
            y[u] -= s.sign[u] * dot(D[u], own.mass * own.push);
            if (s.other_node[u] < 0) return;
            const NetNode &other = node[s.other_node[u]];
            y[u] += dot(D[u], other.mass * other.push);
        });
    }
    void factorize_nodes() const {
        net.for_nodes([&](int32_t first, int32_t end, int32_t) {
            for (int32_t n = first; n < end; ++n) {
                node[n].with_ends = node[n].mass;
                for (int32_t u = s.own_start[n]; u < s.own_start[n + 1]; ++u) {
                    per_E[u] = 1 / E[u];
                    load(node[n].with_ends, E[u], b[u], D[u]);
                }
            }
        });
    }
    // Of a node with its trees, by these values of the ends.
    Vector3<double> acceleration_of(int32_t n, const double *of) const {
        Vector3<double> sum_of = node[n].push;
        for (int32_t u = s.own_start[n]; u < s.own_start[n + 1]; ++u)
            sum_of = add_times(sum_of, s.sign[u] * of[u], b[u]);
        for (int32_t f = s.foreign_start[n]; f < s.foreign_start[n + 1]; ++f)
            sum_of = add_times(sum_of, -of[s.foreign[f]], b[s.foreign[f]]);
        return node[n].mass * sum_of;
    }

    // M^-1: the ends of each node by themselves.
    __attribute__((noinline)) void solve_nodes(int32_t first, int32_t end, const double *of, double *to) const {
        for (int32_t n = first; n < end; ++n) {
            Vector3<double> pull = {};
            for (int32_t u = s.own_start[n]; u < s.own_start[n + 1]; ++u) {
                to[u] = of[u] * per_E[u];
                pull = add_times(pull, s.sign[u] * to[u], b[u]);
            }
            const Vector3<double> a = node[n].with_ends * pull;
            for (int32_t u = s.own_start[n]; u < s.own_start[n + 1]; ++u)
                to[u] = mul_add(-s.sign[u] * per_E[u], dot(D[u], a), to[u]);
        }
    }
    // Of a vector, by its own ends at a node and by foreign ones: what product() needs of it.
    __attribute__((noinline)) void accelerate_nodes(const double *of) const {
        net.for_nodes([&](int32_t first, int32_t end, int32_t) {
            for (int32_t n = first; n < end; ++n) {
                Vector3<double> by_own = {}, by_foreign = {};
                for (int32_t u = s.own_start[n]; u < s.own_start[n + 1]; ++u)
                    by_own = add_times(by_own, s.sign[u] * of[u], b[u]);
                for (int32_t f = s.foreign_start[n]; f < s.foreign_start[n + 1]; ++f)
                    by_foreign = add_times(by_foreign, -of[s.foreign[f]], b[s.foreign[f]]);
                node[n].foreign = node[n].mass * by_foreign;
                node[n].all = node[n].foreign + node[n].mass * by_own;
            }
        });
    }
    // What M leaves out of the product with `of`: what strands couple, and what bonds do where they are foreign.
    HOL_FORCED double product_beside_nodes(int32_t u, const double *of) const {
        double value = coupling[u] * of[s.partner[u]];
        if (!s.has_foreign) return value;
        value = mul_add(s.sign[u], dot(D[u], node[s.node_of[u]].foreign), value);
        return s.other_node[u] < 0 ? value : value - mul_add(E[u], of[u], dot(D[u], node[s.other_node[u]].all));
    }
    // All of the product.
    HOL_FORCED double product(int32_t u, const double *of) const {
        const double value = s.sign[u] * dot(D[u], node[s.node_of[u]].all);
        if (s.other_node[u] >= 0) return value - dot(D[u], node[s.other_node[u]].all);
        return mul_add(E[u], of[u], mul_add(coupling[u], of[s.partner[u]], value));
    }

    // False where a pivot is next to nothing.
    __attribute__((noinline)) bool factorize_fronts() const {
        return fronts.factorize(
            least_share, [&](const FrontPlan::Front &f, const Dense &a) { add_terms(f, a); },
            [&](int32_t u) { return E[u] + dot(D[u], node[s.node_of[u]].mass * b[u]); });
    }
    void solve_fronts(const double *of, double *to) const {
        for (int32_t u = 0; u < s.n_unknowns; ++u) to[u] = of[u];
        fronts.solve(to);
    }

private:
    static constexpr double least_share = 16 * epsilon, least_of_own = 1e-5;

    // Calls each(unknown, row, sign) for all whose bonds meet at a node.
    template <class Each>
    HOL_FORCED void for_unknowns_at(int32_t n, const Each &each) const {
        for (int32_t u = s.own_start[n]; u < s.own_start[n + 1]; ++u) each(u, s.fronts.own_row[u], s.sign[u]);
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
            for_unknowns_at(n, [&](int32_t by, int32_t column, double sign) HOL_FORCED {
                const Vector3<double> push = node[n].mass * (sign * b[by]);
                for_unknowns_at(n, [&](int32_t on, int32_t row, double sign_of_row)
                                       HOL_FORCED { add(row, column, sign_of_row * dot(D[on], push)); });
            });
            for (int32_t u = s.own_start[n]; u < s.own_start[n + 1]; ++u) {
                const int32_t row = s.fronts.own_row[u], other = s.fronts.partner_row[u];
                if (s.other_node[u] < 0) add(row, row, E[u]);
                if (other < 0) continue;
                add(row, other, coupling[u]);
                add(other, row, coupling[s.partner[u]]);
            }
        }
    }
};

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
