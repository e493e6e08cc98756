// Constraints of a set of molecules as kernels of an accelerator solve them: their text, the arrays that they read, and
// how they are launched.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/device/precision.hpp"

namespace holonomic {
class Chains;
}

namespace holonomic::device {

struct Launch {
    std::string positions, velocities;  // names of kernels
    std::int64_t n_groups;
    int group_size;
};

struct KernelPlan {
    std::string source;
    std::vector<std::int32_t> integers;
    std::vector<unsigned char> numbers;  // floats or doubles, by the precision
    std::int64_t scratch_bytes;
    std::vector<std::int32_t> failures;  // whether there is any, and one for each molecule
    std::vector<Launch> launches;
    std::vector<std::int64_t> left;  // molecules for the host, counted as the caller does
};

// Molecules with more entries beside the diagonal of their matrix are solved by a work-group. The registers of one
// work-item on a GPU hold no more than a tree of some 32 bonds, and larger molecules are too few to fill it otherwise.
constexpr std::int64_t default_entries = 70, most_entries = 1000;

// Throws Error.
KernelPlan make_plan(const Chains &chains, Precision precision, std::int64_t max_entries);

}  // namespace holonomic::device
