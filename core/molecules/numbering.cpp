#include "core/molecules/numbering.hpp"

#include <algorithm>

namespace holonomic {

Numbering::Numbering(std::int64_t n_atoms, const std::vector<std::int64_t> &occurring) {
    // A few bonds among many atoms must not cost as much as all atoms do.
    if (static_cast<std::int64_t>(occurring.size()) < n_atoms / 16) {
        atoms_ = occurring;
        std::sort(atoms_.begin(), atoms_.end());
        atoms_.erase(std::unique(atoms_.begin(), atoms_.end()), atoms_.end());
        return;
    }
    number_.assign(static_cast<std::size_t>(n_atoms), 0);
    for (const std::int64_t atom : occurring) number_[static_cast<std::size_t>(atom)] = 1;
    atoms_.reserve(static_cast<std::size_t>(std::count(number_.begin(), number_.end(), 1)));
    for (std::size_t i = 0; i < number_.size(); ++i) {
        if (number_[i] == 0) continue;
        number_[i] = size();
        atoms_.push_back(static_cast<std::int64_t>(i));
    }
}

std::int32_t Numbering::operator()(std::int64_t atom) const {
    if (!number_.empty()) return number_[static_cast<std::size_t>(atom)];
    return static_cast<std::int32_t>(std::lower_bound(atoms_.begin(), atoms_.end(), atom) - atoms_.begin());
}

}  // namespace holonomic
