#include "Algorithm.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>

#include "openmm/OpenMMException.h"

using namespace OpenMM;

void OpenMM::ask(int status) {
    if (status != HOL_OK) throw OpenMMException(std::string("holonomic: ") + hol_error_message());
}

namespace {

// OpenMM's vectors are three doubles each, one after the other.
static_assert(sizeof(Vec3) == 3 * sizeof(double), "");
double *packed(std::vector<Vec3> &vectors) { return reinterpret_cast<double *>(vectors.data()); }

}  // namespace

HolonomicAlgorithm::HolonomicAlgorithm(const System &system, int nThreads) {
    std::vector<double> masses(system.getNumParticles());
    for (int i = 0; i < system.getNumParticles(); ++i) masses[i] = system.getParticleMass(i);
    if (std::all_of(masses.begin(), masses.end(), [](double mass) { return mass == 0; })) return;
    hol_chains *made = nullptr;
    ask(hol_chains_create(system.getNumParticles(), masses.data(), &made));
    molecules.reset(made);
    ask(hol_chains_set_threads(made, nThreads));
    // Lengths belong to the System, so that a wrong unit or order is not to be feared; and OpenMM's users apply
    // constraints to crude positions.
    ask(hol_chains_set_checks(made, HOL_NEVER));
    addConstraints(system);
}

void HolonomicAlgorithm::addConstraints(const System &system) {
    std::vector<std::int64_t> pairs;
    std::vector<double> lengths;
    for (int k = 0; k < system.getNumConstraints(); ++k) {
        int i, j;
        double length;
        system.getConstraintParameters(k, i, j, length);
        pairs.push_back(i);
        pairs.push_back(j);
        lengths.push_back(length);
    }
    if (lengths.empty()) return;
    ask(hol_chains_add_bonds(molecules.get(), static_cast<std::int64_t>(lengths.size()), pairs.data(), lengths.data()));
}

bool HolonomicAlgorithm::takeMasses(const std::vector<double> &inverse) {
    if (!molecules) return false;
    if (inverse.size() == inverseMasses.size() &&
        std::memcmp(inverse.data(), inverseMasses.data(), inverse.size() * sizeof(double)) == 0)
        return true;
    std::vector<double> masses(inverse.size());
    // Of a particle without mass OpenMM gives 0, or in some integrators 1/0: it stays in either case.
    for (std::size_t i = 0; i < inverse.size(); ++i) masses[i] = inverse[i] == 0 ? 0 : 1 / inverse[i];
    ask(hol_chains_set_masses(molecules.get(), masses.data()));
    inverseMasses = inverse;
    return true;
}

void HolonomicAlgorithm::apply(std::vector<Vec3> &reference, std::vector<Vec3> &positions, std::vector<double> &inverse,
                               double) {
    if (!takeMasses(inverse)) return;
    // The unit of time is that of a displacement: 1 leaves the multipliers, which nobody asks for, in a unit of their
    // own.
    const int status = hol_project_positions(molecules.get(), packed(reference), packed(positions), nullptr, 1, nullptr,
                                             0, nullptr, nullptr);
    // Context::applyConstraints: where nothing is known but crude positions, there is more that can be done.
    if (status != HOL_OK && &reference == &positions)
        ask(hol_impose(molecules.get(), packed(positions), nullptr));
    else
        ask(status);
}

void HolonomicAlgorithm::applyToVelocities(std::vector<Vec3> &positions, std::vector<Vec3> &velocities,
                                           std::vector<double> &inverse, double) {
    if (!takeMasses(inverse)) return;
    ask(hol_project_velocities(molecules.get(), packed(positions), packed(velocities), nullptr, nullptr));
}
