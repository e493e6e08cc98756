/**
 * @file cuts.hpp
 * Where the kernels cut a chain, asked of the kernels' own headers: each number of lanes cuts in its own way.
 */
#ifndef STRESS_CUTS_HPP
#define STRESS_CUTS_HPP

#include <cstdint>
#include <vector>

namespace stress
{

/** Atoms at which two parts of a chain meet. */
struct cuts {
    std::vector<std::int64_t> segments;  ///< forces, velocities
    std::vector<std::int64_t> windows;   ///< positions, metric
};

constexpr int lane_counts[] = {1, 2, 4, 8, 16};
constexpr int n_lane_counts = 5;

/** Both are empty if a chain of so many bonds is not cut. */
cuts cuts_of_chain(int lanes, std::int64_t n_bonds);

/** Atoms, counted from its first, at which the segments of an arm of so many bonds meet. */
std::vector<std::int64_t> segments_of_arm(int lanes, std::int64_t n_bonds);

}  // namespace stress

#endif
