// What a platform that keeps its coordinates on a device registers, to solve constraints there.
#ifndef OPENMM_HOLONOMIC_DEVICEKERNEL_H_
#define OPENMM_HOLONOMIC_DEVICEKERNEL_H_

#include <string>

#include "HolonomicConstraints.h"
#include "openmm/KernelImpl.h"
#include "openmm/internal/ContextImpl.h"

namespace OpenMM {

class HOLONOMIC_OPENMM_EXPORT HolonomicDeviceKernel : public KernelImpl {
public:
    static std::string Name() { return "HolonomicConstraints"; }
    explicit HolonomicDeviceKernel(const Platform &of) : KernelImpl(Name(), of) {}

    // Takes the place of the platform's own constraints.
    virtual void initialize(ContextImpl &context, int nThreads) = 0;
    // Forces are computed: an occasion to tell of molecules that could not be solved. With the energy the host waits
    // for the device anyway.
    virtual void forcesAreComputed(bool withEnergy) = 0;
};

}  // namespace OpenMM

#endif
