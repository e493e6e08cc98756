// Position level of one large molecule along its paths (molecules/paths/plan.hpp): junctions, then sections of paths,
// then whether what they have found fits where they meet, and only then anything is written. As in a long chain
// (positions_long.cpp) the result does not rest on how far a bond is felt: all lengths have been tested by then.
#include "core/kernels/molecules/paths/junctions.hpp"
#include "core/kernels/molecules/paths/sections.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

using namespace graph;

static int64_t part_values(const PathPlan &plan) {
    const int64_t junctions = junction_values(plan), sections = scratch_doubles(longest_cut);
    return junctions > sections ? junctions : sections;
}
static int64_t up_to_line(int64_t n) { return (n + most_lanes - 1) / most_lanes * most_lanes; }

int64_t path_positions_bytes(const EliminationPlan &s) {
    return static_cast<int64_t>(sizeof(double)) *
           (up_to_line(s.n_bonds + 3 * static_cast<int64_t>(s.paths->n_atoms)) + part_values(*s.paths));
}

static void solve(PathsWork &x, Tally &sum) {
    solve_parts(x, n_junction_blocks(x.plan), sum, [&](int64_t j, double *scratch, Tally &part) {
        return solve_junctions(x, junctions_of_block(x.plan, j), scratch, part);
    });
    if (x.has(window_failed)) return;
    solve_parts(x, n_section_blocks(x.plan), sum,
                [&](int64_t j, double *scratch, Tally &part) { return solve_sections(x, j, scratch, part); });
}

static bool all_fit(PathsWork &x, Tally &sum) {
    for_parts(x, n_section_blocks(x.plan), sum, [&](int64_t j, double *scratch, Tally &part) {
        for (int64_t i = j * W; i < x.plan.n_sections && i < (j + 1) * W; ++i)
            if (!section_fits(x, x.plan.section[i], Arena(scratch, longest_cut), part)) x.note(window_failed);
    });
    return !x.has(window_failed);
}

// Bonds of no path.
static void add_virial_of_junctions(const PathsWork &x, const EliminationPlan &s, Tally &sum) {
    const Atoms<double> at(&x.molecule, 1, x.packed);
    MoleculesVirial<double> virial;
    for (int32_t k = 0; k < x.plan.n_bonds; ++k) {
        const int32_t bond = x.plan.bond[k];
        Vector3<double> b = read(x.call.r_ref, at, s.atom_j[bond]) - read(x.call.r_ref, at, s.atom_i[bond]),
                        unused = {};
        take_image<false>(x.call.box_ref, b, unused);
        virial.add(b, x.tau[bond] * b);
    }
    virial.count(1, 1 / (x.call.dt * x.call.dt), sum);
}

static void write_all(PathsWork &x, const EliminationPlan &s, bool moved, Tally &sum) {
    for_parts(x, n_section_blocks(x.plan), sum,
              [&](int64_t j, double *scratch, Tally &part) { finish_sections(x, j, moved, scratch, part); });
    for (int32_t k = 0; k < x.plan.n_bonds && x.call.lambda; ++k) write_lambda(x, x.plan.bond[k], 1, moved);
    if (!moved) return;
    move_junctions(x, s.fixed);
    if (x.call.virial) add_virial_of_junctions(x, s, sum);
}

bool path_positions(const PositionsCall &call, const EliminationPlan &s, const MoleculeLane &molecule,
                    const LongTeam *team, double *scratch, Tally &tally) {
    const PositionsCall strict = call_for_parts(call);
    const bool packed = call.r.packed && call.r_ref.packed && (!call.v.x || call.v.packed);
    Vector3<double> *const move = reinterpret_cast<Vector3<double> *>(scratch + s.n_bonds);
    double *const work = scratch + up_to_line(s.n_bonds + 3 * static_cast<int64_t>(s.paths->n_atoms));
    PathsWork x = {call, strict, *s.paths, molecule, packed, team, scratch, move, work, scratch};
    Tally sum = empty_tally();
    solve(x, sum);
    const bool moved = x.has(window_solved);
    if (x.has(window_failed) || (moved && x.has(window_untouched)) || (moved && !all_fit(x, sum))) return false;
    write_all(x, s, moved, sum);
    sum.n_corrected = moved;
    add(tally, sum);
    return true;
}

}  // namespace holonomic::HOL_ISA
