#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>

#include "Elimination.h"
#include "Kinds.h"

namespace OpenMM {

namespace {

using Pairs = std::vector<std::pair<int, int>>;

std::vector<std::vector<int>> neighbours(int n, const Pairs &pairs) {
    std::vector<std::vector<int>> of(n);
    for (const auto &pair : pairs) {
        of[pair.first].push_back(pair.second);
        of[pair.second].push_back(pair.first);
    }
    return of;
}

// Atoms from the one with the most bonds outwards, so that molecules that are written alike, a methyl group with its
// carbon first or last, get the same numbers.
std::vector<int> outwards(int nAtoms, const Pairs &bonds) {
    const auto near = neighbours(nAtoms, bonds);
    const auto more = [&](int a, int b) { return near[a].size() > near[b].size(); };
    std::vector<int> order(nAtoms);
    std::iota(order.begin(), order.end(), 0);
    order = {*std::min_element(order.begin(), order.end(), more)};
    std::vector<bool> seen(nAtoms, false);
    seen[order[0]] = true;
    for (std::size_t next = 0; next < order.size(); ++next) {
        std::vector<int> beyond = near[order[next]];
        std::sort(beyond.begin(), beyond.end());
        std::stable_sort(beyond.begin(), beyond.end(), more);
        for (int atom : beyond)
            if (!seen[atom]) {
                seen[atom] = true;
                order.push_back(atom);
            }
    }
    return order;
}

}  // namespace

std::vector<MoleculesOfKind> sortedByKind(const hol_chains *chains, std::size_t maxEntriesOfThread) {
    std::vector<std::int64_t> pairs(2 * hol_chains_n_bonds(chains));
    std::vector<double> lengths(hol_chains_n_bonds(chains));
    hol_chains_pairs(chains, pairs.data());
    hol_chains_lengths(chains, lengths.data());
    std::map<Kind, std::pair<Kind, std::vector<int>>> eliminated;  // by the Kind as its bonds were named
    std::map<Kind, std::vector<Molecule>> found;
    for (std::int64_t number = 0; number < hol_chains_n_molecules(chains); ++number) {
        int shape;
        std::int64_t nAtoms, nBonds;
        hol_chains_molecule(chains, number, &shape, &nAtoms, &nBonds);
        if (shape == HOL_SHAPE_RIGID) continue;
        std::vector<std::int64_t> bonds(nBonds);
        hol_chains_bonds(chains, number, bonds.data());
        std::vector<int> atoms;
        for (std::int64_t k : bonds)
            for (int end = 0; end < 2; ++end) atoms.push_back(static_cast<int>(pairs[2 * k + end]));
        std::sort(atoms.begin(), atoms.end());
        atoms.erase(std::unique(atoms.begin(), atoms.end()), atoms.end());
        const auto placeOf = [&](std::int64_t atom) {
            return static_cast<int>(std::lower_bound(atoms.begin(), atoms.end(), atom) - atoms.begin());
        };
        Pairs ends;
        for (std::int64_t k : bonds) ends.emplace_back(placeOf(pairs[2 * k]), placeOf(pairs[2 * k + 1]));
        const std::vector<int> order = outwards(static_cast<int>(atoms.size()), ends);
        std::vector<int> renamed(order.size());
        for (std::size_t k = 0; k < order.size(); ++k) renamed[order[k]] = static_cast<int>(k);
        // Bonds by their new ends: the kind does not depend on the order in which they were given.
        std::vector<std::pair<std::pair<int, int>, std::int64_t>> named;
        for (std::size_t k = 0; k < ends.size(); ++k)
            named.emplace_back(std::minmax(renamed[ends[k].first], renamed[ends[k].second]), bonds[k]);
        std::sort(named.begin(), named.end());
        Kind kind{static_cast<int>(atoms.size()), {}, {}, {}};
        for (const auto &bond : named) kind.bonds.push_back(bond.first);
        if (!eliminated.count(kind)) {
            Kind inOrder = kind;
            std::vector<int> placed = eliminateOneByOne(inOrder, maxEntriesOfThread);
            if (placed.empty()) placed = eliminateByLevels(inOrder);
            eliminated.emplace(kind, std::make_pair(std::move(inOrder), std::move(placed)));
        }
        const std::vector<int> &place = eliminated.at(kind).second;
        if (place.empty()) continue;
        Molecule molecule{number, {}, std::vector<double>(bonds.size())};
        for (int atom : order) molecule.atoms.push_back(atoms[atom]);
        for (std::size_t k = 0; k < named.size(); ++k) molecule.lengths[place[k]] = lengths[named[k].second];
        found[eliminated.at(kind).first].push_back(molecule);
    }
    std::vector<MoleculesOfKind> sorted;
    for (auto &one : found) sorted.push_back({one.first, std::move(one.second)});
    std::stable_sort(sorted.begin(), sorted.end(), [](const MoleculesOfKind &a, const MoleculesOfKind &b) {
        if (a.kind.isForBlock() != b.kind.isForBlock()) return b.kind.isForBlock();
        return a.kind.bonds.size() > b.kind.bonds.size();
    });
    return sorted;
}

}  // namespace OpenMM
