// Position level of a batch of trees, a different one in each lane: a way of position_level.hpp. newton.hpp has the
// equations (theory (58)); the order of steps is that of core/plan/tree_batch.hpp.
#pragma once

#include "core/kernels/memory/prefetch.hpp"
#include "core/kernels/molecules/position_level.hpp"
#include "core/kernels/molecules/tree_batch/newton.hpp"

namespace holonomic::HOL_ISA::graph {

struct BatchPositions : PositionWay<vec> {
    typedef BatchTrees::Range Range;
    BatchNewton &newton;
    NextMolecules &ahead;

    Extent<vec> load() {
        Extent<vec> extent = {};
        choose([&](auto packed) { extent.coordinate = newton.template load_bonds<packed>(newton.all(), call); },
               newton.at.layout != elements);
        ahead.fetch();
        newton.load_lengths(newton.all(), extent.a_min, extent.a_max);
        if (call.guess) load_guess(newton.all());
        return extent;
    }
    __attribute__((noinline)) void load_guess(const Range &range) const {
        const double factor = tau_of_lambda();
        newton.for_held(range, all_lanes, [&](int32_t p, unsigned lanes) HOL_FORCED {
            for (int i = 0; i < W; ++i)
                if (lanes >> i & 1) newton.row[p].tau[i] = factor * call.lambda[newton.bond_of(i, p)];
        });
    }
    __attribute__((noinline)) vec largest_pull(bool) const {
        vec pull = {};
        for (int32_t s = 0; s < newton.f.n_steps; ++s)
            for (int32_t p = newton.f.step[s].first, end = p + newton.f.step[s].children; p < end; ++p)
                pull = max(max(newton.w[s], newton.lower_w[p]) * abs(newton.row[p].tau), pull);
        return pull;
    }
    // Of a tree the one with the smallest number among those.
    void note_worst(unsigned which, const vec &error) const {
        const int worst = worst_lane(which, error, lane, tally);
        if (worst >= 0) tally.worst_bond = worst_bond(1u << worst);
    }
    __attribute__((noinline)) int64_t worst_bond(unsigned which) const {
        int64_t bond = INT64_MAX;
        newton.for_held(newton.all(), which, [&](int32_t p, unsigned lanes) {
            const vec left = newton.left_of(p);
            for (int i = 0; i < W; ++i) {
                const int64_t its = newton.f.bond[static_cast<int64_t>(p) * W + i];
                if ((lanes >> i & 1) && its < bond && left[i] >= tally.worst) bond = its;
            }
        });
        return bond < INT64_MAX ? bond : 0;
    }
    void write_multipliers(unsigned which) const { write_multipliers(newton.all(), which); }
    __attribute__((noinline)) void write_multipliers(const Range &range, unsigned which) const {
        const vec factor = splat(lambda_of_tau());
        newton.for_held(range, which, [&](int32_t p, unsigned lanes) HOL_FORCED {
            newton.write_values(p, lanes, mul_add(newton.row[p].tau, factor, vec{}), call.lambda);
        });
    }
    void add_virial(unsigned which) const {
        const BatchRow *const row = newton.row;
        graph::add_virial<vec>(
            0, newton.f.n_bond_rows, [=](int32_t p) HOL_FORCED { return row[p].b; },
            [=](int32_t p) HOL_FORCED { return row[p].tau; }, per_dt2(), which, tally);
    }
    void write_moves(unsigned which, unsigned) const { write_moves(newton.all(), which); }
    // Moves the atoms that are not fixed, and their velocities.
    __attribute__((noinline)) void write_moves(const Range &range, unsigned which) const {
        const AtomArray &r = call.r, &v = call.v.x ? call.v : call.r;
        const bool with_v = call.v.x != nullptr;
        const vec per_dt = splat(1 / call.dt);
        newton.for_atoms(
            range, which, [&](int32_t p) HOL_FORCED { return bits(less_equal(newton.lower_w[p], vec{})); },
            [&](int32_t p, const auto &atom, unsigned lanes) HOL_FORCED {
                const vec3 move = newton.displacement(p);
                atom.write(r, add_times(atom.read(r), splat(1), move), lanes);
                if (with_v) atom.write(v, add_times(atom.read(v), per_dt, move), lanes);
            },
            r, v);
    }
};

}  // namespace holonomic::HOL_ISA::graph
