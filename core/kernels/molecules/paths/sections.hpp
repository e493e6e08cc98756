// Pieces of paths (path_plan.hpp) at the position level, W at a time as chains: those of different paths, too. Where a
// path ends, the junction has found the multipliers beyond, and the section starts from atoms that are displaced by
// them. Where it is cut, sections have margins, as windows of a long chain have (memory/cut.hpp).
#pragma once

#include "core/kernels/memory/load.hpp"
#include "core/kernels/molecules/paths/work.hpp"
#include "core/kernels/newton/attempts.hpp"

namespace holonomic::HOL_ISA::graph {

static_assert(PathPlan::bonds_of_section + 2 * longest_margin <= longest_cut, "scratch is made for these");

// W sections with their margins; the last ones may be fewer.
struct PathSections {
    const PathPlan::Section *section;
    int used;
    Block block;
    Lane lane[W];
    long skip[W];  // bonds of the margin before
};

HOL_INLINE int64_t n_section_blocks(const PathPlan &plan) { return (plan.n_sections + W - 1) / W; }

HOL_INLINE const PathPlan::Path &path_of(const PathsWork &x, const PathPlan::Section &section) {
    return x.plan.path[section.path];
}

// Returns false if margins would be too long.
static inline bool open_sections(const PathsWork &x, int64_t j, Arena &arena, PathSections &p) {
    const int64_t first = j * W, left = x.plan.n_sections - first;
    p.section = x.plan.section + first;
    p.used = left < W ? static_cast<int>(left) : W;
    Lane part[W] = {};
    for (int i = 0; i < p.used; ++i) {
        const PathPlan::Section &section = p.section[i];
        const PathPlan::Path &path = path_of(x, section);
        const Lane own = part_of(lane_of_path(x, section.path), path.own, path.own_end - path.own);
        const int64_t from = section.from - path.own, end = section.end - path.own;
        const long before = from == 0 ? 0 : margin(x.call.r_ref, x.call.box_ref, own, from, -1, 0, arena);
        const long behind = end == own.n_bonds ? 0 : margin(x.call.r_ref, x.call.box_ref, own, end, 1, 0, arena);
        if (before < 0 || behind < 0) return false;
        part[i] = part_of(own, from - before, end - from + before + behind);
        p.skip[i] = before;
    }
    open_block(Unit{part, p.used, false, false}, 0, p.block, p.lane);
    set_masses(p.block, p.lane, arena);
    return true;
}

// w tau b of bond k of a path, for its atom on one side or the other.
static inline Vector3<double> pull_of(const PathsWork &x, const Lane &path, int64_t k, int64_t atom, Arena arena) {
    Packed r_ref = {};
    open_lane(x.call.r_ref, path, k, 1, 1, r_ref, 0, arena.doubles(staged_size(1)), true);
    return (path.w[atom] * x.tau[path.first_bond + k]) * bond_vector(x.call.box_ref, r_ref.lane[0], r_ref.lane[0] + 3);
}

// Where a lane begins or ends with its path's own bonds, the bond beyond displaces the atom there.
static inline void displace_ends(const PathsWork &x, const PathSections &p, vec3 *D, Arena arena) {
    const auto move = [&](vec3 &d, int i, const Vector3<double> &by) {
        d.x[i] += by.x;
        d.y[i] += by.y;
        d.z[i] += by.z;
    };
    for (int i = 0; i < p.used; ++i) {
        const PathPlan::Path &of = path_of(x, p.section[i]);
        const Lane path = lane_of_path(x, p.section[i].path);
        const int64_t first = p.lane[i].first_bond - path.first_bond, end = first + p.lane[i].n_bonds;
        if (first == of.own && !of.begins_free()) move(D[0], i, pull_of(x, path, first - 1, first, arena));
        if (end == of.own_end && !of.ends_free()) move(D[p.lane[i].n_bonds - 1], i, pull_of(x, path, end, end, arena));
    }
}

typedef holonomic::HOL_ISA::Newton ChainNewton;

// The largest error of the sections without their margins; those at seams are looked at there, unless nothing moves.
static inline void note_worst_of_windows(const PathsWork &x, const PathSections &p, const ChainNewton &newton,
                                         bool untouched, Tally &part) {
    vec first = {}, end = {};
    const long inside = untouched ? 0 : 1;
    for (int i = 0; i < p.used; ++i) {
        first[i] = static_cast<double>(p.skip[i] + inside);
        end[i] = static_cast<double>(p.skip[i] + (p.section[i].end - p.section[i].from) - inside);
    }
    const WorstBonds worst = find_worst(newton, p.block.n, first, end);
    for (int i = 0; i < p.used; ++i)
        note_worse(x, worst.error[i], p.lane[i].first_bond + static_cast<int64_t>(worst.bond[i]), part);
}

// Finds the multipliers of a block of sections.
static inline WindowResult solve_sections(const PathsWork &x, int64_t j, double *scratch, Tally &part) {
    Arena arena(scratch, longest_cut);
    PathSections p = {};
    if (!open_sections(x, j, arena, p)) return window_failed;
    const BondLengths a = bond_lengths(p.block, p.lane, arena);
    Positions positions(p.block, p.lane, x.strict, a, arena, part);
    ChainNewton &newton = positions.x;
    const Source source = {&x.strict.box, &positions.r};
    Carried carried(p.block, newton, x.strict, source);
    const mask all = p.block.in_use();
    positions.load();
    displace_ends(x, p, newton.D, positions.arena);
    const NewtonOutcome out = solve_positions(p.block, newton, x.strict, carried, all, false);
    const bool untouched = !any(all & ~out.untouched);
    if (!untouched && any(all & (~out.converged | coarse_moves(p.block, newton, carried, all)))) return window_failed;
    if (x.call.report && any(all & less(splat(part.worst), out.error)))
        note_worst_of_windows(x, p, newton, untouched, part);
    if (untouched) return window_untouched;
    if (out.solves > part.iterations) part.iterations = out.solves;
    for (int i = 0; i < p.used; ++i) {
        double *const tau = x.tau + p.lane[i].first_bond + p.skip[i];
        for (long k = 0; k < p.section[i].end - p.section[i].from; ++k) tau[k] = newton.tau[k + p.skip[i]][i];
    }
    return window_solved;
}

// Whether the multipliers of a section fit to those before it, and of the last one of a path to those behind.
static inline bool section_fits(const PathsWork &x, const PathPlan::Section &section, Arena arena, Tally &part) {
    const PathPlan::Path &of = path_of(x, section);
    const Lane path = lane_of_path(x, section.path);
    bool fits = true;
    for (int side = 0; side < 2; ++side) {
        if (side ? section.end != of.own_end || of.ends_free() : section.from == 0) continue;
        Tally here = empty_tally();
        const double error =
            seam_error(x.call, path, side ? section.end : section.from, x.tau + path.first_bond, arena, here);
        fits = fits && error <= enough_at_seams(x.call);
        if (x.call.report) note_worse(x, error, path.first_bond + here.worst_bond, part);
    }
    return fits;
}

// W sections to be written: the bonds of their paths from where the section before ends, and the atoms behind them. The
// bond behind the last atom is in the lane, too.
struct WrittenSections {
    Block block, own;  // own: without that bond
    Lane lane[W];
    long bonds[W];        // whose multipliers are written
    unsigned free_begin;  // lanes whose first atom is written, too
};
static inline void open_written(const PathsWork &x, int64_t j, Arena &arena, WrittenSections &p) {
    const int64_t start = j * W, left = x.plan.n_sections - start;
    const int used = left < W ? static_cast<int>(left) : W;
    Lane part[W] = {};
    long atoms[W] = {};
    p.free_begin = 0;
    for (int i = 0; i < used; ++i) {
        const PathPlan::Section &section = x.plan.section[start + i];
        const PathPlan::Path &path = path_of(x, section);
        const bool last = section.end == path.own_end, begins = section.from == path.own;
        const int64_t first = begins ? 0 : section.from, end = last ? path.n_bonds : section.end;
        part[i] = part_of(lane_of_path(x, section.path), first, last ? end - first : end - first + 1);
        p.bonds[i] = end - first;
        atoms[i] = last && !path.ends_free() ? end - first - 1 : end - first;
        if (begins && path.begins_free()) p.free_begin |= 1u << i;
    }
    open_block(Unit{part, used, false, false}, 0, p.block, p.lane);
    set_masses(p.block, p.lane, arena);
    p.own = p.block;
    p.own.n_min = p.block.n;
    for (int i = 0; i < W; ++i) {
        p.own.len[i] = atoms[i < used ? i : 0];
        p.own.n_min = p.own.len[i] < p.own.n_min ? p.own.len[i] : p.own.n_min;
    }
}

// The virial of the moves, - sum tau b (x) b / dt^2.
static inline void add_virial(const PathsWork &x, const WrittenSections &p, const ChainNewton &newton, Tally &part) {
    VirialSum sum;
    vec bonds = {};
    for (int i = 0; i < W; ++i) bonds[i] = i < p.block.lanes ? static_cast<double>(p.bonds[i]) : 0.0;
    for (long k = 0; k < p.block.n; ++k)
        sum.add(newton.b[k], keep(less(splat(static_cast<double>(k)), bonds), newton.tau[k]) * newton.b[k]);
    sum.count(p.block.in_use(), splat(1 / (x.call.dt * x.call.dt)), part);
}

// The atoms of each lane that are written; other threads may be writing the others. Copied to staging buffers and back,
// where arrays can't be used in place.
static inline Packed open_own(const AtomArray &array, const WrittenSections &p, Arena &arena) {
    const Packed packed = open(array, p.block, p.lane, arena, false);
    for (int i = 0; i < p.block.lanes && array.x && !in_place(array, p.block); ++i) {
        const long first = p.free_begin >> i & 1 ? 0 : 1;
        stage(array, p.lane[i], first, p.own.len[i] - first, packed.lane[i] + 3 * first);
    }
    return packed;
}
static inline void close_own(const AtomArray &array, const WrittenSections &p, const Packed &packed) {
    for (int i = 0; i < p.block.lanes && array.x && !in_place(array, p.block); ++i) {
        const long first = p.free_begin >> i & 1 ? 0 : 1;
        unstage(array, p.lane[i], first, p.own.len[i] - first, packed.lane[i] + 3 * first, false);
    }
}

static inline void move_sections(const PathsWork &x, const WrittenSections &p, const ChainNewton &newton, Arena arena) {
    const Packed r = open_own(x.call.r, p, arena), v = open_own(x.call.v, p, arena);
    const double per_dt = 1 / x.call.dt;
    move_atoms(p.own, newton, p.block.in_use(), r, v, per_dt, 1, newton.tau[0] * newton.b[0]);
    if (p.free_begin) move_first(newton, p.free_begin, r, v, per_dt);
    close_own(x.call.r, p, r);
    close_own(x.call.v, p, v);
}

HOL_INLINE void write_lambda(const PathsWork &x, int64_t first, int64_t n, bool moved) {
    const double factor = 0.5 / (x.call.dt * x.call.dt), *const tau = x.tau + first;
    double *const lambda = x.call.lambda + x.molecule.first_bond + first;
    for (int64_t k = 0; k < n; ++k) lambda[k] = moved ? mul_add(factor, tau[k], 0.0) : 0.0;  // zeros as +0
}

// Writes the multipliers of a block of sections, and moves its atoms, if the molecule was moved.
static inline void finish_sections(const PathsWork &x, int64_t j, bool moved, double *scratch, Tally &part) {
    Arena arena(scratch, longest_cut);
    WrittenSections p = {};
    open_written(x, j, arena, p);
    const Block &block = p.block;
    for (int i = 0; i < block.lanes && x.call.lambda; ++i) write_lambda(x, p.lane[i].first_bond, p.bonds[i], moved);
    if (!moved) return;
    ChainNewton newton(block, BondLengths{}, arena);
    load_bond_vectors(block, x.call.box_ref, open(x.call.r_ref, block, p.lane, arena, true), newton.b);
    const double *tau[W] = {};
    for (int i = 0; i < block.lanes; ++i) tau[i] = x.tau + p.lane[i].first_bond;
    interleave(tau, block.len, 0, block.n, newton.tau,
               [&](int i, long k) HOL_FORCED { return i < block.lanes && k < block.len[i] ? tau[i][k] : 0.0; });
    move_sections(x, p, newton, arena);
    if (x.call.virial) add_virial(x, p, newton, part);
}

}  // namespace holonomic::HOL_ISA::graph
