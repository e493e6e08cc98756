/**
 * OpenMM's constraints in its reference platform (one thread, double precision), through Context::applyConstraints and
 * applyVelocityConstraints. They take the positions that they are given as the reference too, those after the drift,
 * instead of the ones before it as an integrator does; on coils the work is the same.
 */
#ifndef BENCH_METHODS_OPENMM_CONSTRAINTS_HPP
#define BENCH_METHODS_OPENMM_CONSTRAINTS_HPP

#include <array>
#include <vector>

#include "../method.hpp"

namespace bench {

/// All that OpenMM is told of a scene: one System with all molecules, as in a simulation.
struct OpenmmInput {
    std::vector<double> mass;  ///< [atoms]
    std::vector<std::array<int, 2>> pairs;
    std::vector<double> length;
    std::vector<std::array<int, 3>> angles;  ///< the middle atom in the middle; so that its CCMA knows the angles
    std::vector<double> angle;
    std::size_t molecules_done = 0;  ///< how many of the scene's these are, from the first on
};

/// One method per tolerance, all with the same Context.
Methods openmm_methods(const std::string &name, Level level, const Scene &p, const OpenmmInput &input,
                       const std::vector<double> &tolerances, const std::string &note);

/// The angle at b.
double angle_between(const double *a, const double *b, const double *c);

}  // namespace bench

#endif
