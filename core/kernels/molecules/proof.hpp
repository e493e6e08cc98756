// When a bound on what multipliers leave of the equations proves them right.
#pragma once

#include "core/kernels/molecules/molecules.hpp"

namespace holonomic::HOL_ISA::graph {

// The bound must be no more than this times an equation's terms, both in roundings. This is a part of the 16 + sqrt(n)
// roundings of the scale that count as right (tests/oracle/molecules/README.md), and no more than in trees
// (siblings.hpp).
HOL_INLINE double most_backward(int32_t n_bonds) {
    const double part = 0.5 * (16 + __builtin_sqrt(static_cast<double>(n_bonds)));
    return part < most_cancelled ? part : most_cancelled;
}
// Of large molecules all pivots and their reciprocals are below this, or their units are not ordinary: segments of arms
// do products of six.
constexpr double most_ordinary_pivot = 0x1p120;
// A pivot below this part of its diagonal element may come of bonds that depend on each other.
constexpr double least_proven_pivot = 1e-6;
// Below this it may be nothing but rounding; corrections don't show that if the right-hand side does not.
constexpr double least_pivot = 1e-10;

}  // namespace holonomic::HOL_ISA::graph
