// Which multipliers a long step has. Lengths are quadratic in them, so there may be several roots. At most one has a
// positive definite symmetric part of the Jacobian D_k.W_kl b_l: with D and D' of two roots, (D + D')_k.(D - D')_k = 0,
// so that the sum of their Jacobians is singular. For short steps it is that of the reference itself, and the one that
// a path from there comes to.
#pragma once

#include <vector>

#include "core/molecules/chains.hpp"

namespace holonomic {

// The bonds of one molecule in a step, in doubles. tau is 2 dt^2 lambda.
class StepBonds {
public:
    StepBonds(const Molecule &molecule, const AtomArray &r_ref, const Box &box_ref, const AtomArray &r, const Box &box);

    // The largest |D.D - a^2| / a^2; NaN stays one.
    double error() const { return error_; }
    // By how much of its length a bond differs at most between two sets of multipliers.
    double distance(const std::vector<double> &tau, const std::vector<double> &other) const;

    // Whether it is the one root of a positive definite symmetric part. Of molecules with very many cycles it is not
    // known.
    bool is_certified(const std::vector<double> &tau) const;

    // The root that the reference's, where all are 0, becomes on the way to the positions as they are: of bonds
    // b + t (D - b) and squares of lengths between b.b and a^2. To 1e-9. False where the path has an end before, or
    // `most` points are not enough. Adds to `solves`.
    bool follow(std::int64_t most, std::vector<double> &tau, std::int64_t &solves) const;

    // What SHAKE comes to, bond after bond along the reference, within so many rounds.
    bool shake(std::int64_t rounds, std::vector<double> &tau) const;

private:
    struct BondVector {
        double x, y, z;
    };
    static double dot(const BondVector &a, const BondVector &b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
    struct EnvelopeFactors {
        std::vector<double> low, up;
    };
    std::vector<BondVector> moved(const std::vector<double> &tau, double part) const;  // bonds at this part of the path
    void make_rows();
    bool has_rows() const { return !coupling_.empty(); }
    std::size_t entry(std::int64_t k, std::int64_t l) const {
        const std::size_t row = static_cast<std::size_t>(k);
        return static_cast<std::size_t>(start_[row] + l - first_[row]);
    }
    void solve(const std::vector<BondVector> &D, std::vector<double> &x, EnvelopeFactors &f) const;
    bool correct(double part, std::vector<double> &tau, std::int64_t &solves, EnvelopeFactors &f) const;

    const Molecule &m_;
    std::vector<BondVector> b_, D_;
    double error_ = 0;
    // Bonds of which row k may have elements: first_[k] .. k, from start_[k] on; W of these. Empty: too many.
    std::vector<std::int64_t> first_, start_;
    std::vector<double> coupling_;
};

}  // namespace holonomic
