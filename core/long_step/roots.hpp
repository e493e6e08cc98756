// Which multipliers a long step has. Lengths are quadratic in them, so there may be several roots. At most one has a
// positive definite symmetric part of the Jacobian D_k.W_kl b_l: with D and D' of two roots, (D + D')_k.(D - D')_k = 0,
// so that the sum of their Jacobians is singular. For short steps it is that of the reference itself, and the one that
// a path from there comes to.
#pragma once

#include <vector>

#include "core/long_step/one_molecule.hpp"

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

    // The root that the reference's, where all are 0, becomes on the way to the positions as they are. False where the
    // path has an end before, or takes more than `most` solutions by the kernels. Adds to `solves`.
    bool follow(OneMolecule &one, std::int64_t most, std::vector<double> &tau, std::int64_t &solves) const;

    // What SHAKE comes to, bond after bond along the reference, within so many rounds.
    bool shake(std::int64_t rounds, std::vector<double> &tau) const;

private:
    struct Vector {
        double x, y, z;
    };
    static double dot(const Vector &a, const Vector &b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
    std::vector<std::int64_t> first_of_rows() const;
    std::vector<Vector> moved(const std::vector<double> &tau) const;  // D
    bool lay_out(const std::vector<Vector> &bonds, std::vector<double> &atoms) const;

    const Molecule &m_;
    std::vector<Vector> b_, D_;
    double error_ = 0;
};

}  // namespace holonomic
