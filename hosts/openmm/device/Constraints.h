// The constraints of a System on a device: kernels, and the library for what they leave.
#ifndef OPENMM_HOLONOMIC_DEVICE_CONSTRAINTS_H_
#define OPENMM_HOLONOMIC_DEVICE_CONSTRAINTS_H_

#include <cstdint>
#include <memory>
#include <vector>

#include "../Algorithm.h"
#include "Launches.h"
#include "openmm/common/ComputeContext.h"

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
    void findMolecules();
    void findAtoms();
    // The molecule that is now where the plan has this one.
    std::int64_t nowAt(std::int64_t number) const;
    void solveOnHost(bool toVelocities, const std::vector<std::int64_t> &which);

    ComputeContext &context;
    HolonomicAlgorithm host;
    std::vector<double> inverseMasses;
    // Molecules by the numbers that the library has given them.
    std::vector<std::int64_t> left;        // for the host
    std::vector<std::int64_t> moleculeOf;  // of each atom that can move; else any or -1
    std::vector<int> anyAtom;              // of each molecule, one that can move
    std::vector<int> atomOf;               // the atom that stands at each place of the device's arrays
    std::unique_ptr<Launches> launches;
    long long firstStep = 0;  // since the last check
};

}  // namespace OpenMM

#endif
