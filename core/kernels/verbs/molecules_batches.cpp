// Different trees in the lanes of a vector: constraint forces, multipliers for given right-hand sides, velocities,
// positions.
#include "core/kernels/memory/prefetch.hpp"
#include "core/kernels/molecules/flagged.hpp"
#include "core/kernels/molecules/tree_batch/large_tree.hpp"
#include "core/kernels/molecules/tree_batch/large_tree_positions.hpp"
#include "core/kernels/molecules/tree_batch/widen.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

using namespace graph;

int64_t batch_scratch_bytes(const TreeBatch &f) {
    int64_t extended = 0;
    for (int i = 0; i < f.n_trees; ++i)
        extended = f.elimination[i]->extended_bytes > extended ? f.elimination[i]->extended_bytes : extended;
    const int64_t linear = BatchLinear::values(f),
                  newton = moves_in_batch(f.elimination[0]->way.positions) ? BatchNewton::values(f) : 0;
    return (linear > newton ? linear : newton) * static_cast<int64_t>(sizeof(vec)) + LargeTree::bytes(f) +
           LargeTreeNewton::bytes(f) + 64 + extended + open_bytes(f);
}

// Calls work(batch of trees, lanes, memory) for all batches of trees of a unit.
template <class Work>
static inline void for_each_batch(const MoleculeUnit &unit, double *scratch, NextMolecules &ahead, const Work &work) {
    const MoleculeLane *next = unit.lanes;
    for (int64_t i = 0; i < unit.n_batches; ++i) {
        double *left = scratch;
        const TreeBatch f = open_batch(unit.tree_batches[i], left);
        MoleculeLane lane[W];
        for (int l = 0; l < W; ++l) lane[l] = next[l < f.n_trees ? l : 0];
        next += f.n_trees;
        if (unit.large && i + 1 < unit.n_batches) {
            ahead.begin(unit.tree_batches[i + 1].most_atoms);
            for (int l = 0; l < unit.tree_batches[i + 1].n_trees; ++l) ahead.add(next[l]);
        }
        ahead.fetch();
        work(f, lane, Memory<vec>{left});
        ahead.fetch_the_rest();
    }
}

template <class Call>
static inline void leave_flagged(const Call &call, const TreeBatch &f, const MoleculeLane *lane, unsigned good,
                                 double *scratch, Tally &tally) {
    for (int i = 0; i < f.n_trees; ++i)
        if (!(good >> i & 1)) solve_flagged(call, *f.elimination[i], lane, 1u << i, scratch, tally);
}

template <class Call>
static inline void write_batch(const BatchLinear &z, const BatchTrees::Range &range, const Call &call, unsigned good) {
    if (call.lambda) z.write_bonds<false>(range, 0.5, call.lambda, good);
    if (call.tension) z.write_bonds<true>(range, 1, call.tension, good);
    if (call.g.x) z.write_pulls(range, call.g, call.add, good);
}

// Batches of trees, or one large tree, of forces or for given right-hand sides.
template <class Call>
static inline void solve_batch(const Call &call, const MoleculeUnit &unit, const TreeBatch &f, const MoleculeLane *lane,
                               BatchLinear &z, Memory<vec> &memory, NextMolecules &ahead, Tally &tally) {
    unsigned good;
    if (f.n_pieces > 0) {
        const LargeTree tree(z, unit.team, memory);
        good = tree.solve() ? 1 : 0;
        if (good) tree.for_ranges([&](const BatchTrees::Range &range) { write_batch(z, range, call, all_lanes); });
        if (good && call.virial) tree.add_virial(tally);
    } else {
        z.load(z.all());
        ahead.fetch();
        good = z.solve();
        ahead.fetch();
        write_batch(z, z.all(), call, good);
        if (call.virial) z.add_virial(good, tally);
    }
    leave_flagged(call, f, lane, good, memory.next, tally);
}

