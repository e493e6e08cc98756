// The linear levels of molecules by sparse LDL^T: one (V = double), or W of one shape in lanes.
#pragma once

#include "core/kernels/molecules/linear_level.hpp"
#include "core/kernels/molecules/solve.hpp"
#include "core/kernels/molecules/sparse_ldl/rates.hpp"

namespace holonomic::HOL_ISA::graph {

// W molecules or one of a shape, and what of theirs the memory has already.
template <class V>
struct LdlBlock {
    const EliminationPlan &elimination;
    const MoleculeLane *lane;
    int used;
    bool packed, masses_known;
    const LongTeam *team;
    Memory<V> &memory;
    LdlLinear<V> linear(const Box &box, const AtomArray &r, const Inputs &in, int terms) const {
        return LdlLinear<V>(*elimination.ldl, lane, used, packed, masses_known, team, box, r, in, terms, memory);
    }
};

// The way of linear_level.hpp.
template <class V>
struct LdlWay {
    const LdlLinear<V> &x;

    unsigned in_use() const { return bits(x.in_use()); }
    unsigned solve() const { return solve_and_refine(x); }
    template <bool with_length>
    void write_bonds(double factor, double *out, unsigned which) const {
        x.up([&](const LdlLinear<V> &, const Subtree &subtree) HOL_FORCED {
            for_tiles_up(x.s, subtree, [&](const Tile &tile) HOL_FORCED {
                write_values<V>(x.s.bond_of, x.lane, out, which, tile.first, tile.end, [&](int32_t k) HOL_FORCED {
                    return mul_add(x.t[k], with_length ? x.size[k] : Width<V>::all(factor), V{});
                });
            });
        });
    }
    void write_pulls(const AtomArray &g, bool add, unsigned which) const { write_atoms(g, x.pull, add, which); }
    void write_atoms(const AtomArray &to, const Rows<V> &from, bool add, unsigned which) const {
        for_atoms(x.s, x.team, [&](int32_t first, int32_t end) HOL_FORCED {
            write_vectors(to, x.at.from(first), x.s.site_of + first, end - first, from.by_index(),
                          Written<V>{which, nullptr, x.lane, add, first});
        });
    }
    void write(const LinearOutputs &out, unsigned which, Tally &tally) const {
        if (out.virial)
            share_out(x.team, x.s.n_tiles, tally, [&](int32_t i, Tally &part) HOL_FORCED {
                const Tile &tile = x.s.tile[i];
                const Rows<V> d = x.d.from(tile.first_row - tile.first);
                add_virial<V>(
                    tile.first, tile.end, [&](int32_t k) HOL_FORCED { return vector_of(d[k]); },
                    [&](int32_t k) HOL_FORCED { return x.t[k]; }, 1, which, part);
            });
        write_bonds_and_pulls(*this, out, which);
    }
    void project(const LinearOutputs &out, bool twice, unsigned which, Tally &tally) const {
        write_all_but_atoms(*this, out, which, tally);
        // Nothing reads v any more, so that tiles of one molecule write it as they come.
        const bool tile_by_tile = LdlLinear<V>::step == 4 && twice && !x.lane[0].shared;
        if (twice) take_rates(x, tile_by_tile ? out.g : nullptr);
        if (!tile_by_tile) write_atoms(*out.g, x.a, false, which);
    }
};

// With kept factors. `good`: the lanes that are solved.
template <class V, class Call>
static inline unsigned write_by_ldl(const Call &call, const LdlLinear<V> &x, unsigned good, Tally &tally) {
    const LdlWay<V> way = {x};
    return write_solution(call, way, good, tally);
}

}  // namespace holonomic::HOL_ISA::graph
