#include "arrangement.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <unordered_map>

namespace holonomic {

namespace {

// Bonds by atom.
struct Neighbours {
    Neighbours(const std::vector<Bond> &list, size_t n_atoms) : starts(n_atoms + 1, 0), bonds(2 * list.size()) {
        for (const Bond &bond : list) ++starts[bond.first + 1], ++starts[bond.second + 1];
        std::partial_sum(starts.begin(), starts.end(), starts.begin());
        std::vector<int> next(starts.begin(), starts.end() - 1);
        for (size_t k = 0; k < list.size(); k++)
            for (int atom : {list[k].first, list[k].second}) bonds[next[atom]++] = static_cast<int>(k);
    }
    int count(int atom) const { return starts[atom + 1] - starts[atom]; }
    std::vector<int> starts, bonds;
};

// Where a molecule's atoms and bonds are in the lists of all.
struct Molecule {
    int first_atom, n_atoms, first_bond, n_bonds;
};

class Finder {
public:
    Finder(const std::vector<Bond> &bonds_of_all, const std::vector<double> &masses_of_all)
        : list(bonds_of_all), place(masses_of_all.size(), -1), masses(masses_of_all), around(list, masses.size()) {
        bonds.reserve(list.size());
    }

    bool is_new(int atom) const { return place[atom] < 0 && around.count(atom) > 0; }

    // With all that is bonded to `atom`, the lowest of its molecule.
    Molecule find(int atom) {
        const int first = static_cast<int>(atoms.size()), first_bond = static_cast<int>(bonds.size());
        walk(atom);
        int n_ends = 0, most = 0, end = atom;
        for (size_t k = first; k < atoms.size(); k++) {
            const int i = atoms[k];
            most = std::max(most, around.count(i));
            if (around.count(i) == 1) end = ++n_ends == 1 ? i : std::min(end, i);
        }
        if (most <= 2 && n_ends == 2) {  // a chain: along it
            if (end != atom) walk_again(first, first_bond, end);
        } else if (!std::is_sorted(atoms.begin() + first, atoms.end())) {
            sort(first);
        }
        std::sort(bonds.begin() + first_bond, bonds.end());
        return {first, static_cast<int>(atoms.size()) - first, first_bond, static_cast<int>(bonds.size()) - first_bond};
    }

    // Calls each(number) with what two molecules must have in common to be of one kind, until it says false.
    template <typename Each>
    bool describe(const Molecule &molecule, const Each &each) const {
        if (!each(molecule.n_atoms)) return false;
        for (int k = 0; k < molecule.n_atoms; k++)
            if (!each(masses[atoms[molecule.first_atom + k]])) return false;
        for (int k = 0; k < molecule.n_bonds; k++) {
            const Bond &bond = list[bonds[molecule.first_bond + k]];
            if (!each(place[bond.first]) || !each(place[bond.second]) || !each(bond.a) || !each(bond.b)) return false;
        }
        return true;
    }

    std::vector<double> description(const Molecule &molecule) const {
        std::vector<double> numbers;
        describe(molecule, [&](double number) {
            numbers.push_back(number);
            return true;
        });
        return numbers;
    }

    const std::vector<Bond> &list;
    std::vector<int> atoms, parents, bonds;  // of all molecules; parents: places in their molecules
    std::vector<int> place;                  // of each atom in its molecule, -1 of atoms of none

private:
    void walk(int root) {
        const size_t first = atoms.size();
        add(root, 0, 0);
        for (size_t k = first; k < atoms.size(); k++) {
            const int atom = atoms[k];
            for (int n = around.starts[atom]; n < around.starts[atom + 1]; n++) {
                const int bond = around.bonds[n], other = list[bond].first + list[bond].second - atom;
                if (list[bond].first == atom) bonds.push_back(bond);
                if (place[other] < 0) add(other, static_cast<int>(atoms.size() - first), static_cast<int>(k - first));
            }
        }
    }
    void add(int atom, int its_place, int parent) {
        place[atom] = its_place;
        atoms.push_back(atom);
        parents.push_back(parent);
    }

    void walk_again(int first, int first_bond, int root) {
        for (size_t k = first; k < atoms.size(); k++) place[atoms[k]] = -1;
        atoms.resize(first);
        parents.resize(first);
        bonds.resize(first_bond);
        walk(root);
    }

