// Metric determinants, Fixman potential and its force.
#pragma once

#include "core/molecules/chains.hpp"

namespace holonomic {

// log_det, log_det_z [n_chains], energy: or nullptr. Throws Error once everything that is due has been written.
void metric(const Chains &chains, const AtomArray &r, double kT, double *log_det, double *log_det_z, double *energy,
            const AtomArray &force, bool add);

}  // namespace holonomic
