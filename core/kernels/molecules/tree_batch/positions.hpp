// Position level of a batch of trees, a different one in each lane: what ../positions.hpp does with a block of
// molecules of one shape. newton.hpp has the equations (theory (15)-(17), (58)); the order of steps is that of
// batch.hpp.
#pragma once

#include "core/kernels/molecules/iterate.hpp"
#include "core/kernels/molecules/tree_batch/newton.hpp"
#include "core/kernels/molecules/virial.hpp"
#include "core/kernels/tally.hpp"

namespace holonomic::HOL_ISA::graph {

struct BatchPositions {
    const PositionsCall &call;
    BatchNewton &x;
    Tally &tally;

    typedef BatchTrees::Range Range;

    __attribute__((noinline)) void load_guess(const Range &range) const {
        const double factor = 2 * call.dt * call.dt;
        x.for_held(range, all_lanes, [&](int32_t p, unsigned lanes) HOL_FORCED {
            for (int i = 0; i < W; ++i)
                if (lanes >> i & 1) x.row[p].tau[i] = factor * call.lambda[x.bond_of(i, p)];
        });
    }
    // As PositionsBlock::coarse_moves().
    mask coarse_moves(const vec &extent, const vec &a_max) const {
        return less(0.25 * extent, largest_pull(x.all()) * a_max);
    }
    __attribute__((noinline)) vec largest_pull(const Range &range) const {
        vec pull = {};
        for (int32_t s = range.step; s < range.end_step; ++s)
            for (int32_t p = x.f.step[s].first, end = p + x.f.step[s].children; p < end; ++p)
                pull = max(max(x.w[s], x.lower_w[p]) * abs(x.row[p].tau), pull);
        return pull;
    }
    __attribute__((noinline)) void write_multipliers(const Range &range, unsigned which) const {
        const double factor = 0.5 / (call.dt * call.dt);
        x.for_held(range, which, [&](int32_t p, unsigned lanes) HOL_FORCED {
            x.write_values(p, lanes, mul_add(x.row[p].tau, splat(factor), vec{}), call.lambda);
        });
    }
    void add_virial(unsigned which) const {
        MoleculesVirial<vec> virial;
        for (int32_t p = 0; p < x.f.n_places; ++p) virial.add(x.row[p].b, x.row[p].tau * x.row[p].b);
        virial.count(which, 1 / (call.dt * call.dt), tally);
    }
    // Moves the atoms that are not fixed, and their velocities.
    __attribute__((noinline)) void write_moves(const Range &range, unsigned which) const {
        const AtomArray &r = call.r, &v = call.v.x ? call.v : call.r;
        const bool with_v = call.v.x != nullptr;
        const vec per_dt = splat(1 / call.dt);
        x.for_atoms(
            range, which, [&](int32_t p) HOL_FORCED { return bits(less_equal(x.lower_w[p], vec{})); },
            [&](int32_t p, const auto &atom, unsigned lanes) HOL_FORCED {
                const vec3 move = x.displacement(p);
                atom.write(r, add_times(atom.read(r), splat(1), move), lanes);
                if (with_v) atom.write(v, add_times(atom.read(v), per_dt, move), lanes);
            },
            r, v);
    }
    // The worst bond of the trees in `which`: of a tree the one with the smallest number among those.
    void note_worst(unsigned which, const vec &error) const {
        const int worst = worst_lane(which, error, x.lane, tally);
        if (worst >= 0) tally.worst_bond = worst_bond(1u << worst);
    }
    __attribute__((noinline)) int64_t worst_bond(unsigned which) const {
        int64_t bond = INT64_MAX;
        x.for_held(x.all(), which, [&](int32_t p, unsigned lanes) {
            const vec left = x.left_of(p);
            for (int i = 0; i < W; ++i) {
                const int64_t its = x.f.bond[static_cast<int64_t>(p) * W + i];
                if ((lanes >> i & 1) && its < bond && left[i] >= tally.worst) bond = its;
            }
        });
        return bond < INT64_MAX ? bond : 0;
    }

    // Returns the lanes that need no extended arithmetic; nothing of the others has been written. between() is called
    // between the stages.
    template <class Between>
    unsigned solve(const Between &between) const {
        vec largest = {}, a_min, a_max;
        choose([&](auto packed) { largest = x.template load_bonds<packed>(x.all(), call); }, x.at.layout != elements);
        between();
        x.load_lengths(x.all(), a_min, a_max);
        if (call.guess) load_guess(x.all());
        const Limits<vec> limits(call, largest, a_min);
        const Solved<vec> out = iterate<vec, false, true>(x, limits, call, first_lanes(x.f.n_trees));
        between();
        const unsigned moved = bits(out.converged & ~coarse_moves(largest + a_min, a_max)),
                       good = moved | bits(out.untouched);
        if (call.report) note_worst(good, out.error);
        if (call.lambda) write_multipliers(x.all(), good);
        if (call.virial) add_virial(moved);
        if (moved) write_moves(x.all(), moved);
        if (moved) count_moved(tally, __builtin_popcount(moved), out.solves);
        return good;
    }
};

}  // namespace holonomic::HOL_ISA::graph
