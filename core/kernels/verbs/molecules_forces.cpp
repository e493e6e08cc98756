// Constraint forces of molecules that are no chains, and multipliers for given right-hand sides.
#include "core/kernels/molecules/linear_blocks.hpp"
#include "core/kernels/molecules/network/verbs.hpp"
#include "core/kernels/molecules/star/linear.hpp"
#include "core/kernels/molecules/triangle/blocks.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

using namespace graph;

// Of forces, or for given right-hand sides. Out of line, so that it is compiled once.
HOL_NOINLINE void solve_triangles(const TriangleLinearVerb &verb, const MoleculeUnit &unit, bool packed, bool columns,
                                  double *scratch) {
    for_each_triangle(verb, unit, packed, scratch, columns);
}

static void forces_of_blocks(const ForcesCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    if (unit.tree_batches) return batches_forces(call, unit, scratch, tally);
    const bool packed = are_packed(call);
    const Way way = unit.elimination->way.forces;
    if (way == Way::network) return solve_networks(call, unit, packed, scratch, tally);
    if (way == Way::triangle) {
        const TriangleCall triangles = {call.r,      call.v,       call.f,   nullptr,     call.g,
                                        call.lambda, call.tension, call.add, call.virial, call.box};
        return solve_triangles(TriangleLinearVerb(triangles, &call, nullptr, tally), unit, packed, reads_columns(call),
                               scratch);
    }
    NextMolecules ahead = next_of(call);
    const LinearOfBlocks<ForcesCall> work = {call, *unit.elimination, way, packed, tally, unit.team, ahead};
    const StarForcesVerb stars = {call, tally};
    if (way == Way::star && (do_stars<3>(stars, work, unit, scratch) || do_stars<4>(stars, work, unit, scratch)))
        return;
    for_each_block(unit, scratch, ahead, work);
}

void molecules_forces(const ForcesCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    molecules_in_parts(call, unit, tally, [=](const ForcesCall &c, const MoleculeUnit &u, Tally &own) {
        forces_of_blocks(c, u, scratch, own);
    });
}

void molecules_solve(const SolveCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    if (unit.tree_batches) return batches_solve(call, unit, scratch, tally);
    const bool packed = are_packed(call);
    const Way way = unit.elimination->way.given;
    if (way == Way::network) return solve_networks(call, unit, packed, scratch, tally);
    if (way == Way::triangle) {
        const AtomArray none = {};
        const TriangleCall triangles = {call.r,      none,         none,     call.rhs,    call.g,
                                        call.lambda, call.tension, call.add, call.virial, call.box};
        return solve_triangles(TriangleLinearVerb(triangles, nullptr, &call, tally), unit, packed, false, scratch);
    }
    NextMolecules ahead = next_of(call);
    const LinearOfBlocks<SolveCall> work = {call, *unit.elimination, way, packed, tally, unit.team, ahead};
    for_each_block(unit, scratch, ahead, work);
}

}  // namespace holonomic::HOL_ISA
