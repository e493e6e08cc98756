// The constraints of a System on a device: kernels, and the library for what they leave.
#ifndef OPENMM_HOLONOMIC_DEVICE_CONSTRAINTS_H_
#define OPENMM_HOLONOMIC_DEVICE_CONSTRAINTS_H_

#include <cstdint>
#include <functional>
#include <vector>

#include "../Algorithm.h"
#include "Kinds.h"
#include "openmm/common/ComputeArray.h"
#include "openmm/common/ComputeContext.h"
#include "openmm/common/ComputeKernel.h"

namespace OpenMM {

class DeviceConstraints {
public:
    DeviceConstraints(ComputeContext &device, const System &system, int nThreads);

    // Of positions: what IntegrationUtilities::getPosDelta() adds to them; of velocities: the velocities. In a step
    // nothing is waited for, unless there are molecules for the host. Outside of one, in Context::applyConstraints,
    // what the device can't solve is left to the library.
    void apply(bool toVelocities);
    // Waits for the device and throws if a molecule could not be solved since the last time.
    void check();

    bool outsideOfSteps = false;

private:
    void findAtoms();
    void addLaunch(const std::vector<MoleculesOfKind> &sorted, std::size_t first, std::size_t last, int firstSlot);
    void takeMolecules(const System &system, const std::vector<MoleculesOfKind> &sorted);
    void allocate(const std::vector<mm_int2> &groupData, const std::vector<int> &atomData,
                  const std::vector<double> &parameterData);
    // The molecules that failed in the first call in which one did, by their slots; forgets them.
    std::vector<int> failedSlots(int &firstCall);
    // The molecule that is now where the one of the slot began.
    std::int64_t moleculeIn(int slot) const;
    void solveOnHost(bool toVelocities, const std::vector<std::int64_t> &which);

    ComputeContext &context;
    HolonomicAlgorithm host;
    std::vector<double> inverseMasses;
    // Molecules by the numbers that the library has given them.
    std::vector<std::int64_t> left;        // for the host
    std::vector<std::int64_t> moleculeOf;  // of each atom; of those that are not for the device -1
    std::vector<int> beginnings;           // of the molecules on the device, by slot: a place in its arrays; -1: none
    std::vector<int> atomOf;               // the atom that stands at each place of the device's arrays
    ComputeArray groups, atoms, parameters, failures, anyFailure;
    struct Launch {
        ComputeKernel positions, velocities;
        int firstSlot, lastSlot;
        const ComputeKernel &kernel(bool ofVelocities) const { return ofVelocities ? velocities : positions; }
    };
    std::vector<Launch> launches;
    long long firstStep = 0;  // since the last check
};

}  // namespace OpenMM

#endif
