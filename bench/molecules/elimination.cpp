#include "elimination.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>

namespace bench {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Position of each bond in the order of least fill.
std::vector<int> minimum_degree(const Kind &kind, const std::vector<std::pair<int, int>> &coupled) {
    const int n = static_cast<int>(kind.n_bonds());
    std::vector<Eigen::Triplet<double, int>> entries;
    for (int k = 0; k < n; ++k) entries.emplace_back(k, k, 1.0);
    for (const auto &pair : coupled) {
        entries.emplace_back(pair.first, pair.second, 1.0);
        entries.emplace_back(pair.second, pair.first, 1.0);
    }
    Eigen::SparseMatrix<double, Eigen::ColMajor, int> pattern(n, n);
    pattern.setFromTriplets(entries.begin(), entries.end());
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
    Eigen::AMDOrdering<int>()(pattern, order);
    std::vector<int> step(at(n));
    for (int k = 0; k < n; ++k) step[at(order.indices()[k])] = k;
    return step;
}

/// Later steps that each step couples to, fill included; parents in the elimination tree are the first of them.
std::vector<std::vector<int>> fill(std::size_t n, const std::vector<std::pair<int, int>> &coupled,
                                   const std::vector<int> &step) {
    std::vector<std::vector<int>> below(n), children(n);
    for (const auto &pair : coupled) {
        const int a = step[at(pair.first)], b = step[at(pair.second)];
        below[at(std::min(a, b))].push_back(std::max(a, b));
    }
    for (std::size_t k = 0; k < n; ++k) {
        std::vector<int> &rows = below[k];
        for (int child : children[k]) rows.insert(rows.end(), below[at(child)].begin() + 1, below[at(child)].end());
        std::sort(rows.begin(), rows.end());
        rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
        if (!rows.empty()) children[at(rows.front())].push_back(static_cast<int>(k));
    }
    return below;
}

/// New numbers of the steps, so that each follows what it needs at once: an equivalent order, but with locality.
std::vector<int> postorder(const std::vector<std::vector<int>> &below) {
    const std::size_t n = below.size();
    std::vector<std::vector<int>> children(n);
    std::vector<int> roots, number(n), stack;
    for (std::size_t k = 0; k < n; ++k)
        (below[k].empty() ? roots : children[at(below[k].front())]).push_back(static_cast<int>(k));
    // From the roots down, numbers from the last one on, gives each step a number after all of its subtree.
    int next = static_cast<int>(n);
    for (int root : roots) {
        stack.push_back(root);
        while (!stack.empty()) {
            const int k = stack.back();
            stack.pop_back();
            number[at(k)] = --next;
            stack.insert(stack.end(), children[at(k)].begin(), children[at(k)].end());
        }
    }
    return number;
}

}  // namespace

std::vector<std::pair<int, int>> coupled_bonds(const Kind &kind) {
    std::vector<std::vector<int>> bonds_of(kind.n_atoms());
    std::vector<std::pair<int, int>> pairs;
    for (std::size_t k = 0; k < kind.n_bonds(); ++k)
        for (int atom : {kind.first[k], kind.second[k]}) {
            for (int l : bonds_of[at(atom)]) pairs.emplace_back(static_cast<int>(k), l);
            bonds_of[at(atom)].push_back(static_cast<int>(k));
        }
    return pairs;
}

double coupling_factor(const Kind &kind, int k, int l) {
    const bool same_end = kind.first[at(k)] == kind.first[at(l)] || kind.second[at(k)] == kind.second[at(l)];
    const bool first = kind.first[at(k)] == kind.first[at(l)] || kind.first[at(k)] == kind.second[at(l)];
    const double w = kind.w[at(first ? kind.first[at(k)] : kind.second[at(k)])];
    return same_end ? w : -w;
}

Elimination::Elimination(const Kind &kind) {
    const std::size_t n = kind.n_bonds();
    const auto coupled = coupled_bonds(kind);
    std::vector<int> step = minimum_degree(kind, coupled);
    const std::vector<int> number = postorder(fill(n, coupled, step));
    for (int &k : step) k = number[at(k)];
    const std::vector<std::vector<int>> below = fill(n, coupled, step);
    bond.resize(n);
    for (std::size_t k = 0; k < n; ++k) bond[at(step[k])] = static_cast<int>(k);
    column.push_back(0);
    for (std::size_t k = 0; k < n; ++k) {
        first.push_back(kind.first[at(bond[k])]);
        second.push_back(kind.second[at(bond[k])]);
        length.push_back(kind.length[at(bond[k])]);
        w.push_back(kind.w[at(first[k])] + kind.w[at(second[k])]);
        row.insert(row.end(), below[k].begin(), below[k].end());
        column.push_back(static_cast<int>(row.size()));
    }
    auto entry_of = [this](int i, int k) {
        const auto from = row.begin() + column[at(k)], to = row.begin() + column[at(k) + 1];
        return static_cast<int>(std::lower_bound(from, to, i) - row.begin());
    };
    for (std::size_t k = 0; k < n; ++k)
        for (int a = column[k]; a < column[k + 1]; ++a)
            for (int b = a + 1; b < column[k + 1]; ++b) target.push_back(entry_of(row[at(b)], row[at(a)]));
    for (const auto &pair : coupled) {
        const int a = step[at(pair.first)], b = step[at(pair.second)], i = std::max(a, b), k = std::min(a, b);
        couplings.push_back({entry_of(i, k), i, k, coupling_factor(kind, pair.first, pair.second)});
    }
    std::sort(couplings.begin(), couplings.end(),
              [](const Coupling &a, const Coupling &b) { return a.entry < b.entry; });
}

}  // namespace bench
