// The rates d.(v_j - v_i) that rounding leaves of velocities by sparse LDL^T, and another solve that takes them away.
#pragma once

#include "core/kernels/molecules/sparse_ldl/linear.hpp"

namespace holonomic::HOL_ISA::graph {

// Of a tile; those of bonds between tiles are not known yet.
template <class V>
__attribute__((noinline)) void find_rates(const LdlLinear<V> &x, const Tile &tile) {
    for (int64_t k = tile.first; k < tile.end; k += x.step) x.some(x.rate, k) = x.right_hand_sides_of(tile, k, rates);
}
template <class V>
HOL_INLINE void find_outer_rates(const LdlLinear<V> &x, const Tile &tile) {
    for (int32_t i = tile.first_outer; i < tile.end_outer; ++i) {
        const int32_t k = x.s.outer[i], row = tile.first_row + (k - tile.first);
        const auto at = [&](int32_t end) HOL_FORCED { return x.a[x.s.home[tile.first_site + end / 4]]; };
        const Vector3<V> e = vector_of(x.d[row] * (at(x.s.to[row]) - at(x.s.from[row])));
        x.rate[k] = (e.x + e.y) + e.z;
    }
}

// G, velocities and their rates once more, where multipliers have been changed since.
template <class V>
static inline void find_pulls_again(const LdlLinear<V> &all) {
    all.down([](const LdlLinear<V> &x, const Subtree &subtree) HOL_FORCED {
        for_tiles_down(x.s, subtree, [&](const Tile &tile) HOL_FORCED {
            if (!(x.terms & rates)) return x.find_pulls(tile);  // nobody asks for accelerations any more
            x.load_inputs(tile);
            x.find_pulls(tile);
            x.add_pulls(tile);
            if (x.with_rates) find_rates(x, tile);
        });
    });
}

// Moves the atoms of a tile: by its own bonds, which also find what pulls its ghosts, and by what later tiles have
// found. Pulls are added up first, so that velocities are rounded once. `to`: where those of one molecule go at once,
// or nullptr.
template <class V>
__attribute__((noinline)) void move_atoms(const LdlLinear<V> &x, const Tile &tile, const AtomArray *to) {
    const Rows<V> a = x.a_of(tile);
    const V *const w = x.w + tile.first_site;
    const int32_t n = tile.own_end - tile.first_site;
    sum_pulls(x.s, tile, x.rate, x.d_of(tile), x.v);
    x.keep_for_owners(tile, x.v);
    const auto moved = [&](int32_t i) HOL_FORCED { return multiply_add(in_row(w[i]), x.v[i], a[i]); };
    if constexpr (LdlLinear<V>::step == 4)
        if (to) return write_tile(*to, x.at, x.s, tile, moved);
    for (int32_t i = 0; i < n; ++i) a[i] = moved(i);
}

// With the factors that there are.
template <class V>
static inline void take_rates(const LdlLinear<V> &all, const AtomArray *to) {
    clear_contributions(all.s, all.rate);
    all.up([](const LdlLinear<V> &x, const Subtree &subtree) HOL_FORCED {
        for_tiles_up(x.s, subtree, [&](const Tile &tile) HOL_FORCED {
            find_outer_rates(x, tile);
            x.add_given(tile, x.rate);
            solve_up(x.s, tile, x.lower, x.rate);
        });
    });
    all.down([&](const LdlLinear<V> &x, const Subtree &subtree) HOL_FORCED {
        for_tiles_down(x.s, subtree, [&](const Tile &tile) HOL_FORCED {
            solve_down(x.s, tile, x.lower, x.per_pivot, x.rate, [](int32_t, const V &) HOL_FORCED {});
            move_atoms(x, tile, to);
        });
    });
}

}  // namespace holonomic::HOL_ISA::graph
