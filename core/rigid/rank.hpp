// The rank of distances at random coordinates: exact, modulo the prime 2^61 - 1.
#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/molecules/given/hash.hpp"
#include "core/rigid/relations.hpp"

namespace holonomic::rigid {

// Rows of distances, one after the other.
class Rank {
public:
    using Number = std::uint64_t;
    // An atom: of which free ones, counted from 0, it is a combination. A fixed one of none, and it has a place.
    struct End {
        std::vector<std::pair<std::int64_t, Number>> of;
        Number position[3];
    };
    static End free(std::int64_t column) {
        return {{{column, 1}}, {position(column, 0), position(column, 1), position(column, 2)}};
    }
    static End fixed(std::int64_t atom) {
        return {{}, {position(-1 - atom, 0), position(-1 - atom, 1), position(-1 - atom, 2)}};
    }
    // A point with coefficients of free ones.
    static End combination(std::vector<std::pair<std::int64_t, Number>> of) {
        End end{std::move(of), {0, 0, 0}};
        for (const auto &[column, c] : end.of)
            for (int x = 0; x < 3; ++x)
                end.position[x] = minus(end.position[x], times(minus(0, c), position(column, x)));
        return end;
    }
    // Of each atom, the coefficients of the leaders: [n_atoms][leaders]. Those of the relations are taken to 40 binary
    // digits, so that their sum is 0; what is made of them is exact.
    static std::vector<Number> followers(const Relations &relations, const Leaders &leaders) {
        const std::size_t n = static_cast<std::size_t>(relations.n_atoms), count = leaders.atoms.size();
        std::vector<std::vector<Number>> rows;
        rows.reserve(static_cast<std::size_t>(relations.count()));
        for (std::int32_t k = 0; k < relations.count(); ++k) rows.push_back(row_of(relations.row(k), n));
        std::vector<Number> of(n * count, 0);
        std::size_t done = 0, leader = 0;
        std::vector<std::size_t> follower;
        for (std::size_t i = 0; i < n; ++i) {
            if (leader < count && static_cast<std::size_t>(leaders.atoms[leader]) == i) {
                of[i * count + leader++] = 1;
                continue;
            }
            for (std::size_t k = done; k < rows.size(); ++k)
                if (rows[k][i] != 0) {
                    std::swap(rows[k], rows[done]);
                    break;
                }
            const Number scale = inverse(rows[done][i]);
            for (Number &c : rows[done]) c = times(scale, c);
            for (std::size_t k = 0; k < rows.size(); ++k) {
                const Number factor = rows[k][i];
                for (std::size_t j = 0; k != done && factor != 0 && j < n; ++j)
                    rows[k][j] = minus(rows[k][j], times(factor, rows[done][j]));
            }
            follower.push_back(i);
            ++done;
        }
        for (std::size_t k = 0; k < done; ++k)
            for (std::size_t l = 0; l < count; ++l)
                of[follower[k] * count + l] = minus(0, rows[k][static_cast<std::size_t>(leaders.atoms[l])]);
        return of;
    }

    // Whether those before imply it.
    bool add(const End &i, const End &j) {
        std::map<std::int64_t, Number> row;
        for (int x = 0; x < 3; ++x) {
            const Number d = minus(j.position[x], i.position[x]);
            for (const auto &[column, c] : i.of) row[3 * column + x] = minus(row[3 * column + x], times(c, d));
            for (const auto &[column, c] : j.of)
                row[3 * column + x] = minus(row[3 * column + x], times(minus(0, c), d));
        }
        while (!row.empty()) {
            const auto first = row.begin();
            if (first->second == 0) {
                row.erase(first);
                continue;
            }
            const auto pivot = pivots_.find(first->first);
            if (pivot == pivots_.end()) {
                keep(row);
                return false;
            }
            const Number factor = first->second;
            for (const auto &entry : pivot->second) {
                Number &value = row[entry.first];
                value = minus(value, times(factor, entry.second));
            }
        }
        return true;
    }

private:
    using Row = std::vector<std::pair<std::int64_t, Number>>;
    static constexpr Number prime = (Number{1} << 61) - 1;
    __extension__ typedef unsigned __int128 Wide;

    static Number times(Number a, Number b) {
        const Wide product = static_cast<Wide>(a) * b;
        const Number sum = static_cast<Number>(product & prime) + static_cast<Number>(product >> 61);
        return sum >= prime ? sum - prime : sum;
    }
    static Number minus(Number a, Number b) { return a >= b ? a - b : a + prime - b; }
    static Number inverse(Number a) {  // a^(prime - 2)
        Number result = 1;
        for (Number e = prime - 2; e > 0; e >>= 1, a = times(a, a))
            if (e & 1) result = times(result, a);
        return result;
    }
    static Number number(double c) {
        const double scaled = std::nearbyint(std::ldexp(c, 40));
        const Number size = static_cast<Number>(std::fabs(scaled)) % prime, half = inverse(Number{1} << 40);
        return times(scaled < 0 ? minus(0, size) : size, half);
    }
    static std::vector<Number> row_of(const double *c, std::size_t n) {
        std::vector<Number> row;
        std::size_t last = 0;
        Number sum = 0;
        for (std::size_t i = 0; i < n; ++i) {
            row.push_back(number(c[i]));
            sum = minus(sum, minus(0, row.back()));
            if (row.back() != 0) last = i;
        }
        row[last] = minus(row[last], sum);
        return row;
    }
    static Number position(std::int64_t atom, int x) {
        return mix(mix(0x9e3779b97f4a7c15u, static_cast<std::uint64_t>(atom)), static_cast<std::uint64_t>(x)) % prime;
    }
    void keep(const std::map<std::int64_t, Number> &row) {
        const Number scale = inverse(row.begin()->second);
        Row &pivot = pivots_[row.begin()->first];
        for (const auto &entry : row)
            if (entry.second != 0) pivot.emplace_back(entry.first, times(scale, entry.second));
    }
    std::unordered_map<std::int64_t, Row> pivots_;  // by the column of their first entry, which is 1
};

}  // namespace holonomic::rigid
