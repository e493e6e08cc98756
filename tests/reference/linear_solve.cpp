#include "linear_solve.hpp"

#include <utility>

namespace reference
{

bool solve_dense(const tridiagonal &matrix, std::vector<quad> &b)
{
    const std::size_t n = matrix.size();
    std::vector<std::vector<quad>> a(n, std::vector<quad>(n, quad(0)));
    for (std::size_t k = 0; k < n; ++k) {
        a[k][k] = matrix.diagonal[k];
        if (k > 0) a[k][k - 1] = matrix.lower[k];
        if (k + 1 < n) a[k][k + 1] = matrix.upper[k];
    }
    for (std::size_t k = 0; k < n; ++k) {
        std::size_t pivot = k;
        for (std::size_t i = k + 1; i < n; ++i)
            if (absolute(a[i][k]) > absolute(a[pivot][k])) pivot = i;
        if (a[pivot][k] == 0) return false;
        std::swap(a[k], a[pivot]);
        std::swap(b[k], b[pivot]);
        for (std::size_t i = k + 1; i < n; ++i) {
            if (a[i][k] == 0) continue;
            const quad factor = a[i][k] / a[k][k];
            for (std::size_t j = k; j < n; ++j) a[i][j] -= factor * a[k][j];
            b[i] -= factor * b[k];
        }
    }
    for (std::size_t k = n; k-- > 0;) {
        for (std::size_t j = k + 1; j < n; ++j) b[k] -= a[k][j] * b[j];
        b[k] /= a[k][k];
    }
    return true;
}

bool solve_banded(tridiagonal m, std::vector<quad> &b)
{
    const std::size_t n = m.size();
    std::vector<quad> second(n, quad(0));  // second superdiagonal, filled by row exchanges
    for (std::size_t k = 0; k + 1 < n; ++k) {
        if (absolute(m.lower[k + 1]) > absolute(m.diagonal[k])) {
            std::swap(m.diagonal[k], m.lower[k + 1]);
            std::swap(m.upper[k], m.diagonal[k + 1]);
            std::swap(second[k], m.upper[k + 1]);
            std::swap(b[k], b[k + 1]);
        }
        if (m.diagonal[k] == 0) return false;
        const quad factor = m.lower[k + 1] / m.diagonal[k];
        m.diagonal[k + 1] -= factor * m.upper[k];
        m.upper[k + 1] -= factor * second[k];
        b[k + 1] -= factor * b[k];
    }
    if (m.diagonal[n - 1] == 0) return false;
    for (std::size_t k = n; k-- > 0;) {
        if (k + 1 < n) b[k] -= m.upper[k] * b[k + 1];
        if (k + 2 < n) b[k] -= second[k] * b[k + 2];
        b[k] /= m.diagonal[k];
    }
    return true;
}

bool solve(const tridiagonal &matrix, std::vector<quad> &right_side)
{
    const std::size_t dense_limit = 64;
    return matrix.size() <= dense_limit ? solve_dense(matrix, right_side) : solve_banded(matrix, right_side);
}

tridiagonal with_negative_neighbours(tridiagonal matrix)
{
    for (quad &x : matrix.lower) x = -absolute(x);
    for (quad &x : matrix.upper) x = -absolute(x);
    return matrix;
}

}  // namespace reference
