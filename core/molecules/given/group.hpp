// The molecules of a set, in groups of one kind, and where their atoms and bonds stand.
#pragma once

#include <cstdint>
#include <vector>

#include "core/molecules/given/kind.hpp"

namespace holonomic {

// Molecules of one kind that follow each other in the caller's arrays or in the lists.
struct Group {
    std::int64_t kind;
    std::int64_t count;
    std::int64_t first_molecule;
    std::int64_t first_atom;  // of the first molecule, the others follow; if listed in the lists of atoms
    std::int64_t first_bond;  // in the caller's arrays per bond; if reordered in the list of bonds
    bool listed;              // its atoms are any of the caller's
    bool reordered;           // its bonds stand in the caller's arrays in another order
};

class Groups {
public:
    // Atoms: from first_atom on, or `atoms` [n_atoms] of one molecule. Bonds: from first_bond on, or `bonds` [n_bonds]
    // of one molecule. Joins the last group where it continues it. Throws std::bad_alloc, changing nothing.
    void append(const Kinds &kinds, std::int64_t kind, std::int64_t count, std::int64_t first_atom,
                const std::int64_t *atoms, std::int64_t first_bond, const std::int64_t *bonds);

    // Takes back all that was appended since.
    struct Mark {
        std::size_t n_groups, n_atoms, n_bonds;
        std::int64_t n_molecules;
        Group last;
    };
    Mark mark() const;
    void roll_back(const Mark &mark) noexcept;

    const std::vector<Group> &all() const { return groups_; }
    const Group &of_molecule(std::int64_t molecule) const;
    std::int64_t n_molecules() const { return n_molecules_; }
    std::int64_t last_kind() const { return groups_.empty() ? -1 : groups_.back().kind; }

    // Places of a group's atoms and bonds; the molecule is counted within the group.
    const std::int64_t *atoms(const Group &group, std::int64_t index, std::int64_t n_atoms) const {
        return group.listed ? atoms_.data() + group.first_atom + index * n_atoms : nullptr;
    }
    // Bond in the caller's arrays per bond.
    std::int64_t bond(const Group &group, std::int64_t place) const {
        return group.reordered ? bonds_[static_cast<std::size_t>(place)] : place;
    }
    // For bonds of reordered groups: where they stand in the caller's arrays.
    const std::vector<std::int64_t> &reordered() const { return bonds_; }
    void shrink() {
        groups_.shrink_to_fit();
        atoms_.shrink_to_fit();
        bonds_.shrink_to_fit();
    }
    std::size_t bytes() const {
        return groups_.capacity() * sizeof(Group) + (atoms_.capacity() + bonds_.capacity()) * sizeof(std::int64_t);
    }

private:
    std::vector<Group> groups_;
    std::vector<std::int64_t> atoms_, bonds_;
    std::int64_t n_molecules_ = 0;
};

}  // namespace holonomic