    // Into the order of the topology, where each atom but the first has a bond to one before it.
    void sort(int first) {
        std::vector<int> sorted(atoms.begin() + first, atoms.end());
        std::sort(sorted.begin(), sorted.end());
        std::vector<int> their_parents(sorted.size(), 0);
        for (size_t k = 1; k < sorted.size(); k++) {
            int parent = sorted[k];
            for (int n = around.starts[sorted[k]]; n < around.starts[sorted[k] + 1]; n++) {
                const Bond &bond = list[around.bonds[n]];
                parent = std::min(parent, bond.first + bond.second - sorted[k]);
            }
            if (parent == sorted[k]) return;
            their_parents[k] =
                static_cast<int>(std::lower_bound(sorted.begin(), sorted.end(), parent) - sorted.begin());
        }
        for (size_t k = 0; k < sorted.size(); k++) place[sorted[k]] = static_cast<int>(k);
        std::copy(sorted.begin(), sorted.end(), atoms.begin() + first);
        std::copy(their_parents.begin(), their_parents.end(), parents.begin() + first);
    }

    const std::vector<double> &masses;
    const Neighbours around;
};

// Molecules by kind. Most are like one that was there before: a hash of the description finds it.
class Sorter {
public:
    explicit Sorter(const Finder &where) : finder(where) {}

    void add(const Molecule &molecule) {
        uint64_t hash = 0;
        finder.describe(molecule, [&](double number) {
            uint64_t bits;
            std::memcpy(&bits, &number, sizeof bits);
            hash = (hash ^ bits ^ (bits >> 29)) * 0x9e3779b97f4a7c15u;
            return true;
        });
        for (auto [here, end] = known.equal_range(hash); here != end; ++here) {
            if (!is_like(molecule, here->second)) continue;
            kinds[here->second].push_back(molecule);
            return;
        }
        known.emplace(hash, kinds.size());
        kinds.push_back({molecule});
        descriptions.push_back(finder.description(molecule));
    }

    // In an order that the description gives, so that other atoms of the same kinds are arranged alike.
    std::vector<const std::vector<Molecule> *> sorted() const {
        std::vector<size_t> order(kinds.size());
        std::iota(order.begin(), order.end(), size_t{0});
        std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return descriptions[a] < descriptions[b]; });
        std::vector<const std::vector<Molecule> *> result;
        for (size_t kind : order) result.push_back(&kinds[kind]);
        return result;
    }

private:
    bool is_like(const Molecule &molecule, size_t kind) const {
        const std::vector<double> &wanted = descriptions[kind];
        size_t k = 0;
        return finder.describe(molecule, [&](double number) { return k < wanted.size() && number == wanted[k++]; }) &&
               k == wanted.size();
    }

    const Finder &finder;
    std::vector<std::vector<Molecule>> kinds;
    std::vector<std::vector<double>> descriptions;
    std::unordered_multimap<uint64_t, size_t> known;
};

}  // namespace

Arrangement arrange(const std::vector<Bond> &list, const std::vector<double> &masses) {
    Finder finder(list, masses);
    Sorter sorter(finder);
    for (size_t atom = 0; atom < masses.size(); atom++)
        if (finder.is_new(static_cast<int>(atom))) sorter.add(finder.find(static_cast<int>(atom)));
    Arrangement result;
    result.atoms.reserve(finder.atoms.size());
    result.parents.reserve(finder.atoms.size());
    result.order.reserve(list.size());
    result.bonds.reserve(list.size());
    for (const std::vector<Molecule> *molecules : sorter.sorted()) {
        const Molecule &one = molecules->front();
        result.kinds.push_back({static_cast<int64_t>(molecules->size()), one.n_atoms, one.n_bonds,
                                static_cast<int64_t>(result.atoms.size()), static_cast<int64_t>(result.order.size())});
        for (const Molecule &molecule : *molecules) {
            const int start = static_cast<int>(result.atoms.size());
            result.starts.push_back(start);
            for (int k = molecule.first_atom; k < molecule.first_atom + molecule.n_atoms; k++) {
                result.atoms.push_back(finder.atoms[k]);
                result.parents.push_back(start + finder.parents[k]);
            }
            for (int k = molecule.first_bond; k < molecule.first_bond + molecule.n_bonds; k++) {
                const Bond &bond = list[finder.bonds[k]];
                result.order.push_back(finder.bonds[k]);
                result.bonds.push_back(
                    {start + finder.place[bond.first], start + finder.place[bond.second], bond.a, bond.b});
            }
        }
    }
    result.starts.push_back(static_cast<int>(result.atoms.size()));
    return result;
}

}  // namespace holonomic
