/**
 * From a chain to the tridiagonal system that its multipliers obey, and back: what every direct solver needs around it.
 * Z_kk = 4 (w_{k-1} + w_k) d_k.d_k, Z_{k,k+1} = -4 w_k d_k.d_{k+1}.
 */
#ifndef BENCH_METHODS_TRIDIAGONAL_SYSTEM_HPP
#define BENCH_METHODS_TRIDIAGONAL_SYSTEM_HPP

#include <functional>
#include <vector>

#include "../method.hpp"
#include "../problem.hpp"

namespace bench {

/// A symmetric positive definite tridiagonal system; a solver may overwrite the matrix and leaves the solution in x.
struct System {
    std::vector<double> diagonal, beside, x;
    std::vector<double> d;  ///< bond vectors [n][3]
    explicit System(std::size_t n) : diagonal(n), beside(n), x(n), d(3 * n) {}
    int size() const { return static_cast<int>(diagonal.size()); }
};

/// Solves in place.
using Solver = std::function<void(System &)>;

/// Fills d and the matrix from positions [n+1][3].
void assemble_matrix(const Problem &p, const double *r, System &s);

/// Right side K + C.
void assemble_forces(const Problem &p, const double *v, const double *f, System &s);

/// G_i = 2 (lambda_{i+1} d_{i+1} - lambda_i d_i).
void apply_forces(const System &s, double *g);

/// Acceleration level with the given solver.
Method direct_forces(const Problem &p, const std::string &name, const std::string &setting, Solver solver);

/// Velocity level with the given solver.
Method direct_velocities(const Problem &p, const std::string &name, const std::string &setting, Solver solver);

/// Level solve: the systems of all chains with ones on the diagonal, gamma = -Z~_{k-1,k}, made once from the problem.
struct UnitSystems {
    std::vector<double> gamma;       ///< [chains][n]: gamma_k couples bonds k-1 and k; the first is 0
    std::vector<double> right_side;  ///< [chains][n]
    explicit UnitSystems(const Problem &p);
};

Method direct_solve(const Problem &p, const UnitSystems &systems, const std::string &name, const std::string &setting,
                    Solver solver);

/// Level metric: ln det Z~ from the pivots of a factorization of the matrix scaled to ones on its diagonal.
using LogDeterminant = std::function<double(System &)>;
Method direct_metric(const Problem &p, const std::string &name, const std::string &setting, LogDeterminant log_det);

}  // namespace bench

#endif
