// Constraints of an OpenMM System, solved by holonomic: a Force that adds none, but takes the place of the constraint
// algorithms when a Context is made. System::addForce(new HolonomicConstraints()) is all that a program does.
#ifndef OPENMM_HOLONOMICCONSTRAINTS_H_
#define OPENMM_HOLONOMICCONSTRAINTS_H_

#include "openmm/Force.h"

#if defined(__GNUC__)
#define HOLONOMIC_OPENMM_EXPORT __attribute__((visibility("default")))
#else
#define HOLONOMIC_OPENMM_EXPORT
#endif

namespace OpenMM {

class HOLONOMIC_OPENMM_EXPORT HolonomicConstraints : public Force {
public:
    // threads: how many threads one call may use. Worth it from some ten thousand constraints on.
    explicit HolonomicConstraints(int threads = 1);

    int getNumThreads() const { return nThreads; }

    // Constraints are within molecules, and OpenMM keeps their coordinates whole.
    bool usesPeriodicBoundaryConditions() const override { return false; }

protected:
    ForceImpl *createImpl() const override;

private:
    int nThreads;
};

}  // namespace OpenMM

// For programs that know a System by its address alone, as Python does. Returns the index of the Force in the System.
extern "C" HOLONOMIC_OPENMM_EXPORT int holonomicOpenMMAdd(void *system, int nThreads);

#endif
