// Means of powers of the metric determinant over the conformations of the freely jointed chain.
#pragma once

#include <cstdint>

namespace holonomic {

// Logarithms; only what is asked for is computed.
struct Partition {
    double he, rigid, volume;
};
struct PartitionAsked {
    bool means, volume;
};

// masses [n_bonds+1], 0 or infinity: fixed; nullptr: all equal. Throws Error.
Partition partition_function(std::int64_t n_bonds, const double *masses, const PartitionAsked &asked);

}  // namespace holonomic
