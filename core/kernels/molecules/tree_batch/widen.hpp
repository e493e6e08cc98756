// Makes the lists of a batch of trees from its stored numbers, each time that it is worked on: less is read from
// memory.
#pragma once

#include "core/kernels/isa/lanes.hpp"
#include "core/plan/tree_batch.hpp"

namespace holonomic::HOL_ISA::graph {

static inline int64_t open_bytes(const TreeBatch &f) { return f.stored ? (4 * f.n_numbers(W) + 63) / 64 * 64 : 0; }

// Takes open_bytes() of the scratch.
HOL_NOINLINE TreeBatch open_batch(const TreeBatch &stored, double *&scratch) {
    TreeBatch f = stored;
    if (!f.stored) return f;
    int32_t *const number = reinterpret_cast<int32_t *>(scratch);
    const int64_t n = f.n_numbers(W);
    for (int64_t i = 0; i < n; ++i) number[i] = stored.stored[i];
    f.point_into(number, W);
    scratch += open_bytes(stored) / static_cast<int64_t>(sizeof(double));
    return f;
}

}  // namespace holonomic::HOL_ISA::graph
