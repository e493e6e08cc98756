// The caller's masses, to their last digit: bodies need them as they are, and 1 / (1 / m) may be another number.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

namespace holonomic {

class Masses {
public:
    // mass 0 or infinite: held fixed, w = 0. Throws Error naming the atom, counted from `base`.
    Masses(std::int64_t n_atoms, const double *masses, int base);

    bool fixed(std::int64_t atom) const { return !(given(atom) > 0) || infinite(atom); }
    // Whether it was given an infinite mass: a fixed atom that can be no massless site of a body.
    bool infinite(std::int64_t atom) const { return std::isinf(given(atom)); }
    // 0 of one that is held fixed.
    double mass(std::int64_t atom) const { return fixed(atom) ? 0 : given(atom); }
    double w(std::int64_t atom) const { return fixed(atom) ? 0 : 1 / given(atom); }
    bool uniform() const { return masses_.empty(); }
    std::int64_t n_movable() const;
    void copy(double *out) const {
        for (std::int64_t i = 0; i < n_atoms_; ++i) out[i] = given(i);
    }
    std::size_t bytes() const { return masses_.capacity() * sizeof(double); }

private:
    double given(std::int64_t atom) const {
        return masses_.empty() ? uniform_mass_ : masses_[static_cast<std::size_t>(atom)];
    }

    std::int64_t n_atoms_;
    double uniform_mass_ = 0;
    std::vector<double> masses_;  // [n_atoms] as they were given, empty if all are uniform_mass_
};

}  // namespace holonomic
