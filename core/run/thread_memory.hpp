// Memory that a thread keeps from call to call, until it ends.
#pragma once

#include <cstdint>

namespace holonomic {

enum class Keep {
    scratch,
    store,
    chunk_tallies,
    block_tallies,
    staging,
    right_hand_sides,
    multipliers,
    reference,
    rigid,
    outcomes,
    rescaled,
    factors,
    rhs_of_factors,
    arrays_of_factors,
    last
};

// At least `bytes` of the calling thread's memory for this purpose, aligned to 64; its contents are lost when it has to
// grow. Null if there is no memory.
void *thread_memory(Keep what, std::int64_t bytes) noexcept;

}  // namespace holonomic
