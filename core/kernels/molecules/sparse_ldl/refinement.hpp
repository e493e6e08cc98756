// Corrects the multipliers of molecules by sparse LDL^T against the exact residual, with the factors that there are.
#pragma once

#include "core/kernels/arithmetic/thresholds.hpp"
#include "core/kernels/molecules/refine.hpp"
#include "core/kernels/molecules/sparse_ldl/error_bound.hpp"
#include "core/kernels/molecules/sparse_ldl/pairs.hpp"

namespace holonomic::HOL_ISA::graph {

template <class V>
struct LdlRefinement {
    typedef RowOf<V> Row;
    typedef Pair<Row> Twice;
    static constexpr int step = at_once<V>;
    const LdlLinear<V> &x;
    const LdlPlan &s;
    const int terms;
    V *const solution;  // in the memory of what the proof needed
    V *const rhs;

    explicit LdlRefinement(const LdlLinear<V> &linear)
        : x(linear), s(linear.s), terms(linear.terms), solution(x.back), rhs(x.rhs) {}

    // Calls body(this in a thread, tile) for all tiles, as LdlLinear does.
    template <class Body>
    HOL_FORCED void up(const Body &body) const {
        x.up([&](const LdlLinear<V> &in_thread, const Subtree &subtree) HOL_FORCED {
            const LdlRefinement own(in_thread);
            for_tiles_up(s, subtree, [&](const Tile &tile) HOL_FORCED { body(own, tile); });
        });
    }
    template <class Body>
    HOL_FORCED void down(const Body &body) const {
        x.down([&](const LdlLinear<V> &in_thread, const Subtree &subtree) HOL_FORCED {
            const LdlRefinement own(in_thread);
            for_tiles_down(s, subtree, [&](const Tile &tile) HOL_FORCED { body(own, tile); });
        });
    }

    // The largest of value(this in a thread, tile) of all tiles; the lanes in which all of right(..) are.
    template <class Value>
    HOL_FORCED V largest(const Value &value) const {
        up([&](const LdlRefinement &own, const Tile &tile) HOL_FORCED { x.found[&tile - s.tile] = value(own, tile); });
        V most = x.found[0];
        for (int32_t i = 1; i < s.n_tiles; ++i) most = max(x.found[i], most);
        return most;
    }
    template <class Right>
    HOL_FORCED MaskOf<V> lanes_where(const Right &right) const {
        const V wrong = largest([&](const LdlRefinement &own, const Tile &tile)
                                    HOL_FORCED { return select(right(own, tile), V{}, Width<V>::all(1)); });
        return x.in_use() & ~less(V{}, wrong);
    }

    // A tile's coordinates and velocities, and its bonds with their low words: of one tile these stay.
    __attribute__((noinline)) void open(const Tile &tile) const {
        read_atoms(x.coordinates, x.at, s, tile, x.r);
        if (terms & squares) read_atoms(*x.in.v, x.at, s, tile, x.v);
        const int64_t rows = in_fours(tile.end - tile.first);
        for (int64_t k = 0; k < rows; ++k) {
            const int64_t row = tile.first_row + k;
            Vector3<V> d = {}, low = {};
            unrounded_bond(x.box, vector_of(x.r.at_four_times(s.from[row])), vector_of(x.r.at_four_times(s.to[row])), d,
                           low);
            x.d[row] = row_of(d);
            x.d_low[k] = row_of(low);
        }
    }
    void open_again(const Tile &tile) const {
        if (s.n_tiles > 1) open(tile);
    }

    // Inputs once more, and right-hand sides; the multipliers as they are.
    void start() const {
        up([](const LdlRefinement &own, const Tile &tile) HOL_FORCED { own.start(tile); });
    }
    __attribute__((noinline)) void start(const Tile &tile) const {
        open(tile);
        x.load_inputs(tile);
        for (int64_t k = tile.first; k < tile.end; k += step) x.some(rhs, k) = x.right_hand_sides_of(tile, k, terms);
        x.add_given(tile, rhs);
        for (int32_t k = tile.first; k < tile.end; ++k) solution[k] = x.t[k];
    }

