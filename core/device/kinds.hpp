// Molecules sorted by the graph of their bonds: those of one kind are solved by the same statements.
#pragma once

#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

namespace holonomic {
class Chains;
}

namespace holonomic::device {

// Bonds stand in the order of their elimination, each between two atoms of the molecule.
struct KernelKind {
    int n_atoms;
    std::vector<std::pair<int, int>> bonds;
    // Pairs of bonds, first < second, whose entry in the matrix of the multipliers is not 0: those that share an atom,
    // and what the elimination fills.
    std::vector<std::pair<int, int>> entries;
    // Of what a work-group solves: where each level of bonds begins that have no entries with each other, and where the
    // last one ends. Empty: for one work-item.
    std::vector<int> levels;

    int n_bonds() const { return static_cast<int>(bonds.size()); }
    int n_entries() const { return static_cast<int>(entries.size()); }
    bool is_for_group() const { return !levels.empty(); }
    bool operator<(const KernelKind &other) const {
        return std::tie(n_atoms, bonds) < std::tie(other.n_atoms, other.bonds);
    }
};

struct Member {
    std::int64_t number;          // of the molecule
    std::vector<int> atoms;       // in the order of its KernelKind
    std::vector<double> lengths;  // in the order of the bonds of its KernelKind
};

struct Sorted {
    struct OfKind {
        KernelKind kind;
        std::vector<Member> members;
    };
    // Those for one work-item, then those with more than max_entries entries, which are for a work-group; the largest
    // of each first.
    std::vector<OfKind> kinds;
    // Molecules that are in none: with rigid bodies or told images, and what eliminate_by_levels leaves out. Ascending.
    std::vector<std::int64_t> left;
};

Sorted sorted_by_kind(const Chains &chains, std::int64_t max_entries);

}  // namespace holonomic::device
