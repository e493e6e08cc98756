// Position level of molecules with cycles, and of large ones, by sparse LDL^T: one (V = double), or W in lanes.
// Reads bonds, runs iterate() on newton.hpp (theory (15)-(17), (58)), and writes once all lengths are right. It
// relies on ldl_plan.hpp for the order of elimination.
#pragma once

#include "core/kernels/molecules/atoms/vectors.hpp"
#include "core/kernels/molecules/iterate.hpp"
#include "core/kernels/molecules/sparse_ldl/newton.hpp"
#include "core/kernels/molecules/store.hpp"
#include "core/kernels/tally.hpp"

namespace holonomic::HOL_ISA::graph {

template <class V>
struct LdlPositions {
    typedef RowOf<V> Row;
    static constexpr int step = at_once<V>;
    const PositionsCall &call;
    const EliminationPlan &elimination;
    const MoleculeLane *const lane;
    const int used;
    const Atoms<V> at;
    const bool known;  // masses and lengths, and their extremes, are those of the molecules before, in the same memory
    LdlNewton<V> newton;
    Tally &tally;
    V a_min, a_max, largest_coordinate;

    LdlPositions(const PositionsCall &c, const EliminationPlan &s, const MoleculeLane *l, int in_use, bool packed,
                 bool masses_known, const LongTeam *team, Memory<V> &memory, Tally &sum)
        : call(c), elimination(s), lane(l), used(in_use), at(l, in_use, packed), known(masses_known),
          newton(*s.ldl, team, memory), tally(sum), a_min(), a_max(), largest_coordinate() {}

