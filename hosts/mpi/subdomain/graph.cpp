#include "graph.hpp"

#include <algorithm>

namespace holonomic_subdomain {

Graph::Graph(std::vector<double> inverse_masses, std::vector<Bond> given, const std::vector<End> &ends)
    : w(std::move(inverse_masses)), bonds(std::move(given)), n_rows(n_bonds()), first_(w.size() + 1, 0),
      at_(2 * bonds.size() + ends.size()) {
    for (const Bond &bond : bonds) ++first_[bond.from + 1], ++first_[bond.to + 1];
    for (const End &end : ends) ++first_[end.atom + 1], n_rows = std::max(n_rows, end.row + 1);
    for (std::size_t i = 0; i < w.size(); ++i) first_[i + 1] += first_[i];
    std::vector<int> next(first_.begin(), first_.end() - 1);
    for (int k = 0; k < n_bonds(); ++k) {
        at_[next[bonds[k].from]++] = {k, -1.0};
        at_[next[bonds[k].to]++] = {k, 1.0};
    }
    for (const End &end : ends) at_[next[end.atom]++] = {end.row, end.sign()};
}

}  // namespace holonomic_subdomain
