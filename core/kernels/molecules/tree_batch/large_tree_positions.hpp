// Position level of one large tree, piece by piece (batch.hpp): a system of one number for iterate.hpp. What goes up
// is done behind what makes it, while the piece is in a cache; so it is done once too often when a solve was the last.
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
    // What has been found of a piece.
    struct Found {
        double error, coordinate, least, most;
    };
    BatchNewton &x;
    const LongTeam *team;
    Found *found;        // [n_pieces + 1]
    double opening = 0;  // the largest error of the bonds as they came
    bool eliminated = false, displaced = false, moved = false;

    static int64_t bytes(const TreeBatch &f) {
        return (f.n_pieces > 0 ? f.n_pieces + 1 : 0) * static_cast<int64_t>(sizeof(Found));
    }
    int32_t top() const { return x.f.n_pieces; }
    Memory<vec> memory(int32_t p) const {
        Memory<vec> own = x.working;
        own.values(p * BatchNewton::joint_values(x.f));
        return own;
    }
    // begin(p) of the top, then of each piece with go_on(p) behind it, and of the top again go_on().
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
            const Range range = x.piece(p);
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
    void factorize(Flag) {
        up(
            [&](int32_t p) {
                BatchNewton::Errors unused = {};
                const Range range = x.piece(p);
                for (int32_t k = range.place; k < range.end_place; ++k)
                    Newton<vec>::measure<true>(x.row[k], x.new_D[k], unused);
                x.begin_factors(range);
            },
            [&](int32_t p) { factorize_and_substitute(p); });
        eliminated = true;
    }
    void factorize_and_substitute(int32_t p) const {
        x.make_factors(x.piece(p), memory(p));
        x.substitute(x.piece(p), memory(p));
    }

    void forget(Flag which) {
        if (!which.set) return;
        for (int32_t p = 0; p < x.f.n_places; ++p) x.row[p].tau = vec{};
        displaced = false;
    }
    void solve(Flag) {
        if (!eliminated) up([](int32_t) {}, [&](int32_t p) { x.substitute(x.piece(p), memory(p)); });
        eliminated = false;
        displace<true>();
    }
    template <bool corrected>
    void displace() {
        const mask every = first_lanes(W);
        x.go_down<corrected>(x.piece(top()), every);
        share_out(team, top(), [&](int32_t p) { x.go_down<corrected>(x.piece(p), every); });
        displaced = true;
    }
    // The first time new factors will mostly follow.
    double move() {
        if (!displaced) displace<false>();
        up([&](int32_t p) { found[p].error = largest_of(x.move_bonds(x.piece(p))); },
           [&](int32_t p) {
               if (moved) x.substitute(x.piece(p), memory(p));
           });
        eliminated = moved;
        moved = true;
        return largest_error();
    }
};

struct LargeTreePositions {
    typedef BatchTrees::Range Range;
    LargeTreeNewton &newton;
    const BatchPositions &lanes;
    Tally &tally;

    // Returns whether it is done; if not, nothing has been written.
    bool solve(int64_t molecule) const {
        const PositionsCall &call = lanes.call;
        BatchNewton &x = newton.x;
        newton.load(call);
        if (call.guess) lanes.load_guess(x.all());
        double largest = 0, a_min = newton.found[0].least, a_max = 0;
        for (int32_t p = 0; p <= newton.top(); ++p) {
            largest = max(newton.found[p].coordinate, largest);
            a_min = min(newton.found[p].least, a_min);
            a_max = max(newton.found[p].most, a_max);
        }
        const Limits<double> limits(call, largest, a_min);
        const Solved<double> out = iterate<double, false, true>(newton, limits, call, Flag{true});
        const bool moved =
            out.converged.set && !(0.25 * (largest + a_min) < largest_of(lanes.largest_pull(x.all())) * a_max);
        if (!moved && !out.untouched.set) return false;
        if (call.report && take_worst(tally, out.error, molecule)) tally.worst_bond = lanes.worst_bond(all_lanes);
        if (moved && !newton.displaced) newton.displace<false>();
        newton.up([](int32_t) {}, [&](int32_t p) { write(x.piece(p), moved); });
        if (!moved) return true;
        if (call.virial) add_virial();
        count_moved(tally, 1, out.solves);
        return true;
    }
    void write(const Range &range, bool moved) const {
        const PositionsCall &call = lanes.call;
        if (call.lambda) lanes.write_multipliers(range, all_lanes);
        if (moved) lanes.write_moves(range, all_lanes);
    }
    // In the order of the slots, whatever lanes there are.
    void add_virial() const {
        const BatchNewton &x = newton.x;
        MoleculesVirial<double> virial;
        for (int32_t slot = 0; slot < x.f.elimination[0]->n_tree; ++slot) {
            const BatchRow &row = x.row[x.f.element[slot] / W];
            const int i = x.f.element[slot] % W;
            const Vector3<double> b = {row.b.x[i], row.b.y[i], row.b.z[i]};
            virial.add(b, row.tau[i] * b);
        }
        virial.count(1, 1 / (lanes.call.dt * lanes.call.dt), tally);
    }
};

}  // namespace holonomic::HOL_ISA::graph
