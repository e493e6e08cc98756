// A DeviceConstraints in the place of a platform's SETTLE, SHAKE and CCMA.
#ifndef OPENMM_HOLONOMIC_STANDIN_H_
#define OPENMM_HOLONOMIC_STANDIN_H_

#include <memory>

#include "Constraints.h"

namespace OpenMM {

void putInPlace(ComputeContext &context, const std::shared_ptr<DeviceConstraints> &constraints);
// What has been put there, or null.
DeviceConstraints *inPlace(ComputeContext &context);

}  // namespace OpenMM

#endif
