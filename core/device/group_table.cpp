#include "core/device/group_table.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "core/index.hpp"

namespace holonomic::device {

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

// 0: none. Two bonds between the same atoms depend on each other; they have been refused.
int shared_atom(const std::pair<int, int> &one, const std::pair<int, int> &other) {
    for (const int atom : {one.first, one.second})
        if (atom == other.first || atom == other.second)
            return (one.first == atom) == (other.first == atom) ? atom + 1 : -atom - 1;
    return 0;
}

}  // namespace

std::vector<int> group_table(const KernelKind &kind) {
    const auto &entries = kind.entries;  // sorted, so that those of a bond stand together
    const int n_bonds = kind.n_bonds(), n_entries = kind.n_entries();
    const auto place = [&](int one, int other) {
        const std::pair<int, int> entry = std::minmax({one, other});
        return std::lower_bound(entries.begin(), entries.end(), entry) - entries.begin();
    };
    std::vector<int> ends, rows(at(n_bonds + 1), n_entries), bonds_of_entries, shared;
    Lists earlier(at(n_bonds)), terms(at(n_entries)), bonds_of_atoms(at(kind.n_atoms));
    for (int k = 0; k < n_bonds; ++k) {
        const auto &bond = kind.bonds[at(k)];
        ends.insert(ends.end(), {bond.first, bond.second});
        bonds_of_atoms[at(bond.first)].push_back(k + 1);
        bonds_of_atoms[at(bond.second)].push_back(-k - 1);
    }
    for (int p = n_entries; p-- > 0;) rows[at(entries[at(p)].first)] = p;
    for (int k = n_bonds; k-- > 0;)
        if (rows[at(k)] == n_entries) rows[at(k)] = rows[at(k + 1)];
    for (int p = 0; p < n_entries; ++p) {
        const auto [bond, other] = entries[at(p)];
        bonds_of_entries.insert(bonds_of_entries.end(), {bond, other});
        shared.push_back(shared_atom(kind.bonds[at(bond)], kind.bonds[at(other)]));
        earlier[at(other)].insert(earlier[at(other)].end(), {p, bond});
        for (int q = p + 1; q < rows[at(bond + 1)]; ++q) {
            auto &taken = terms[at(place(other, entries[at(q)].second))];
            taken.insert(taken.end(), {p, q, bond});
        }
    }
    const int n_levels = static_cast<int>(kind.levels.size()) - 1;
    const std::vector<int> parts[] = {{kind.n_atoms, n_bonds, n_levels},
                                      ends,
                                      kind.levels,
                                      rows,
                                      bonds_of_entries,
                                      shared,
                                      starts(earlier, 2),
                                      joined(earlier),
                                      starts(terms, 3),
                                      joined(terms),
                                      starts(bonds_of_atoms, 1),
                                      joined(bonds_of_atoms)};
    constexpr std::size_t n_parts = sizeof parts / sizeof *parts;
    static_assert(n_parts == sizeof parts_of_table / sizeof *parts_of_table);
    std::vector<int> table(n_parts);
    for (std::size_t part = 0; part < n_parts; ++part) {
        table[part] = static_cast<int>(table.size());
        table.insert(table.end(), parts[part].begin(), parts[part].end());
    }
    return table;
}

}  // namespace holonomic::device
