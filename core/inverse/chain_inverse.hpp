// The inverse of a linear chain, in time and memory proportional to its number of bonds.
#pragma once

#include <cstdint>
#include <vector>

#include "core/double_pair.hpp"
#include "core/inverse/inverse.hpp"

namespace holonomic {

class ChainInverse final : public Inverse {
public:
    ChainInverse(const Chains &chains, std::int64_t chain, const AtomArray &r);

    std::int64_t n_bonds() const override { return static_cast<std::int64_t>(n_); }
    double entry(bool physical, std::int64_t i, std::int64_t j) const override;
    void row(bool physical, std::int64_t i, double *out) const override;
    void band(bool physical, std::int64_t width, double *out) const override;
    void matrix(bool physical, double *out) const override;
    double condition() const override;
    std::vector<double> error_bound(const AtomArray &v, const AtomArray &f, const double *lambda) const override;

private:
    struct EliminatedBond {
        double l;  // of the elimination: couples it to the bond before, with the sign of their cosine; 0 for the first
        double l_rest;     // what |l| is more than its double
        DoublePair pivot;  // P of theory (26)
        double inverse;    // (M^-1)_kk
        double root;       // sqrt(M_kk)
        double length;     // |d_k|
    };
    class Walk;

    double scale(bool physical, std::size_t k) const;
    void multiply_by_absolute_inverse(std::vector<double> &x) const;
    bool touched(const AtomArray &v, const AtomArray &f, const double *lambda, std::size_t k) const;
    DoublePair residual(const AtomArray &v, const AtomArray &f, const double *lambda, std::size_t k,
                        double &terms) const;

    std::size_t n_;
    std::vector<std::int64_t> atoms_;  // [n+1]
    std::vector<double> w_;            // [n+1]
    std::vector<PairVector> d_;        // [n], exact differences of the coordinates
    std::vector<EliminatedBond> bonds_;
    double largest_row_;  // sum of absolute values in the largest row of Z~
};

}  // namespace holonomic
