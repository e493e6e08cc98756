// Metric determinants, Fixman potential and its force.
#pragma once

#include "core/molecules/chains.hpp"

namespace holonomic {

// `call`: as of forces(); its kT, log_det and log_det_z [n_chains] or nullptr, too. energy: or nullptr. Throws Error
// once everything that is due has been written.
void metric(const Chains &chains, MetricCall &call, double *energy);

}  // namespace holonomic
