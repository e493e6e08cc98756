// L D L^T of molecules by sparse LDL^T in twice the precision, which is kept. What solves with it lose is so far below
// a rounding that no right-hand side needs a proof or a correction: all that there is to be proved is that pivots are
// large enough, once.
#pragma once

#include "core/kernels/molecules/sparse_ldl/factor.hpp"
#include "core/kernels/molecules/sparse_ldl/pairs.hpp"

namespace holonomic::HOL_ISA::graph {

// Numbers hi + lo in two arrays.
template <class V>
struct Pairs {
    V *hi, *lo;
    HOL_FORCED Pair<V> operator[](int64_t k) const { return {hi[k], lo[k]}; }
    HOL_FORCED void put(int64_t k, const Pair<V> &a) const {
        hi[k] = a.hi;
        lo[k] = a.lo;
    }
    HOL_FORCED void take(int64_t k, const Pair<V> &a) const { put(k, subtract_pairs((*this)[k], a)); }
    HOL_FORCED void add(int64_t k, const Pair<V> &a) const { put(k, add_pairs((*this)[k], a)); }
};
template <class V>
HOL_INLINE Pair<V> tidied(const Pair<V> &a) {
    return fast_two_sum<V>(a.hi, a.lo);
}

template <class V>
struct LdlKeptFactor {
    typedef RowOf<V> Row;
    static constexpr int step = at_once<V>;
    const LdlLinear<V> &x;  // its bonds, factor and pivots are the high words
    const LdlPlan &s;
    const Rows<V> bond_low;
    const Pairs<V> lower, pivot;

    LdlKeptFactor(const LdlLinear<V> &linear, const Rows<V> &low_bonds, V *low_lower, V *low_pivot)
        : x(linear), s(linear.s),
          bond_low(low_bonds), lower{linear.lower, low_lower}, pivot{linear.per_pivot, low_pivot} {}

    // Lanes in which pivots are large enough: x.firm; and those whose solves in plain arithmetic may be proved: x.left.
    static void make(const LdlLinear<V> &all, const Rows<V> &low_bonds, V *low_lower, V *low_pivot) {
        read_masses(all.lane, all.s, all.w);
        clear_entries(all.s, all.lower);
        clear_entries(all.s, low_lower);
        clear_contributions(all.s, all.per_pivot);
        clear_contributions(all.s, low_pivot);
        all.up([&](const LdlLinear<V> &in_thread, const Subtree &subtree) HOL_FORCED {
            const LdlKeptFactor own(in_thread, low_bonds, low_lower, low_pivot);
            unsigned proven = bits(in_thread.in_use()), firm = proven;
            for_tiles_up(all.s, subtree, [&](const Tile &tile) HOL_FORCED {
                own.load(tile);
                own.assemble(tile);
                own.eliminate(tile);
                proven &= pivots_above(in_thread, tile, least_proven_pivot);
                firm &= pivots_above(in_thread, tile, least_pivot);
            });
            all.left[&subtree - all.s.subtree] = proven;
            all.firm[&subtree - all.s.subtree] = firm;
        });
    }

private:
    HOL_FORCED Pair<Row> bond_at(int64_t row) const { return {x.d[row], bond_low[row]}; }

    // Bonds, their sizes and the diagonal of A.
    __attribute__((noinline)) void load(const Tile &tile) const {
        read_atoms(x.coordinates, x.at, s, tile, x.r);
        for (int64_t row = tile.first_row; row < tile.end_row; ++row) {
            const Row &from = x.r.at_four_times(s.from[row]), &to = x.r.at_four_times(s.to[row]);
            Pair<Row> bond = two_difference<Row>(to, from);
            if (x.box.lattice != Box::none) {
                Vector3<V> d = {}, low = {};
                unrounded_bond(x.box, vector_of(from), vector_of(to), d, low);
                bond = {row_of(d), row_of(low)};
            }
            x.d[row] = bond.hi;
            bond_low[row] = bond.lo;
        }
        const V *const of_site = x.w + tile.first_site;
        int64_t row = tile.first_row;
        for (int64_t k = tile.first; k < tile.end; k += step, row += step) {
            Pair<Row> q[step];
            HOL_UNROLL_FEW
            for (int i = 0; i < step; ++i) q[i] = product_of(bond_at(row + i), bond_at(row + i));
            const Pair<Columns<V>> square = sums_of_pairs<V>(q),
                                   of_ends = two_sum<Columns<V>>(masses_at<V>(of_site, s.from + row),
                                                                 masses_at<V>(of_site, s.to + row)),
                                   a = columns_product<V>(of_ends, square);
            x.some(x.diagonal, k - tile.first) = x.some(pivot.hi, k) = a.hi;
            x.some(pivot.lo, k) = a.lo;
            x.some(x.size, k) = root_of(square.hi);
        }
    }
    // The entries of A off its diagonal.
    __attribute__((noinline)) void assemble(const Tile &tile) const {
        const Rows<V> bond = x.d_of(tile), low = bond_low.from(tile.first_row);
        sign_masses(tile, x.w, x.masses);
        for (int64_t e = tile.first_entry; e < tile.end_entry; e += step) {
            Pair<Row> p[step];
            HOL_UNROLL_FEW
            for (int i = 0; i < step; ++i) {
                const int32_t row = s.row_4[e + i], column = s.column_4[e + i];
                p[i] = product_of(Pair<Row>{bond.at_four_times(row), low.at_four_times(row)},
                                  Pair<Row>{bond.at_four_times(column), low.at_four_times(column)});
            }
            const Pair<Columns<V>> mass = {gathered(x.masses, s.mass + e), Columns<V>{}},
                                   a = columns_product<V>(mass, sums_of_pairs<V>(p));
            x.some(lower.hi, e) = a.hi;
            x.some(lower.lo, e) = a.lo;
        }
    }
    // As eliminate() of factor.hpp.
    __attribute__((noinline)) void eliminate(const Tile &tile) const {
        const LdlKeptFactor y = *this;
        for (int32_t i = tile.first_late; i < tile.end_late; ++i)
            y.pivot.add(s.late[i].number, y.pivot[s.late[i].contribution]);
        for (int32_t i = tile.first_late_entry; i < tile.end_late_entry; ++i)
            y.lower.add(s.late_entry[i].number, y.lower[s.late_entry[i].contribution]);
        const int32_t *update = s.update + tile.first_update;
        for_columns_up(s, tile, [&](int32_t k, int32_t first, int32_t n) HOL_FORCED {
            const int32_t *const row = y.s.row + first;
            const Pair<V> inverse = inverse_of(tidied(y.pivot[k]));
            y.pivot.put(k, inverse);
            for (int32_t i = 0; i < n; ++i) {
                const Pair<V> l = tidied(y.lower[first + i]), part = tidied(multiply_pairs(l, inverse));
                for (int32_t j = 0; j < i; ++j, ++update)  // l of j is multiplied already
                    y.lower.take(*update, multiply_pairs(l, y.lower[first + j]));
                y.pivot.take(row[i], multiply_pairs(l, part));
                y.lower.put(first + i, part);
            }
        });
    }
    HOL_FORCED static Pair<V> inverse_of(const Pair<V> &a) {
        const V one = Width<V>::all(1), r = one / a.hi;
        const Pair<V> p = two_product<V>(a.hi, r);
        return {r, r * (((one - p.hi) - p.lo) - a.lo * r)};
    }
};

}  // namespace holonomic::HOL_ISA::graph
