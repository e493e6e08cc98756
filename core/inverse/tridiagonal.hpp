// The symmetric tridiagonal matrix with ones on its diagonal and -gamma beside it, known by gamma alone.
#pragma once

#include <cstdint>
#include <vector>

#include "core/double_pair.hpp"

namespace holonomic {

// By plain products where these are sure of the last digits, else as Tridiagonal has it. x may be b; on an Error
// nothing is written.
void tridiagonal_pivots(std::int64_t n, const double *gamma, double *omega2);
double tridiagonal_log_det(std::int64_t n, const double *gamma);
void tridiagonal_solve(std::int64_t n, const double *gamma, const double *b, double *x);

// Elimination from the first row on, in twice the precision: without the bonds there is no form without subtractions,
// so the digits that they cost are carried along. Throws Error.
class Tridiagonal {
public:
    Tridiagonal(std::int64_t n, const double *gamma);  // gamma [n-1], used by the functions, too

    void pivots(double *omega2) const;
    double log_det() const;
    void solve(const double *b, double *x) const;
    double inverse_entry(std::int64_t i, std::int64_t j) const;
    void inverse_band(std::int64_t width, double *band) const;

private:
    DoublePair gamma(std::size_t k) const { return as_pair(gamma_[k - 1]); }  // between rows k-1 and k
    DoublePair factor(std::size_t k) const { return gamma(k) / omega2_[k - 1]; }
    std::vector<double> inverse_diagonal() const;

    std::size_t n_;
    const double *gamma_;
    std::vector<DoublePair> omega2_;
};

}  // namespace holonomic
