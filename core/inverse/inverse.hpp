// The inverse of the matrix Z of one chain in one conformation: elements on demand, condition number, error bounds.
#ifndef HOLONOMIC_INVERSE_HPP
#define HOLONOMIC_INVERSE_HPP

#include <cstdint>
#include <vector>

#include "core/double_pair.hpp"
#include "core/molecules/chains.hpp"

namespace holonomic {

class Inverse {
public:
    // Throws Error if the chain's data are bad.
    Inverse(const Chains &chains, std::int64_t chain, const AtomArray &r);

    std::int64_t n_bonds() const { return static_cast<std::int64_t>(n_); }
    int base() const { return base_; }

    // Bonds are counted from 0; physical: of Z, otherwise of Z~.
    double entry(bool physical, std::int64_t i, std::int64_t j) const;
    void row(bool physical, std::int64_t i, double *out) const;
    void band(bool physical, std::int64_t width, double *out) const;
    void matrix(bool physical, double *out) const;
    double condition() const;

    // |lambda_k - exact| <= bound[k]. Throws Error if something is not finite.
    std::vector<double> error_bound(const AtomArray &v, const AtomArray &f, const double *lambda) const;

private:
    struct Bond {
        double l;  // of the elimination: couples it to the bond before, with the sign of their cosine; 0 for the first
        double pivot;    // P of theory (26)
        double inverse;  // (M^-1)_kk
        double root;     // sqrt(M_kk)
        double length;   // |d_k|
    };
    class Walk;

    void check(std::int64_t i) const;
    double scale(bool physical, std::size_t k) const;
    void multiply_by_absolute_inverse(std::vector<double> &x) const;
    bool touched(const AtomArray &v, const AtomArray &f, const double *lambda, std::size_t k) const;
    DoublePair residual(const AtomArray &v, const AtomArray &f, const double *lambda, std::size_t k,
                        double &terms) const;

    std::size_t n_;
    int base_;
    std::vector<std::int64_t> atoms_;  // [n+1]
    std::vector<double> w_;            // [n+1]
    std::vector<PairVector> d_;        // [n], exact differences of the coordinates
    std::vector<Bond> bonds_;
    double largest_row_;  // sum of absolute values in the largest row of Z~
};

}  // namespace holonomic
#endif
