#include "Elimination.h"

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

using namespace OpenMM;

namespace {

using Pairs = std::vector<std::pair<int, int>>;
using Neighbours = std::vector<std::set<int>>;

Neighbours bondsThatShareAtoms(int nAtoms, const Pairs &bonds) {
    std::vector<std::vector<int>> at(nAtoms);
    Neighbours near(bonds.size());
    for (int k = 0; k < static_cast<int>(bonds.size()); ++k)
        for (int atom : {bonds[k].first, bonds[k].second}) {
            for (int other : at[atom]) {
                near[k].insert(other);
                near[other].insert(k);
            }
            at[atom].push_back(k);
        }
    return near;
}

// How many pairs of a bond's neighbours get an entry when it is eliminated.
int filled(const Neighbours &near, int bond) {
    int n = 0;
    for (int one : near[bond])
        for (int other : near[bond]) n += one < other && !near[one].count(other);
    return n;
}

// An order that grows bond by bond.
class Order {
public:
    explicit Order(Kind &of) : near(bondsThatShareAtoms(of.nAtoms, of.bonds)), kind(of), place(of.bonds.size(), -1) {}

    bool isPlaced(int bond) const { return place[bond] >= 0; }
    std::size_t nEntries() const { return entries.size(); }
    // Eliminates a bond: its neighbours are neighbours of each other from now on.
    void add(int bond) {
        place[bond] = static_cast<int>(ordered.size());
        ordered.push_back(kind.bonds[bond]);
        for (int k : near[bond]) {
            entries.emplace_back(bond, k);
            near[k].erase(bond);
            for (int other : near[bond])
                if (other != k) near[k].insert(other);
        }
    }
    // Of all bonds: writes it into the kind, and gives the place of each.
    std::vector<int> finished() {
        for (auto &entry : entries) entry = {place[entry.first], place[entry.second]};
        std::sort(entries.begin(), entries.end());
        kind.bonds = ordered;
        kind.entries = entries;
        return place;
    }

    Neighbours near;  // of those that are not placed yet

private:
    Kind &kind;
    std::vector<int> place;
    Pairs ordered, entries;
};

}  // namespace

std::vector<int> OpenMM::eliminateOneByOne(Kind &kind, std::size_t maxEntries) {
    const int n = static_cast<int>(kind.bonds.size());
    if (kind.bonds.size() > maxEntries) return {};
    Order order(kind);
    for (int step = 0; step < n; ++step) {
        int next = -1, least = 0;
        for (int k = 0; k < n; ++k) {
            if (order.isPlaced(k)) continue;
            const int fill = filled(order.near, k);
            if (next < 0 || fill < least) {
                next = k;
                least = fill;
            }
        }
        order.add(next);
        if (order.nEntries() > maxEntries) return {};
    }
    return order.finished();
}

std::vector<int> OpenMM::eliminateByLevels(Kind &kind) {
    const int n = static_cast<int>(kind.bonds.size());
    Order order(kind);
    std::vector<int> levels{0}, levelOfNeighbour(n, -1);
    std::size_t nTerms = 0;
    while (levels.back() < n) {
        std::vector<std::tuple<int, std::size_t, int>> left;  // by fill, then by neighbours
        for (int k = 0; k < n; ++k)
            if (!order.isPlaced(k)) left.emplace_back(filled(order.near, k), order.near[k].size(), k);
        std::sort(left.begin(), left.end());
        const int level = static_cast<int>(levels.size()), mostFill = 2 * std::get<0>(left[0]) + 1;
        levels.push_back(levels.back());
        for (const auto &one : left) {
            const int k = std::get<2>(one);
            if (std::get<0>(one) > mostFill || levelOfNeighbour[k] == level) continue;
            for (int other : order.near[k]) levelOfNeighbour[other] = level;
            nTerms += std::get<1>(one) * std::get<1>(one);
            order.add(k);
            ++levels.back();
        }
        if (nTerms > mostTermsOfBond * kind.bonds.size()) return {};
    }
    kind.levels = levels;
    return order.finished();
}
