#include "sparse_factors.hpp"

#include <algorithm>
#include <set>

namespace holonomic_subdomain {

SparseFactors::SparseFactors(int n, std::vector<std::array<int, 2>> pairs) : n_(n), pairs_(std::move(pairs)) {
    order();
    find_pattern();
}

/** Minimum degree: of the rows that are left, the one coupled to the fewest goes next; it couples these to each other.
 */
void SparseFactors::order() {
    std::vector<std::set<int>> neighbours(n_);
    for (const auto &pair : pairs_) {
        neighbours[pair[0]].insert(pair[1]);
        neighbours[pair[1]].insert(pair[0]);
    }
    std::set<std::array<int, 2>> queue;  // degree, row
    const auto degree = [&](int row) { return static_cast<int>(neighbours[row].size()); };
    for (int row = 0; row < n_; ++row) queue.insert({degree(row), row});
    place_.assign(n_, 0);
    std::vector<std::vector<int>> rows(n_);
    for (int k = 0; k < n_; ++k) {
        const int row = (*queue.begin())[1];
        queue.erase(queue.begin());
        place_[row] = k;
        rows[k].assign(neighbours[row].begin(), neighbours[row].end());
        for (int other : rows[k]) {
            queue.erase({degree(other), other});
            neighbours[other].erase(row);
            for (int third : rows[k])
                if (third != other) neighbours[other].insert(third);
            queue.insert({degree(other), other});
        }
        neighbours[row].clear();
    }
    first_.assign(1, 0);
    for (std::vector<int> &row : rows) {
        for (int &other : row) other = place_[other];
        std::sort(row.begin(), row.end());
        columns_.insert(columns_.end(), row.begin(), row.end());
        first_.push_back(columns_.size());
    }
}

void SparseFactors::find_pattern() {
    lower_first_.assign(n_ + 1, 0);
    for (int column : columns_) ++lower_first_[column + 1];
    for (int i = 0; i < n_; ++i) lower_first_[i + 1] += lower_first_[i];
    std::vector<std::size_t> next(lower_first_.begin(), lower_first_.end() - 1);
    lower_rows_.resize(columns_.size());
    lower_at_.resize(columns_.size());
    for (int k = 0; k < n_; ++k)
        for (std::size_t at = first_[k]; at < first_[k + 1]; ++at) {
            lower_rows_[next[columns_[at]]] = k;
            lower_at_[next[columns_[at]]++] = at;
        }
    for (const auto &pair : pairs_) {
        const int row = std::min(place_[pair[0]], place_[pair[1]]), column = std::max(place_[pair[0]], place_[pair[1]]);
        const auto begin = columns_.begin() + static_cast<std::ptrdiff_t>(first_[row]);
        const auto end = columns_.begin() + static_cast<std::ptrdiff_t>(first_[row + 1]);
        position_.push_back(static_cast<std::size_t>(std::lower_bound(begin, end, column) - columns_.begin()));
    }
    values_.resize(columns_.size());
    pivots_.resize(n_);
    dense_.resize(n_);
}

bool SparseFactors::factorize(const double *values) {
    std::fill(values_.begin(), values_.end(), 0.0);
    for (std::size_t p = 0; p < pairs_.size(); ++p) values_[position_[p]] = values[n_ + p];
    for (int row = 0; row < n_; ++row) pivots_[place_[row]] = values[row];
    for (int i = 0; i < n_; ++i) {
        for (std::size_t at = first_[i]; at < first_[i + 1]; ++at) dense_[columns_[at]] = values_[at];
        for (std::size_t p = lower_first_[i]; p < lower_first_[i + 1]; ++p) {
            // Row k of the upper factor, from column i on
            const int k = lower_rows_[p];
            const double factor = values_[lower_at_[p]] * pivots_[k];
            pivots_[i] -= factor * values_[lower_at_[p]];
            for (std::size_t at = lower_at_[p] + 1; at < first_[k + 1]; ++at)
                dense_[columns_[at]] -= factor * values_[at];
        }
        if (!(pivots_[i] > 0)) return false;
        for (std::size_t at = first_[i]; at < first_[i + 1]; ++at) values_[at] = dense_[columns_[at]] / pivots_[i];
    }
    return true;
}

void SparseFactors::solve(double *x) const {
    std::vector<double> &y = dense_;
    for (int row = 0; row < n_; ++row) y[place_[row]] = x[row];
    for (int k = 0; k < n_; ++k)
        for (std::size_t at = first_[k]; at < first_[k + 1]; ++at) y[columns_[at]] -= values_[at] * y[k];
    for (int k = n_ - 1; k >= 0; --k) {
        y[k] /= pivots_[k];
        for (std::size_t at = first_[k]; at < first_[k + 1]; ++at) y[k] -= values_[at] * y[columns_[at]];
    }
    for (int row = 0; row < n_; ++row) x[row] = y[place_[row]];
}

}  // namespace holonomic_subdomain
