#include "core/molecules/given/find.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>

#include "core/index.hpp"
#include "core/molecules/given/numbering.hpp"
#include "core/molecules/given/recognise.hpp"

namespace holonomic {

namespace {

using Numbers = std::vector<std::int32_t>;

}  // namespace

const BondList &checked(std::int64_t n_atoms, const BondList &list) {
    // Below the base a number without a sign is large.
    const auto is_outside = [&](std::int64_t atom) {
        return static_cast<std::uint64_t>(atom) - static_cast<std::uint64_t>(list.base) >=
               static_cast<std::uint64_t>(n_atoms);
    };
    for (std::int64_t k = 0; k < list.n_bonds; ++k) {
        const std::int64_t i = list.pairs[2 * k], j = list.pairs[2 * k + 1];
        if (is_outside(i) || is_outside(j)) {
            const std::int64_t atom = is_outside(i) ? i : j;
            Error error = make_error(Status::index, "bond %lld of the list: atom %lld is outside %d .. %lld",
                                     static_cast<long long>(k + list.base), static_cast<long long>(atom), list.base,
                                     static_cast<long long>(n_atoms - 1 + list.base));
            error.bond = k;
            error.atom = atom < list.base ? -1 : atom - list.base;
            error.base = list.base;
            throw error;
        }
        if (i == j) throw bond_error(list, Status::value, k, "joins an atom to itself");
    }
    return list;
}

namespace {

// Sets of atoms that hold together. The least number stands for its set.
class DisjointSets {
public:
    explicit DisjointSets(std::int32_t n) : parent_(at(n)) {
        for (std::int32_t i = 0; i < n; ++i) parent_[at(i)] = i;
    }
    std::int32_t of(std::int32_t i) {
        while (parent_[at(i)] != i) {
            parent_[at(i)] = parent_[at(parent_[at(i)])];
            i = parent_[at(i)];
        }
        return i;
    }
    void join(std::int32_t i, std::int32_t j) {
        i = of(i);
        j = of(j);
        if (i == j) return;
        parent_[at(std::max(i, j))] = std::min(i, j);
        ++n_joined_;
    }
    bool are_one() const { return n_joined_ + 1 == parent_.size(); }

private:
    Numbers parent_;
    std::size_t n_joined_ = 0;
};

// Elements in the order of their molecules, and within a molecule in their own: start[m] is where molecule m begins.
Numbers sorted_by_molecule(const Numbers &molecule, std::size_t n_molecules, Numbers &start) {
    start.assign(n_molecules + 1, 0);
    for (const std::int32_t m : molecule)
        if (m >= 0) ++start[at(m) + 1];
    for (std::size_t m = 0; m < n_molecules; ++m) start[m + 1] += start[m];
    Numbers next(start.begin(), start.end() - 1), sorted(at(start.back()));
    for (std::size_t i = 0; i < molecule.size(); ++i)
        if (molecule[i] >= 0) sorted[at(next[at(molecule[i])]++)] = static_cast<std::int32_t>(i);
    return sorted;
}

class Finder {
public:
    Finder(const Masses &masses, std::int64_t n_atoms, const BondList &list)
        : list_(checked(n_atoms, list)), number_(n_atoms, list.pairs, 2 * list.n_bonds, list.base),
          end_(at(2 * list.n_bonds)), fixed_(at(number_.size())) {
        for (std::size_t e = 0; e < end_.size(); ++e) end_[e] = number_(list.pairs[e] - list.base);
        for (std::int32_t i = 0; i < number_.size(); ++i) {
            fixed_[at(i)] = masses.fixed(number_.atom(i));
            any_fixed_ = any_fixed_ || fixed_[at(i)];
        }
        bring_together();
    }

    FoundMolecules find() {
        divide();
        Recogniser recognise(list_);
        if (is_one_) {
            take_all(recognise.draft());
            recognise.add_to(found_);
            return std::move(found_);
        }
        found_.atoms.reserve(atoms_.size());
        found_.bonds.reserve(bonds_.size());
        found_.pairs.reserve(2 * bonds_.size());
        found_.molecules.reserve(n_molecules_);
        Numbers local(at(number_.size()));
        for (std::size_t m = 0; m < n_molecules_; ++m) {
            Draft &draft = recognise.draft();
            take(m, local, draft);
            recognise.add_to(found_);
        }
        return std::move(found_);
    }

private:
    std::int32_t least_atom(std::size_t p) const { return std::min(end_[2 * p], end_[2 * p + 1]); }
    std::int64_t bond_at(std::size_t p) const { return bond_at_.empty() ? static_cast<std::int64_t>(p) : bond_at_[p]; }

