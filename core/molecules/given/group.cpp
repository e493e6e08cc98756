#include "core/molecules/given/group.hpp"

namespace holonomic {

void Groups::append(const Kinds &kinds, std::int64_t kind, std::int64_t count, std::int64_t first_atom,
                    const std::int64_t *atoms, std::int64_t first_bond, const std::int64_t *bonds) {
    const Kind &k = kinds[kind];
    const Mark before = mark();
    try {
        if (atoms) atoms_.insert(atoms_.end(), atoms, atoms + k.n_atoms());
        if (bonds) bonds_.insert(bonds_.end(), bonds, bonds + k.n_bonds);
        const std::int64_t atom = atoms ? static_cast<std::int64_t>(before.n_atoms) : first_atom;
        const std::int64_t bond = bonds ? static_cast<std::int64_t>(before.n_bonds) : first_bond;
        const Group next{kind, count, n_molecules_, atom, bond, atoms != nullptr, bonds != nullptr};
        bool joined = false;
        if (!groups_.empty()) {
            Group &last = groups_.back();
            joined = last.kind == kind && last.listed == next.listed && last.reordered == next.reordered &&
                     last.first_bond + last.count * k.n_bonds == bond &&
                     last.first_atom + last.count * k.n_atoms() == atom;
            if (joined) last.count += count;
        }
        if (!joined) groups_.push_back(next);
        n_molecules_ += count;
    } catch (...) {
        roll_back(before);
        throw;
    }
}

Groups::Mark Groups::mark() const {
    return {groups_.size(), atoms_.size(), bonds_.size(), n_molecules_, groups_.empty() ? Group{} : groups_.back()};
}

void Groups::roll_back(const Mark &mark) noexcept {
    groups_.resize(mark.n_groups);
    if (mark.n_groups > 0) groups_.back() = mark.last;
    atoms_.resize(mark.n_atoms);
    bonds_.resize(mark.n_bonds);
    n_molecules_ = mark.n_molecules;
}

const Group &Groups::of_molecule(std::int64_t molecule) const {
    std::size_t low = 0, high = groups_.size();
    while (high - low > 1) {
        const std::size_t middle = (low + high) / 2;
        (groups_[middle].first_molecule <= molecule ? low : high) = middle;
    }
    return groups_[low];
}

}  // namespace holonomic
