// All kernels of one instruction set; the including file defines HOL_ISA, HOL_LANES and HOL_NAME.
#include "call.hpp"
#include "compensated.hpp"
#include "lanes.hpp"

#include "block.inl"
#include "recursion.inl"
#include "forces.inl"
#include "velocities.inl"
#include "positions.inl"

namespace holonomic {
namespace HOL_ISA {

// Interleaved vectors per bond that the greediest kernel takes, staging included.
constexpr int64_t vectors_per_bond = 40;

static int64_t scratch_bytes(int64_t n_bonds) {
    return static_cast<int64_t>(sizeof(vec)) * vectors_per_bond * (n_bonds + 2 * W + 8);
}

extern const Kernels kernels;
const Kernels kernels = {HOL_NAME, W, scratch_bytes, forces, velocities, positions};

}  // namespace HOL_ISA
}  // namespace holonomic
