// What is left of a network's equations: the ends of strands, coupled at the nodes and from end to end. Stabilised
// bi-conjugate gradients (H. van der Vorst, SIAM J. Sci. Stat. Comput. 13, 631 (1992)), with the ends of each node
// solved exactly as the preconditioner M: what strands couple dies out along them, so that it takes few rounds. Where
// these would be few in any case, corrections by M alone do. With p' = M^-1 p the product with the matrix is p +
// (matrix - M) p'.
#pragma once

#include "core/kernels/molecules/network/ends.hpp"

namespace holonomic::HOL_ISA::graph {

struct Unknowns : Ends {
    double *x, *size;                                  // solution, squares of the sizes of right-hand sides' terms
    double *sum;                                       // [n_node_shares][3]
    double *r, *shadow, *p, *p_node, *v, *s_node, *t;  // s takes the place of r
    mutable bool direct = false, tried = false;        // fronts are used; or have been tried

    static int64_t values(const NetworkPlan &s, bool symmetric) {
        return Ends::values(s, symmetric) + in_fours(3 * static_cast<int64_t>(s.n_node_shares)) +
               9 * in_fours(s.n_unknowns + 3 * s.fronts.n_hubs);
    }
    Unknowns(const Net &of, bool symmetric, Memory<double> &of_factor, Memory<double> &memory)
        : Ends(of, symmetric, of_factor, memory) {
        sum = memory.values(in_fours(3 * static_cast<int64_t>(s.n_node_shares)));
        double **const arrays[] = {&x, &size, &r, &shadow, &p, &p_node, &v, &s_node, &t};
        for (double **array : arrays) *array = memory.values(in_fours(s.n_unknowns + 3 * s.fronts.n_hubs));
    }

    void factorize() const {
        direct = tried = false;
        factorize_nodes();
        if (s.fronts.at_once) use_fronts();
    }
    // Solves for y until what is left is `part` of it, both as sums of squares' roots, and, with `sizes`, of right-hand
    // sides' terms by bond index, every unknown's is a rounding of its own, or of the mean. How many rounds it took, or
    // -1. What the iteration cannot do alone is begun again with fronts.
    int32_t solve(double part, const double *sizes) const {
        const int32_t taken = iterate(part, sizes);
        return taken < 0 && use_fronts() ? iterate(part, sizes) : taken;
    }
    // Makes fronts where they take less than two solves without them, as one shows whose solution is no matter.
    // sizes: room for those of right-hand sides.
    void prepare_for_many(double part, double *sizes) const {
        if (direct || s.fronts.n_fronts == 0) return;
        for (int32_t u = 0; u < s.n_unknowns; ++u) {
            const bool turned = static_cast<uint32_t>(u) * 2654435769u >> 31 != 0;
            y[u] = turned ? -E[u] : E[u];
            sizes[s.bond_index_of[u]] = E[u];
        }
        if (2 * solve(part, sizes) > s.fronts.rounds) use_fronts();
    }

private:
    __attribute__((noinline)) int32_t iterate(double part, const double *sizes) const {
        Sums<double> all = sums_of_shares([&](int32_t share, SumsOfShare &parts) {
            net.for_unknowns(share, [&](auto width, int32_t u) HOL_FORCED {
                typedef decltype(width) V;
                const V whole = load_any<V>(y + u), of_terms = sizes ? gather<V>(sizes, s.bond_index_of + u) : V{};
                store_any(x + u, V{});
                store_any(r + u, whole);
                store_any(size + u, Width<V>::all(rounding_part) * (of_terms * of_terms));
                V &sum_of = parts.of(width).a;
                sum_of = mul_add(whole, whole, sum_of);
            });
        });
        if (!(all.a > 0)) return all.a == 0 ? 0 : -1;
        const Goal goal = {part * part * all.a, (least_of_mean * rounding_part) * all.a / s.n_unknowns,
                           sizes != nullptr};
        const double rhs = all.a;
        const int32_t simple = s.has_foreign || direct ? 0 : iterate_simply(goal, all);
        if (simple > 0 && goal.is_reached(all)) return simple;
        const double whole = all.a;
        double rho = 0, looked_at = all.a;
        for (int32_t round = simple + 1; round <= most_rounds; ++round) {
            if (round == simple + 1 || (is_slow(round - simple - 1, rhs, whole, all.a, goal) && use_fronts())) {
                begin();
                rho = looked_at = all.a;
            }
            all = multiply(p, p_node, v, [&](auto width, int32_t u, const auto &product, auto &sums) HOL_FORCED {
                sums.a = mul_add(load_any<decltype(width)>(shadow + u), product, sums.a);
            });
            const double alpha = rho / all.a;
            all = sums_of_shares([&](int32_t share, SumsOfShare &parts) {
                net.for_unknowns(share,
                                 [&](auto width, int32_t u) HOL_FORCED { step(width, u, alpha, p_node, v, parts); });
                if (!direct) solve_nodes(share, r, s_node);
            });
            if (!(all.a < 1e300)) return -1;
            if (goal.is_reached(all)) return round;
            if (direct) solve_fronts(r, s_node);
            all = multiply(r, s_node, t, [&](auto width, int32_t u, const auto &product, auto &sums) HOL_FORCED {
                sums.a = mul_add(product, load_any<decltype(width)>(r + u), sums.a);
                sums.b = mul_add(product, product, sums.b);
            });
            const double omega = all.a / all.b;
            all = sums_of_shares([&](int32_t share, SumsOfShare &parts) {
                net.for_unknowns(share, [&](auto width, int32_t u) HOL_FORCED {
                    const auto left = step(width, u, omega, s_node, t, parts);
                    auto &sums = parts.of(width);
                    sums.b = mul_add(load_any<decltype(width)>(shadow + u), left, sums.b);
                });
            });
            if (all.a < 1e300 && goal.is_reached(all)) return round;
            if (round % (direct ? few_rounds : look_after) == 0) {
                if (!(all.a < least_progress * looked_at)) return -1;
                looked_at = all.a;
            }
            const double beta = all.b / rho * (alpha / omega);
            if (!(abs(beta) < 1e300)) return -1;
            rho = all.b;
            net.for_node_shares([&](int32_t share) {
                net.for_unknowns(share, [&](auto width, int32_t u) HOL_FORCED {
                    typedef decltype(width) V;
                    const V before = mul_add(Width<V>::all(-omega), load_any<V>(v + u), load_any<V>(p + u));
                    store_any(p + u, mul_add(Width<V>::all(beta), before, load_any<V>(r + u)));
                });
                if (!direct) solve_nodes(share, p, p_node);
            });
            if (direct) solve_fronts(p, p_node);
        }
        return -1;
    }

