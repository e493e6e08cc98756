#include "core/molecules/given/recognise.hpp"

#include <algorithm>
#include <utility>

#include "core/index.hpp"
#include "core/molecules/given/count.hpp"

namespace holonomic {

namespace {

// A list that has no memory yet takes that of the draft, which is of the only molecule.
template <class T>
void append(std::vector<T> &list, std::vector<T> &draft) {
    if (list.capacity() == 0) return list.swap(draft);
    list.insert(list.end(), draft.begin(), draft.end());
}

}  // namespace

void Recogniser::sort_few() {
    for (std::size_t k = 1; k < draft_.bonds.size(); ++k) {
        const std::int64_t bond = draft_.bonds[k];
        const std::int32_t i = draft_.pairs[2 * k], j = draft_.pairs[2 * k + 1];
        std::size_t to = k;
        for (; to > 0; --to) {
            const std::int32_t i0 = draft_.pairs[2 * to - 2], j0 = draft_.pairs[2 * to - 1];
            if (i0 < i || (i0 == i && j0 <= j)) break;
            draft_.pairs[2 * to] = i0;
            draft_.pairs[2 * to + 1] = j0;
            draft_.bonds[to] = draft_.bonds[to - 1];
        }
        draft_.pairs[2 * to] = i;
        draft_.pairs[2 * to + 1] = j;
        draft_.bonds[to] = bond;
    }
}

// Counts, first by the higher, then by the lower atom.
void Recogniser::sort_many() {
    const std::size_t n_bonds = draft_.bonds.size(), n_atoms = draft_.atoms.size();
    sorted_.resize(n_bonds);
    sorted_pairs_.resize(2 * n_bonds);
    for (int e = 1; e >= 0; --e) {
        start_.assign(n_atoms + 1, 0);
        for (std::size_t k = 0; k < n_bonds; ++k) ++start_[at(draft_.pairs[2 * k + at(e)]) + 1];
        for (std::size_t i = 0; i < n_atoms; ++i) start_[i + 1] += start_[i];
        for (std::size_t k = 0; k < n_bonds; ++k) {
            const std::size_t to = at(start_[at(draft_.pairs[2 * k + at(e)])]++);
            sorted_[to] = draft_.bonds[k];
            sorted_pairs_[2 * to] = draft_.pairs[2 * k];
            sorted_pairs_[2 * to + 1] = draft_.pairs[2 * k + 1];
        }
        draft_.bonds.swap(sorted_);
        draft_.pairs.swap(sorted_pairs_);
    }
}

void Recogniser::sort_bonds() {
    const std::size_t n_bonds = draft_.bonds.size();
    bool sorted = true;
    for (std::size_t k = 0; k < n_bonds; ++k) {
        if (draft_.pairs[2 * k] > draft_.pairs[2 * k + 1]) std::swap(draft_.pairs[2 * k], draft_.pairs[2 * k + 1]);
        if (k > 0)
            sorted = sorted && std::make_pair(draft_.pairs[2 * k - 2], draft_.pairs[2 * k - 1]) <
                                   std::make_pair(draft_.pairs[2 * k], draft_.pairs[2 * k + 1]);
    }
    if (sorted) return;
    n_bonds > 40 ? sort_many() : sort_few();
    for (std::size_t k = 1; k < n_bonds; ++k)
        if (draft_.pairs[2 * k] == draft_.pairs[2 * k - 2] && draft_.pairs[2 * k + 1] == draft_.pairs[2 * k - 1])
            throw bond_error(list_, Status::degenerate, std::max(draft_.bonds[k], draft_.bonds[k - 1]),
                             "joins two atoms that another bond of the list joins already");
}

// Puts the atoms and bonds of a tree into the order along it, the lower end first; false if it is branched.
bool Recogniser::walk_along_chain() {
    const std::size_t n_bonds = draft_.bonds.size(), n_atoms = draft_.atoms.size();
    bool in_order = true;
    for (std::size_t k = 0; k < n_bonds; ++k)
        in_order = in_order && at(draft_.pairs[2 * k]) == k && at(draft_.pairs[2 * k + 1]) == k + 1;
    if (in_order) return true;
    degree_.assign(n_atoms, 0);
    neighbours_.resize(2 * n_atoms);  // the bonds of each atom
    for (std::size_t e = 0; e < 2 * n_bonds; ++e) {
        const std::size_t i = at(draft_.pairs[e]);
        if (degree_[i] == 2) return false;
        neighbours_[2 * i + at(degree_[i]++)] = static_cast<std::int32_t>(e / 2);
    }
    // Its ends ascend with their places; two of one fixed atom do so by their other atoms.
    std::size_t atom = 0;
    while (degree_[atom] != 1) ++atom;
    const std::vector<std::int64_t> atoms = draft_.atoms, bonds = draft_.bonds;
    const std::vector<unsigned char> fixed = draft_.fixed;
    std::int32_t bond = -1;
    for (std::size_t k = 0;; ++k) {
        draft_.atoms[k] = atoms[atom];
        draft_.fixed[k] = fixed[atom];
        if (k == n_bonds) break;
        bond = neighbours_[2 * atom] != bond ? neighbours_[2 * atom] : neighbours_[2 * atom + 1];
        draft_.bonds[k] = bonds[at(bond)];
        const std::size_t i = at(draft_.pairs[2 * at(bond)]), j = at(draft_.pairs[2 * at(bond) + 1]);
        atom = i == atom ? j : i;
    }
    for (std::size_t k = 0; k < n_bonds; ++k) {
        draft_.pairs[2 * k] = static_cast<std::int32_t>(k);
        draft_.pairs[2 * k + 1] = static_cast<std::int32_t>(k + 1);
    }
    return true;
}

Topology Recogniser::topology_of_cyclic() const {
    const std::size_t n_atoms = draft_.atoms.size();
    if (draft_.bonds.size() != n_atoms) return Topology::other;
    std::vector<unsigned char> degree(n_atoms, 0);
    for (const std::int32_t i : draft_.pairs)
        if (++degree[at(i)] > 2) return Topology::other;
    return n_atoms == 3 ? Topology::triangle : Topology::ring;
}

void Recogniser::add_to(FoundMolecules &found) {
    sort_bonds();
    const std::size_t n_bonds = draft_.bonds.size(), n_atoms = draft_.atoms.size();
    const bool acyclic = n_bonds + 1 == n_atoms;
    const Topology topology = !acyclic ? topology_of_cyclic() : walk_along_chain() ? Topology::chain : Topology::tree;
    if (topology == Topology::tree || topology == Topology::other) check_count(list_, draft_);
    found.molecules.push_back({topology, static_cast<std::int32_t>(n_atoms), static_cast<std::int32_t>(n_bonds),
                               static_cast<std::int32_t>(std::count(draft_.fixed.begin(), draft_.fixed.end(), 1)),
                               static_cast<std::int64_t>(found.atoms.size()),
                               static_cast<std::int64_t>(found.bonds.size())});
    append(found.atoms, draft_.atoms);
    append(found.fixed, draft_.fixed);
    append(found.bonds, draft_.bonds);
    append(found.pairs, draft_.pairs);
}

}  // namespace holonomic
