#ifndef HOLONOMIC_SUBDOMAIN_SPARSE_FACTORS_HPP
#define HOLONOMIC_SUBDOMAIN_SPARSE_FACTORS_HPP

#include <array>
#include <climits>
#include <cstddef>
#include <vector>

namespace holonomic_subdomain {

/**
 * Elimination without exchange of rows, of a sparse matrix with a symmetric pattern that stays. Some rows may be left,
 * the rest: what elimination makes of their elements and right-hand sides belongs to equations of their own.
 */
class SparseFactors {
public:
    SparseFactors() = default;

    /**
     * @param n, pairs  rows, and those that are coupled; elements of pairs that are there twice are added up
     * @param n_last    the last rows, which are left
     * @param most      a row that is coupled to more is left, too
     */
    SparseFactors(int n, const std::vector<std::array<int, 2>> &pairs, int n_last = 0, int most = INT_MAX);

    /**
     * @param values  the n elements of the diagonal, then those of the pairs, as these were given
     * @param lower   elements of the pairs' transposed, or NULL: the matrix is symmetric
     * @return -1, or a row whose pivot is not positive, or lost in rounding
     */
    int factorize(const double *values, const double *lower = nullptr);

    /** x, [n]: right-hand side, then solution. */
    void solve(double *x) { forward(x), backward(x); }

    /** The same in two: x is the right-hand side; the rest's is given by rest(), where its solution is put; x is the
     * solution. */
    void forward(const double *x);
    double &rest(int k) { return solution_[n_eliminated_ + k]; }
    void backward(double *x);

    int n_rest() const { return n_ - n_eliminated_; }
    /** Number of a row of the rest, and the two that are coupled in one of its pairs. */
    int rest_row(int k) const { return row_at_[n_eliminated_ + k]; }
    const std::vector<std::array<int, 2>> &rest_pairs() const { return rest_pairs_; }
    double rest_diagonal(int k) const { return pivots_[n_eliminated_ + k]; }
    double rest_element(std::size_t pair) const { return values_[first_[n_eliminated_] + pair]; }
    double rest_lower(std::size_t pair) const { return lower_[first_[n_eliminated_] + pair]; }

    /** Numbers that factorize() takes; elements of the factor. */
    std::size_t n_values() const { return n_ + position_.size(); }
    std::size_t n_entries() const { return columns_.size(); }

private:
    void order(const std::vector<std::array<int, 2>> &pairs, int n_last, int most);
    void find_pattern(const std::vector<std::array<int, 2>> &pairs);

    int n_ = 0, n_eliminated_ = 0;
    std::vector<int> place_, row_at_;  // of a row in the order of elimination; the row that is there
    // Row k of the upper factor, ones on the diagonal left out: columns and values; column k of the lower one likewise.
    std::vector<std::size_t> first_ = {0};
    std::vector<int> columns_;
    std::vector<double> values_, lower_, pivots_, inverse_;
    bool symmetric_ = true;  // lower_ is values_
    // Row i of the lower factor: the rows of the upper one that have column i, and where.
    std::vector<std::size_t> lower_first_;
    std::vector<int> lower_rows_;
    std::vector<std::size_t> lower_at_;
    std::vector<std::array<int, 2>> rest_pairs_;
    std::vector<double> dense_, dense_lower_, solution_;
    std::vector<std::size_t> position_;  // of a pair's value in values_
    std::vector<char> swapped_;          // whether it is the transposed that stands there
};

}  // namespace holonomic_subdomain

#endif
