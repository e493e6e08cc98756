/**
 * All methods. Each is in a file of its own name; every one works through all chains of the problem in a call.
 */
#ifndef BENCH_METHODS_METHODS_HPP
#define BENCH_METHODS_METHODS_HPP

#include "tridiagonal_system.hpp"

namespace bench {

// The library: holonomic*.cpp. Each returns the whole work of the level first, then what its settings change.
Method holonomic(Level level, const Problem &p, int threads = 1);
Method holonomic_tolerance(const Problem &p, double tolerance);
Method holonomic_solve(const Problem &p, const UnitSystems &systems);
/// The whole work with one thing less or more at a time.
Methods holonomic_skips(Level level, const Problem &p);
/// Accelerations with NULL for v or f, of a problem in which they are zero.
Method holonomic_without(const Problem &p, bool v, bool f);
/// Of a problem in the plane z = 0, on arrays without a z.
Method holonomic_flat(Level level, const Problem &p);

// Packages.
bool have_lapack();
Solver lapack_dptsv();
Solver lapack_dgtsv();
Solver eigen_ldlt();
Solver eigen_simplicial();
LogDeterminant eigen_ldlt_log_det();
LogDeterminant eigen_simplicial_log_det();
bool have_openmm();
/// Level position or velocity, a method per tolerance. With angles: OpenMM is told the exact angles between
/// neighbouring bonds, its best case.
Methods openmm_ccma(Level level, const Problem &p, const std::vector<double> &tolerances, bool angles);

// Textbook algorithms, written here.
/// SHAKE sweeps (position) or RATTLE's sweeps over velocities until every bond is within the tolerance.
Method rattle(Level level, const Problem &p, double tolerance);
/// Newton-like iteration with the tridiagonal matrix of the first iterate kept, solved by dgtsv each time.
Method milc_shake(const Problem &p, double tolerance);
Method lincs(const Problem &p, int order, int iterations);
/// Newton's method with a sparse factorization for molecules of any shape.
Method sparse_newton(const Problem &p, double tolerance);
/// The paper's explicit inverse, element by element, O(N^2).
Solver eq20();
/// The recursion for Omega as printed, with the factors of Eqs. (9) and (24) put right.
Solver omega_recursion();
LogDeterminant omega_recursion_log_det();
/// Level acceleration: the same elimination without the scaling, i.e. an L D L^T of Z, as one inlined scalar sweep.
Method scalar_sweep(const Problem &p);

}  // namespace bench

#endif
