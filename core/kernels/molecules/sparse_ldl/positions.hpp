// Position level of molecules with cycles, and of large ones, by sparse LDL^T: one (V = double), or W in lanes.
// A way of position_level.hpp, with the equations of newton.hpp (theory (58)). It relies on core/plan/sparse_ldl.hpp
// for the order of elimination.
#pragma once

#include "core/kernels/molecules/atoms/vectors.hpp"
#include "core/kernels/molecules/position_level.hpp"
#include "core/kernels/molecules/sparse_ldl/newton.hpp"

namespace holonomic::HOL_ISA::graph {

template <class V>
struct LdlPositions : PositionWay<V> {
    typedef RowOf<V> Row;
    typedef PositionWay<V> Base;
    using Base::call, Base::lane;
    static constexpr int step = at_once<V>;
    const EliminationPlan &elimination;
    const Atoms<V> at;
    const bool known;  // masses and lengths, and their extremes, are those of the molecules before, in the same memory
    LdlNewton<V> newton;

    LdlPositions(const PositionsCall &c, const EliminationPlan &s, const MoleculeLane *l, int in_use, bool packed,
                 bool masses_known, const LongTeam *team, Memory<V> &memory, Tally &sum)
        : Base{c, l, sum}, elimination(s), at(l, in_use, packed), known(masses_known), newton(*s.ldl, team, memory) {}

    // Reads all tiles, and makes the factors that a solve without a guess begins with.
    __attribute__((noinline)) Extent<V> load() {
        if (call.guess)
            newton.up([&](const Tile &tile, const Rows<V> &r) HOL_FORCED {
                load(tile, r);
                this->load_guess(newton.s.bond_of, tile.first, tile.end, multipliers());
            });
        else
            newton.make_factors([&](const Tile &tile, const Rows<V> &r) HOL_FORCED {
                load(tile, r);
                newton.assemble(tile, newton.D.from(tile.first_row), r);
            });
        newton.opening = newton.largest_error();
        return find_extent();
    }
    HOL_FORCED auto multipliers() const {
        return [tau = newton.tau](int32_t k) HOL_FORCED -> V & { return tau[k]; };
    }
    __attribute__((noinline)) void load(const Tile &tile, const Rows<V> &r) const {
        const LdlPlan &s = newton.s;
        LdlFound<V> &found = newton.found[&tile - s.tile];
        const Rows<V> ref = newton.moves.from(tile.first_site);
        found.coordinate = Row{};
        if constexpr (step == 4) {
            Row largest = {};
            double lightest = 0;
            const double *const w = newton.w + tile.first_site;
            choose(
                [&](auto packed) HOL_FORCED {
                    for_sites<packed, true, false>(
                        at, s, tile, *lane, newton.w + tile.first_site, call.r_ref, call.r, call.r,
                        [&](int32_t i, const Row &before, const Row &now, const Row &) HOL_FORCED {
                            ref[i] = before;
                            r[i] = now;
                            largest = larger(absolute(now), largest);
                            lightest = max(w[i], lightest);
                        });
                },
                at.layout != elements);
            found.coordinate = largest;
            found.w = lightest;
        } else {
            if (!known) {
                read_masses(lane, s, newton.w);
                found.w = V{};
                for (int32_t k = 0; k < s.n_sites; ++k) found.w = max(newton.w[k], found.w);
            }
            read_atoms(call.r_ref, at, s, tile, ref);
            read_atoms(call.r, at, s, tile, r);
            for (int32_t k = 0; k < s.n_sites; ++k) found.coordinate = larger(absolute(r[k]), found.coordinate);
        }
        find_bonds(s, tile, call.box_ref, ref, newton.b);
        find_bonds(s, tile, call.box, r, newton.D);
        if (!known) load_lengths(tile, found);
        for (int64_t k = tile.first; k < tile.end; k += step) newton.some(newton.tau, k) = Columns<V>{};  // inert, too
        found.errors = newton.template measure_tile<true>(tile, newton.D.from(tile.first_row));
    }
    Extent<V> find_extent() const {
        Row coordinate = {};
        Columns<V> least = all_columns<V>(1e300), most = {};
        for (int32_t i = 0; i < newton.s.n_tiles; ++i) {
            const LdlFound<V> &one = newton.found[i];
            coordinate = larger(one.coordinate, coordinate);
            least = smaller(one.least, least);
            most = larger(one.most, most);
        }
        return {largest_component(coordinate), smallest_of<V>(least), largest_of<V>(most)};
    }
    void load_lengths(const Tile &tile, LdlFound<V> &found) const {
        Columns<V> least = all_columns<V>(1e300), most = {};
        const int32_t *const bond = newton.s.bond_of;
        for (int64_t k = tile.first; k < tile.end; k += step) {
            if (is_from_memory(newton.s))
                for (int64_t i = k + rows_ahead; i < k + rows_ahead + step && i < tile.end; ++i)
                    __builtin_prefetch(lane[0].length + bond[i], 0, 2);
            Columns<V> a = {};
            for (int i = 0; i < step; ++i) {
                V one = {};
                for (int l = 0; l < Width<V>::lanes; ++l) Width<V>::set(one, l, lane[l].length[bond[k + i]]);
                put<V>(a, i, one);
            }
            least = smaller(a, least);
            most = larger(a, most);
            const Columns<V> a2 = a * a;
            newton.some(newton.a2, k) = a2;
            newton.some(newton.per_a2, k) = all_columns<V>(1) / a2;
        }
        found.least = least;
        found.most = most;
        for (int64_t k = tile.end; k < in_fours(tile.end); ++k) newton.a2[k] = newton.per_a2[k] = V{};  // inert
    }

