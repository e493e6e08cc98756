// Position level: Newton's method back onto the constraints.
#pragma once

#include "core/check.hpp"
#include "core/molecules/chains.hpp"
#include "core/reference_error.hpp"

namespace holonomic {

// What a projection of positions did; chain and bond as the caller counts them, -1 if there is none.
struct Report {
    std::int64_t iterations, n_corrected, n_failed, chain, bond;
    double max_error;
    bool made;  // false: the call failed before it did anything
};

// `call`: with arrays, lambda, dt and guess, the rest is filled in (core/forces.hpp). `bonds`: vectors [n_bonds] to
// project along in place of those of call.r_ref, or nullptr. virial [9], report: or nullptr. The error that the
// reference has is told where it is compared with the lengths, and with a report where nothing else is compared. Throws
// Error once everything that is due has been written.
void project_positions(const Chains &chains, PositionsCall &call, const AtomArray *bonds, double *virial,
                       Report *report, ReferenceError &reference_error);

}  // namespace holonomic
