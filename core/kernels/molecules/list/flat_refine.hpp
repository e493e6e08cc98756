// Corrects the multipliers of one large molecule against the exact residual, as linear.hpp does those of molecules in
// lanes, with the factors along its list. Residuals are those of residual.hpp, x y z at once.
#pragma once

#include "core/kernels/molecules/cycles/refine.hpp"
#include "core/kernels/molecules/list/flat_proof.hpp"

namespace holonomic::HOL_ISA::graph {

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
    const int terms;
    double *const solution;  // in the memory of what the proof needed
    double *const side;

    explicit FlatRefine(const FlatLinear &linear)
        : x(linear), s(linear.s), terms(linear.terms), solution(x.back), side(x.diagonal) {}

    // As in core_matrix.hpp.
    bool has_good_pivots() const {
        for (int32_t k = 0; k < s.n_bonds; ++k)
            if (!(x.E[k] >= least_pivot * x.diagonal[k])) return false;
        return true;
    }

    template <class Body>
    HOL_FORCED void for_tiles_up(const Body &body) const {
        for (int32_t i = 0; i < s.n_tiles; ++i) body(s.tile[i]);
    }
    template <class Body>
    HOL_FORCED void for_tiles_down(const Body &body) const {
        for (int32_t i = s.n_tiles; i-- > 0;) body(s.tile[i]);
    }

    // A tile's coordinates and velocities, and its bonds with their low words: of one tile these stay.
    __attribute__((noinline)) void open(const Tile &tile) const {
        read_atoms(x.coordinates, x.at, s, tile, x.r);
        if (terms & squares) read_atoms(*x.in.v, x.at, s, tile, x.v);
        const int64_t rows = in_fours(tile.end - tile.first);
        for (int64_t k = 0; k < rows; ++k) {
            const int64_t row = tile.first_row + k;
            Vector3<double> d = {}, low = {};
            unrounded_bond(x.box, vector_of(x.r.at_four_times(s.from[row])), vector_of(x.r.at_four_times(s.to[row])), d,
                           low);
            x.d[row] = row_of(d);
            x.d_low[k] = row_of(low);
        }
    }
    void open_again(const Tile &tile) const {
        if (s.n_tiles > 1) open(tile);
    }

    // Inputs once more, and right-hand sides.
    __attribute__((noinline)) void start() const {
        for_tiles_up([&](const Tile &tile) {
            open(tile);
            x.load_inputs(tile, x.a_of(tile));
            for (int64_t k = tile.first; k < tile.end; k += 4) x.four(side, k) = x.sides_of(tile, k, terms);
            x.add_given(tile, side);
        });
        for (int32_t k = 0; k < s.n_bonds; ++k) solution[k] = x.t[k];
    }

    // Accelerations, or velocities, of a tile's own atoms; later tiles have been here. High words in pull.
    __attribute__((noinline)) void pull_atoms(const Tile &tile) const {
        const Rows a = rows_from(x.pull, tile.first_site), low = rows_from(x.a_low, tile.first_site);
        const int32_t own = tile.own_end - tile.first_site, n = tile.end_site - tile.first_site;
        if (terms & pulls) read_atoms(*x.in.f, x.at, s, tile, a);
        for (int32_t i = terms & pulls ? own : 0; i < n; ++i) a[i] = Row{};
        for (int32_t i = 0; i < n; ++i) low[i] = Row{};
        const int32_t *const from = s.from + tile.first_row, *const to = s.to + tile.first_row;
        for (int32_t k = 0; k < tile.end - tile.first; ++k) {
            const Pair<Row> bond = {x.d[tile.first_row + k], x.d_low[k]},
                            p = product_of(in_row(solution[tile.first + k]), bond);
            set(a, low, from[k], add_pairs(get(a, low, from[k]), p));
            set(a, low, to[k], subtract_pairs(get(a, low, to[k]), p));
        }
        for (int32_t i = tile.first_visit; i < tile.end_visit; ++i) {
            const int32_t own_site = 4 * s.visit[i].own, guest = 4 * s.visit[i].guest;
            set(x.pull, x.a_low, own_site, add_pairs(get(x.pull, x.a_low, own_site), get(x.pull, x.a_low, guest)));
        }
        const double *const w = x.mass + tile.first_mass;
        for (int32_t i = 0; i < own; ++i) {
            Pair<Row> sum = product_of(in_row(w[2 * i + 1]), get(a, low, 4 * i));
            if (terms & rates) sum = add_pairs(sum, Pair<Row>{x.a_of(tile)[i], Row{}});
            set(a, low, 4 * i, sum);
        }
    }
    HOL_FORCED static Pair<Row> get(const Rows &hi, const Rows &low, int32_t four_times) {
        return {hi.at_four_times(four_times), low.at_four_times(four_times)};
    }
    HOL_FORCED static void set(const Rows &hi, const Rows &low, int32_t four_times, const Pair<Row> &a) {
        hi.at_four_times(four_times) = a.hi;
        low.at_four_times(four_times) = a.lo;
    }

