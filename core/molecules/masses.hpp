// Inverse masses of the caller's atoms.
#ifndef HOLONOMIC_MASSES_HPP
#define HOLONOMIC_MASSES_HPP

#include <cstdint>
#include <vector>

namespace holonomic {

class Masses {
public:
    // mass 0 or infinite: held fixed, w = 0. Throws Error naming the atom, counted from `base`.
    Masses(std::int64_t n_atoms, const double *masses, int base);

    double w(std::int64_t atom) const { return w_.empty() ? w_uniform_ : w_[static_cast<std::size_t>(atom)]; }
    bool fixed(std::int64_t atom) const { return w(atom) == 0; }
    bool uniform() const { return w_.empty(); }
    std::int64_t n_movable() const;
    std::size_t bytes() const { return w_.capacity() * sizeof(double); }

private:
    std::int64_t n_atoms_;
    double w_uniform_ = 0;
    std::vector<double> w_;  // [n_atoms], empty if all are w_uniform_
};

}  // namespace holonomic
#endif