    // The largest multiplier and inverse mass of a tile do for most.
    __attribute__((noinline)) V largest_pull(bool exact) const {
        newton.up([&](const Tile &tile, const Rows<V> &)
                      HOL_FORCED { newton.found[&tile - newton.s.tile].pull = exact ? pull_in(tile) : most_in(tile); });
        V pull = {};
        for (int32_t i = 0; i < newton.s.n_tiles; ++i) pull = max(newton.found[i].pull, pull);
        return pull;
    }
    V most_in(const Tile &tile) const {
        Columns<V> most = {};
        for (int64_t k = tile.first; k < tile.end; k += step) most = larger(absolute(newton.some(newton.tau, k)), most);
        return newton.found[&tile - newton.s.tile].w * largest_of<V>(most);
    }
    V pull_in(const Tile &tile) const {
        const LdlPlan &s = newton.s;
        const V *const w = newton.w + tile.first_site;
        const int32_t *const from = s.from + (tile.first_row - tile.first), *const to = s.to + (from - s.from);
        V pull = {};
        for (int32_t k = tile.first; k < tile.end; ++k)
            pull = max(max(at_four_times(w, from[k]), at_four_times(w, to[k])) * abs(newton.tau[k]), pull);
        return pull;
    }

    // A long step is tried, and its result tested, unless forces have stretched the bonds.
    double far() const { return call.worst_trial; }
    MaskOf<V> rejected(MaskOf<V> converged) {
        MaskOf<V> far = converged & less(Width<V>::all(call.far_trial), newton.opening);
        if (any(far)) far = far & ~newton.turned_little(call.far_trial);
        return any(far) ? far & ~newton.is_certified() : far;
    }

    void note_worst(unsigned which, const V &error) const {
        const Tile *tile = newton.s.tile;
        note_worst_bond(
            newton.s, which, error, lane, [&](int32_t k) { return newton.error_of(*tile, k); },
            [&](const auto &each) {
                for (int32_t i = 0; i < newton.s.n_tiles; ++i, ++tile)
                    if (any(~less(newton.found[i].errors.largest(), error))) each(tile->first, tile->end);
            },
            this->tally);
    }
    void write_moves(unsigned which, unsigned right) {
        newton.displace();
        for_atoms(newton.s, newton.team, [&](int32_t first, int32_t end) { write_atoms(which, right, first, end); });
    }
    __attribute__((noinline)) void write_atoms(unsigned which, unsigned right, int32_t first, int32_t end) const {
        bool any_fixed = false;
        for (int32_t i = first; i < end; ++i) any_fixed = any_fixed || elimination.fixed[i];
        const unsigned char *const fixed = any_fixed ? elimination.fixed + first : nullptr;
        move_vectors(call, at.from(first), newton.s.site_of + first, end - first, newton.moves.by_index(),
                     Written<V>{which, fixed, nullptr, false, 0, right});
    }

    void write_multipliers(unsigned which) const {
        newton.up([&](const Tile &tile, const Rows<V> &)
                      HOL_FORCED { this->write_lambda(newton.s.bond_of, tile.first, tile.end, which, multipliers()); });
    }
    void add_virial(unsigned which) const {
        share_out(newton.team, newton.s.n_tiles, this->tally, [&](int32_t i, Tally &part) HOL_FORCED {
            const Tile &tile = newton.s.tile[i];
            const Rows<V> b = newton.b.from(tile.first_row - tile.first);
            graph::add_virial<V>(
                tile.first, tile.end, [&](int32_t k) HOL_FORCED { return vector_of(b[k]); }, multipliers(),
                this->per_dt2(), which, part);
        });
    }
};

}  // namespace holonomic::HOL_ISA::graph
