/**
 * The methods for molecules of any topology. Each works through all molecules of a scene in a call.
 */
#ifndef BENCH_METHODS_GRAPH_METHODS_HPP
#define BENCH_METHODS_GRAPH_METHODS_HPP

#include "../method.hpp"
#include "../molecules/molecules.hpp"

namespace bench {

/// The library's whole work of a level: holonomic_molecules.cpp.
Method holonomic(Level level, const Molecules &m, int threads = 1);
Method holonomic_tolerance(const Molecules &m, double tolerance);
/// The same with the bonds of each molecule given in random order, either atom first.
Method holonomic_any_order(Level level, const Molecules &m);
/// The library on its own linear chains instead, as many and with as many bonds, general masses over one decade.
Method holonomic_chains_instead(Level level, const Molecules &m);

/// SHAKE or RATTLE sweeps over the bonds of a molecule until all are within the tolerance.
Method graph_rattle(Level level, const Molecules &m, double tolerance);
/// Newton's method, the unsymmetric Jacobian factored along a list made once per kind.
Method graph_newton(const Molecules &m, double tolerance);
/// The symmetric matrix of the reference positions factored once per step and kept: the quasi-Newton way.
Method graph_quasi_newton(const Molecules &m, double tolerance);
Method graph_lincs(const Molecules &m, int order, int iterations);
/// Accelerations or velocities by L D L^T along a list made once per kind.
Method graph_direct(Level level, const Molecules &m);
/// The same by Eigen's simplicial L D L^T, the pattern analysed once per kind.
Method graph_eigen(Level level, const Molecules &m);
/// Rigid water alone: positions with the velocities they imply, or velocities.
Method settle(Level level, const Molecules &m);
/// OpenMM's reference platform, told the exact angles; SETTLE for water, CCMA for all else. A method per tolerance.
Methods openmm(Level level, const Molecules &m, const std::vector<double> &tolerances);
/// Bonds of a scene that OpenMM leaves to CCMA, which takes a time for its preparation that grows as their square.
std::size_t openmm_ccma_bonds(const Molecules &m);

}  // namespace bench

#endif
