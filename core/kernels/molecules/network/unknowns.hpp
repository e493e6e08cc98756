// What is left of a network's equations: the ends of strands, coupled at the nodes and from end to end. Stabilised
// bi-conjugate gradients (H. van der Vorst, SIAM J. Sci. Stat. Comput. 13, 631 (1992)), with the ends of each node
// solved exactly as the preconditioner M: what strands couple dies out along them, so that it takes few rounds.
// With p' = M^-1 p the product with the matrix is p + (matrix - M) p'.
#ifndef HOLONOMIC_KERNELS_MOLECULES_NETWORK_UNKNOWNS_HPP
#define HOLONOMIC_KERNELS_MOLECULES_NETWORK_UNKNOWNS_HPP

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

struct Unknowns {
    const Net &net;
    const NetworkPlan &s;
    double *E, *per_E, *coupling;  // what the far side of an end offers; to the partner's value
    double *y, *x, *size;          // right-hand sides, solution, squares of the sizes of right-hand sides' terms
    Vector3<double> *D, *b, *tree_bond;
    NetNode *node;
    double *sum;                                       // [n_node_shares][3]
    double *r, *shadow, *p, *p_node, *v, *s_node, *t;  // s takes the place of r
    Fronts fronts;
    mutable bool direct = false, tried = false;  // fronts are used; or have been tried

    static constexpr int64_t node_values = static_cast<int64_t>(sizeof(NetNode) / sizeof(double));

    static int64_t values(const NetworkPlan &s, bool symmetric) {
        return Fronts::values(s.fronts, symmetric) + in_fours(node_values * static_cast<int64_t>(s.n_nodes)) +
               in_fours(3 * static_cast<int64_t>(s.n_tree)) + in_fours(3 * static_cast<int64_t>(s.n_node_shares)) +
               2 * in_fours(3 * static_cast<int64_t>(s.n_unknowns)) + 13 * in_fours(s.n_unknowns);
    }
    Unknowns(const Net &of, bool symmetric, Memory<double> &memory)
        : net(of), s(of.s), fronts(of.s.fronts, symmetric, memory) {
        const int64_t n = in_fours(s.n_unknowns);
        node = reinterpret_cast<NetNode *>(memory.values(in_fours(node_values * static_cast<int64_t>(s.n_nodes))));
        tree_bond = reinterpret_cast<Vector3<double> *>(memory.values(in_fours(3 * static_cast<int64_t>(s.n_tree))));
        sum = memory.values(in_fours(3 * static_cast<int64_t>(s.n_node_shares)));
        D = reinterpret_cast<Vector3<double> *>(memory.values(in_fours(3 * static_cast<int64_t>(s.n_unknowns))));
        b = reinterpret_cast<Vector3<double> *>(memory.values(in_fours(3 * static_cast<int64_t>(s.n_unknowns))));
        double **const arrays[] = {&E, &per_E, &coupling, &y, &x, &size, &r, &shadow, &p, &p_node, &v, &s_node, &t};
        for (double **array : arrays) *array = memory.values(n);
    }

