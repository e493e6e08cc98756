// All kernels of one instruction set; the including file defines HOL_ISA, HOL_LANES and HOL_NAME.
#include "call.hpp"
#include "compensated.hpp"
#include "lanes.hpp"

#include "block.inl"
#include "load.inl"
#include "store.inl"
#include "recursion.inl"
#include "solve.inl"
#include "pulls.inl"
#include "gathered.inl"
#include "forces.inl"
#include "velocities.inl"
#include "newton_sweeps.inl"
#include "newton.inl"
#include "positions_arrays.inl"
#include "solve_positions.inl"
#include "positions_gathered.inl"
#include "positions.inl"
#include "molecules.inl"
#include "molecules_positions.inl"
#include "metric.inl"
#include "segments_cut.inl"
#include "segments_load.inl"
#include "segments.inl"
#include "segments_join.inl"
#include "segments_forces.inl"
#include "segments_newton.inl"
#include "segments_steps.inl"
#include "segments_positions.inl"
#include "positions_windows.inl"
#include "metric_segments.inl"
#include "careful/linear.cpp"
#include "careful/positions.cpp"

namespace holonomic {
namespace HOL_ISA {

// Interleaved vectors per bond that the greediest kernel takes, staging included.
constexpr int64_t vectors_per_bond = 40;

static int64_t scratch_bytes(int64_t n_bonds) {
    return static_cast<int64_t>(sizeof(vec)) * vectors_per_bond * (n_bonds + 2 * W + 8);
}

static int64_t long_blocks(int64_t n_bonds) { return Cut(n_bonds).blocks; }

extern const Kernels kernels;
const Kernels kernels = {
    HOL_NAME,
    W,
    scratch_bytes,
    forces,
    velocities,
    positions,
    metric,
    {long_blocks, long_bytes, long_forces_eliminate, long_join, long_forces_finish},
    {long_blocks, long_bytes, long_velocities_eliminate, long_join, long_velocities_finish},
    {long_blocks, long_positions_bytes, long_positions_load, long_positions_guess, long_positions_forget,
     long_positions_factorize, long_positions_join, long_positions_step, long_positions_pull, long_positions_finish,
     long_positions_windows, long_positions_window, long_positions_windows_fit, long_positions_finish_window},
    {long_blocks, long_metric_bytes, long_metric_map, long_metric_join, long_metric_finish},
};

}  // namespace HOL_ISA
}  // namespace holonomic
