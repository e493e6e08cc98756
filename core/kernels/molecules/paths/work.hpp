// A large molecule along its paths (plan.hpp) at the position level: what the threads that work on junctions and
// paths share. Each writes multipliers and moves of its own bonds; nothing reaches the caller before all fit.
#pragma once

#include "core/kernels/memory/arena.hpp"
#include "core/kernels/memory/cut.hpp"
#include "core/kernels/newton/seams.hpp"
#include "core/plan/elimination.hpp"
#include "core/plan/paths.hpp"

namespace holonomic::HOL_ISA::graph {

struct PathsWork {
    const PositionsCall &call, &strict;
    const PathPlan &plan;
    const MoleculeLane &molecule;
    const bool packed;
    const LongTeam *const team;  // or nullptr
    double *tau;                 // [bonds of the molecule] multipliers, 2 dt^2 lambda
    Vector3<double> *move;       // [plan.n_atoms] displacements of the atoms of junctions
    double *work;                // in place of the calling thread's scratch
    const double *scratch;       // which holds all of this
    SharedLargest worst = {};
    bool seen[3] = {};  // of each WindowResult

    bool has(WindowResult result) const { return __atomic_load_n(&seen[result], __ATOMIC_RELAXED); }
    void note(WindowResult result) { __atomic_store_n(&seen[result], true, __ATOMIC_RELAXED); }
};

// A path as a chain, whose first bond is counted from the molecule's.
HOL_INLINE Lane lane_of_path(const PathsWork &x, int32_t p) {
    const PathPlan::Path &path = x.plan.path[p];
    Lane lane = {};
    lane.n_bonds = path.n_bonds;
    lane.first_atom = x.molecule.first_atom + path.first_atom;
    lane.atoms = x.molecule.atoms ? x.molecule.atoms + path.first_atom : nullptr;
    lane.w = x.molecule.w + path.first_atom;
    lane.length = x.molecule.length + path.first_bond;
    lane.first_bond = path.first_bond;
    lane.chain = x.molecule.molecule;
    return lane;
}

// A worse bond of the molecule than those before.
HOL_INLINE void note_worse(const PathsWork &x, double error, int64_t bond, Tally &part) {
    if (!(error > part.worst)) return;
    part.worst = error;
    part.worst_chain = x.molecule.molecule;
    part.worst_bond = bond;
}

// Calls body(j, scratch, part) for j = 0 .. n - 1, on the threads that there are.
template <class Body>
HOL_INLINE void for_parts(const PathsWork &x, int64_t n, Tally &total, const Body &body) {
    const auto own = [&](int64_t j, double *scratch, Tally &part) {
        body(j, scratch == x.scratch ? x.work : scratch, part);
    };
    typedef decltype(own) Own;
    if (x.team) {
        x.team->run(
            x.team->threads, n, total,
            [](const void *context, int64_t j, double *scratch, Tally &part) {
                (*static_cast<const Own *>(context))(j, scratch, part);
            },
            &own);
        return;
    }
    for (int64_t j = 0; j < n; ++j) {
        Tally part = empty_tally();
        body(j, x.work, part);
        add(total, part);
    }
}

// The same for what finds multipliers: nothing more is done once a part has failed. Only a part with an error that may
// be the largest one looks for its bond.
template <class Solve>
HOL_INLINE void solve_parts(PathsWork &x, int64_t n, Tally &total, const Solve &solve) {
    for_parts(x, n, total, [&](int64_t j, double *scratch, Tally &part) {
        if (x.has(window_failed)) return;
        x.note(x.worst.look(x.molecule.molecule, part, [&] { return solve(j, scratch, part); }));
    });
}

}  // namespace holonomic::HOL_ISA::graph
