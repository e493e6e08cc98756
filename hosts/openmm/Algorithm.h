// The constraint algorithm that OpenMM's integrators call on the Reference and CPU platforms.
#ifndef OPENMM_HOLONOMIC_ALGORITHM_H_
#define OPENMM_HOLONOMIC_ALGORITHM_H_

#include <holonomic.h>

#include <memory>
#include <vector>

#include "ReferenceConstraintAlgorithm.h"
#include "openmm/System.h"

namespace OpenMM {

// Throws the library's message unless the status of a call is HOL_OK.
void ask(int status);

// Tolerances that OpenMM hands over are not looked at: results are right to their rounding.
class HolonomicAlgorithm : public ReferenceConstraintAlgorithm {
public:
    HolonomicAlgorithm(const System &system, int nThreads);

    void apply(std::vector<Vec3> &reference, std::vector<Vec3> &positions, std::vector<double> &inverseMasses,
               double tolerance) override;
    void applyToVelocities(std::vector<Vec3> &positions, std::vector<Vec3> &velocities,
                           std::vector<double> &inverseMasses, double tolerance) override;

    // For a platform that leaves some of the molecules to the library.
    hol_chains *chains() { return molecules.get(); }

private:
    void addConstraints(const System &system);
    // Gives whether there is anything that can move.
    bool takeMasses(const std::vector<double> &inverse);

    struct Destroy {
        void operator()(hol_chains *molecules) const { hol_chains_destroy(molecules); }
    };
    std::unique_ptr<hol_chains, Destroy> molecules;  // null: no particle has mass
    std::vector<double> inverseMasses;               // of the last call
};

}  // namespace OpenMM

#endif
