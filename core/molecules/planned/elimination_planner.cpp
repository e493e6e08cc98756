#include "core/molecules/planned/elimination_planner.hpp"

#include <algorithm>

#include "core/molecules/planned/way.hpp"

namespace holonomic {

void EliminationPlanner::make() {
    invert(
        s_.n_atoms, s_.n_bonds, [&](std::int32_t k, int end) { return (end ? m_.atom_j : m_.atom_i)[at(k)]; },
        m_.bonds);
    strip();
    number_trees();
    if (s_.n_core == 0) {
        s_.type = EliminationPlan::tree;
    } else if (for_ != network && is_ring(s_, most_trees_at_core())) {
        s_.type = s_.n_bonds == 3 ? EliminationPlan::triangle : EliminationPlan::ring;
        number_ring();
    } else {
        s_.type = EliminationPlan::graph;
        number_core();
    }
    invert_numbers();
    list_children();
    m_.column_start.assign(1, 0);
    if (s_.n_core == 0) return;
    Lists meeting = meetings();
    if (!is_network_) list_fill(meeting);
    m_.meet_start = std::move(meeting.start);
    m_.meet = std::move(meeting.item);
}

// Takes away atoms with one bond until none is left: upper_bond_ of those. Of a tree the last two atoms would take
// each other away; the one that is left is the atom with the largest number of those that had one bond. Of trees in
// lanes, from which atoms are taken at all ends at once, it is the centre, and they hang from a leaf near it.
void EliminationPlanner::strip() {
    Numbers &degree = m_.degree, &leaves = m_.leaves;
    degree.resize(at(s_.n_atoms));
    leaves.clear();
    leaves.reserve(at(s_.n_atoms));
    upper_bond_.assign(at(s_.n_atoms), -1);
    const bool is_tree = s_.n_bonds == s_.n_atoms - 1, centred = is_tree && s_.n_bonds <= largest_in_lanes;
    std::int32_t root = -1;
    for (std::int32_t i = 0; i < s_.n_atoms; ++i) {
        degree[at(i)] = bonds_.size(i);
        if (is_tree && !centred && degree[at(i)] == 1) root = i;
    }
    for (std::int32_t i = 0; i < s_.n_atoms; ++i)
        if (degree[at(i)] == 1 && i != root && !stays(i)) leaves.push_back(i);
    s_.n_tree = 0;
    for (std::size_t next = 0; next < leaves.size(); ++next) {
        const std::int32_t i = leaves[next];
        for (const std::int32_t *k = bonds_.begin(i); k != bonds_.end(i); ++k) {
            const std::int32_t j = other_end(*k, i);
            if (upper_bond_[at(j)] == *k) continue;  // a child's
            upper_bond_[at(i)] = *k;
            if (--degree[at(j)] == 1 && j != root && !stays(j)) leaves.push_back(j);
        }
        ++s_.n_tree;
    }
    if (centred) {
        s_.n_tree = s_.n_bonds;
        hang_from_leaf(leaves.back());
    }
    s_.n_core = s_.n_bonds - s_.n_tree;
    s_.n_core_atoms = is_tree ? 0 : s_.n_atoms - s_.n_tree;
}

// A tree that hangs from its centre: from the nearest leaf.
void EliminationPlanner::hang_from_leaf(std::int32_t centre) {
    Numbers &found = m_.stack;
    found.assign(1, centre);
    std::int32_t i = centre;
    for (std::size_t next = 0; bonds_.size(i) > 1; i = found[++next])
        for (const std::int32_t *k = bonds_.begin(i); k != bonds_.end(i); ++k)
            if (is_child(*k, i)) found.push_back(other_end(*k, i));
    for (std::int32_t bond = -1; i >= 0;) {
        std::swap(bond, upper_bond_[at(i)]);
        i = bond >= 0 ? other_end(bond, i) : -1;
    }
}

// The trees below the atoms that were not taken away, from the last index to the first. Of molecules that go in lanes
// level by level, so that what waits for each other is far apart and the children of all atoms follow each other. Of
// large ones each atom is followed by all that hangs from it, so that a tile of the indices is connected.
void EliminationPlanner::number_trees() {
    Numbers &order = m_.stack, &left = m_.next;
    const auto add_children = [&](std::int32_t i, Numbers &to) {
        for (const std::int32_t *k = bonds_.begin(i); k != bonds_.end(i); ++k)
            if (is_child(*k, i)) to.push_back(other_end(*k, i));
    };
    order.clear();
    order.reserve(at(s_.n_tree));
    left.clear();
    m_.atom_of.reserve(at(s_.n_atoms));
    m_.bond_of.reserve(at(s_.n_bonds));
    for (std::int32_t i = 0; i < s_.n_atoms; ++i)
        if (upper_bond_[at(i)] < 0) add_children(i, s_.n_bonds <= largest_in_lanes ? order : left);
    for (std::size_t next = 0; next < order.size(); ++next) add_children(order[next], order);
    while (!left.empty()) {
        order.push_back(left.back());
        left.pop_back();
        add_children(order.back(), left);
    }
    for (std::size_t n = order.size(); n-- > 0;) {
        m_.atom_of.push_back(order[n]);
        m_.bond_of.push_back(upper_bond_[at(order[n])]);
    }
    for (std::int32_t i = 0; i < s_.n_atoms; ++i)
        if (upper_bond_[at(i)] < 0) m_.atom_of.push_back(i);
}

// At an atom of a ring.
std::int32_t EliminationPlanner::most_trees_at_core() const {
    std::int32_t most = 0;
    for (std::int32_t i = 0; i < s_.n_atoms; ++i)
        if (upper_bond_[at(i)] < 0) most = std::max(most, bonds_.size(i) - 2);
    return most;
}

// Round from the core's first atom in the direction of its first bond.
void EliminationPlanner::number_ring() {
    const std::int32_t first = m_.atom_of[at(s_.n_tree)];
    m_.atom_of.resize(at(s_.n_tree));
    std::int32_t atom = first, bond = -1;
    do {
        const std::int32_t *k = bonds_.begin(atom);
        while (*k == bond || is_child(*k, atom)) ++k;
        bond = *k;
        m_.atom_of.push_back(atom);
        m_.bond_of.push_back(bond);
        atom = other_end(bond, atom);
    } while (atom != first);
}

void EliminationPlanner::number_core() {
    Numbers core, core_number = minus_ones(s_.n_bonds);
    for (std::int32_t k = 0; k < s_.n_bonds; ++k) {
        const std::int32_t i = m_.atom_i[at(k)], j = m_.atom_j[at(k)];
        if (upper_bond_[at(i)] == k || upper_bond_[at(j)] == k) continue;
        core_number[at(k)] = static_cast<std::int32_t>(core.size());
        core.push_back(k);
    }
    const bool listed = has_short_ldl(s_, bonds_);
    if (for_ == junction || for_ == extended || (listed && s_.n_bonds <= largest_graph_in_lanes))
        return order_core(core, core_number, most_bytes_);
    is_network_ = for_ == network || !listed || is_mostly_strands(s_, ends_of_strands());
    try {
        if (!is_network_) return order_core(core, core_number, std::min(most_bytes_, most_bytes_of_ldl(s_)));
    } catch (const TooMuchMemory &) {
        is_network_ = true;
    }
    m_.bond_of.insert(m_.bond_of.end(), core.begin(), core.end());
}

void EliminationPlanner::order_core(const Numbers &core, const Numbers &core_number, std::int64_t most_bytes) {
    check_atoms(most_bytes);
    Lists neighbours = neighbours_of(bonds_, m_.atom_i.data(), m_.atom_j.data(), core, core_number);
    Lists of_list;
    if (for_ == molecule) of_list = neighbours;
    for (const std::int32_t p : minimum_degree(std::move(neighbours), Ties::latest, most_bytes))
        m_.bond_of.push_back(core[at(p)]);
    if (for_ != molecule) return;
    // The list takes the bonds of trees as they came free, so that no bond waits for more others than it must.
    m_.leaves_first.reserve(at(s_.n_bonds));
    for (const std::int32_t i : m_.leaves) m_.leaves_first.push_back(upper_bond_[at(i)]);
    for (const std::int32_t p : minimum_degree(std::move(of_list), Ties::first)) m_.leaves_first.push_back(core[at(p)]);
}

// At atoms with other than two bonds of the core, or with trees.
std::int64_t EliminationPlanner::ends_of_strands() const {
    std::int64_t ends = 0;
    for (std::int32_t i = 0; i < s_.n_atoms; ++i)
        if (upper_bond_[at(i)] < 0 && (m_.degree[at(i)] > 2 || bonds_.size(i) > 2)) ends += m_.degree[at(i)];
    return ends;
}

// Bonds at one atom are all neighbours of each other: n of them fill at least what n columns do, with 0 .. n - 1
// entries.
void EliminationPlanner::check_atoms(std::int64_t most_bytes) const {
    std::int64_t bytes = 0;
    for (std::int32_t i = 0; i < s_.n_atoms; ++i)
        if (upper_bond_[at(i)] < 0) bytes += bytes_of_columns_below(m_.degree[at(i)]);
    if (bytes > most_bytes) throw TooMuchMemory(bytes);
}

void EliminationPlanner::invert_numbers() {
    m_.index_of.resize(at(s_.n_atoms));
    for (std::int32_t i = 0; i < s_.n_atoms; ++i) m_.index_of[at(m_.atom_of[at(i)])] = i;
    if (for_ == junction) m_.bond_index_of.resize(at(s_.n_bonds));
    for (std::int32_t k = 0; for_ == junction && k < s_.n_bonds; ++k) m_.bond_index_of[at(m_.bond_of[at(k)])] = k;
    m_.parent.resize(at(s_.n_tree));
    for (std::int32_t k = 0; k < s_.n_tree; ++k)
        m_.parent[at(k)] = m_.index_of[at(other_end(m_.bond_of[at(k)], m_.atom_of[at(k)]))];
    const bool round = s_.type == EliminationPlan::ring || s_.type == EliminationPlan::triangle;
    m_.from.reserve(at(s_.n_core));
    m_.to.reserve(at(s_.n_core));
    for (std::int32_t p = 0; p < s_.n_core; ++p) {
        const std::int32_t k = m_.bond_of[at(s_.n_tree + p)];
        const std::int32_t i = m_.index_of[at(m_.atom_i[at(k)])], j = m_.index_of[at(m_.atom_j[at(k)])];
        m_.from.push_back(round ? s_.n_tree + p : i);
        m_.to.push_back(round ? s_.n_tree + (p + 1) % s_.n_core : j);
    }
}

void EliminationPlanner::list_children() {
    m_.child_start.assign(at(s_.n_atoms) + 1, 0);
    for (const std::int32_t p : m_.parent) ++m_.child_start[at(p)];
    m_.pair_start.resize(at(s_.n_atoms) + 1);
    m_.pair_start[0] = 0;
    s_.max_children = s_.max_joint = 0;
    for (std::int32_t i = 0, first = 0; i < s_.n_atoms; ++i) {
        const std::int32_t k = m_.child_start[at(i)];
        m_.child_start[at(i)] = first += k;
        const bool decomposed = !is_network_ && (i >= s_.n_tree || k <= most_decomposed);
        m_.pair_start[at(i) + 1] = m_.pair_start[at(i)] + (decomposed ? k * (k - 1) / 2 : values_of_joint(k));
        s_.max_children = std::max(s_.max_children, k);
        if (decomposed) s_.max_joint = std::max(s_.max_joint, k);
    }
    s_.n_pairs = m_.pair_start[at(s_.n_atoms)];
    m_.child_start[at(s_.n_atoms)] = s_.n_tree;
    m_.child.resize(at(s_.n_tree));
    for (std::int32_t k = s_.n_tree; k-- > 0;) m_.child[at(--m_.child_start[at(m_.parent[at(k)])])] = k;
}

// Which bonds meet at each atom of the core.
Lists EliminationPlanner::meetings() const {
    return invert(s_.n_core_atoms, s_.n_core,
                  [&](std::int32_t p, int end) { return (end ? m_.to : m_.from)[at(p)] - s_.n_tree; });
}

// The factor's pattern.
void EliminationPlanner::list_fill(const Lists &meeting) {
    Fill fill = sorted(fill_of(meeting, s_.n_core, 0,
                               [&](std::int32_t p, int end) { return (end ? m_.to : m_.from)[at(p)] - s_.n_tree; }));
    m_.column_start = std::move(fill.column_start);
    m_.row = std::move(fill.row);
}

}  // namespace holonomic
