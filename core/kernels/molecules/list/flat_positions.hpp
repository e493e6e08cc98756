// Position level of one large molecule: positions.hpp along a list.
#pragma once

#include "core/kernels/molecules/iterate.hpp"
#include "core/kernels/molecules/list/flat_newton.hpp"
#include "core/kernels/molecules/schedule.hpp"
#include "core/kernels/molecules/virial.hpp"
#include "core/kernels/tally.hpp"

namespace holonomic::HOL_ISA::graph {

struct FlatPositions {
    const PositionsCall &call;
    const Schedule &schedule;
    const MoleculeLane &lane;
    const Atoms<double> at;
    FlatNewton newton;
    Tally &tally;
    double a_min, a_max, largest_coordinate;

    FlatPositions(const PositionsCall &c, const Schedule &s, const MoleculeLane &l, bool packed, const LongTeam *team,
                  Memory<double> memory, Tally &sum)
        : call(c), schedule(s), lane(l), at(&l, 1, packed), newton(*s.flat, team, memory), tally(sum), a_min(), a_max(),
          largest_coordinate() {}

    // Reads all tiles, and makes the factors that a solve without a guess begins with.
    __attribute__((noinline)) void load() {
        const FlatList &s = newton.s;
        if (call.guess)
            share_out(newton.team, s.n_tiles, [&](int32_t i) { load(s.tile[i]); });
        else
            newton.make_factors([&](const Tile &tile) {
                load(tile);
                newton.assemble(tile, rows_from(newton.D, tile.first_row));
            });
        newton.opening = newton.largest_error();
        find_extent();
        for (int32_t k = 0; k < s.n_bonds && call.guess; ++k)
            newton.tau[k] = 2 * call.dt * call.dt * call.lambda[lane.first_bond + s.bond_of[k]];
    }
    void load(const Tile &tile) const {
        const FlatList &s = newton.s;
        const Rows r = newton.coordinates_of(tile);
        FlatFound &found = newton.found[&tile - s.tile];
        read_masses(lane.w, s, tile, newton.mass);
        read_atoms(call.r_ref, at, s, tile, r);
        find_bonds(s, tile, call.box_ref, r, newton.b);
        read_atoms(call.r, at, s, tile, r);
        find_bonds(s, tile, call.box, r, newton.D);
        found.coordinate = Row{};
        for (int32_t k = 0; k < tile.own_end - tile.first_site; ++k)
            found.coordinate = larger(absolute(r[k]), found.coordinate);
        load_lengths(tile, found);
        found.errors = newton.template measure_tile<true>(tile, rows_from(newton.D, tile.first_row));
    }
    void find_extent() {
        Row coordinate = {}, least = in_row(1e300), most = {};
        for (int32_t i = 0; i < newton.s.n_tiles; ++i) {
            const FlatFound &one = newton.found[i];
            coordinate = larger(one.coordinate, coordinate);
            least = smaller(one.least, least);
            most = larger(one.most, most);
        }
        largest_coordinate = largest_of(coordinate);
        a_min = smallest_of(least);
        a_max = largest_of(most);
    }
    void load_lengths(const Tile &tile, FlatFound &found) const {
        Row least = in_row(1e300), most = {};
        for (int64_t k = tile.first; k < tile.end; k += 4) {
            const int32_t *const bond = newton.s.bond_of + k;
            for (int i = rows_ahead; i < rows_ahead + 4 && k + i < tile.end; ++i)
                __builtin_prefetch(lane.length + bond[i], 0, 2);
            const Row a = {lane.length[bond[0]], lane.length[bond[1]], lane.length[bond[2]], lane.length[bond[3]]},
                      a2 = a * a;
            least = smaller(a, least);
            most = larger(a, most);
            newton.four(newton.a2, k) = a2;
            newton.four(newton.per_a2, k) = in_row(1) / a2;
            newton.four(newton.tau, k) = Row{};
        }
        found.least = least;
        found.most = most;
        for (int64_t k = tile.end; k < in_fours(tile.end); ++k) newton.a2[k] = newton.per_a2[k] = 0;  // inert
    }

    // Whether an atom's displacement is the difference of pulls so large that their rounding is more than the
    // coordinates'.
    bool coarse_moves() const {
        const FlatList &s = newton.s;
        double pull = 0;
        for (int32_t i = 0; i < s.n_tiles; ++i) {
            const Tile &tile = s.tile[i];
            const double *const mass = newton.mass + tile.first_mass;
            const int32_t *const from = s.from + (tile.first_row - tile.first), *const to = s.to + (from - s.from);
            for (int32_t k = tile.first; k < tile.end; ++k)
                pull = max(max(mass[from[k] / 2 + 1], mass[to[k] / 2 + 1]) * abs(newton.tau[k]), pull);
        }
        return 0.25 * (largest_coordinate + a_min) < pull * a_max;
    }

    void write_atoms() const {
        constexpr int32_t step = FlatList::columns_of_tile;
        const int32_t n = newton.s.n_atoms;
        share_out(newton.team, (n + step - 1) / step,
                  [&](int32_t i) { write_atoms(i * step, i * step + step < n ? i * step + step : n); });
    }
    __attribute__((noinline)) void write_atoms(int32_t first, int32_t end) const {
        const double per_dt = 1 / call.dt;
        for (int32_t i = first; i < end; ++i) {
            if (i + rows_ahead < end) __builtin_prefetch(&newton.moves[newton.s.place_of[i + rows_ahead]], 0, 2);
            if (schedule.fixed[i]) continue;
            const Row &move = newton.moves[newton.s.place_of[i]];
            write(call.r, at, i, vector_of(read_row_of(call.r, at, i) + move), 1);
            if (call.v.x)
                write(call.v, at, i, vector_of(multiply_add(in_row(per_dt), move, read_row_of(call.v, at, i))), 1);
        }
    }

    void write_multipliers() const {
        const double factor = 0.5 / (call.dt * call.dt);
        for (int32_t k = 0; k < newton.s.n_bonds; ++k)
            call.lambda[lane.first_bond + newton.s.bond_of[k]] = mul_add(newton.tau[k], factor, 0.0);
    }

    void add_virial() const {
        MoleculesVirial<double> virial;
        for (int32_t i = 0; i < newton.s.n_tiles; ++i) {
            const Tile &tile = newton.s.tile[i];
            for (int32_t k = tile.first; k < tile.end; ++k) {
                const Vector3<double> b = vector_of(newton.b[tile.first_row + (k - tile.first)]);
                virial.add(b, newton.tau[k] * b);
            }
        }
        virial.count(1, 1 / (call.dt * call.dt), tally);
    }

    // Whether it is done; if not, nothing has been written.
    bool solve() {
        load();
        const Limits<double> limits(call, largest_coordinate, a_min);
        const Solved<double> out = iterate<double, false, true>(newton, limits, call, Flag{true});
        const bool moved = out.converged.set && !coarse_moves();
        if (!moved && !out.untouched.set) return false;
        if (call.report)
            note_worst_of_one(
                newton, out.error, lane.molecule, [&](const auto &each) { each(0, newton.s.n_bonds); }, tally);
        if (call.lambda) write_multipliers();
        if (!moved) return true;
        newton.displace();
        if (call.virial) add_virial();
        write_atoms();
        count_moved(tally, 1, out.solves);
        return true;
    }
};

static inline bool solve_flat(const PositionsCall &call, const Schedule &s, const MoleculeLane &lane, bool packed,
                              const LongTeam *team, Memory<double> memory, Tally &tally) {
    return FlatPositions(call, s, lane, packed, team, memory, tally).solve();
}

}  // namespace holonomic::HOL_ISA::graph
