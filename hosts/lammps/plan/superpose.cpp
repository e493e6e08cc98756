// SPDX-License-Identifier: GPL-2.0-only
#include "superpose.hpp"

#include <algorithm>
#include <cmath>

namespace holonomic_lammps {

namespace {

using Vector = std::array<double, 3>;

Vector middle_of(const Points &points) {
    Vector sum{0, 0, 0};
    for (const Vector &p : points)
        for (int c = 0; c < 3; ++c) sum[c] += p[c] / static_cast<double>(points.size());
    return sum;
}

double square_of_distance(const Vector &a, const Vector &b) {
    return std::pow(a[0] - b[0], 2) + std::pow(a[1] - b[1], 2) + std::pow(a[2] - b[2], 2);
}

/** The eigenvector of the largest eigenvalue of a symmetric matrix, by Jacobi's rotations. */
std::array<double, 4> first_eigenvector(double (&n)[4][4]) {
    double v[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    double size = 0;
    for (const auto &row : n)
        for (double x : row) size = std::max(size, std::fabs(x));
    bool turned = true;
    for (int sweep = 0; turned && sweep < 30; ++sweep) {
        turned = false;
        for (int p = 0; p < 3; ++p)
            for (int q = p + 1; q < 4; ++q) {
                if (std::fabs(n[p][q]) <= 1e-17 * size) continue;
                turned = true;
                const double angle = 0.5 * std::atan2(2 * n[p][q], n[q][q] - n[p][p]);
                const double c = std::cos(angle), s = std::sin(angle);
                for (int k = 0; k < 4; ++k) {
                    const double a = n[k][p], b = n[k][q], x = v[k][p], y = v[k][q];
                    n[k][p] = c * a - s * b, n[k][q] = s * a + c * b;
                    v[k][p] = c * x - s * y, v[k][q] = s * x + c * y;
                }
                for (int k = 0; k < 4; ++k) {
                    const double a = n[p][k], b = n[q][k];
                    n[p][k] = c * a - s * b, n[q][k] = s * a + c * b;
                }
                n[p][q] = n[q][p] = 0;
            }
    }
    int first = 0;
    for (int k = 1; k < 4; ++k)
        if (n[k][k] > n[first][first]) first = k;
    return {v[0][first], v[1][first], v[2][first], v[3][first]};
}

}  // namespace

double largest_displacement(const Points &shape, const Points &points) {
    const Vector from = middle_of(shape), to = middle_of(points);
    double m[3][3] = {};
    for (std::size_t k = 0; k < shape.size(); ++k)
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b) m[a][b] += (shape[k][a] - from[a]) * (points[k][b] - to[b]);
    double n[4][4] = {{m[0][0] + m[1][1] + m[2][2], m[1][2] - m[2][1], m[2][0] - m[0][2], m[0][1] - m[1][0]},
                      {m[1][2] - m[2][1], m[0][0] - m[1][1] - m[2][2], m[0][1] + m[1][0], m[2][0] + m[0][2]},
                      {m[2][0] - m[0][2], m[0][1] + m[1][0], m[1][1] - m[0][0] - m[2][2], m[1][2] + m[2][1]},
                      {m[0][1] - m[1][0], m[2][0] + m[0][2], m[1][2] + m[2][1], m[2][2] - m[0][0] - m[1][1]}};
    const auto [w, x, y, z] = first_eigenvector(n);
    const double turn[3][3] = {{w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)},
                               {2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)},
                               {2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z}};
    double worst = 0;
    for (std::size_t k = 0; k < shape.size(); ++k) {
        Vector moved = to;
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b) moved[a] += turn[a][b] * (shape[k][b] - from[b]);
        worst = std::max(worst, square_of_distance(moved, points[k]));
    }
    return std::sqrt(worst);
}

double shortest_distance(const Points &shape) {
    double least = HUGE_VAL;
    for (std::size_t i = 0; i < shape.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) least = std::min(least, square_of_distance(shape[i], shape[j]));
    return std::sqrt(least);
}

std::vector<std::array<int, 2>> shortest_way(const Points &shape) {
    const std::size_t n = shape.size();
    std::vector<double> gap(n, HUGE_VAL);
    std::vector<int> nearest(n, 0);
    std::vector<char> joined(n, 0);
    std::vector<std::array<int, 2>> way;
    for (std::size_t done = 1, last = 0; done < n; ++done) {
        joined[last] = 1;
        std::size_t next = 0;
        for (std::size_t k = 0; k < n; ++k) {
            if (joined[k]) continue;
            const double square = square_of_distance(shape[k], shape[last]);
            if (square < gap[k]) gap[k] = square, nearest[k] = static_cast<int>(last);
            if (joined[next] || gap[k] < gap[next]) next = k;
        }
        way.push_back({static_cast<int>(next), nearest[next]});
        last = next;
    }
    return way;
}

}  // namespace holonomic_lammps