    // Bonds that stand in the list in any order are first sorted by their lower atoms: what follows would miss the
    // cache at every step, and branch at random.
    void bring_together() {
        const std::size_t n_bonds = end_.size() / 2;
        std::size_t jumps = 0;
        for (std::size_t p = 1; p < n_bonds; ++p) jumps += std::abs(least_atom(p) - least_atom(p - 1)) > 4096;
        if (jumps < n_bonds / 16) return;
        int shift = 0;
        while (number_.size() >> shift > 1024) ++shift;
        std::vector<std::size_t> next(at(number_.size() >> shift) + 2, 0);
        for (std::size_t p = 0; p < n_bonds; ++p) ++next[at(least_atom(p) >> shift) + 1];
        for (std::size_t b = 1; b < next.size(); ++b) next[b] += next[b - 1];
        std::vector<ListedBond> entry(n_bonds), sorted;
        for (std::size_t p = 0; p < n_bonds; ++p)
            entry[next[at(least_atom(p) >> shift)]++] = {end_[2 * p], end_[2 * p + 1], static_cast<std::int32_t>(p)};
        bond_at_.resize(n_bonds);
        // Now next[b] is where the bonds of part b end.
        for (std::size_t b = 0, begin = 0; begin < n_bonds; begin = next[b++]) {
            sort_part(entry.data() + begin, next[b] - begin, shift, sorted);
            for (std::size_t p = begin; p < next[b]; ++p) {
                const ListedBond &e = sorted[p - begin];
                end_[2 * p] = e.i;
                end_[2 * p + 1] = e.j;
                bond_at_[p] = e.bond;
            }
        }
    }

    struct ListedBond {
        std::int32_t i, j, bond;
    };

    // Entries whose lower atoms differ in their last `shift` bits only; counts.
    static void sort_part(const ListedBond *entry, std::size_t n, int shift, std::vector<ListedBond> &sorted) {
        const auto place = [shift](const ListedBond &e) { return at(std::min(e.i, e.j) & ((1 << shift) - 1)); };
        std::vector<std::uint32_t> next((std::size_t{1} << shift) + 1, 0);
        for (std::size_t p = 0; p < n; ++p) ++next[place(entry[p]) + 1];
        for (std::size_t i = 1; i < next.size(); ++i) next[i] += next[i - 1];
        sorted.resize(n);
        for (std::size_t p = 0; p < n; ++p) sorted[next[place(entry[p])]++] = entry[p];
    }

    // Which molecule each bond and each movable atom belongs to.
    void divide() {
        const std::size_t n_bonds = end_.size() / 2;
        DisjointSets sets(number_.size());
        for (std::size_t k = 0; k < n_bonds; ++k)
            if (!any_fixed_ || (!fixed_[at(end_[2 * k])] && !fixed_[at(end_[2 * k + 1])]))
                sets.join(end_[2 * k], end_[2 * k + 1]);
        is_one_ = !any_fixed_ && sets.are_one();
        if (is_one_) return;
        Numbers molecule(at(number_.size()), -1), of_bond(n_bonds, -1);
        for (std::int32_t i = 0; i < number_.size(); ++i) {
            if (fixed_[at(i)]) continue;
            const std::int32_t least = sets.of(i);
            molecule[at(i)] = least == i ? static_cast<std::int32_t>(n_molecules_++) : molecule[at(least)];
        }
        for (std::size_t k = 0; k < n_bonds; ++k) {
            const std::int32_t i = any_fixed_ && fixed_[at(end_[2 * k])] ? end_[2 * k + 1] : end_[2 * k];
            of_bond[k] = molecule[at(i)];
            if (of_bond[k] >= 0) continue;
            found_.unconstrained.push_back(bond_at(k));
            for (std::size_t e = 0; e < 2; ++e) found_.unconstrained_atoms.push_back(number_.atom(end_[2 * k + e]));
        }
        bonds_ = sorted_by_molecule(of_bond, n_molecules_, bond_start_);
        atoms_ = sorted_by_molecule(molecule, n_molecules_, atom_start_);
    }

    // Where all is one molecule.
    void take_all(Draft &draft) {
        draft.atoms.resize(at(number_.size()));
        for (std::int32_t i = 0; i < number_.size(); ++i) draft.atoms[at(i)] = number_.atom(i);
        draft.fixed.swap(fixed_);
        draft.bonds.resize(end_.size() / 2);
        for (std::size_t p = 0; p < draft.bonds.size(); ++p) draft.bonds[p] = bond_at(p);
        draft.pairs.swap(end_);
    }