    // Bonds of the ends, and what trees at the nodes give to right-hand sides.
    void open(const Net3 &new_D, const Net3 &ref) const {
        for_each([&](int32_t u) {
            D[u] = new_D.get<double>(s.place_of[u]);
            b[u] = ref.get<double>(s.place_of[u]);
            const int32_t other = s.other_node[u];
            if (other < 0) return;
            // Taken off again by multiply(), so that it needs not be exact; what is held fixed offers nothing.
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
    void factorize() const {
        direct = tried = false;
        net.for_nodes([&](int32_t first, int32_t end, int32_t) {
            for (int32_t n = first; n < end; ++n) {
                node[n].with_ends = node[n].mass;
                for (int32_t u = s.own_start[n]; u < s.own_start[n + 1]; ++u) {
                    per_E[u] = 1 / E[u];
                    load(node[n].with_ends, E[u], b[u], D[u]);
                }
            }
        });
        if (s.fronts.at_once) use_fronts();
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

    // Calls body(u) for all unknowns, node by node.
    template <class Body>
    HOL_FORCED void for_each(const Body &body) const {
        net.for_nodes([&](int32_t first, int32_t end, int32_t) {
            for (int32_t u = s.own_start[first]; u < s.own_start[end]; ++u) body(u);
        });
    }

    // Solves for y until what is left is `part` of it, both as sums of squares' roots, and, with `sizes`, of right-hand
    // sides' terms by place, every unknown's is a rounding of its own, or of the mean. How many rounds it took, or -1.
    __attribute__((noinline)) int32_t solve(double part, const double *sizes) const {
        Sums all = sums_of_nodes([&](int32_t first, int32_t end, Sums &one) {
            for (int32_t u = s.own_start[first]; u < s.own_start[end]; ++u) {
                x[u] = 0;
                r[u] = y[u];
                one.a = mul_add(y[u], y[u], one.a);
                size[u] = sizes ? rounding_part * (sizes[s.place_of[u]] * sizes[s.place_of[u]]) : 0;
            }
        });
        if (!(all.a > 0)) return all.a == 0 ? 0 : -1;
        const Goal goal = {part * part * all.a, (least_of_mean * rounding_part) * all.a / s.n_unknowns,
                           sizes != nullptr};
        const double whole = all.a;
        double rho = 0, looked_at = all.a;
        for (int32_t round = 1; round <= most_rounds; ++round) {
            if (round == 1 || (is_slow(round - 1, whole, all.a, goal) && use_fronts())) {
                begin();
                rho = looked_at = all.a;
            }
            all = multiply(p, p_node, v, [&](int32_t u, Sums &one) { one.a = mul_add(shadow[u], v[u], one.a); });
            const double alpha = rho / all.a;
            all = sums_of_nodes([&](int32_t first, int32_t end, Sums &one) {
                for (int32_t u = s.own_start[first]; u < s.own_start[end]; ++u) {
                    x[u] = mul_add(alpha, p_node[u], x[u]);
                    r[u] = mul_add(-alpha, v[u], r[u]);
                    note_left(u, one);
                }
                if (!direct) precondition(first, end, r, s_node);
            });
            if (!(all.a < 1e300)) return -1;
            if (goal.is_reached(all)) return round;
            if (direct) precondition_all(r, s_node);
            all = multiply(r, s_node, t, [&](int32_t u, Sums &one) {
                one.a = mul_add(t[u], r[u], one.a);
                one.b = mul_add(t[u], t[u], one.b);
            });
            const double omega = all.a / all.b;
            all = sums_of_nodes([&](int32_t first, int32_t end, Sums &one) {
                for (int32_t u = s.own_start[first]; u < s.own_start[end]; ++u) {
                    x[u] = mul_add(omega, s_node[u], x[u]);
                    r[u] = mul_add(-omega, t[u], r[u]);
                    note_left(u, one);
                    one.b = mul_add(shadow[u], r[u], one.b);
                }
            });
            if (all.a < 1e300 && goal.is_reached(all)) return round;
            if (round % (direct ? few_rounds : look_after) == 0) {
                if (!(all.a < least_progress * looked_at)) return -1;
                looked_at = all.a;
            }
            const double beta = all.b / rho * (alpha / omega);
            if (!(abs(beta) < 1e300)) return -1;
            rho = all.b;
            net.for_nodes([&](int32_t first, int32_t end, int32_t) {
                for (int32_t u = s.own_start[first]; u < s.own_start[end]; ++u)
                    p[u] = mul_add(beta, mul_add(-omega, v[u], p[u]), r[u]);
                if (!direct) precondition(first, end, p, p_node);
            });
            if (direct) precondition_all(p, p_node);
        }
        return -1;
    }

private:
    // So many rounds have to take squares down to less than this part.
    static constexpr int32_t most_rounds = 2000, look_after = 64;
    static constexpr double least_progress = 0.1;
    static constexpr double rounding_part = 16 * epsilon * 16 * epsilon, least_of_mean = 1. / 256,  // of squares
        least_share = 16 * epsilon, least_of_own = 1e-5;
    static constexpr int32_t few_rounds = 8;
    struct Sums {
        double a, b, most;
    };
    // Squares of what may be left: of all together, and of one beyond its rounding.
    struct Goal {
        double of_all, of_one;
        bool by_one;
        bool is_reached(const Sums &left) const { return left.a <= of_all && (!by_one || left.most <= of_one); }
    };
    void begin() const {
        net.for_nodes([&](int32_t first, int32_t end, int32_t) {
            for (int32_t u = s.own_start[first]; u < s.own_start[end]; ++u) shadow[u] = p[u] = r[u];
            if (!direct) precondition(first, end, p, p_node);
        });
        if (direct) precondition_all(p, p_node);
    }

    // Whether it takes more rounds than fronts do, and a good part of these yet, if each gains as many orders as the
    // ones so far: `taken` of them took squares down from `whole` to `left`.
    bool is_slow(int32_t taken, double whole, double left, const Goal &goal) const {
        if (direct || tried) return false;
        const int gained = order_of(whole) - order_of(left),
                  wanted = goal.by_one ? 2 * 46 : order_of(whole) - order_of(goal.of_all);
        const double can_take = s.fronts.rounds * (gained > 0 ? gained : 0);
        return taken > 1 && taken * wanted > can_take && 4 * taken * (wanted - gained) > can_take;
    }
    // Of a square: binary exponent.
    HOL_STATIC int order_of(double a) {
        uint64_t bits_of_a;
        __builtin_memcpy(&bits_of_a, &a, sizeof a);
        return static_cast<int>(bits_of_a >> 52 & 2047);
    }
    __attribute__((noinline)) bool use_fronts() const {
        if (tried || s.fronts.n_fronts == 0) return false;
        tried = true;
        return direct = fronts.factorize(
                   least_share, [&](const FrontPlan::Front &f, const Dense &a) { add_terms(f, a); },
                   [&](int32_t u) { return E[u] + dot(D[u], node[s.node_of[u]].mass * b[u]); });
    }
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
    void precondition_all(const double *of, double *to) const {
        for (int32_t u = 0; u < s.n_unknowns; ++u) to[u] = of[u];
        fronts.solve(to);
    }

    void note_left(int32_t u, Sums &of) const {
        const double square = r[u] * r[u];
        of.a += square;
        of.most = max(square - size[u], of.most);
    }

    // Sums that body(first, end, sums) adds up over each share, then over these in order: the same for any number of
    // threads.
    template <class Body>
    HOL_FORCED Sums sums_of_nodes(const Body &body) const {
        net.for_nodes([&](int32_t first, int32_t end, int32_t share) {
            Sums one = {0, 0, 0};
            body(first, end, one);
            sum[3 * share] = one.a;
            sum[3 * share + 1] = one.b;
            sum[3 * share + 2] = one.most;
        });
        Sums all = {0, 0, 0};
        for (int32_t i = 0; i < s.n_node_shares; ++i) {
            all.a += sum[3 * i];
            all.b += sum[3 * i + 1];
            all.most = max(sum[3 * i + 2], all.most);
        }
        return all;
    }

    // M^-1: the ends of each node by themselves.
    __attribute__((noinline)) void precondition(int32_t first, int32_t end, const double *of, double *to) const {
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
    // What strands couple, and what bonds do at the nodes where they are foreign, added to `own`, which is M times
    // `of`; with fronts, all terms of the matrix.
    template <class Body>
    HOL_FORCED Sums multiply(const double *own, const double *of, double *to, const Body &body) const {
        if (s.has_foreign || direct) accelerate_nodes(of);
        if (direct)
            return sums_of_nodes([&](int32_t first, int32_t end, Sums &one) {
                for (int32_t u = s.own_start[first]; u < s.own_start[end]; ++u) {
                    double value = s.sign[u] * dot(D[u], node[s.node_of[u]].all);
                    if (s.other_node[u] >= 0)
                        value -= dot(D[u], node[s.other_node[u]].all);
                    else
                        value = mul_add(E[u], of[u], mul_add(coupling[u], of[s.partner[u]], value));
                    to[u] = value;
                    body(u, one);
                }
            });
        return sums_of_nodes([&](int32_t first, int32_t end, Sums &one) {
            for (int32_t u = s.own_start[first]; u < s.own_start[end]; ++u) {
                double value = mul_add(coupling[u], of[s.partner[u]], own[u]);
                if (s.has_foreign) {
                    value = mul_add(s.sign[u], dot(D[u], node[s.node_of[u]].foreign), value);
                    if (s.other_node[u] >= 0) value -= dot(D[u], node[s.other_node[u]].all) + E[u] * of[u];
                }
                to[u] = value;
                body(u, one);
            }
        });
    }
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
};

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
