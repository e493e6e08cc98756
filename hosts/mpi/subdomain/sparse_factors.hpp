#ifndef HOLONOMIC_SUBDOMAIN_SPARSE_FACTORS_HPP
#define HOLONOMIC_SUBDOMAIN_SPARSE_FACTORS_HPP

#include <array>
#include <cstddef>
#include <vector>

namespace holonomic_subdomain {

/** Cholesky's elimination, without roots, of a sparse symmetric matrix whose pattern stays. */
class SparseFactors {
public:
    SparseFactors() = default;

    /** pairs: rows that are coupled, (k, l) with k < l, each once. */
    SparseFactors(int n, std::vector<std::array<int, 2>> pairs);

    /**
     * @param values  the n elements of the diagonal, then those of the pairs, as these were given
     * @return whether every pivot is positive
     */
    bool factorize(const double *values);

    /** x, [n]: right-hand side, then solution. */
    void solve(double *x) const;

    const std::vector<std::array<int, 2>> &pairs() const { return pairs_; }
    std::size_t n_entries() const { return columns_.size(); }

private:
    void order();
    void find_pattern();

    int n_ = 0;
    std::vector<std::array<int, 2>> pairs_;
    std::vector<int> place_;  // of a row in the order of elimination
    // Row k of the upper factor, ones on the diagonal left out: columns and values.
    std::vector<std::size_t> first_;
    std::vector<int> columns_;
    std::vector<double> values_, pivots_;
    // Row i of the lower factor: the rows of the upper one that have column i, and where.
    std::vector<std::size_t> lower_first_;
    std::vector<int> lower_rows_;
    std::vector<std::size_t> lower_at_;
    mutable std::vector<double> dense_;
    std::vector<std::size_t> position_;  // of a pair's value in values_
};

}  // namespace holonomic_subdomain

#endif
