// Corrects the multipliers of one large molecule against the exact residual, as linear.hpp does those of molecules in
// lanes, with the factors along its list, if that has one tile. Residuals are those of residual.hpp, x y z at once.
#ifndef HOLONOMIC_KERNELS_MOLECULES_LIST_FLAT_REFINE_HPP
#define HOLONOMIC_KERNELS_MOLECULES_LIST_FLAT_REFINE_HPP

#include "core/kernels/molecules/cycles/refine.hpp"
#include "core/kernels/molecules/list/flat_proof.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

// Products in twice the precision of exact.hpp and residual.hpp, whose templates know no rows where these are no lanes.
HOL_INLINE Pair<Row> product_of(const Row &a, const Row &b) {
#if HOL_HAS_FMA
    const Row p = a * b;
    return {p, multiply_add(a, b, -p)};
#else
    return two_product<Row>(a, b);
#endif
}
HOL_INLINE Pair<Row> product_of(const Row &s, const Pair<Row> &a) {
    const Pair<Row> p = product_of(s, a.hi);
    return {p.hi, multiply_add(s, a.lo, p.lo)};
}
HOL_INLINE Pair<Row> product_of(const Pair<Row> &a, const Pair<Row> &b) {
    const Pair<Row> p = product_of(a.hi, b.hi);
    return {p.hi, multiply_add(a.hi, b.lo, multiply_add(a.lo, b.hi, p.lo))};
}

struct FlatRefine {
    const FlatLinear &x;
    const FlatList &s;
    const Tile &tile;
    const int terms;
    double *const solution;  // in the memory of what the proof needed
    double *const side;

    explicit FlatRefine(const FlatLinear &linear)
        : x(linear), s(linear.s), tile(s.tile[0]), terms(linear.terms), solution(x.back), side(x.diagonal) {}

    // As in core_matrix.hpp.
    bool has_good_pivots() const {
        for (int32_t k = 0; k < s.n_bonds; ++k)
            if (!(x.E[k] >= least_pivot * x.diagonal[k])) return false;
        return true;
    }

    // Inputs once more, right-hand sides, and bonds with their low words.
    __attribute__((noinline)) void start() const {
        x.load_inputs(tile, x.a);
        if (terms & squares) read_atoms(*x.in.v, x.at, s, tile, x.v);
        for (int64_t k = 0; k < s.n_bonds; k += 4) x.four(side, k) = x.sides_of(tile, k, terms);
        x.add_given(tile, side);
        for (int32_t k = 0; k < s.n_rows; ++k) {
            Vector3<double> d = {}, low = {};
            unrounded_bond(x.box, vector_of(x.r.at_four_times(s.from[k])), vector_of(x.r.at_four_times(s.to[k])), d,
                           low);
            x.d[k] = row_of(d);
            x.d_low[k] = row_of(low);
        }
        for (int32_t k = 0; k < s.n_bonds; ++k) solution[k] = x.t[k];
    }

    // Accelerations, or velocities: high words in pull.
    __attribute__((noinline)) void pull_atoms() const {
        if (terms & pulls)
            read_atoms(*x.in.f, x.at, s, tile, x.pull);
        else
            for (int64_t i = 0; i < s.n_sites; ++i) x.pull[i] = Row{};
        for (int64_t i = 0; i < s.n_sites; ++i) x.a_low[i] = Row{};
        for (int32_t k = 0; k < s.n_bonds; ++k) {
            const Pair<Row> bond = {x.d[k], x.d_low[k]}, p = product_of(in_row(solution[k]), bond);
            set(s.from[k], add_pairs(acceleration(s.from[k]), p));
            set(s.to[k], subtract_pairs(acceleration(s.to[k]), p));
        }
        for (int32_t i = 0; i < s.n_sites; ++i) {
            Pair<Row> a = product_of(in_row(x.mass[2 * i + 1]), acceleration(4 * i));
            if (terms & rates) a = add_pairs(a, Pair<Row>{x.a[i], Row{}});
            set(4 * i, a);
        }
    }
    HOL_FORCED Pair<Row> acceleration(int32_t four_times) const {
        return {x.pull.at_four_times(four_times), x.a_low.at_four_times(four_times)};
    }
    HOL_FORCED void set(int32_t four_times, const Pair<Row> &a) const {
        x.pull.at_four_times(four_times) = a.hi;
        x.a_low.at_four_times(four_times) = a.lo;
    }

