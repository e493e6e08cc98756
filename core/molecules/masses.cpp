#include "core/molecules/masses.hpp"

#include <algorithm>
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
                                     "the mass of atom %lld (counted from %d) is %g; it must be positive, or 0 for an "
                                     "atom that is held fixed",
                                     static_cast<long long>(i + base), base, masses[i]);
            error.atom = i;
            error.base = base;
            throw error;
        }
        uniform = uniform && masses[i] == masses[0];
        if (std::isinf(masses[i])) infinite_.push_back(i);
    }
    if (uniform && n_atoms > 0 && masses[0] == 0)
        throw make_error(Status::value,
                         "all %lld masses are 0, so that no atom can move: they have not been set; if that is meant, "
                         "atoms that are held fixed may have the mass +infinity, too",
                         static_cast<long long>(n_atoms));
    if (uniform && n_atoms > 0) {
        w_uniform_ = masses[0] == 0 ? 0 : 1 / masses[0];
        return;
    }
    w_.resize(static_cast<std::size_t>(n_atoms));
    for (std::size_t i = 0; i < w_.size(); ++i) w_[i] = masses[i] == 0 ? 0 : 1 / masses[i];
}

std::int64_t Masses::n_movable() const {
    if (uniform()) return w_uniform_ == 0 ? 0 : n_atoms_;
    return n_atoms_ - std::count(w_.begin(), w_.end(), 0.0);
}

}  // namespace holonomic
