// The table through which core calls the kernels of one instruction set.
#include "core/kernels/eliminate/segment.hpp"
#include "core/kernels/extended/chain.hpp"
#include "core/kernels/isa/lanes.hpp"
#include "core/kernels/memory/arena.hpp"
#include "core/kernels/memory/cut.hpp"
#include "core/kernels/verbs/verbs.hpp"

#define HOL_STRING_OF(name) #name
#define HOL_STRING(name) HOL_STRING_OF(name)

namespace holonomic::HOL_ISA {

static_assert(W <= most_lanes, "Box and the alignment of a thread's memory are made for fewer lanes");

// the extended-precision solver's memory stands behind that of a block.
static int64_t scratch_bytes(int64_t n_bonds) {
    return scratch_doubles(n_bonds) * static_cast<int64_t>(sizeof(double)) + extended::chain_scratch_bytes(n_bonds);
}

#ifndef HOL_CHAINS_ONLY
static int64_t long_blocks(int64_t n_bonds) { return Cut(n_bonds).blocks; }
#endif

extern const Kernels kernels;
const Kernels kernels = {
    HOL_STRING(HOL_ISA),
    W,
    HOL_HAS_FMA != 0,
    scratch_bytes,
    scratch_doubles(longest_cut) * static_cast<int64_t>(sizeof(double)),
    forces,
    velocities,
    positions,
    metric,
#ifndef HOL_CHAINS_ONLY
    {long_blocks, long_bytes, long_forces_eliminate, long_join, long_forces_finish},
    {long_blocks, long_bytes, long_velocities_eliminate, long_join, long_velocities_finish},
    {long_blocks, long_positions_bytes, long_positions},
    {long_blocks, long_metric_bytes, long_metric},
    {molecules_scratch_bytes, batch_scratch_bytes, molecules_forces, molecules_velocities, molecules_positions,
     molecules_metric, molecules_solve},
    {tridiagonal_solve, tridiagonal_pivots},
    {bodies_scratch_bytes, bodies_forces, bodies_velocities, bodies_positions},
    {keep_chains, solve_kept_chains, is_kept, kept_scratch_bytes, keep_molecules, solve_kept_molecules},
#else
    {},
    {},
    {},
    {},
    {},
    {},
    {},
    {keep_chains, solve_kept_chains, nullptr, nullptr, nullptr, nullptr},
#endif
};

}  // namespace holonomic::HOL_ISA
