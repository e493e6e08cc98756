#include "core/molecules/given/numbering.hpp"

#include <algorithm>

namespace holonomic {

Numbering::Numbering(std::int64_t n_atoms, const std::int64_t *atoms, std::int64_t count, int base) {
    // A few bonds among many atoms must not cost as much as all atoms do.
    if (count < n_atoms / 16) {
        atoms_.resize(static_cast<std::size_t>(count));
        std::transform(atoms, atoms + count, atoms_.begin(), [base](std::int64_t atom) { return atom - base; });
        std::sort(atoms_.begin(), atoms_.end());
        atoms_.erase(std::unique(atoms_.begin(), atoms_.end()), atoms_.end());
        size_ = static_cast<std::int32_t>(atoms_.size());
        return;
    }
    std::vector<unsigned char> occurs(static_cast<std::size_t>(n_atoms), 0);
    for (std::int64_t i = 0; i < count; ++i) occurs[static_cast<std::size_t>(atoms[i] - base)] = 1;
    size_ = static_cast<std::int32_t>(std::count(occurs.begin(), occurs.end(), 1));
    all_ = size_ == n_atoms;
    if (all_) return;
    atoms_.reserve(static_cast<std::size_t>(size_));
    number_.resize(occurs.size());
    for (std::size_t i = 0; i < occurs.size(); ++i) {
        if (!occurs[i]) continue;
        number_[i] = static_cast<std::int32_t>(atoms_.size());
        atoms_.push_back(static_cast<std::int64_t>(i));
    }
}

std::int32_t Numbering::looked_up(std::int64_t atom) const {
    return static_cast<std::int32_t>(std::lower_bound(atoms_.begin(), atoms_.end(), atom) - atoms_.begin());
}

}  // namespace holonomic