    // Into t.
    __attribute__((noinline)) void find_residuals() const {
        for (int64_t k = 0; k < s.n_bonds; k += 4) {
            Pair<Row> product[4] = {}, square[4] = {};
            HOL_UNROLL
            for (int i = 0; i < 4; ++i) {
                const int32_t from = s.from[k + i], to = s.to[k + i];
                const Pair<Row> bond = {x.d[k + i], x.d_low[k + i]};
                product[i] = product_of(bond, subtract_pairs(acceleration(to), acceleration(from)));
                if (!(terms & squares)) continue;
                const Pair<Row> dv = two_difference<Row>(x.v.at_four_times(to), x.v.at_four_times(from));
                square[i] = product_of(dv, dv);
            }
            Pair<Row> sum = sums(product);
            if (terms & squares) sum = add_pairs(sum, sums(square));
            if ((terms & (given | rates)) && (x.in.rhs || x.in.strain)) {
                Row c = {};
                for (int i = 0; i < 4 && k + i < s.n_bonds; ++i) c[i] = x.given_to(tile, static_cast<int32_t>(k + i));
                sum = add_pairs(sum, Pair<Row>{c, Row{}});
            }
            x.four(x.t, k) = sum.hi + sum.lo;
        }
    }
    HOL_FORCED static Pair<Row> sums(const Pair<Row> *p) {
        const Lanes3 hi = turned(p[0].hi, p[1].hi, p[2].hi, p[3].hi), lo = turned(p[0].lo, p[1].lo, p[2].lo, p[3].lo);
        return add_pairs(Pair<Row>{hi.x, lo.x}, add_pairs(Pair<Row>{hi.y, lo.y}, Pair<Row>{hi.z, lo.z}));
    }

    void solve() const {
        pull_atoms();
        find_residuals();
        solve_up(s, tile, x.lower, x.t);
        solve_down(s, tile, x.lower, x.per_pivot, x.t, [](int32_t, double) HOL_FORCED {});
    }
    double correct() const {
        return add_corrections<double>(s.n_bonds, [&](int32_t k) HOL_FORCED {
            return Correction<double>{x.t[k], side[k] * x.per_pivot[k], x.size[k] * x.size[k], solution[k]};
        });
    }
    // Whether corrections are no more than what rounding does to right-hand sides.
    bool is_rounding() const {
        for (int32_t k = 0; k < s.n_bonds; ++k) {
            const Row terms_of_ends = absolute(x.a.at_four_times(s.from[k])) + absolute(x.a.at_four_times(s.to[k])),
                      all = absolute(x.d[k]) * terms_of_ends;
            if (!(abs(x.t[k]) <= 4 * epsilon * ((all[0] + all[1]) + all[2]) * x.per_pivot[k])) return false;
        }
        return true;
    }

    bool refine() const {
        if (s.n_tiles > 1 || !has_good_pivots()) return false;
        start();
        const Flag good = correct_until_right<double>(
            Flag{true}, [&]() HOL_FORCED { solve(); }, [&](Flag) HOL_FORCED { return correct(); },
            [&]() HOL_FORCED { return Flag{is_rounding()}; });
        if (!good.set) return false;
        for (int32_t k = 0; k < s.n_bonds; ++k) x.t[k] = solution[k];
        x.find_pulls(tile);
        x.add_pulls(tile);
        return true;
    }
};

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