void batches_forces(const ForcesCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    const bool packed =
        call.r.packed && (!call.v.x || call.v.packed) && (!call.f.x || call.f.packed) && (!call.g.x || call.g.packed);
    NextMolecules ahead({&call.r, &call.v, &call.f, &call.g}, call.lambda);
    for_each_batch(unit, scratch, ahead, [&](const TreeBatch &f, const MoleculeLane *lane, Memory<vec> memory) {
        BatchLinear z(f, lane, packed, call.box, call.r, {&call.v, &call.f, nullptr, false},
                      (call.v.x ? squares : 0) | (call.f.x ? pulls : 0), memory);
        solve_batch(call, unit, f, lane, z, memory, ahead, tally);
    });
}

void batches_solve(const SolveCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    const bool packed = call.r.packed && (!call.g.x || call.g.packed);
    NextMolecules ahead({&call.r, &call.g}, call.lambda);
    for_each_batch(unit, scratch, ahead, [&](const TreeBatch &f, const MoleculeLane *lane, Memory<vec> memory) {
        BatchLinear z(f, lane, packed, call.box, call.r, {nullptr, nullptr, call.rhs, false}, given, memory);
        solve_batch(call, unit, f, lane, z, memory, ahead, tally);
    });
}

// Twice, as molecules/velocities.hpp says.
void batches_velocities(const VelocitiesCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    NextMolecules ahead({&call.r, &call.v}, call.lambda);
    for_each_batch(unit, scratch, ahead, [&](const TreeBatch &f, const MoleculeLane *lane, Memory<vec> memory) {
        BatchLinear z(f, lane, call.r.packed && call.v.packed, call.box, call.r,
                      {&call.v, nullptr, nullptr, true, call.strain}, rates, memory);
        const bool twice = !call.v.is_float;
        unsigned good;
        if (f.n_pieces > 0) {
            const LargeTree tree(z, unit.team, memory);
            good = tree.solve() && !(twice && tree.any_overcorrected()) ? 1 : 0;
            const auto write = [&](const BatchTrees::Range &range) { z.write_velocities(range, call.v, all_lanes); };
            if (good) {
                if (call.lambda)
                    tree.for_ranges([&](const BatchTrees::Range &range) {
                        z.write_bonds<false>(range, 0.5, call.lambda, all_lanes);
                    });
                if (call.virial) tree.add_virial(tally);
                tree.project(twice);
                tree.for_ranges(write);
            }
        } else {
            z.load(z.all());
            good = z.solve();
            ahead.fetch();
            if (good) {
                if (call.lambda) z.write_bonds<false>(z.all(), 0.5, call.lambda, good);
                if (call.virial) z.add_virial(good, tally);
                z.add_pulls_to_velocities(z.all());
                if (twice) {
                    z.find_rates(z.all());
                    z.solve_again();
                    z.add_pulls_to_velocities(z.all());
                }
                z.write_velocities(z.all(), call.v, good);
            }
        }
        leave_flagged(call, f, lane, good, memory.next, tally);
    });
}

void batches_positions(const PositionsCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    const bool packed = call.r.packed && call.r_ref.packed && (!call.v.x || call.v.packed);
    NextMolecules ahead({&call.r_ref, &call.r, &call.v}, call.lambda);
    for_each_batch(unit, scratch, ahead, [&](const TreeBatch &f, const MoleculeLane *lane, Memory<vec> memory) {
        BatchNewton newton(f, lane, packed, memory);
        BatchPositions lanes = {{call, lane, tally}, newton, ahead};
        unsigned rest;
        if (f.n_pieces > 0) {
            const LargeTreeNewton one{newton, unit.team, reinterpret_cast<LargeTreeNewton::Found *>(memory.next)};
            memory.next += LargeTreeNewton::bytes(f) / static_cast<int64_t>(sizeof(double));
            LargeTreePositions tree = {{call, lane, tally}, one, lanes};
            rest = solve_positions(tree, Flag{true}, [] {});
        } else {
            rest = solve_positions(lanes, first_lanes(f.n_trees), [&] { ahead.fetch(); });
        }
        leave_flagged(call, f, lane, ~rest, memory.next, tally);
    });
}

}  // namespace holonomic::HOL_ISA
