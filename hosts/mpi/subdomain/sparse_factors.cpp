#include "sparse_factors.hpp"

#include <algorithm>

namespace holonomic_subdomain {

SparseFactors::SparseFactors(int n, const std::vector<std::array<int, 2>> &pairs, int n_last, int most) : n_(n) {
    order(pairs, n_last, most);
    find_pattern(pairs);
}

namespace {

/** Rows by the number of others that they are coupled to; what a row was before is found out when it is its turn. */
class Queue {
public:
    void add(int row, std::size_t degree) {
        if (degree >= rows_.size()) rows_.resize(degree + 1);
        rows_[degree].push_back(row);
        least_ = std::min(least_, degree);
    }

    /** The row of the least degree that was added last; -1: none. */
    template <class Degree>
    int take(Degree degree_of) {
        for (; least_ < rows_.size(); ++least_)
            while (!rows_[least_].empty()) {
                const int row = rows_[least_].back();
                rows_[least_].pop_back();
                if (degree_of(row) == least_) return row;
            }
        return -1;
    }

private:
    std::vector<std::vector<int>> rows_;
    std::size_t least_ = 0;
};

}  // namespace

/** Minimum degree: of the rows that are left, the one coupled to the fewest goes next; it couples these to each other.
 */
void SparseFactors::order(const std::vector<std::array<int, 2>> &pairs, int n_last, int most) {
    std::vector<std::vector<int>> neighbours(n_);
    for (const auto &pair : pairs) {
        std::vector<int> &some = neighbours[pair[0]];
        if (std::find(some.begin(), some.end(), pair[1]) != some.end()) continue;
        some.push_back(pair[1]);
        neighbours[pair[1]].push_back(pair[0]);
    }
    const int n_first = n_ - n_last;
    Queue queue;
    for (int row = n_first; row-- > 0;)
        if (neighbours[row].size() <= static_cast<std::size_t>(most)) queue.add(row, neighbours[row].size());
    place_.assign(n_, -1);
    std::vector<int> mark(n_, -1);
    std::vector<std::vector<int>> rows;
    const auto degree = [&](int row) {
        return place_[row] < 0 ? neighbours[row].size() : static_cast<std::size_t>(-1);
    };
    for (int row; (row = queue.take(degree)) >= 0;) {
        place_[row] = static_cast<int>(row_at_.size());
        row_at_.push_back(row);
        const std::vector<int> &around = neighbours[row];
        for (int other : around) {
            std::vector<int> &its = neighbours[other];
            *std::find(its.begin(), its.end(), row) = its.back();
            its.pop_back();
            for (int third : its) mark[third] = other;
            mark[other] = other;
            for (int third : around)
                if (mark[third] != other) its.push_back(third);
            if (other < n_first && its.size() <= static_cast<std::size_t>(most)) queue.add(other, its.size());
        }
        rows.push_back(around);
    }
    n_eliminated_ = static_cast<int>(row_at_.size());
    for (int row = 0; row < n_; ++row) {
        if (place_[row] >= 0) continue;
        place_[row] = static_cast<int>(row_at_.size());
        row_at_.push_back(row);
        rows.push_back(neighbours[row]);
    }
    for (int k = 0; k < n_; ++k) {
        for (int &other : rows[k]) other = place_[other];
        std::sort(rows[k].begin(), rows[k].end());
        for (int other : rows[k]) {
            if (other < k) continue;  // of the rest
            columns_.push_back(other);
            if (k >= n_eliminated_) rest_pairs_.push_back({row_at_[k], row_at_[other]});
        }
        first_.push_back(columns_.size());
    }
}

void SparseFactors::find_pattern(const std::vector<std::array<int, 2>> &pairs) {
    lower_first_.assign(n_ + 1, 0);
    for (std::size_t at = 0; at < first_[n_eliminated_]; ++at) ++lower_first_[columns_[at] + 1];
    for (int i = 0; i < n_; ++i) lower_first_[i + 1] += lower_first_[i];
    std::vector<std::size_t> next(lower_first_.begin(), lower_first_.end() - 1);
    lower_rows_.resize(first_[n_eliminated_]);
    lower_at_.resize(first_[n_eliminated_]);
    for (int k = 0; k < n_eliminated_; ++k)
        for (std::size_t at = first_[k]; at < first_[k + 1]; ++at) {
            lower_rows_[next[columns_[at]]] = k;
            lower_at_[next[columns_[at]]++] = at;
        }
    for (const auto &pair : pairs) {
        const int row = std::min(place_[pair[0]], place_[pair[1]]), column = std::max(place_[pair[0]], place_[pair[1]]);
        const auto begin = columns_.begin() + static_cast<std::ptrdiff_t>(first_[row]);
        const auto end = columns_.begin() + static_cast<std::ptrdiff_t>(first_[row + 1]);
        swapped_.push_back(row != place_[pair[0]]);
        position_.push_back(static_cast<std::size_t>(std::lower_bound(begin, end, column) - columns_.begin()));
    }
    values_.resize(columns_.size());
    pivots_.resize(n_);
    inverse_.resize(n_);
    dense_.resize(n_);
    solution_.resize(n_);
}

int SparseFactors::factorize(const double *values, const double *lower) {
    symmetric_ = !lower;
    std::fill(values_.begin(), values_.end(), 0.0);
    lower_.assign(symmetric_ ? 0 : values_.size(), 0.0);
    dense_lower_.resize(symmetric_ ? 0 : n_);
    for (std::size_t p = 0; p < position_.size(); ++p) {
        values_[position_[p]] += symmetric_ || !swapped_[p] ? values[n_ + p] : lower[p];
        if (!symmetric_) lower_[position_[p]] += swapped_[p] ? values[n_ + p] : lower[p];
    }
    for (int row = 0; row < n_; ++row) pivots_[place_[row]] = values[row];
    for (int i = 0; i < n_; ++i) {
        const double least = 1e-15 * pivots_[i];
        for (std::size_t at = first_[i]; at < first_[i + 1]; ++at) dense_[columns_[at]] = values_[at];
        for (std::size_t at = first_[i]; !symmetric_ && at < first_[i + 1]; ++at)
            dense_lower_[columns_[at]] = lower_[at];
        for (std::size_t p = lower_first_[i]; p < lower_first_[i + 1]; ++p) {
            // Row k of the upper factor, and column k of the lower one, from i on
            const int k = lower_rows_[p];
            const std::size_t here = lower_at_[p];
            const double factor = (symmetric_ ? values_ : lower_)[here] * pivots_[k];
            pivots_[i] -= factor * values_[here];
            for (std::size_t at = here + 1; at < first_[k + 1]; ++at) dense_[columns_[at]] -= factor * values_[at];
            if (symmetric_) continue;
            const double factor_of_column = values_[here] * pivots_[k];
            for (std::size_t at = here + 1; at < first_[k + 1]; ++at)
                dense_lower_[columns_[at]] -= factor_of_column * lower_[at];
        }
        double inverse = 1;
        if (i < n_eliminated_) {
            if (!(pivots_[i] > least)) return row_at_[i];
            inverse_[i] = inverse = 1 / pivots_[i];
        }
        for (std::size_t at = first_[i]; at < first_[i + 1]; ++at) values_[at] = dense_[columns_[at]] * inverse;
        for (std::size_t at = first_[i]; !symmetric_ && at < first_[i + 1]; ++at)
            lower_[at] = dense_lower_[columns_[at]] * inverse;
    }
    return -1;
}

void SparseFactors::forward(const double *x) {
    double *y = solution_.data();
    const double *lower = (symmetric_ ? values_ : lower_).data();
    for (int k = 0; k < n_; ++k) y[k] = x[row_at_[k]];
    for (int k = 0; k < n_eliminated_; ++k) {
        const double minus = -y[k];
        for (std::size_t at = first_[k]; at < first_[k + 1]; ++at) y[columns_[at]] += lower[at] * minus;
    }
}

void SparseFactors::backward(double *x) {
    double *y = solution_.data();
    for (int k = n_eliminated_ - 1; k >= 0; --k) {
        double sum = y[k] * inverse_[k];
        for (std::size_t at = first_[k]; at < first_[k + 1]; ++at) sum -= values_[at] * y[columns_[at]];
        y[k] = sum;
    }
    for (int k = 0; k < n_; ++k) x[row_at_[k]] = y[k];
}

}  // namespace holonomic_subdomain
