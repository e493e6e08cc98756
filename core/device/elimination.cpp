#include "core/device/elimination.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <tuple>
#include <utility>

#include "core/index.hpp"
#include "core/molecules/given/lists.hpp"

namespace holonomic::device {

namespace {

using Pairs = std::vector<std::pair<int, int>>;
using Neighbours = std::vector<std::vector<int>>;  // of each bond, ascending

Neighbours bonds_that_share_atoms(int n_atoms, const Pairs &bonds) {
    const int n = static_cast<int>(bonds.size());
    const Lists bonds_at =
        invert(n_atoms, n, [&](int k, int end) { return end == 0 ? bonds[at(k)].first : bonds[at(k)].second; });
    Neighbours near(bonds.size());
    for (int k = 0; k < n; ++k) {
        const int one = bonds[at(k)].first, other = bonds[at(k)].second;
        std::set_union(bonds_at.begin(one), bonds_at.end(one), bonds_at.begin(other), bonds_at.end(other),
                       std::back_inserter(near[at(k)]));
        near[at(k)].erase(std::lower_bound(near[at(k)].begin(), near[at(k)].end(), k));
    }
    return near;
}

int n_common(const std::vector<int> &one, const std::vector<int> &other) {
    int n = 0;
    for (auto a = one.begin(), b = other.begin(); a != one.end() && b != other.end();) {
        n += *a == *b;
        const int last = std::min(*a, *b);
        a += *a == last;
        b += *b == last;
    }
    return n;
}

// How many pairs of a bond's neighbours get an entry when it is eliminated.
int filled(const Neighbours &near, int bond) {
    const int n = static_cast<int>(near[at(bond)].size());
    int ordered = n * (n - 1);
    for (const int one : near[at(bond)]) ordered -= n_common(near[at(one)], near[at(bond)]);
    return ordered / 2;
}

// Products that any order takes at least: all bonds of an atom have entries with each other.
std::int64_t least_products(const KernelKind &kind) {
    std::vector<std::int64_t> degree(at(kind.n_atoms), 0);
    std::int64_t sum = 0;
    for (const auto &bond : kind.bonds)
        for (const int atom : {bond.first, bond.second}) {
            sum += degree[at(atom)] * degree[at(atom)];
            ++degree[at(atom)];
        }
    return sum;
}

// An order that grows bond by bond.
class Order {
public:
    explicit Order(KernelKind &of)
        : near(bonds_that_share_atoms(of.n_atoms, of.bonds)), kind_(of), place_(of.bonds.size(), -1) {}

    bool is_placed(int bond) const { return place_[at(bond)] >= 0; }
    std::int64_t n_entries() const { return static_cast<std::int64_t>(entries_.size()); }
    // Eliminates a bond: its neighbours are neighbours of each other from now on.
    void add(int bond) {
        place_[at(bond)] = static_cast<int>(ordered_.size());
        ordered_.push_back(kind_.bonds[at(bond)]);
        for (const int k : near[at(bond)]) {
            entries_.emplace_back(bond, k);
            joined_.clear();
            std::set_union(near[at(k)].begin(), near[at(k)].end(), near[at(bond)].begin(), near[at(bond)].end(),
                           std::back_inserter(joined_));
            joined_.erase(std::remove_if(joined_.begin(), joined_.end(), [&](int n) { return n == bond || n == k; }),
                          joined_.end());
            near[at(k)] = joined_;
        }
    }
    // Of all bonds: writes it into the kind, and gives the place of each.
    std::vector<int> finished() {
        for (auto &entry : entries_) entry = {place_[at(entry.first)], place_[at(entry.second)]};
        std::sort(entries_.begin(), entries_.end());
        kind_.bonds = ordered_;
        kind_.entries = entries_;
        return place_;
    }

    Neighbours near;  // of those that are not placed yet

private:
    KernelKind &kind_;
    std::vector<int> place_, joined_;
    Pairs ordered_, entries_;
};

}  // namespace

std::vector<int> eliminate_one_by_one(KernelKind &kind, std::int64_t max_entries) {
    const int n = kind.n_bonds();
    if (n > max_entries + 1) return {};  // even a chain has more
    Order order(kind);
    for (int step = 0; step < n; ++step) {
        int next = -1, least = 0;
        for (int k = 0; k < n; ++k) {
            if (order.is_placed(k)) continue;
            const int fill = filled(order.near, k);
            if (next < 0 || fill < least) {
                next = k;
                least = fill;
            }
        }
        order.add(next);
        if (order.n_entries() > max_entries) return {};
    }
    return order.finished();
}

std::vector<int> eliminate_by_levels(KernelKind &kind) {
    const int n = kind.n_bonds();
    const std::int64_t most = most_products_of_bond * n;
    if (least_products(kind) > most) return {};
    Order order(kind);
    std::vector<int> levels{0}, level_of_neighbour(at(n), -1);
    std::int64_t n_products = 0;
    while (levels.back() < n) {
        // If all that is left had its entries with each other, this would be thrice the products.
        std::int64_t ahead = 0;
        for (int k = 0; k < n; ++k)
            if (!order.is_placed(k))
                ahead += static_cast<std::int64_t>(order.near[at(k)].size() * order.near[at(k)].size());
        if (n_products + ahead / 3 > most) return {};
        std::vector<std::tuple<int, std::size_t, int>> left;  // by fill, then by neighbours
        for (int k = 0; k < n; ++k)
            if (!order.is_placed(k)) left.emplace_back(filled(order.near, k), order.near[at(k)].size(), k);
        std::sort(left.begin(), left.end());
        const int level = static_cast<int>(levels.size()), most_fill = 2 * std::get<0>(left[0]) + 1;
        levels.push_back(levels.back());
        for (const auto &[fill, n_near, k] : left) {
            if (fill > most_fill || level_of_neighbour[at(k)] == level) continue;
            for (const int other : order.near[at(k)]) level_of_neighbour[at(other)] = level;
            n_products += static_cast<std::int64_t>(n_near * n_near);
            order.add(k);
            ++levels.back();
        }
    }
    kind.levels = levels;
    return order.finished();
}

}  // namespace holonomic::device
