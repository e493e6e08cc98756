/**
 * @file sparse_factor.hpp
 * Elimination of a matrix with a symmetric pattern in minimum-degree order: A = L D U, with unit diagonals of L and U.
 * It subtracts as textbooks do and pays for it with the digits of its numbers. Pivots are taken from the diagonal,
 * which is right for positive definite matrices and for matrices near such ones.
 */
#ifndef REFERENCE_SPARSE_FACTOR_HPP
#define REFERENCE_SPARSE_FACTOR_HPP

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <vector>

namespace reference
{

/** Rows of a matrix: row k holds its elements by column. */
template <class REAL>
using sparse_matrix = std::vector<std::map<std::size_t, REAL>>;

template <class REAL>
class sparse_factor
{
public:
    explicit sparse_factor(const sparse_matrix<REAL> &a)
        : rank_(a.size()), per_pivot_(a.size()), pivot_(a.size()), lower_(a.size()), upper_(a.size())
    {
        order(a);
        std::vector<std::size_t> place(a.size());  // of each neighbour of the row at hand
        const auto find_places = [&](std::size_t k) {
            for (std::size_t n = 0; n < beside_[k].size(); ++n) place[beside_[k][n]] = n;
        };
        for (std::size_t k = 0; k < a.size(); ++k) {
            lower_[k].resize(beside_[k].size());
            upper_[k].resize(beside_[k].size());
            find_places(k);
            for (const std::size_t i : beside_[k])
                if (const auto x = a[i].find(k); x != a[i].end()) lower_[k][place[i]] = x->second;
            for (const auto &[j, x] : a[k])
                if (rank_[j] > rank_[k]) upper_[k][place[j]] = x;
            pivot_[k] = a[k].at(k);
            symmetric_ = symmetric_ && lower_[k] == upper_[k];
        }
        for (const std::size_t k : order_) {
            if (pivot_[k] == REAL(0)) {
                regular_ = false;
                return;
            }
            per_pivot_[k] = REAL(1) / pivot_[k];
            const std::vector<REAL> row = upper_[k];
            if (symmetric_) lower_[k] = row;
            for (REAL &u : upper_[k]) u *= per_pivot_[k];
            for (REAL &l : lower_[k]) l *= per_pivot_[k];
            for (std::size_t n = 0; n < row.size(); ++n) {
                const std::size_t i = beside_[k][n];
                find_places(i);
                pivot_[i] -= lower_[k][n] * row[n];
                for (std::size_t m = 0; m < row.size(); ++m) {
                    const std::size_t j = beside_[k][m];
                    if (rank_[j] <= rank_[i]) continue;
                    upper_[i][place[j]] -= lower_[k][n] * row[m];
                    if (!symmetric_) lower_[i][place[j]] -= lower_[k][m] * row[n];
                }
            }
        }
    }
    /** The same factors, with as many digits as this type has. */
    template <class OTHER>
    explicit sparse_factor(const sparse_factor<OTHER> &other)
        : regular_(other.regular_), symmetric_(other.symmetric_), order_(other.order_), rank_(other.rank_),
          beside_(other.beside_)
    {
        const auto copy = [](const std::vector<OTHER> &x) {
            std::vector<REAL> y;
            for (const OTHER &one : x) y.emplace_back(one);
            return y;
        };
        per_pivot_ = copy(other.per_pivot_);
        pivot_ = copy(other.pivot_);
        for (const auto &x : other.lower_) lower_.push_back(copy(x));
        for (const auto &x : other.upper_) upper_.push_back(copy(x));
    }

    bool regular() const
    {
        return regular_;
    }
    const std::vector<REAL> &pivots() const
    {
        return pivot_;
    }

    /** Whether the matrix was symmetric, to the bit. */
    bool symmetric() const
    {
        return symmetric_;
    }

    static constexpr std::size_t all = SIZE_MAX;
    /** From `row` on in the order of elimination: before it b is zero, and the rows before it are not found. */
    std::vector<REAL> solve(std::vector<REAL> b, std::size_t row = all) const
    {
        const std::size_t first = row == all ? 0 : rank_[row];
        for (std::size_t step = first; step < order_.size(); ++step) {
            const std::size_t k = order_[step];
            if (b[k] == REAL(0)) continue;
            for (std::size_t n = 0; n < beside_[k].size(); ++n) b[beside_[k][n]] -= lower_[k][n] * b[k];
        }
        for (std::size_t step = order_.size(); step-- > first;) {
            const std::size_t k = order_[step];
            b[k] *= per_pivot_[k];
            for (std::size_t n = 0; n < beside_[k].size(); ++n) b[k] -= upper_[k][n] * b[beside_[k][n]];
        }
        return b;
    }

    /** Column by column: inverse[l][k] = (A^-1)_kl. */
    std::vector<std::vector<REAL>> inverse() const
    {
        std::vector<std::vector<REAL>> columns;
        for (std::size_t l = 0; l < pivot_.size(); ++l) {
            std::vector<REAL> e(pivot_.size());
            e[l] = REAL(1);
            columns.push_back(solve(e));
        }
        return columns;
    }

private:
    template <class OTHER>
    friend class sparse_factor;

    /** Order of least degree; for each row its neighbours when its turn comes. */
    void order(const sparse_matrix<REAL> &a)
    {
        const std::size_t n = a.size();
        std::vector<std::set<std::size_t>> graph(n);
        for (std::size_t i = 0; i < n; ++i)
            for (const auto &element : a[i])
                if (element.first != i) graph[i].insert(element.first), graph[element.first].insert(i);
        std::set<std::pair<std::size_t, std::size_t>> by_degree;
        for (std::size_t i = 0; i < n; ++i) by_degree.insert({graph[i].size(), i});
        while (!by_degree.empty()) {
            const std::size_t k = by_degree.begin()->second;
            by_degree.erase(by_degree.begin());
            rank_[k] = order_.size();
            order_.push_back(k);
            for (const std::size_t i : graph[k]) {
                by_degree.erase({graph[i].size(), i});
                graph[i].erase(k);
                for (const std::size_t j : graph[k])
                    if (j != i) graph[i].insert(j);
                by_degree.insert({graph[i].size(), i});
            }
        }
        for (const auto &neighbours : graph) beside_.emplace_back(neighbours.begin(), neighbours.end());
    }

    bool regular_ = true, symmetric_ = true;
    std::vector<std::size_t> order_, rank_;
    std::vector<std::vector<std::size_t>> beside_;  // the neighbours of each row when its turn came
    std::vector<REAL> per_pivot_, pivot_;
    std::vector<std::vector<REAL>> lower_, upper_;  // of these, a column of L and a row of U
};

}  // namespace reference

#endif