    // Accelerations, or velocities, of a tile's own atoms; later tiles have been here. High words in pull.
    __attribute__((noinline)) void pull_atoms(const Tile &tile) const {
        const Rows<V> a = x.pull.from(tile.first_site), low = x.a_low.from(tile.first_site);
        const int32_t own = tile.own_end - tile.first_site, n = tile.end_site - tile.first_site;
        if (terms & pulls) read_atoms(*x.in.f, x.at, s, tile, a);
        for (int32_t i = terms & pulls ? own : 0; i < n; ++i) a[i] = Row{};
        for (int32_t i = 0; i < n; ++i) low[i] = Row{};
        const int32_t *const from = s.from + tile.first_row, *const to = s.to + tile.first_row;
        for (int32_t k = 0; k < tile.end - tile.first; ++k) {
            const Twice bond = {x.d[tile.first_row + k], x.d_low[k]},
                        p = product_of(in_row(solution[tile.first + k]), bond);
            set(a, low, from[k], add_pairs(get(a, low, from[k]), p));
            set(a, low, to[k], subtract_pairs(get(a, low, to[k]), p));
        }
        for (int32_t i = tile.first_visit; i < tile.end_visit; ++i) {
            const int32_t own_site = 4 * s.visit[i].own, ghost = 4 * s.visit[i].ghost;
            set(x.pull, x.a_low, own_site, add_pairs(get(x.pull, x.a_low, own_site), get(x.pull, x.a_low, ghost)));
        }
        const V *const w = x.w + tile.first_site;
        for (int32_t i = 0; i < own; ++i) {
            Twice sum = product_of(in_row(w[i]), get(a, low, 4 * i));
            if (terms & rates) sum = add_pairs(sum, Twice{x.a_of(tile)[i], Row{}});
            set(a, low, 4 * i, sum);
        }
    }
    HOL_FORCED static Twice get(const Rows<V> &hi, const Rows<V> &low, int32_t four_times) {
        return {hi.at_four_times(four_times), low.at_four_times(four_times)};
    }
    HOL_FORCED static void set(const Rows<V> &hi, const Rows<V> &low, int32_t four_times, const Twice &a) {
        hi.at_four_times(four_times) = a.hi;
        low.at_four_times(four_times) = a.lo;
    }

    // Of a tile, into t.
    __attribute__((noinline)) void find_residuals(const Tile &tile) const {
        copy_ghosts(s, tile, x.pull);
        copy_ghosts(s, tile, x.a_low);
        const Rows<V> a = x.pull.from(tile.first_site), low = x.a_low.from(tile.first_site);
        for (int64_t k = tile.first; k < tile.end; k += step) {
            const int64_t row = tile.first_row + (k - tile.first);
            Twice product[step] = {}, square[step] = {};
            HOL_UNROLL
            for (int i = 0; i < step; ++i) {
                const int32_t from = s.from[row + i], to = s.to[row + i];
                const Twice bond = {x.d[row + i], x.d_low[k - tile.first + i]};
                product[i] = product_of(bond, subtract_pairs(get(a, low, to), get(a, low, from)));
                if (!(terms & squares)) continue;
                const Twice dv = two_difference<Row>(x.v.at_four_times(to), x.v.at_four_times(from));
                square[i] = product_of(dv, dv);
            }
            Pair<Columns<V>> sum = sums_of_pairs<V>(product);
            if (terms & squares) sum = add_pairs(sum, sums_of_pairs<V>(square));
            if ((terms & (given | rates)) && (x.in.rhs || x.in.strain)) {
                Columns<V> c = {};
                for (int i = 0; i < step && k + i < tile.end; ++i)
                    put<V>(c, i, x.given_to(tile, static_cast<int32_t>(k + i)));
                sum = add_pairs(sum, Pair<Columns<V>>{c, Columns<V>{}});
            }
            x.some(x.t, k) = sum.hi + sum.lo;
        }
    }
    void solve() const {
        clear_contributions(s, x.t);
        down([](const LdlRefinement &own, const Tile &tile) HOL_FORCED {
            own.open_again(tile);
            own.pull_atoms(tile);
        });
        up([](const LdlRefinement &own, const Tile &tile) HOL_FORCED {
            own.open_again(tile);
            own.find_residuals(tile);
            solve_up(own.s, tile, own.x.lower, own.x.t);
        });
        down([](const LdlRefinement &own, const Tile &tile) HOL_FORCED {
            solve_down(own.s, tile, own.x.lower, own.x.per_pivot, own.x.t, [](int32_t, const V &) HOL_FORCED {});
        });
    }
    V correct(MaskOf<V> active) const {
        const auto bond = [&](int32_t k) HOL_FORCED {
            return Correction<V>{keep(active, x.t[k]), rhs[k] * x.per_pivot[k], x.size[k] * x.size[k], solution[k]};
        };
        const V tension2 = largest([&](const LdlRefinement &, const Tile &tile)
                                       HOL_FORCED { return largest_tension2<V>(tile.first, tile.end, bond); });
        return largest([&](const LdlRefinement &, const Tile &tile)
                           HOL_FORCED { return add_corrections<V>(tile.first, tile.end, tension2, bond); });
    }