    // So many rounds have to take squares down to less than this part.
    static constexpr int32_t most_rounds = 2000, look_after = 64;
    static constexpr double least_progress = 0.1;
    static constexpr double rounding_part = 16 * epsilon * 16 * epsilon, least_of_mean = 1. / 256;  // of squares
    static constexpr int32_t few_rounds = 8;
    static constexpr double enough_gained = 1. / 256;  // of squares
    template <class V>
    struct Sums {
        V a, b, most;
    };
    // Of a share, in lanes and of what is left of it.
    struct SumsOfShare {
        Sums<vec> lanes;
        Sums<double> rest;
        HOL_FORCED Sums<vec> &of(const vec &) { return lanes; }
        HOL_FORCED Sums<double> &of(double) { return rest; }
    };
    // Squares of what may be left: of all together, and of one beyond its rounding.
    struct Goal {
        double of_all, of_one;
        bool by_one;
        bool is_reached(const Sums<double> &left) const { return left.a <= of_all && (!by_one || left.most <= of_one); }
    };
    void begin() const {
        net.for_node_shares([&](int32_t share) {
            for (int32_t u = s.unknown_start[share]; u < s.unknown_start[share + 1]; ++u) shadow[u] = p[u] = r[u];
            if (!direct) solve_nodes(share, p, p_node);
        });
        if (direct) solve_fronts(p, p_node);
    }

