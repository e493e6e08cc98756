// Position level of one large tree, tile by tile (core/plan/tree_batch.hpp): a system of one number for iterate.hpp.
// What goes up is done behind what makes it, while the tile is in a cache; so it is done once too often when a solve
// was the last.
#pragma once

#include "core/kernels/molecules/share_out.hpp"
#include "core/kernels/molecules/tree_batch/positions.hpp"

namespace holonomic::HOL_ISA::graph {

HOL_INLINE double largest_of(const vec &a) {
    double most = a[0], sum = 0;
    for (int i = 0; i < W; ++i) {
        most = max(a[i], most);
        sum += a[i];
    }
    return mul_add(sum, 0.0, most);  // max() may lose a NaN, the sum keeps it
}

struct LargeTreeNewton {
    typedef BatchTrees::Range Range;
    // What has been found of a tile.
    struct FoundOfTile {
        double error, coordinate, least, most;
    };
    BatchNewton &x;
    const LongTeam *team;
    FoundOfTile *found;  // [n_tiles + 1]
    double opening = 0;  // the largest error of the bonds as they came
    bool eliminated = false, displaced = false, moved = false;

    static int64_t bytes(const TreeBatch &f) {
        return (f.n_tiles > 0 ? f.n_tiles + 1 : 0) * static_cast<int64_t>(sizeof(FoundOfTile));
    }
    int32_t top() const { return x.f.n_tiles; }
    Memory<vec> memory(int32_t p) const {
        Memory<vec> own = x.working;
        own.values(p * BatchNewton::joint_values(x.f));
        return own;
    }
    // begin(p) of the top, then of each tile with go_on(p) behind it, and of the top again go_on().
    template <class Begin, class GoOn>
    void up(const Begin &begin, const GoOn &go_on) const {
        begin(top());
        share_out(team, top(), [&](int32_t p) {
            begin(p);
            go_on(p);
        });
        go_on(top());
    }
    void load(const PositionsCall &call) {
        const auto begin = [&](int32_t p) {
            const Range range = x.tile(p);
            vec coordinate = {}, least, most;
            choose([&](auto packed) { coordinate = x.template load_bonds<packed>(range, call); },
                   x.at.layout != elements);
            x.load_lengths(range, least, most);
            const double error = largest_of(x.open(range));
            found[p] = {error, largest_of(coordinate), -largest_of(-least), largest_of(most)};
            if (!call.guess) x.begin_factors(range);
        };
        up(begin, [&](int32_t p) {
            if (!call.guess) factorize_and_substitute(p);
        });
        eliminated = !call.guess;
        opening = largest_error();
    }
    double largest_error() const {
        double most = 0, sum = 0;
        for (int32_t p = 0; p <= top(); ++p) {
            most = max(found[p].error, most);
            sum += found[p].error;
        }
        return mul_add(sum, 0.0, most);
    }

    double open() const { return opening; }
    void first_factors() {
        if (!eliminated) factorize({true});
    }
    void factorize(ScalarMask) {
        up(
            [&](int32_t p) {
                BatchNewton::Errors unused = {};
                const Range range = x.tile(p);
                for (int32_t k = range.row; k < range.end_row; ++k)
                    TreeNewton<vec>::measure<true>(x.row[k], x.new_D[k], unused);
                x.begin_factors(range);
            },
            [&](int32_t p) { factorize_and_substitute(p); });
        eliminated = true;
    }
    void factorize_and_substitute(int32_t p) const {
        x.make_factors(x.tile(p), memory(p));
        x.substitute(x.tile(p), memory(p));
    }

    void forget(ScalarMask which) {
        if (!which.set) return;
        for (int32_t p = 0; p < x.f.n_bond_rows; ++p) x.row[p].tau = vec{};
        displaced = false;
    }
    void solve(ScalarMask) {
        if (!eliminated) up([](int32_t) {}, [&](int32_t p) { x.substitute(x.tile(p), memory(p)); });
        eliminated = false;
        displace<true>();
    }
    template <bool corrected>
    void displace() {
        const mask every = first_lanes(W);
        x.go_down<corrected>(x.tile(top()), every);
        share_out(team, top(), [&](int32_t p) { x.go_down<corrected>(x.tile(p), every); });
        displaced = true;
    }
    // The first time new factors will mostly follow.
    double move() {
        if (!displaced) displace<false>();
        up([&](int32_t p) { found[p].error = largest_of(x.move_bonds(x.tile(p))); },
           [&](int32_t p) {
               if (moved) x.substitute(x.tile(p), memory(p));
           });
        eliminated = moved;
        moved = true;
        return largest_error();
    }
};

struct LargeTreePositions : PositionWay<double> {
    LargeTreeNewton newton;
    const BatchPositions &lanes;

    Extent<double> load() {
        newton.load(call);
        if (call.guess) lanes.load_guess(newton.x.all());
        Extent<double> extent = {0, newton.found[0].least, 0};
        for (int32_t p = 0; p <= newton.top(); ++p)
            extent = {max(newton.found[p].coordinate, extent.coordinate), min(newton.found[p].least, extent.a_min),
                      max(newton.found[p].most, extent.a_max)};
        return extent;
    }
    double largest_pull(bool exact) const { return largest_of(lanes.largest_pull(exact)); }
    void note_worst(unsigned which, double error) const {
        if (worst_lane(which, error, lane, tally) >= 0) tally.worst_bond = lanes.worst_bond(all_lanes);
    }
    void write_multipliers(unsigned) const {
        newton.up([](int32_t) {}, [&](int32_t p) { lanes.write_multipliers(newton.x.tile(p), all_lanes); });
    }
    // In the order of the indices, whatever lanes there are.
    void add_virial(unsigned which) const {
        const BatchNewton &x = newton.x;
        const auto element = [&](int32_t index) { return x.f.element[index]; };
        graph::add_virial<double>(
            0, x.f.elimination[0]->n_tree,
            [&](int32_t index) { return one_of(x.row[element(index) / W].b, element(index) % W); },
            [&](int32_t index) { return x.row[element(index) / W].tau[element(index) % W]; }, per_dt2(), which, tally);
    }
    void write_moves(unsigned, unsigned) {
        if (!newton.displaced) newton.displace<false>();
        newton.up([](int32_t) {}, [&](int32_t p) { lanes.write_moves(newton.x.tile(p), all_lanes); });
    }
};

}  // namespace holonomic::HOL_ISA::graph
