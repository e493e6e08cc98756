// Different trees in the lanes of a vector: constraint forces, multipliers for given right-hand sides, velocities,
// positions.
#include "core/kernels/careful/plan.hpp"
#include "core/kernels/molecules/doubtful.hpp"
#include "core/kernels/molecules/forest/forest_positions.hpp"
#include "core/kernels/molecules/forest/forest_sweeps.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

using namespace graph;

int64_t forest_scratch_bytes(const Forest &f) {
    int64_t careful = 0;
    for (int i = 0; i < f.n_trees; ++i)
        careful = f.schedule[i]->careful->scratch_bytes > careful ? f.schedule[i]->careful->scratch_bytes : careful;
    const int64_t linear = ForestLinear::values(f), newton = ForestNewton::values(f);
    return (linear > newton ? linear : newton) * static_cast<int64_t>(sizeof(vec)) + 64 + careful;
}

// Starts to fetch the atoms of a forest: trees that are worked on one after the other are not so in memory.
HOL_NOINLINE void fetch(const Forest &f, const MoleculeLane *lane, const AtomArray *const *arrays, int n_arrays) {
    const auto lines = [](const void *first, int64_t bytes) {
        for (int64_t i = 0; i < bytes; i += 64) __builtin_prefetch(static_cast<const char *>(first) + i, 0, 2);
    };
    for (int l = 0; l < f.n_trees; ++l) {
        lines(lane[l].w, 8 * f.most_atoms);
        for (int a = 0; a < n_arrays && !lane[l].atoms; ++a)
            lines(arrays[a]->x + 24 * lane[l].first_atom, 24 * f.most_atoms);
    }
}

// Calls work(forest, lanes) for all forests of a unit. The arrays are fetched ahead where they are packed.
template <int n, class Work>
static inline void for_each_forest(const MoleculeUnit &unit, const AtomArray *const (&arrays)[n], const Work &work) {
    const AtomArray *fetched[n];
    int n_fetched = 0;
    for (int a = 0; a < n; ++a)
        if (unit.large && arrays[a]->x && arrays[a]->packed) fetched[n_fetched++] = arrays[a];
    const MoleculeLane *next = unit.lanes;
    for (int64_t i = 0; i < unit.n_forests; ++i) {
        const Forest &f = unit.forests[i];
        MoleculeLane lane[W];
        for (int l = 0; l < W; ++l) lane[l] = next[l < f.n_trees ? l : 0];
        next += f.n_trees;
        if (i + 1 < unit.n_forests && n_fetched > 0) fetch(unit.forests[i + 1], next, fetched, n_fetched);
        work(f, lane);
    }
}

template <class Call>
static inline void leave_doubtful(const Call &call, const Forest &f, const MoleculeLane *lane, unsigned good,
                                  double *scratch, Tally &tally) {
    for (int i = 0; i < f.n_trees; ++i)
        if (!(good >> i & 1)) solve_doubtful(call, *f.schedule[i], lane, 1u << i, scratch, tally);
}

template <class Call>
static inline void write_forest(const ForestLinear &z, const Call &call, unsigned good, Tally &tally) {
    if (call.lambda) z.write_bonds<false>(0.5, call.lambda, good);
    if (call.tension) z.write_bonds<true>(1, call.tension, good);
    if (call.virial) z.add_virial(good, tally);
    if (call.g.x) z.write_pulls(call.g, call.add, good);
}

void forests_forces(const ForcesCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    const bool packed =
        call.r.packed && (!call.v.x || call.v.packed) && (!call.f.x || call.f.packed) && (!call.g.x || call.g.packed);
    const AtomArray *const arrays[] = {&call.r, &call.v, &call.f, &call.g};
    for_each_forest(unit, arrays, [&](const Forest &f, const MoleculeLane *lane) {
        Memory<vec> memory = {scratch};
        ForestLinear z(f, lane, packed, call.box, call.r, {&call.v, &call.f, nullptr, false},
                       (call.v.x ? squares : 0) | (call.f.x ? pulls : 0), memory);
        z.load();
        const unsigned good = z.solve();
        write_forest(z, call, good, tally);
        leave_doubtful(call, f, lane, good, memory.next, tally);
    });
}

void forests_solve(const SolveCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    const bool packed = call.r.packed && (!call.g.x || call.g.packed);
    const AtomArray *const arrays[] = {&call.r, &call.g};
    for_each_forest(unit, arrays, [&](const Forest &f, const MoleculeLane *lane) {
        Memory<vec> memory = {scratch};
        ForestLinear z(f, lane, packed, call.box, call.r, {nullptr, nullptr, call.rhs, false}, given, memory);
        z.load();
        const unsigned good = z.solve();
        write_forest(z, call, good, tally);
        leave_doubtful(call, f, lane, good, memory.next, tally);
    });
}

// Twice, as molecules/velocities.hpp says.
void forests_velocities(const VelocitiesCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    const AtomArray *const arrays[] = {&call.r, &call.v};
    for_each_forest(unit, arrays, [&](const Forest &f, const MoleculeLane *lane) {
        Memory<vec> memory = {scratch};
        ForestLinear z(f, lane, call.r.packed && call.v.packed, call.box, call.r,
                       {&call.v, nullptr, nullptr, true, call.strain}, rates, memory);
        z.load();
        const unsigned good = z.solve();
        if (good) {
            if (call.lambda) z.write_bonds<false>(0.5, call.lambda, good);
            if (call.virial) z.add_virial(good, tally);
            z.add_pulls_to_velocities();
            if (!call.v.is_float) {
                z.find_rates();
                z.solve_again();
                z.add_pulls_to_velocities();
            }
            z.write_velocities(call.v, good);
        }
        leave_doubtful(call, f, lane, good, memory.next, tally);
    });
}

void forests_positions(const PositionsCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    const bool packed = call.r.packed && call.r_ref.packed && (!call.v.x || call.v.packed);
    const AtomArray *const arrays[] = {&call.r_ref, &call.r, &call.v};
    for_each_forest(unit, arrays, [&](const Forest &f, const MoleculeLane *lane) {
        Memory<vec> memory = {scratch};
        ForestNewton newton(f, lane, packed, memory);
        const unsigned good = ForestPositions{call, newton, tally}.solve();
        leave_doubtful(call, f, lane, good, memory.next, tally);
    });
}

}  // namespace holonomic::HOL_ISA
