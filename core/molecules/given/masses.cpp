#include "core/molecules/given/masses.hpp"

#include <cmath>
#include <limits>

#include "core/error.hpp"

namespace holonomic {

Masses::Masses(std::int64_t n_atoms, const double *masses, int base) : n_atoms_(n_atoms) {
    if (n_atoms < 0)
        throw make_error(Status::value, "n_atoms is %lld; it must be at least 0", static_cast<long long>(n_atoms));
    if (n_atoms > std::numeric_limits<std::int64_t>::max() / 64)
        throw make_error(Status::value, "n_atoms is %lld: too large", static_cast<long long>(n_atoms));
    bool uniform = true;
    for (std::int64_t i = 0; i < n_atoms; ++i) {
        const double w = masses[i] == 0 ? 0 : 1 / masses[i];
        if (!(masses[i] >= 0) || !std::isfinite(w)) {
            Error error = make_error(Status::value,
                                     "the mass of atom %lld (counted from %d) is %g; it must be positive, or "
                                     "infinite for an atom that is held fixed",
                                     static_cast<long long>(i + base), base, masses[i]);
            error.atom = i;
            error.base = base;
            throw error;
        }
        uniform = uniform && masses[i] == masses[0];
    }
    if (uniform && n_atoms > 0)
        uniform_mass_ = masses[0];
    else
        masses_.assign(masses, masses + n_atoms);
}

std::int64_t Masses::n_movable() const {
    if (uniform()) return n_atoms_ == 0 || fixed(0) ? 0 : n_atoms_;
    std::int64_t n = 0;
    for (std::int64_t i = 0; i < n_atoms_; ++i) n += !fixed(i);
    return n;
}

}  // namespace holonomic
