// The rates d.(v_j - v_i) that rounding leaves of velocities along a list, and another solve that takes them away.
#pragma once

#include "core/kernels/molecules/list/flat_linear.hpp"

namespace holonomic::HOL_ISA::graph {

// Of a tile; those of bonds between tiles are not known yet.
template <class V>
__attribute__((noinline)) void find_rates(const FlatLinear<V> &x, const Tile &tile) {
    for (int64_t k = tile.first; k < tile.end; k += x.step) x.some(x.rate, k) = x.sides_of(tile, k, rates);
}
template <class V>
HOL_INLINE void find_outer_rates(const FlatLinear<V> &x, const Tile &tile) {
    for (int32_t i = tile.first_outer; i < tile.end_outer; ++i) {
        const int32_t k = x.s.outer[i], row = tile.first_row + (k - tile.first);
        const auto at = [&](int32_t end) HOL_FORCED { return x.a[x.s.home[tile.first_site + end / 4]]; };
        const Vector3<V> e = vector_of(x.d[row] * (at(x.s.to[row]) - at(x.s.from[row])));
        x.rate[k] = (e.x + e.y) + e.z;
    }
}

// G, velocities and their rates once more, where multipliers have been changed since.
template <class V>
static inline void find_pulls_again(const FlatLinear<V> &all) {
    all.down([](const FlatLinear<V> &x, const Branch &branch) HOL_FORCED {
        for_tiles_down(x.s, branch, [&](const Tile &tile) HOL_FORCED {
            x.find_pulls(tile);
            if (!(x.terms & rates)) return;  // nobody asks for accelerations any more
            x.load_inputs(tile, x.a_of(tile));
            x.add_pulls(tile);
            if (x.with_rates) find_rates(x, tile);
        });
    });
}

// Moves the atoms of a tile: by its own bonds, which also find what pulls its guests, and by what later tiles have
// found. Pulls are added up first, so that velocities are rounded once.
template <class V>
__attribute__((noinline)) void move_atoms(const FlatLinear<V> &x, const Tile &tile) {
    const Rows<V> a = x.a_of(tile);
    const V *const w = x.mass + tile.first_mass;
    const int32_t n_own = tile.own_end - tile.first_site, n = tile.end_site - tile.first_site;
    sum_pulls(x.s, tile, x.rate, x.d_of(tile), x.v);
    for (int32_t i = n_own; i < n; ++i) a[i] = x.v[i];
    for (int32_t i = tile.first_visit; i < tile.end_visit; ++i) {
        const FlatList::Visit &visit = x.s.visit[i];
        x.v[visit.own - tile.first_site] = x.v[visit.own - tile.first_site] + x.a[visit.guest];
    }
    for (int32_t i = 0; i < n_own; ++i) a[i] = multiply_add(in_row(w[2 * i + 1]), x.v[i], a[i]);
}

// With the factors that there are.
template <class V>
static inline void take_rates(const FlatLinear<V> &all) {
    clear_sides(all.s, all.rate);
    all.up([](const FlatLinear<V> &x, const Branch &branch) HOL_FORCED {
        for_tiles_up(x.s, branch, [&](const Tile &tile) HOL_FORCED {
            find_outer_rates(x, tile);
            x.add_given(tile, x.rate);
            solve_up(x.s, tile, x.lower, x.rate);
        });
    });
    all.down([](const FlatLinear<V> &x, const Branch &branch) HOL_FORCED {
        for_tiles_down(x.s, branch, [&](const Tile &tile) HOL_FORCED {
            solve_down(x.s, tile, x.lower, x.per_pivot, x.rate, [](int32_t, const V &) HOL_FORCED {});
            move_atoms(x, tile);
        });
    });
}

}  // namespace holonomic::HOL_ISA::graph
