#include "core/molecules/careful_shape.hpp"

#include <algorithm>
#include <utility>

#include "core/kernels/careful/scratch.hpp"
#include "core/molecules/elimination_order.hpp"

namespace holonomic {

namespace {

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

}  // namespace

CarefulShape::CarefulShape(std::int32_t n_atoms, std::int32_t n_bonds, const std::int32_t *pairs,
                           std::int64_t most_bytes) {
    plan_.n_atoms = n_atoms;
    plan_.n_bonds = n_bonds;
    for (List *const list : {&atom_i_, &atom_j_}) list->reserve(at(n_bonds));
    for (std::int32_t k = 0; k < n_bonds; ++k) {
        atom_i_.push_back(pairs[2 * k]);
        atom_j_.push_back(pairs[2 * k + 1]);
    }
    find_arms();
    strip();
    order_core(most_bytes);
    find_ring();
    plan_.atom_i = atom_i_.data();
    plan_.atom_j = atom_j_.data();
    plan_.arm_start = arm_start_.data();
    plan_.arms = arms_.data();
    plan_.table_start = table_start_.data();
    plan_.parent = parent_.data();
    plan_.n_hanging = static_cast<std::int32_t>(hanging_.size());
    plan_.hanging = hanging_.data();
    plan_.n_core = static_cast<std::int32_t>(core_.size());
    plan_.core = core_.data();
    plan_.place = place_.data();
    plan_.column_start = column_start_.data();
    plan_.rows = rows_.data();
    plan_.ring = ring_.empty() ? nullptr : ring_.data();
    plan_.scratch_bytes = careful_scratch_bytes(plan_);
}

std::int64_t CarefulShape::memory() const {
    std::size_t bytes = sizeof(*this);
    for (const List *list : {&atom_i_, &atom_j_, &arm_start_, &arms_, &parent_, &hanging_, &core_, &place_, &rows_,
                             &ring_, &column_start_})
        bytes += list->capacity() * sizeof(std::int32_t);
    bytes += table_start_.capacity() * sizeof(std::int64_t);
    return static_cast<std::int64_t>(bytes);
}

void CarefulShape::find_arms() {
    const std::size_t n = at(plan_.n_atoms), n_bonds = at(plan_.n_bonds);
    arm_start_.assign(n + 1, 0);
    for (const List *ends : {&atom_i_, &atom_j_})
        for (const std::int32_t atom : *ends) ++arm_start_[at(atom) + 1];
    table_start_.assign(n + 1, 0);
    for (std::size_t i = 0; i < n; ++i) {
        const std::int32_t arms = arm_start_[i + 1];
        plan_.most_arms = std::max(plan_.most_arms, arms);
        table_start_[i + 1] = table_start_[i] + static_cast<std::int64_t>(arms) * arms;
        arm_start_[i + 1] += arm_start_[i];
    }
    arms_.resize(2 * n_bonds);
    List next(arm_start_.begin(), arm_start_.end() - 1);
    for (std::size_t k = 0; k < n_bonds; ++k)
        for (const List *ends : {&atom_i_, &atom_j_}) arms_[at(next[at((*ends)[k])]++)] = static_cast<std::int32_t>(k);
}

// Finds the core, and hangs the trees on it; of a tree the atom that is left last is the root.
void CarefulShape::strip() {
    const std::size_t n = at(plan_.n_atoms);
    List left(n), gone;
    parent_.assign(n, -1);
    place_.assign(at(plan_.n_bonds), 0);
    for (std::size_t i = 0; i < n; ++i) {
        left[i] = arm_start_[i + 1] - arm_start_[i];
        if (left[i] == 1) gone.push_back(static_cast<std::int32_t>(i));
    }
    for (std::size_t g = 0; g < gone.size(); ++g) {
        const std::int32_t atom = gone[g];
        for (std::int32_t a = arm_start_[at(atom)]; a < arm_start_[at(atom) + 1]; ++a) {
            const std::size_t k = at(arms_[at(a)]);
            if (place_[k] < 0) continue;
            const std::int32_t other = atom_i_[k] + atom_j_[k] - atom;
            place_[k] = -1;
            parent_[at(atom)] = static_cast<std::int32_t>(k);
            if (--left[at(other)] == 1) gone.push_back(other);
        }
    }
    hanging_.reserve(gone.size());
    for (const std::int32_t atom : gone)
        if (parent_[at(atom)] >= 0) hanging_.push_back(atom);
}

// A bare ring: its bonds one after the other, beginning with bond 0 at its atom_j.
void CarefulShape::find_ring() {
    if (plan_.n_bonds < 3 || plan_.n_atoms != plan_.n_bonds || plan_.most_arms != 2) return;
    if (core_.size() != at(plan_.n_bonds)) return;
    std::int32_t bond = 0, atom = atom_j_[0];
    do {
        ring_.push_back(bond);
        const std::int32_t first = arm_start_[at(atom)];
        bond = arms_[at(first)] == bond ? arms_[at(first) + 1] : arms_[at(first)];
        atom = atom_i_[at(bond)] + atom_j_[at(bond)] - atom;
    } while (bond != 0);
}

void CarefulShape::order_core(std::int64_t most_bytes) {
    column_start_.assign(1, 0);
    if (plan_.n_bonds == plan_.n_atoms - 1) return;  // a tree has no core
    List number(at(plan_.n_bonds), -1), bonds;
    for (std::int32_t k = 0; k < plan_.n_bonds; ++k)
        if (place_[at(k)] >= 0) {
            number[at(k)] = static_cast<std::int32_t>(bonds.size());
            bonds.push_back(k);
        }
    const auto neighbours = [&](const List &numbers) {
        std::vector<List> lists(bonds.size());
        for (std::int32_t i = 0; i < plan_.n_atoms; ++i)
            for (std::int32_t a = arm_start_[at(i)]; a < arm_start_[at(i) + 1]; ++a)
                for (std::int32_t b = arm_start_[at(i)]; b < arm_start_[at(i) + 1]; ++b) {
                    const std::int32_t k = numbers[at(arms_[at(a)])], l = numbers[at(arms_[at(b)])];
                    if (k != l && k >= 0 && l >= 0) lists[at(k)].push_back(l);
                }
        return lists;
    };
    for (const std::int32_t p : minimum_degree(neighbours(number), Ties::latest, most_bytes)) {
        const std::int32_t k = bonds[at(p)];
        place_[at(k)] = static_cast<std::int32_t>(core_.size());
        core_.push_back(k);
    }
    Fill fill = fill_of(neighbours(place_));
    column_start_ = std::move(fill.column_start);
    rows_ = std::move(fill.row);
}

}  // namespace holonomic
