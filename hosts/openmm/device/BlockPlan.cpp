#include "BlockPlan.h"

#include <algorithm>
#include <utility>

namespace OpenMM {

namespace {

using Lists = std::vector<std::vector<int>>;

// Where each list begins, counted in groups of so many numbers, and the end.
std::vector<int> starts(const Lists &lists, int size) {
    std::vector<int> begin{0};
    for (const auto &list : lists) begin.push_back(begin.back() + static_cast<int>(list.size()) / size);
    return begin;
}

std::vector<int> joined(const Lists &lists) {
    std::vector<int> all;
    for (const auto &list : lists) all.insert(all.end(), list.begin(), list.end());
    return all;
}

// 0: none. Two bonds between the same atoms depend on each other; the library has refused them.
int sharedAtom(const std::pair<int, int> &one, const std::pair<int, int> &other) {
    for (int atom : {one.first, one.second})
        if (atom == other.first || atom == other.second)
            return (one.first == atom) == (other.first == atom) ? atom + 1 : -atom - 1;
    return 0;
}

}  // namespace

std::vector<int> blockPlan(const Kind &kind) {
    const auto &entries = kind.entries;  // sorted, so that those of a bond stand together
    const std::size_t nBonds = kind.bonds.size(), nEntries = entries.size();
    const auto place = [&](int one, int other) {
        const auto entry = std::minmax(one, other);
        return static_cast<int>(std::lower_bound(entries.begin(), entries.end(), std::pair<int, int>(entry)) -
                                entries.begin());
    };
    std::vector<int> ends, rows(nBonds + 1, static_cast<int>(nEntries)), bondsOfEntries, shared;
    Lists earlier(nBonds), terms(nEntries), bondsOfAtoms(kind.nAtoms);
    for (std::size_t k = 0; k < nBonds; ++k) {
        const auto &bond = kind.bonds[k];
        ends.insert(ends.end(), {bond.first, bond.second});
        bondsOfAtoms[bond.first].push_back(static_cast<int>(k) + 1);
        bondsOfAtoms[bond.second].push_back(-static_cast<int>(k) - 1);
    }
    for (std::size_t p = nEntries; p-- > 0;) rows[entries[p].first] = static_cast<int>(p);
    for (std::size_t k = nBonds; k-- > 0;)
        if (rows[k] == static_cast<int>(nEntries)) rows[k] = rows[k + 1];
    for (std::size_t p = 0; p < nEntries; ++p) {
        const int bond = entries[p].first, other = entries[p].second;
        bondsOfEntries.insert(bondsOfEntries.end(), {bond, other});
        shared.push_back(sharedAtom(kind.bonds[bond], kind.bonds[other]));
        earlier[other].insert(earlier[other].end(), {static_cast<int>(p), bond});
        for (int q = static_cast<int>(p) + 1; q < rows[bond + 1]; ++q) {
            auto &taken = terms[place(other, entries[q].second)];
            taken.insert(taken.end(), {static_cast<int>(p), q, bond});
        }
    }
    const int nLevels = static_cast<int>(kind.levels.size()) - 1;
    const std::vector<int> parts[] = {{kind.nAtoms, static_cast<int>(nBonds), nLevels},
                                      ends,
                                      kind.levels,
                                      rows,
                                      bondsOfEntries,
                                      shared,
                                      starts(earlier, 2),
                                      joined(earlier),
                                      starts(terms, 3),
                                      joined(terms),
                                      starts(bondsOfAtoms, 1),
                                      joined(bondsOfAtoms)};
    static_assert(sizeof parts / sizeof *parts == sizeof partsOfPlan / sizeof *partsOfPlan, "");
    std::vector<int> plan(sizeof parts / sizeof *parts);
    for (std::size_t part = 0; part < sizeof parts / sizeof *parts; ++part) {
        plan[part] = static_cast<int>(plan.size());
        plan.insert(plan.end(), parts[part].begin(), parts[part].end());
    }
    return plan;
}

}  // namespace OpenMM
