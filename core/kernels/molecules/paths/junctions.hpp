// Junctions of a large molecule (path_plan.hpp) at the position level: W of a kind at a time as small molecules, whose
// overlaps reach so far that what is beyond them is not felt at the junction.
#pragma once

#include "core/kernels/molecules/paths/work.hpp"
#include "core/kernels/molecules/positions.hpp"

namespace holonomic::HOL_ISA::graph {

// W junctions of a kind; the last ones of it may be fewer.
struct Junctions {
    const PathPlan::JunctionKind &kind;
    int32_t first;  // among those of the kind
    int used;

    int32_t atom(int32_t i) const { return kind.first_atom + (first + i) * kind.n_atoms; }
    int32_t bond(int32_t i) const { return kind.first_bond + (first + i) * kind.n_bonds; }
    int32_t overlap(int32_t i) const { return kind.first_overlap + (first + i) * kind.n_overlaps; }
};

HOL_INLINE int64_t n_junction_blocks(const PathPlan &plan) {
    int64_t n = 0;
    for (int32_t i = 0; i < plan.n_kinds; ++i) n += (plan.kind[i].count + W - 1) / W;
    return n;
}
HOL_INLINE Junctions junctions_of_block(const PathPlan &plan, int64_t j) {
    const PathPlan::JunctionKind *kind = plan.kind;
    for (; j >= (kind->count + W - 1) / W; ++kind) j -= (kind->count + W - 1) / W;
    const int32_t first = static_cast<int32_t>(j) * W, left = kind->count - first;
    return {*kind, first, left < W ? left : W};
}

// The local numbers of an overlap's bonds and of the atoms behind them.
HOL_INLINE int32_t bond_of_overlap(const PathPlan &plan, const PathPlan::Overlap &overlap, int32_t j) {
    const PathPlan::Path &path = plan.path[overlap.path];
    return overlap.backwards ? path.first_bond + path.n_bonds - 1 - j : path.first_bond + j;
}
HOL_INLINE int32_t atom_of_overlap(const PathPlan &plan, const PathPlan::Overlap &overlap, int32_t j) {
    const PathPlan::Path &path = plan.path[overlap.path];
    return overlap.backwards ? path.first_atom + path.n_bonds - 1 - j : path.first_atom + 1 + j;
}

// Which of the reaches the overlaps need; n_reaches: none is enough.
static inline int reach_of(const PathsWork &x, const Junctions &junctions, Arena arena) {
    int32_t most = 0;
    for (int32_t l = junctions.overlap(0); l < junctions.overlap(junctions.used); ++l) {
        const PathPlan::Overlap &overlap = x.plan.overlap[l];
        const Lane path = lane_of_path(x, overlap.path);
        const int64_t end = PathPlan::bonds_of_end;
        const long n = margin(x.call.r_ref, x.call.box_ref, path, overlap.backwards ? path.n_bonds - end : end,
                              overlap.backwards ? -1 : 1, 0, arena);
        if (n < 0) return PathPlan::n_reaches;
        most = n > most ? static_cast<int32_t>(n) : most;
    }
    int i = 0;
    while (i < PathPlan::n_reaches && PathPlan::reach(i) < PathPlan::bonds_of_end + most) ++i;
    return i;
}

// Junction i of a block as a molecule of its own.
static inline MoleculeLane lane_of_junction(const PathsWork &x, const Junctions &junctions, int32_t i, int32_t reach,
                                            Memory<double> &memory) {
    const PathPlan &plan = x.plan;
    const int32_t overlaps = junctions.kind.n_overlaps * reach, n_atoms = junctions.kind.n_atoms + overlaps,
                  n_bonds = junctions.kind.n_bonds + overlaps;
    int64_t *const atoms = reinterpret_cast<int64_t *>(memory.values(n_atoms));
    double *const w = memory.values(n_atoms), *const length = memory.values(n_bonds);
    const auto take = [&](int32_t k, int32_t atom) {
        atoms[k] = x.molecule.atoms ? x.molecule.atoms[atom] : x.molecule.first_atom + atom;
        w[k] = x.molecule.w[atom];
    };
    for (int32_t k = 0; k < junctions.kind.n_atoms; ++k) take(k, plan.atom[junctions.atom(i) + k]);
    for (int32_t k = 0; k < junctions.kind.n_bonds; ++k)
        length[k] = x.molecule.length[plan.bond[junctions.bond(i) + k]];
    for (int32_t l = 0; l < junctions.kind.n_overlaps; ++l) {
        const PathPlan::Overlap &overlap = plan.overlap[junctions.overlap(i) + l];
        for (int32_t j = 0; j < reach; ++j) {
            take(junctions.kind.n_atoms + l * reach + j, atom_of_overlap(plan, overlap, j));
            length[junctions.kind.n_bonds + l * reach + j] = x.molecule.length[bond_of_overlap(plan, overlap, j)];
        }
    }
    MoleculeLane lane = {};
    lane.atoms = atoms;
    lane.w = w;
    lane.length = length;
    lane.molecule = x.molecule.molecule;
    return lane;
}
HOL_INLINE int64_t lane_values(const EliminationPlan &s) { return 2 * s.n_atoms + s.n_bonds; }

// Doubles for a block of junctions of any kind.
static inline int64_t junction_values(const PathPlan &plan) {
    int64_t most = 0;
    for (int32_t i = 0; i < plan.n_kinds; ++i) {
        const EliminationPlan &s = *plan.kind[i].elimination[PathPlan::n_reaches - 1];
        const int64_t n = W * (lane_values(s) + TreeNewton<vec>::values(s)) + most_lanes;
        most = n > most ? n : most;
    }
    return most;
}

// Calls body(lane, bond, place) for the bonds of a block whose multipliers are the junction's: of overlaps the first n.
template <class Body>
HOL_INLINE void for_bonds_of_junctions(const PathPlan &plan, const Junctions &junctions, const EliminationPlan &s,
                                       int32_t reach, int32_t n, const Body &body) {
    for (int32_t i = 0; i < junctions.used; ++i) {
        for (int32_t k = 0; k < junctions.kind.n_bonds; ++k)
            body(i, plan.bond[junctions.bond(i) + k], s.bond_index_of[k]);
        for (int32_t l = 0; l < junctions.kind.n_overlaps; ++l)
            for (int32_t j = 0; j < n; ++j)
                body(i, bond_of_overlap(plan, plan.overlap[junctions.overlap(i) + l], j),
                     s.bond_index_of[junctions.kind.n_bonds + l * reach + j]);
    }
}

static inline void keep_junctions(const PathsWork &x, const Junctions &junctions, const TreeNewton<vec> &newton,
                                  int32_t reach) {
    const EliminationPlan &s = newton.x.s;
    for_bonds_of_junctions(x.plan, junctions, s, reach, PathPlan::bonds_of_end,
                           [&](int32_t i, int32_t bond, int32_t place) { x.tau[bond] = newton.x.row[place].tau[i]; });
    for (int32_t k = 0; k < junctions.kind.n_atoms; ++k) {
        const vec3 move = newton.displacements()[s.index_of[k]];
        for (int32_t i = 0; i < junctions.used; ++i) x.move[junctions.atom(i) + k] = {move.x[i], move.y[i], move.z[i]};
    }
}

// Finds the multipliers of a block of junctions, and how far their atoms move.
static inline WindowResult solve_junctions(const PathsWork &x, const Junctions &junctions, double *scratch,
                                           Tally &part) {
    const int which = reach_of(x, junctions, Arena(scratch, longest_cut));
    if (which == PathPlan::n_reaches) return window_failed;
    const int32_t reach = PathPlan::reach(which);
    const EliminationPlan &s = *junctions.kind.elimination[which];
    MoleculeLane lane[W];
    Memory<double> lists = {scratch};
    for (int i = 0; i < W; ++i)
        lane[i] = i < junctions.used ? lane_of_junction(x, junctions, i, reach, lists) : lane[0];
    Memory<vec> memory = {scratch + (W * lane_values(s) + most_lanes - 1) / most_lanes * most_lanes};
    const Atoms<vec> at(lane, junctions.used, x.packed);
    TreeNewton<vec> newton(s, memory);
    newton.set_masses(lane);
    const mask all = first_lanes(junctions.used);
    PositionsBlock<TreeNewton<vec>> block(x.strict, lane, part, at, newton, false);
    const Solved<vec> out = find_multipliers(block, all);
    const bool untouched = !any(all & ~out.untouched);
    if (!untouched && any(all & ~out.converged)) return window_failed;
    if (x.call.report)
        for_bonds_of_junctions(
            x.plan, junctions, s, reach, untouched ? PathPlan::bonds_of_end : 1,
            [&](int32_t i, int32_t bond, int32_t place) { note_worse(x, newton.left_of(place)[i], bond, part); });
    if (untouched) return window_untouched;
    if (out.solves > part.iterations) part.iterations = out.solves;
    keep_junctions(x, junctions, newton, reach);
    return window_solved;
}

// Moves the atoms of junctions.
static inline void move_junctions(const PathsWork &x, const uint8_t *fixed) {
    const Atoms<double> at(&x.molecule, 1, x.packed);
    for (int32_t k = 0; k < x.plan.n_atoms; ++k) {
        const int32_t atom = x.plan.atom[k];
        if (fixed[atom]) continue;
        write(x.call.r, at, atom, read(x.call.r, at, atom) + x.move[k], 1);
        if (!x.call.v.x) continue;
        write(x.call.v, at, atom, add_times(read(x.call.v, at, atom), 1 / x.call.dt, x.move[k]), 1);
    }
}

}  // namespace holonomic::HOL_ISA::graph
