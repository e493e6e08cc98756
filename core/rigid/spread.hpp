// Which distances within flat and straight groups tell these well: in a plane bonds that are all but parallel say the
// same twice, though exact arithmetic finds them independent where lengths have been rounded.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/molecules/given/hash.hpp"
#include "core/rigid/linear.hpp"

namespace holonomic::rigid {

class Spread {
public:
    explicit Spread(const LinearParts &linear) : linear_(linear), kept_(linear.parts().size()) {}

    // Whether a distance is far from what those that have been added tell of its part; it is added then, or if
    // `always`.
    bool add(std::int64_t i, std::int64_t j, bool always) {
        constexpr double far = 0.1;
        const LinearParts::Membership *const a = linear_.find(i), *const b = linear_.find(j);
        if (!a || !b || a->part != b->part) return true;
        std::vector<double> row = row_of(*a, *b);
        const double size = norm(row);
        for (const std::vector<double> &other : kept_[a->part]) {
            double product = 0;
            for (std::size_t e = 0; e < row.size(); ++e) product += row[e] * other[e];
            for (std::size_t e = 0; e < row.size(); ++e) row[e] -= product * other[e];
        }
        const double left = norm(row);
        const bool is_far = left > far * size;
        if (is_far || (always && left > 0)) {
            for (double &x : row) x /= left;
            kept_[a->part].push_back(std::move(row));
        }
        return is_far;
    }

private:
    static double norm(const std::vector<double> &row) {
        double sum = 0;
        for (const double x : row) sum += x * x;
        return std::sqrt(sum);
    }
    // Of each leader, its coefficient times the bond, with leaders anywhere.
    std::vector<double> row_of(const LinearParts::Membership &a, const LinearParts::Membership &b) const {
        const Leaders &leaders = linear_.leaders()[a.part];
        const std::size_t n = leaders.atoms.size();
        std::vector<double> c(n), row(3 * n);
        double d[3] = {0, 0, 0};
        for (std::size_t l = 0; l < n; ++l) {
            c[l] = leaders.of[b.atom * n + l].hi - leaders.of[a.atom * n + l].hi;
            for (std::size_t x = 0; x < 3; ++x) d[x] += c[l] * coordinates(l, x);
        }
        for (std::size_t e = 0; e < row.size(); ++e) row[e] = c[e / 3] * d[e % 3];
        return row;
    }
    static double coordinates(std::size_t leader, std::size_t x) {
        return std::ldexp(static_cast<double>(mix(mix(0x9e3779b97f4a7c15u, leader), x) >> 11), -53) - 0.5;
    }

    const LinearParts &linear_;
    std::vector<std::vector<std::vector<double>>> kept_;  // of each part, orthonormal
};

}  // namespace holonomic::rigid