    // The molecule's atoms, ascending, and its bonds as the list has them.
    void take(std::size_t m, Numbers &local, Draft &draft) {
        const std::size_t first = at(bond_start_[m]), n_bonds = at(bond_start_[m + 1]) - first;
        draft.atoms.clear();
        draft.fixed.clear();
        draft.bonds.resize(n_bonds);
        draft.pairs.resize(2 * n_bonds);
        bool leaves = false;
        for (std::size_t k = 0; k < n_bonds; ++k) {
            const std::size_t bond = at(bonds_[first + k]);
            draft.bonds[k] = bond_at(bond);
            leaves = leaves || (any_fixed_ && (fixed_[at(end_[2 * bond])] || fixed_[at(end_[2 * bond + 1])]));
        }
        if (leaves) return take_with_leaves(m, local, draft);
        for (std::int32_t i = atom_start_[m]; i < atom_start_[m + 1]; ++i) {
            local[at(atoms_[at(i)])] = static_cast<std::int32_t>(draft.atoms.size());
            draft.atoms.push_back(number_.atom(atoms_[at(i)]));
        }
        draft.fixed.assign(draft.atoms.size(), 0);
        for (std::size_t k = 0; k < n_bonds; ++k)
            for (std::size_t e = 0; e < 2; ++e) draft.pairs[2 * k + e] = local[at(end_[2 * at(bonds_[first + k]) + e])];
    }

    // With fixed atoms, each once for every bond that it ends; those of one atom in the order of the bonds' other
    // atoms.
    void take_with_leaves(std::size_t m, Numbers &local, Draft &draft) {
        struct End {
            std::int32_t atom, other;
            std::size_t end;  // of the leaf's bond in the draft
        };
        const std::size_t first = at(bond_start_[m]);
        std::vector<End> entries;
        for (std::int32_t i = atom_start_[m]; i < atom_start_[m + 1]; ++i) entries.push_back({atoms_[at(i)], -1, 0});
        for (std::size_t k = 0; k < draft.bonds.size(); ++k)
            for (std::size_t e = 0; e < 2; ++e) {
                const std::size_t bond = 2 * at(bonds_[first + k]);
                if (fixed_[at(end_[bond + e])]) entries.push_back({end_[bond + e], end_[bond + 1 - e], 2 * k + e});
            }
        std::sort(entries.begin(), entries.end(), [](const End &a, const End &b) {
            return a.atom != b.atom ? a.atom < b.atom : a.other != b.other ? a.other < b.other : a.end < b.end;
        });
        for (std::size_t i = 0; i < entries.size(); ++i) {
            const End &entry = entries[i];
            if (i > 0 && entry.other >= 0 && entry.atom == entries[i - 1].atom && entry.other == entries[i - 1].other)
                throw bond_error(list_, Status::degenerate,
                                 std::max(draft.bonds[entry.end / 2], draft.bonds[entries[i - 1].end / 2]),
                                 "joins two atoms that another bond of the list joins already");
            if (entry.other < 0) local[at(entry.atom)] = static_cast<std::int32_t>(i);
            draft.atoms.push_back(number_.atom(entry.atom));
            draft.fixed.push_back(entry.other >= 0);
        }
        for (std::size_t k = 0; k < draft.bonds.size(); ++k)
            for (std::size_t e = 0; e < 2; ++e) draft.pairs[2 * k + e] = local[at(end_[2 * at(bonds_[first + k]) + e])];
        for (std::size_t i = 0; i < entries.size(); ++i)
            if (entries[i].other >= 0) draft.pairs[entries[i].end] = static_cast<std::int32_t>(i);
    }

    const BondList &list_;
    const Numbering number_;
    Numbers end_;      // short numbers of the atoms of each bond, the bonds in an order of our own:
    Numbers bond_at_;  // their numbers in the list; empty if that is their order
    std::vector<unsigned char> fixed_;
    bool any_fixed_ = false, is_one_ = false;
    std::size_t n_molecules_ = 0;
    Numbers bonds_, bond_start_, atoms_, atom_start_;  // of each molecule
    FoundMolecules found_;
};

}  // namespace

FoundMolecules find_molecules(const Masses &masses, std::int64_t n_atoms, const BondList &list) {
    return Finder(masses, n_atoms, list).find();
}

Error bond_error(const BondList &list, Status status, std::int64_t bond, const char *what) {
    const std::int64_t *const pair = list.pairs + 2 * bond;
    const Labels none, &labels = list.labels ? *list.labels : none;
    Error error = make_error(
        status, "bond %lld of the list (atoms %s and %s) %s", static_cast<long long>(bond + list.base),
        labels.of_atom(pair[0] - list.base, list.base).text, labels.of_atom(pair[1] - list.base, list.base).text, what);
    error.bond = bond;
    error.base = list.base;
    return error;
}

}  // namespace holonomic