    // Of a tile, into t.
    __attribute__((noinline)) void find_residuals(const Tile &tile) const {
        copy_guests(s, tile, x.pull);
        copy_guests(s, tile, x.a_low);
        const Rows a = rows_from(x.pull, tile.first_site), low = rows_from(x.a_low, tile.first_site);
        for (int64_t k = tile.first; k < tile.end; k += 4) {
            const int64_t row = tile.first_row + (k - tile.first);
            Pair<Row> product[4] = {}, square[4] = {};
            HOL_UNROLL
            for (int i = 0; i < 4; ++i) {
                const int32_t from = s.from[row + i], to = s.to[row + i];
                const Pair<Row> bond = {x.d[row + i], x.d_low[k - tile.first + i]};
                product[i] = product_of(bond, subtract_pairs(get(a, low, to), get(a, low, from)));
                if (!(terms & squares)) continue;
                const Pair<Row> dv = two_difference<Row>(x.v.at_four_times(to), x.v.at_four_times(from));
                square[i] = product_of(dv, dv);
            }
            Pair<Row> sum = sums(product);
            if (terms & squares) sum = add_pairs(sum, sums(square));
            if ((terms & (given | rates)) && (x.in.rhs || x.in.strain)) {
                Row c = {};
                for (int i = 0; i < 4 && k + i < tile.end; ++i) c[i] = x.given_to(tile, static_cast<int32_t>(k + i));
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
        clear_sides(s, x.t);
        for_tiles_down([&](const Tile &tile) {
            open_again(tile);
            pull_atoms(tile);
        });
        for_tiles_up([&](const Tile &tile) {
            open_again(tile);
            find_residuals(tile);
            solve_up(s, tile, x.lower, x.t);
        });
        for_tiles_down([&](const Tile &tile) {
            solve_down(s, tile, x.lower, x.per_pivot, x.t, [](int32_t, double) HOL_FORCED {});
        });
    }
    double correct() const {
        return add_corrections<double>(s.n_bonds, [&](int32_t k) HOL_FORCED {
            return Correction<double>{x.t[k], side[k] * x.per_pivot[k], x.size[k] * x.size[k], solution[k]};
        });
    }
    // Whether corrections are no more than what rounding does to right-hand sides.
    bool is_rounding() const {
        for (int32_t i = 0; i < s.n_tiles; ++i) {
            const Tile &tile = s.tile[i];
            x.load_inputs_again(tile);
            const Rows a = x.a_of(tile);
            for (int32_t k = tile.first; k < tile.end; ++k) {
                const int32_t row = tile.first_row + (k - tile.first);
                const Row terms_of_ends = absolute(a.at_four_times(s.from[row])) + absolute(a.at_four_times(s.to[row])),
                          all = absolute(x.d[row]) * terms_of_ends;
                if (!(abs(x.t[k]) <= 4 * epsilon * ((all[0] + all[1]) + all[2]) * x.per_pivot[k])) return false;
            }
        }
        return true;
    }

    bool refine() const {
        if (!has_good_pivots()) return false;
        start();
        const Flag good = correct_until_right<double>(
            Flag{true}, [&]() HOL_FORCED { solve(); }, [&](Flag) HOL_FORCED { return correct(); },
            [&]() HOL_FORCED { return Flag{is_rounding()}; });
        if (!good.set) return false;
        double sum = 0;
        for (int32_t k = 0; k < s.n_bonds; ++k) {
            x.t[k] = solution[k];
            sum += abs(solution[k]);
        }
        if (!(sum - sum == 0)) return false;  // corrections that are no numbers are not seen
        for_tiles_down([&](const Tile &tile) {
            x.find_pulls(tile);
            if (terms & rates) x.add_pulls(tile);  // nobody asks for accelerations any more
        });
        return true;
    }
};

}  // namespace holonomic::HOL_ISA::graph
