// The kernels of a System's molecules on a device, and the arrays that they read.
#ifndef OPENMM_HOLONOMIC_LAUNCHES_H_
#define OPENMM_HOLONOMIC_LAUNCHES_H_

#include <vector>

#include "Kinds.h"
#include "openmm/common/ComputeArray.h"
#include "openmm/common/ComputeContext.h"
#include "openmm/common/ComputeKernel.h"

namespace OpenMM {

class Launches {
public:
    Launches(ComputeContext &device, const std::vector<MoleculesOfKind> &sorted,
             const std::vector<double> &inverseMasses);

    bool empty() const { return launches.empty(); }
    // Of positions, or of velocities; by the number of the call, from 1 on, molecules that fail are remembered.
    void execute(bool toVelocities, int call);
    // The molecules that failed in the first call in which one did, by their slots; forgets them.
    std::vector<int> failedSlots(int &firstCall);
    // Of the slot's molecule: its place in the device's arrays.
    int firstAtom(int slot) const { return beginnings[slot]; }

private:
    struct Data;  // of the arrays below, as they are gathered
    void takeGroups(const MoleculesOfKind &some, int kind, Data &data);
    void takeBlocks(const MoleculesOfKind &some, bool inLocalMemory, Data &data);
    int takeParameters(const Molecule &molecule, int slot, Data &data);
    void allocate(const Data &data);
    void addLaunch(const ComputeKernel &positions, const ComputeKernel &velocities, int firstSlot, int lastSlot,
                   int threadsOfSlot, int blockSize, const std::vector<ArrayInterface *> &own);
    void launchGroups(const std::vector<MoleculesOfKind> &sorted, std::size_t first, std::size_t last);
    void launchBlocks(const std::vector<MoleculesOfKind> &sorted, std::size_t first, std::size_t last,
                      bool inLocalMemory);

    ComputeContext &context;
    const std::vector<double> &inverseMasses;
    std::vector<int> beginnings;  // the first atom of each slot's molecule; -1: none
    ComputeArray groups, atoms, parameters, failures, anyFailure;
    ComputeArray blocks, plans, mixedScratch, realScratch;
    int firstBlock = 0;  // the slot of the first molecule that a block solves
    struct Launch {
        ComputeKernel positions, velocities;
        int firstSlot, lastSlot, threadsOfSlot, blockSize;
        const ComputeKernel &kernel(bool ofVelocities) const { return ofVelocities ? velocities : positions; }
    };
    std::vector<Launch> launches;
};

}  // namespace OpenMM

#endif
