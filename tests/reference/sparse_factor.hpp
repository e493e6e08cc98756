/**
 * @file sparse_factor.hpp
 * Elimination of a matrix with a symmetric pattern in minimum-degree order: A = L D U, with unit diagonals of L and U.
 * It subtracts as textbooks do and pays for it with the digits of its numbers. Pivots are taken from the diagonal,
 * which is right for positive definite matrices and for matrices near such ones.
 */
#ifndef REFERENCE_SPARSE_FACTOR_HPP
#define REFERENCE_SPARSE_FACTOR_HPP

#include <cstddef>
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
    explicit sparse_factor(sparse_matrix<REAL> a)
        : rank_(a.size()), pivot_(a.size()), lower_(a.size()), upper_(a.size())
    {
        const std::vector<std::set<std::size_t>> neighbours = order(a);
        sparse_matrix<REAL> columns(a.size());  // the part below the diagonal, by column
        for (std::size_t i = 0; i < a.size(); ++i)
            for (const auto &[j, x] : a[i])
                if (rank_[i] > rank_[j]) columns[j][i] = x;
        for (const std::size_t k : order_) {
            pivot_[k] = a[k][k];
            if (pivot_[k] == REAL(0)) {
                regular_ = false;
                return;
            }
            for (const std::size_t i : neighbours[k]) {
                lower_[k].push_back({i, columns[k][i] / pivot_[k]});
                upper_[k].push_back({i, a[k][i] / pivot_[k]});
            }
            for (const auto &[i, l] : lower_[k])
                for (const std::size_t j : neighbours[k]) {
                    const REAL change = l * a[k][j];
                    REAL &target = rank_[i] > rank_[j] ? columns[j][i] : a[i][j];
                    target -= change;
                }
        }
    }

    bool regular() const
    {
        return regular_;
    }
    const std::vector<REAL> &pivots() const
    {
        return pivot_;
    }

    std::vector<REAL> solve(std::vector<REAL> b) const
    {
        for (const std::size_t k : order_) {
            if (b[k] == REAL(0)) continue;
            for (const auto &[i, l] : lower_[k]) b[i] -= l * b[k];
        }
        for (std::size_t step = order_.size(); step-- > 0;) {
            const std::size_t k = order_[step];
            b[k] /= pivot_[k];
            for (const auto &[j, u] : upper_[k]) b[k] -= u * b[j];
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
    /** Order of least degree; for each row its neighbours when its turn comes. */
    std::vector<std::set<std::size_t>> order(const sparse_matrix<REAL> &a)
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
        return graph;
    }

    bool regular_ = true;
    std::vector<std::size_t> order_, rank_;
    std::vector<REAL> pivot_;
    std::vector<std::vector<std::pair<std::size_t, REAL>>> lower_, upper_;
};

}  // namespace reference

#endif
