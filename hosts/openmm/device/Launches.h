// The kernels of the library's plan on a device, and the arrays that they read.
#ifndef OPENMM_HOLONOMIC_LAUNCHES_H_
#define OPENMM_HOLONOMIC_LAUNCHES_H_

#include <holonomic.h>

#include <cstdint>
#include <vector>

#include "openmm/common/ComputeArray.h"
#include "openmm/common/ComputeContext.h"
#include "openmm/common/ComputeKernel.h"

namespace OpenMM {

class Launches {
public:
    Launches(ComputeContext &device, const hol_chains *chains);

    bool empty() const { return launches.empty(); }
    // Molecules that the plan leaves to the host.
    const std::vector<std::int64_t> &leftToHost() const { return left; }
    // Of positions, or of velocities; by the number of the call, from 1 on, molecules that fail are remembered.
    void execute(bool toVelocities, int call);
    // The molecules that failed in the first call in which one did; forgets them.
    std::vector<std::int64_t> failedMolecules(int &firstCall);

private:
    void allocate(const hol_device_plan *plan);
    void create(const hol_device_plan *plan);
    ComputeKernel kernel(const ComputeProgram &program, const char *name, ArrayInterface &state);

    ComputeContext &context;
    ComputeArray integers, numbers, scratch, failures;
    std::vector<std::int64_t> left;
    struct Launch {
        ComputeKernel positions, velocities;
        int nThreads, blockSize;
    };
    std::vector<Launch> launches;
};

}  // namespace OpenMM

#endif
