// Different trees in the lanes of a vector: constraint forces, multipliers for given right-hand sides, velocities,
// positions.
#include "core/kernels/memory/prefetch.hpp"
#include "core/kernels/molecules/doubtful.hpp"
#include "core/kernels/molecules/forest/one_tree.hpp"
#include "core/kernels/molecules/forest/one_tree_positions.hpp"
#include "core/kernels/molecules/forest/open_forest.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

using namespace graph;

int64_t forest_scratch_bytes(const Forest &f) {
    int64_t careful = 0;
    for (int i = 0; i < f.n_trees; ++i)
        careful = f.schedule[i]->careful_bytes > careful ? f.schedule[i]->careful_bytes : careful;
    const int64_t linear = ForestLinear::values(f), newton = moves_in_forest(f.schedule[0]->way.positions) ? ForestNewton::values(f) : 0;
    return (linear > newton ? linear : newton) * static_cast<int64_t>(sizeof(vec)) + OneTree::bytes(f) +
           OneTreeNewton::bytes(f) + 64 + careful + open_bytes(f);
}

// Calls work(forest, lanes, memory) for all forests of a unit.
template <class Work>
static inline void for_each_forest(const MoleculeUnit &unit, double *scratch, NextMolecules &ahead, const Work &work) {
    const MoleculeLane *next = unit.lanes;
    for (int64_t i = 0; i < unit.n_forests; ++i) {
        double *left = scratch;
        const Forest f = open_forest(unit.forests[i], left);
        MoleculeLane lane[W];
        for (int l = 0; l < W; ++l) lane[l] = next[l < f.n_trees ? l : 0];
        next += f.n_trees;
        if (unit.large && i + 1 < unit.n_forests) {
            ahead.begin(unit.forests[i + 1].most_atoms);
            for (int l = 0; l < unit.forests[i + 1].n_trees; ++l) ahead.add(next[l]);
        }
        ahead.fetch();
        work(f, lane, Memory<vec>{left});
        ahead.fetch_the_rest();
    }
}

template <class Call>
static inline void leave_doubtful(const Call &call, const Forest &f, const MoleculeLane *lane, unsigned good,
                                  double *scratch, Tally &tally) {
    for (int i = 0; i < f.n_trees; ++i)
        if (!(good >> i & 1)) solve_doubtful(call, *f.schedule[i], lane, 1u << i, scratch, tally);
}

template <class Call>
static inline void write_forest(const ForestLinear &z, const ForestTrees::Range &range, const Call &call,
                                unsigned good) {
    if (call.lambda) z.write_bonds<false>(range, 0.5, call.lambda, good);
    if (call.tension) z.write_bonds<true>(range, 1, call.tension, good);
    if (call.g.x) z.write_pulls(range, call.g, call.add, good);
}

// Forests, or one large tree, of forces or for given right-hand sides.
template <class Call>
static inline void solve_forest(const Call &call, const MoleculeUnit &unit, const Forest &f, const MoleculeLane *lane,
                                ForestLinear &z, Memory<vec> &memory, NextMolecules &ahead, Tally &tally) {
    unsigned good;
    if (f.n_pieces > 0) {
        const OneTree tree(z, unit.team, memory);
        good = tree.solve() ? 1 : 0;
        if (good) tree.for_ranges([&](const ForestTrees::Range &range) { write_forest(z, range, call, all_lanes); });
        if (good && call.virial) tree.add_virial(tally);
    } else {
        z.load(z.all());
        ahead.fetch();
        good = z.solve();
        ahead.fetch();
        write_forest(z, z.all(), call, good);
        if (call.virial) z.add_virial(good, tally);
    }
    leave_doubtful(call, f, lane, good, memory.next, tally);
}

void forests_forces(const ForcesCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    const bool packed =
        call.r.packed && (!call.v.x || call.v.packed) && (!call.f.x || call.f.packed) && (!call.g.x || call.g.packed);
    NextMolecules ahead({&call.r, &call.v, &call.f, &call.g}, call.lambda);
    for_each_forest(unit, scratch, ahead, [&](const Forest &f, const MoleculeLane *lane, Memory<vec> memory) {
        ForestLinear z(f, lane, packed, call.box, call.r, {&call.v, &call.f, nullptr, false},
                       (call.v.x ? squares : 0) | (call.f.x ? pulls : 0), memory);
        solve_forest(call, unit, f, lane, z, memory, ahead, tally);
    });
}

void forests_solve(const SolveCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    const bool packed = call.r.packed && (!call.g.x || call.g.packed);
    NextMolecules ahead({&call.r, &call.g}, call.lambda);
    for_each_forest(unit, scratch, ahead, [&](const Forest &f, const MoleculeLane *lane, Memory<vec> memory) {
        ForestLinear z(f, lane, packed, call.box, call.r, {nullptr, nullptr, call.rhs, false}, given, memory);
        solve_forest(call, unit, f, lane, z, memory, ahead, tally);
    });
}

// Twice, as molecules/velocities.hpp says.
void forests_velocities(const VelocitiesCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    NextMolecules ahead({&call.r, &call.v}, call.lambda);
    for_each_forest(unit, scratch, ahead, [&](const Forest &f, const MoleculeLane *lane, Memory<vec> memory) {
        ForestLinear z(f, lane, call.r.packed && call.v.packed, call.box, call.r,
                       {&call.v, nullptr, nullptr, true, call.strain}, rates, memory);
        const bool twice = !call.v.is_float;
        unsigned good;
        if (f.n_pieces > 0) {
            const OneTree tree(z, unit.team, memory);
            good = tree.solve() && !(twice && tree.any_torn()) ? 1 : 0;
            const auto write = [&](const ForestTrees::Range &range) { z.write_velocities(range, call.v, all_lanes); };
            if (good) {
                if (call.lambda)
                    tree.for_ranges([&](const ForestTrees::Range &range) {
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
        leave_doubtful(call, f, lane, good, memory.next, tally);
    });
}

void forests_positions(const PositionsCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    const bool packed = call.r.packed && call.r_ref.packed && (!call.v.x || call.v.packed);
    NextMolecules ahead({&call.r_ref, &call.r, &call.v}, call.lambda);
    for_each_forest(unit, scratch, ahead, [&](const Forest &f, const MoleculeLane *lane, Memory<vec> memory) {
        ForestNewton newton(f, lane, packed, memory);
        const ForestPositions lanes{call, newton, tally};
        unsigned good;
        if (f.n_pieces > 0) {
            OneTreeNewton one{newton, unit.team, reinterpret_cast<OneTreeNewton::Found *>(memory.next)};
            memory.next += OneTreeNewton::bytes(f) / static_cast<int64_t>(sizeof(double));
            good = OneTreePositions{one, lanes, tally}.solve(lane->molecule) ? 1 : 0;
        } else {
            good = lanes.solve([&] { ahead.fetch(); });
        }
        leave_doubtful(call, f, lane, good, memory.next, tally);
    });
}

}  // namespace holonomic::HOL_ISA
