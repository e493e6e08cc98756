// Copies of rows where lanes end, for what reads whole chunks.
#pragma once

#include "core/kernels/memory/block.hpp"

namespace holonomic::HOL_ISA {

// Where lanes end: rows of the chunk from k0 on, padded with zeros, at places that begin at k0.
struct PaddedRows {
    double row[W][3 * W + 3];
    Packed rows;
    const Packed *take(const Block &block, const Packed &from, long k0) {
        constexpr long size = 3 * W + 3;
        for (int i = 0; i < W; ++i) {
            const long left = 3 * (block.len[i] + 1 - k0);
            const double *const x = from.lane[i] + 3 * k0;
            if (left >= size) {
                for (int j = 0; j < 3; ++j) store(row[i] + W * j, load(x + W * j));
                for (int j = 0; j < 3; ++j) row[i][3 * W + j] = x[3 * W + j];
            } else {
                for (int j = 0; j < 3; ++j) store(row[i] + W * j, vec{});
                for (int j = 0; j < 3; ++j) row[i][3 * W + j] = 0;
                for (long e = 0; e < left; e += 3)
                    for (int c = 0; c < 3; ++c) row[i][e + c] = x[e + c];
            }
            rows.lane[i] = reinterpret_cast<double *>(reinterpret_cast<uintptr_t>(row[i]) -
                                                      static_cast<uintptr_t>(3 * k0) * sizeof(double));
        }
        return &rows;
    }
};

}  // namespace holonomic::HOL_ISA