    // Reads all tiles, and makes the factors that a solve without a guess begins with.
    __attribute__((noinline)) void load() {
        if (call.guess)
            newton.up([&](const Tile &tile, const Rows<V> &r) HOL_FORCED {
                load(tile, r);
                load_guess(tile);
            });
        else
            newton.make_factors([&](const Tile &tile, const Rows<V> &r) HOL_FORCED {
                load(tile, r);
                newton.assemble(tile, newton.D.from(tile.first_row), r);
            });
        newton.opening = newton.largest_error();
        find_extent();
    }
    void load_guess(const Tile &tile) const {
        const double factor = 2 * call.dt * call.dt;
        for (int32_t k = tile.first; k < tile.end; ++k)
            for (int i = 0; i < Width<V>::lanes; ++i)
                Width<V>::set(newton.tau[k], i, factor * call.lambda[lane[i].first_bond + newton.s.bond_of[k]]);
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
    void find_extent() {
        Row coordinate = {};
        Columns<V> least = all_columns<V>(1e300), most = {};
        for (int32_t i = 0; i < newton.s.n_tiles; ++i) {
            const LdlFound<V> &one = newton.found[i];
            coordinate = larger(one.coordinate, coordinate);
            least = smaller(one.least, least);
            most = larger(one.most, most);
        }
        largest_coordinate = largest_component(coordinate);
        a_min = smallest_of<V>(least);
        a_max = largest_of<V>(most);
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

    // The lanes in which an atom's displacement is the difference of pulls so large that their rounding is more than
    // the coordinates'. The largest multiplier and inverse mass of a tile do for most.
    MaskOf<V> coarse_moves() const {
        const MaskOf<V> perhaps = coarse_where([&](const Tile &tile) HOL_FORCED {
            Columns<V> most = {};
            for (int64_t k = tile.first; k < tile.end; k += step)
                most = larger(absolute(newton.some(newton.tau, k)), most);
            return newton.found[&tile - newton.s.tile].w * largest_of<V>(most);
        });
        if (!any(perhaps)) return perhaps;
        return coarse_where([&](const Tile &tile) HOL_FORCED {
            const LdlPlan &s = newton.s;
            const V *const w = newton.w + tile.first_site;
            const int32_t *const from = s.from + (tile.first_row - tile.first), *const to = s.to + (from - s.from);
            V pull = {};
            for (int32_t k = tile.first; k < tile.end; ++k)
                pull = max(max(at_four_times(w, from[k]), at_four_times(w, to[k])) * abs(newton.tau[k]), pull);
            return pull;
        });
    }
    template <class Pull>
    MaskOf<V> coarse_where(const Pull &pull_in) const {
        const LdlPlan &s = newton.s;
        newton.up([&](const Tile &tile, const Rows<V> &)
                      HOL_FORCED { newton.found[&tile - s.tile].pull = pull_in(tile); });
        V pull = {};
        for (int32_t i = 0; i < s.n_tiles; ++i) pull = max(newton.found[i].pull, pull);
        return less(0.25 * (largest_coordinate + a_min), pull * a_max);
    }

    void write_atoms(unsigned which, unsigned right) const {
        for_atoms(newton.s, newton.team, [&](int32_t first, int32_t end) { write_atoms(which, right, first, end); });
    }
    __attribute__((noinline)) void write_atoms(unsigned which, unsigned right, int32_t first, int32_t end) const {
        bool any_fixed = false;
        for (int32_t i = first; i < end; ++i) any_fixed = any_fixed || elimination.fixed[i];
        const unsigned char *const fixed = any_fixed ? elimination.fixed + first : nullptr;
        move_vectors(call, at.from(first), newton.s.place_of + first, end - first, newton.moves.slots(),
                     Written<V>{which, fixed, nullptr, false, 0, right});
    }

    void write_multipliers(unsigned which) const {
        const V factor = Width<V>::all(0.5 / (call.dt * call.dt));
        newton.up([&](const Tile &tile, const Rows<V> &) HOL_FORCED {
            write_values<V>(newton.s.bond_of, lane, call.lambda, which, tile.first, tile.end,
                            [&](int32_t k) HOL_FORCED { return mul_add(newton.tau[k], factor, V{}); });
        });
    }

    void add_virial(unsigned which) const {
        share_out(newton.team, newton.s.n_tiles, tally, [&](int32_t i, Tally &part) HOL_FORCED {
            MoleculesVirial<V> virial;
            const Tile &tile = newton.s.tile[i];
            for (int32_t k = tile.first; k < tile.end; ++k) {
                const Vector3<V> b = vector_of(newton.b[tile.first_row + (k - tile.first)]);
                virial.add(b, newton.tau[k] * b);
            }
            virial.count(which, 1 / (call.dt * call.dt), part);
        });
    }

    // Returns the lanes that are flagged; nothing of them has been written.
    unsigned solve() {
        load();
        const MaskOf<V> in_use = Width<V>::first(used);
        Limits<V> limits(call, largest_coordinate, a_min);
        limits.far = call.worst_trial;
        const Solved<V> out = iterate<V, false, true>(newton, limits, call, in_use);
        MaskOf<V> far = out.converged & less(Width<V>::all(call.far_trial), newton.opening);
        if (any(far)) far = far & ~newton.turned_little(call.far_trial);  // bonds that forces have stretched
        MaskOf<V> converged = out.converged & ~coarse_moves();
        if (any(far)) converged = converged & (~far | newton.is_certified());
        const unsigned moved = bits(converged), good = moved | bits(out.untouched);
        const Tile *tile = newton.s.tile;
        if (call.report)
            note_worst_bond(
                newton.s, good, out.error, lane, [&](int32_t k) { return newton.error_of(*tile, k); },
                [&](const auto &each) {
                    for (int32_t i = 0; i < newton.s.n_tiles; ++i, ++tile)
                        if (any(~less(newton.found[i].errors.largest(), out.error))) each(tile->first, tile->end);
                },
                tally);
        if (call.lambda) write_multipliers(good);
        if (moved) {
            newton.displace();
            if (call.virial) add_virial(moved);
            write_atoms(moved, good & ~moved);
            count_moved(tally, __builtin_popcount(moved), out.solves);
        }
        return bits(in_use) & ~good;
    }
};

}  // namespace holonomic::HOL_ISA::graph
