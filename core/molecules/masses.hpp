// Inverse masses of the caller's atoms.
#ifndef HOLONOMIC_MASSES_HPP
#define HOLONOMIC_MASSES_HPP

#include <algorithm>
#include <cstdint>
#include <vector>

namespace holonomic {

class Masses {
public:
    // mass 0 or infinite: held fixed, w = 0. Throws Error naming the atom, counted from `base`.
    Masses(std::int64_t n_atoms, const double *masses, int base);

    double w(std::int64_t atom) const { return w_.empty() ? w_uniform_ : w_[static_cast<std::size_t>(atom)]; }
    bool fixed(std::int64_t atom) const { return w(atom) == 0; }
    // Whether it was given an infinite mass: a fixed atom that can be no massless site of a body.
    bool infinite(std::int64_t atom) const { return std::binary_search(infinite_.begin(), infinite_.end(), atom); }
    bool uniform() const { return w_.empty(); }
    std::int64_t n_movable() const;
    std::size_t bytes() const { return (w_.capacity() + infinite_.capacity()) * sizeof(double); }

private:
    std::int64_t n_atoms_;
    double w_uniform_ = 0;
    std::vector<double> w_;  // [n_atoms], empty if all are w_uniform_
    std::vector<std::int64_t> infinite_;
};

}  // namespace holonomic
#endif
