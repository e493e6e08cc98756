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
static inline void leave_flagged(const Call &call, const TreeBatch &f, const MoleculeLane *lane, unsigned rest,
                                 double *scratch, Tally &tally) {
    for (int i = 0; i < f.n_trees; ++i)
        if (rest >> i & 1) solve_flagged(call, *f.elimination[i], lane, 1u << i, scratch, tally);
}

// Batches of trees, or one large tree, at a linear level.
template <class Call>
static inline void solve_batches(const Call &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    const bool packed = are_packed(call);
    const RightHandSides rhs = right_hand_sides_of(call);
    NextMolecules ahead = next_of(call);
    for_each_batch(unit, scratch, ahead, [&](const TreeBatch &f, const MoleculeLane *lane, Memory<vec> memory) {
        BatchLinear z(f, lane, packed, call.box, call.r, rhs.in, rhs.terms, memory);
        unsigned rest;
        if (f.n_tiles > 0) {
            const LargeTree tree(z, unit.team, memory);
            rest = solve_linear(call, tree, tally, [] {});
        } else {
            const BatchWay x = {z, ahead};
            rest = solve_linear(call, x, tally, [&] { ahead.fetch(); });
        }
        leave_flagged(call, f, lane, rest, memory.next, tally);
    });
}
void batches_forces(const ForcesCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    solve_batches(call, unit, scratch, tally);
}
void batches_solve(const SolveCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    solve_batches(call, unit, scratch, tally);
}
void batches_velocities(const VelocitiesCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    solve_batches(call, unit, scratch, tally);
}

void batches_positions(const PositionsCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    const bool packed = call.r.packed && call.r_ref.packed && (!call.v.x || call.v.packed);
    NextMolecules ahead({&call.r_ref, &call.r, &call.v}, call.lambda);
    for_each_batch(unit, scratch, ahead, [&](const TreeBatch &f, const MoleculeLane *lane, Memory<vec> memory) {
        BatchNewton newton(f, lane, packed, memory);
        BatchPositions lanes = {{call, lane, tally}, newton, ahead};
        unsigned rest;
        if (f.n_tiles > 0) {
            const LargeTreeNewton one{newton, unit.team, reinterpret_cast<LargeTreeNewton::FoundOfTile *>(memory.next)};
            memory.next += LargeTreeNewton::bytes(f) / static_cast<int64_t>(sizeof(double));
            LargeTreePositions tree = {{call, lane, tally}, one, lanes};
            rest = solve_positions(tree, ScalarMask{true}, [] {});
        } else {
            rest = solve_positions(lanes, first_lanes(f.n_trees), [&] { ahead.fetch(); });
        }
        leave_flagged(call, f, lane, rest, memory.next, tally);
    });
}

}  // namespace holonomic::HOL_ISA
