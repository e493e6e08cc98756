#include "arrangement.hpp"

#include <algorithm>
#include <map>
#include <numeric>

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

struct Molecule {
    std::vector<int> atoms, parents, bonds;  // parents: places within it
};

class Finder {
public:
    Finder(const std::vector<Bond> &bonds, const std::vector<double> &masses)
        : list(bonds), around(bonds, masses.size()), place(masses.size(), -1) {}

    bool is_new(int atom) const { return place[atom] < 0 && around.count(atom) > 0; }

    // With all that is bonded to `atom`, the lowest of its molecule.
    Molecule find(int atom) {
        Molecule found = walk(atom);
        int n_ends = 0, most = 0, end = atom;
        for (int i : found.atoms) {
            most = std::max(most, around.count(i));
            if (around.count(i) == 1 && ++n_ends == 1)
                end = i;
            else if (around.count(i) == 1)
                end = std::min(end, i);
        }
        if (most <= 2 && n_ends == 2) {  // a chain: along it
            if (end != atom) found = walk_again(found, end);
        } else {
            sort(found);
        }
        std::sort(found.bonds.begin(), found.bonds.end());
        return found;
    }

private:
    Molecule walk(int root) {
        Molecule found;
        found.atoms.push_back(root);
        found.parents.push_back(0);
        place[root] = 0;
        for (size_t k = 0; k < found.atoms.size(); k++) {
            const int atom = found.atoms[k];
            for (int n = around.starts[atom]; n < around.starts[atom + 1]; n++) {
                const int bond = around.bonds[n], other = list[bond].first + list[bond].second - atom;
                if (list[bond].first == atom) found.bonds.push_back(bond);
                if (place[other] >= 0) continue;
                place[other] = static_cast<int>(found.atoms.size());
                found.atoms.push_back(other);
                found.parents.push_back(static_cast<int>(k));
            }
        }
        return found;
    }

    Molecule walk_again(const Molecule &found, int root) {
        for (int atom : found.atoms) place[atom] = -1;
        return walk(root);
    }

    // Into the order of the topology, where each atom but the first has a bond to one before it.
    void sort(Molecule &found) {
        std::vector<int> sorted = found.atoms;
        std::sort(sorted.begin(), sorted.end());
        std::vector<int> parents(sorted.size(), 0);
        for (size_t k = 1; k < sorted.size(); k++) {
            int parent = sorted[k];
            for (int n = around.starts[sorted[k]]; n < around.starts[sorted[k] + 1]; n++) {
                const Bond &bond = list[around.bonds[n]];
                parent = std::min(parent, bond.first + bond.second - sorted[k]);
            }
            if (parent == sorted[k]) return;
            parents[k] = static_cast<int>(std::lower_bound(sorted.begin(), sorted.end(), parent) - sorted.begin());
        }
        for (size_t k = 0; k < sorted.size(); k++) place[sorted[k]] = static_cast<int>(k);
        found.atoms.swap(sorted);
        found.parents.swap(parents);
    }

    const std::vector<Bond> &list;
    const Neighbours around;

public:
    std::vector<int> place;  // of each atom in its molecule, -1 of atoms of none
};

// What two molecules must have in common to be of one kind.
std::vector<double> signature(const Molecule &molecule, const Finder &finder, const std::vector<Bond> &list,
                              const std::vector<double> &masses) {
    std::vector<double> numbers;
    numbers.reserve(1 + molecule.atoms.size() + 4 * molecule.bonds.size());
    numbers.push_back(static_cast<double>(molecule.atoms.size()));
    for (int atom : molecule.atoms) numbers.push_back(masses[atom]);
    for (int k : molecule.bonds) {
        numbers.push_back(finder.place[list[k].first]);
        numbers.push_back(finder.place[list[k].second]);
        numbers.push_back(list[k].a);
        numbers.push_back(list[k].b);
    }
    return numbers;
}

}  // namespace

Arrangement arrange(const std::vector<Bond> &list, const std::vector<double> &masses) {
    Finder finder(list, masses);
    std::map<std::vector<double>, std::vector<Molecule>> kinds;
    for (size_t atom = 0; atom < masses.size(); atom++) {
        if (!finder.is_new(static_cast<int>(atom))) continue;
        Molecule molecule = finder.find(static_cast<int>(atom));
        kinds[signature(molecule, finder, list, masses)].push_back(std::move(molecule));
    }
    Arrangement result;
    for (const auto &[numbers, molecules] : kinds) {
        const Molecule &one = molecules.front();
        result.kinds.push_back({static_cast<int64_t>(molecules.size()), static_cast<int64_t>(one.atoms.size()),
                                static_cast<int64_t>(one.bonds.size()), static_cast<int64_t>(result.atoms.size()),
                                static_cast<int64_t>(result.order.size())});
        for (const Molecule &molecule : molecules) {
            const int start = static_cast<int>(result.atoms.size());
            result.starts.push_back(start);
            result.atoms.insert(result.atoms.end(), molecule.atoms.begin(), molecule.atoms.end());
            for (int parent : molecule.parents) result.parents.push_back(start + parent);
            for (int k : molecule.bonds) {
                result.order.push_back(k);
                result.bonds.push_back(
                    {start + finder.place[list[k].first], start + finder.place[list[k].second], list[k].a, list[k].b});
            }
        }
    }
    result.starts.push_back(static_cast<int>(result.atoms.size()));
    return result;
}

}  // namespace holonomic