    // In which corrections are no more than what rounding does to right-hand sides: of velocities that are projected
    // already, or in free fall.
    MaskOf<V> rounded_rhs(const Tile &tile) const {
        MaskOf<V> rounded = x.in_use();
        const Rows<V> a = x.a_of(tile);
        for (int32_t k = tile.first; k < tile.end; ++k) {
            const int32_t row = tile.first_row + (k - tile.first);
            const Row terms_of_ends = absolute(a.at_four_times(s.from[row])) + absolute(a.at_four_times(s.to[row]));
            const Vector3<V> all = vector_of(absolute(x.d[row]) * terms_of_ends);
            rounded = rounded & less_equal(abs(x.t[k]), 4 * epsilon * ((all.x + all.y) + all.z) * x.per_pivot[k]);
        }
        return rounded;
    }
    // In which there are numbers.
    MaskOf<V> take_solution(const Tile &tile) const {
        V sum = {};
        for (int32_t k = tile.first; k < tile.end; ++k) {
            x.t[k] = solution[k];
            sum = sum + abs(solution[k]);
        }
        return finite(sum);
    }
    // In which no multiplier is so small beside what pulls the atoms of its bond that it may be the rounding of the
    // residual.
    MaskOf<V> no_cancelling_bonds(const Tile &tile) const {
        V least = Width<V>::all(1);
        for (int32_t k = tile.first; k < tile.end; ++k) {
            const int32_t row = tile.first_row + (k - tile.first);
            const V T =
                x.tensions_at(tile.first_site + s.from[row] / 4) + x.tensions_at(tile.first_site + s.to[row] / 4);
            least = min(abs(x.t[k]) - cancelling_part * (x.size[k] * T) * x.per_pivot[k], least);
        }
        return ~less(least, V{});
    }

    // To the lanes that were not refined, the bonds that they would have had without the others.
    void restore_bonds(MaskOf<V> which) const {
        if constexpr (Width<V>::lanes > 1) {
            if (x.box.lattice == Box::none || !any(which)) return;
            const Tile &tile = s.tile[0];
            for (int64_t row = tile.first_row; row < tile.end_row; ++row) {
                Row &bond = x.d[row], fast = x.r.at_four_times(s.to[row]) - x.r.at_four_times(s.from[row]);
                take_image(x.box, fast);
                bond = {select(which, fast.x, bond.x), select(which, fast.y, bond.y), select(which, fast.z, bond.z),
                        bond.more};
            }
        }
    }

    // Of the lanes that are not `proven`. Returns those that are right, with these.
    unsigned refine(unsigned proven) const {
        const auto rounded = [](const LdlRefinement &own, const Tile &tile)
                                 HOL_FORCED { return own.rounded_rhs(tile); };
        const auto taken = [](const LdlRefinement &own, const Tile &tile)
                               HOL_FORCED { return own.take_solution(tile); };
        const auto cancelling = [](const LdlRefinement &own, const Tile &tile)
                                    HOL_FORCED { return own.no_cancelling_bonds(tile); };
        const MaskOf<V> flagged = Width<V>::of_bits(x.in_all_subtrees(x.firm) & ~proven);
        if (!any(flagged)) return proven;
        start();
        MaskOf<V> good = correct_until_right<V>(
            flagged,
            [&]() HOL_FORCED {
                solve();
                return flagged;
            },
            [&](MaskOf<V> active) HOL_FORCED { return correct(active); },
            [&]() HOL_FORCED { return lanes_where(rounded); });
        good = good & lanes_where(taken);
        if (!(bits(good) | proven)) return 0;
        restore_bonds(Width<V>::of_bits(proven));
        find_pulls_again(x);
        return bits(good & lanes_where(cancelling)) | proven;
    }
};

}  // namespace holonomic::HOL_ISA::graph