    // Corrections by M alone leave what strands couple of them. As long as each gains enough they are as good as those
    // of the other method, and take half the time. Returns how many were made; `all` becomes what is left.
    int32_t iterate_simply(const Goal &goal, Sums<double> &all) const {
        for (int32_t round = 1;; ++round) {
            net.for_node_shares([&](int32_t share) {
                solve_nodes(share, r, p_node);
                net.for_unknowns(share, [&](auto width, int32_t u) HOL_FORCED {
                    typedef decltype(width) V;
                    store_any(x + u, load_any<V>(x + u) + load_any<V>(p_node + u));
                });
            });
            const double before = all.a;
            all = sums_of_shares([&](int32_t share, SumsOfShare &parts) {
                net.for_unknowns(share, [&](auto width, int32_t u) HOL_FORCED {
                    typedef decltype(width) V;
                    const V left = -(load_any<V>(coupling + u) * gather<V>(p_node, s.partner + u));
                    store_any(r + u, left);
                    note_left(left, u, parts.of(width));
                });
            });
            if (goal.is_reached(all) || !(all.a < enough_gained * before)) return round;
        }
    }

    // Whether it takes more rounds than fronts do, and a good part of these yet, if each gains as many orders as the
    // ones so far: `taken` of them took squares down from `whole` to `left`, where right-hand sides were `rhs`.
    bool is_slow(int32_t taken, double rhs, double whole, double left, const Goal &goal) const {
        if (direct || tried) return false;
        const int gained = order_of(whole) - order_of(left),
                  wanted = order_of(whole) - (goal.by_one ? order_of(rhs) - 2 * 46 : order_of(goal.of_all));
        const double can_take = s.fronts.rounds * (gained > 0 ? gained : 0);
        return taken > 1 && taken * wanted > can_take && 4 * taken * (wanted - gained) > can_take;
    }
    // Of a square: binary exponent.
    HOL_STATIC int order_of(double a) {
        uint64_t bits_of_a;
        __builtin_memcpy(&bits_of_a, &a, sizeof a);
        return static_cast<int>(bits_of_a >> 52 & 2047);
    }
    bool use_fronts() const {
        if (tried || s.fronts.n_fronts == 0) return false;
        tried = true;
        return direct = factorize_fronts();
    }
    // A step along a direction, whose product with the matrix it has: into the solution, and what is left, which it
    // returns.
    template <class V>
    HOL_FORCED V step(const V &, int32_t u, double so_far, const double *along, const double *product,
                      SumsOfShare &parts) const {
        const V far = Width<V>::all(so_far);
        const V left = mul_add(Width<V>::all(-so_far), load_any<V>(product + u), load_any<V>(r + u));
        store_any(x + u, mul_add(far, load_any<V>(along + u), load_any<V>(x + u)));
        store_any(r + u, left);
        note_left(left, u, parts.of(V{}));
        return left;
    }
    template <class V>
    HOL_FORCED void note_left(const V &left, int32_t u, Sums<V> &sums) const {
        const V square = left * left;
        sums.a = sums.a + square;
        sums.most = max(square - load_any<V>(size + u), sums.most);
    }

    // Sums that body(share, parts) adds up over each share, then over these in order: the same for any number of
    // threads.
    template <class Body>
    HOL_FORCED Sums<double> sums_of_shares(const Body &body) const {
        net.for_node_shares([&](int32_t share) {
            SumsOfShare parts = {};
            body(share, parts);
            double most = parts.rest.most;
            for (int i = 0; i < W; ++i) most = max(Width<vec>::get(parts.lanes.most, i), most);
            sum[3 * share] = sum_lanes(parts.lanes.a) + parts.rest.a;
            sum[3 * share + 1] = sum_lanes(parts.lanes.b) + parts.rest.b;
            sum[3 * share + 2] = most;
        });
        Sums<double> all = {0, 0, 0};
        for (int32_t i = 0; i < s.n_node_shares; ++i) {
            all.a += sum[3 * i];
            all.b += sum[3 * i + 1];
            all.most = max(sum[3 * i + 2], all.most);
        }
        return all;
    }

    // The product of the matrix with `of`, and sums over the unknowns. own: M times `of`, without fronts.
    template <class Body>
    HOL_FORCED Sums<double> multiply(const double *own, const double *of, double *to, const Body &body) const {
        if (s.has_foreign || direct) accelerate_nodes(of);
        return sums_of_shares([&](int32_t share, SumsOfShare &parts) {
            Ends::multiply(share, direct ? nullptr : own, of, to);
            net.for_unknowns(share, [&](auto width, int32_t u) HOL_FORCED {
                body(width, u, load_any<decltype(width)>(to + u), parts.of(width));
            });
        });
    }
};

}  // namespace holonomic::HOL_ISA::graph
