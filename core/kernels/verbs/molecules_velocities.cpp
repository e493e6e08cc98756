// Velocity level of molecules that are no chains.
#include "core/kernels/molecules/linear_blocks.hpp"
#include "core/kernels/molecules/network/verbs.hpp"
#include "core/kernels/molecules/star/linear.hpp"
#include "core/kernels/molecules/triangle/blocks.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

using namespace graph;

static void velocities_of_blocks(const VelocitiesCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    if (unit.tree_batches) return batches_velocities(call, unit, scratch, tally);
    const bool packed = are_packed(call);
    const Way way = unit.elimination->way.forces;
    if (way == Way::network) return solve_networks(call, unit, packed, scratch, tally);
    if (way == Way::triangle)
        return for_each_triangle(TriangleVelocitiesVerb(call, tally), unit, packed, scratch, reads_columns(call));
    NextMolecules ahead = next_of(call);
    const LinearOfBlocks<VelocitiesCall> work = {call, *unit.elimination, way, packed, tally, unit.team, ahead};
    const StarVelocitiesVerb stars = {call, tally};
    if (way == Way::star && (do_stars<3>(stars, work, unit, scratch) || do_stars<4>(stars, work, unit, scratch)))
        return;
    for_each_block(unit, scratch, ahead, work);
}

void molecules_velocities(const VelocitiesCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    molecules_in_parts(call, unit, tally, [=](const VelocitiesCall &c, const MoleculeUnit &u, Tally &own) {
        velocities_of_blocks(c, u, scratch, own);
    });
}

}  // namespace holonomic::HOL_ISA
