#include "core/rigid/implied.hpp"

#include <algorithm>
#include <map>
#include <unordered_map>
#include <unordered_set>

#include "core/molecules/hash.hpp"

namespace holonomic::rigid {

namespace {

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

// Numbers modulo 2^61 - 1.
using Number = std::uint64_t;
constexpr Number prime = (Number{1} << 61) - 1;
__extension__ typedef unsigned __int128 Wide;

Number times(Number a, Number b) {
    const Wide product = static_cast<Wide>(a) * b;
    const Number sum = static_cast<Number>(product & prime) + static_cast<Number>(product >> 61);
    return sum >= prime ? sum - prime : sum;
}
Number minus(Number a, Number b) { return a >= b ? a - b : a + prime - b; }
Number inverse(Number a) {  // a^(prime - 2)
    Number result = 1;
    for (Number e = prime - 2; e > 0; e >>= 1, a = times(a, a))
        if (e & 1) result = times(result, a);
    return result;
}

// Rows of distances at random coordinates, one after the other.
class Rank {
public:
    // Atoms are counted from 0; -1: it is fixed, at `place`.
    struct End {
        std::int64_t column, place;
    };
    // Whether those before imply it.
    bool add(const End &i, const End &j) {
        std::map<std::int64_t, Number> row;
        for (int c = 0; c < 3; ++c) {
            const Number d = minus(coordinate(j.place, c), coordinate(i.place, c));
            if (i.column >= 0) row[3 * i.column + c] = minus(0, d);
            if (j.column >= 0) row[3 * j.column + c] = d;
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
    static Number coordinate(std::int64_t place, int c) {
        return mix(mix(0x9e3779b97f4a7c15u, static_cast<std::uint64_t>(place)), static_cast<std::uint64_t>(c)) % prime;
    }
    void keep(const std::map<std::int64_t, Number> &row) {
        const Number scale = inverse(row.begin()->second);
        Row &pivot = pivots_[row.begin()->first];
        for (const auto &entry : row)
            if (entry.second != 0) pivot.emplace_back(entry.first, times(scale, entry.second));
    }
    std::unordered_map<std::int64_t, Row> pivots_;  // by the column of their first entry, which is 1
};

class Search {
public:
    Search(const Masses &masses, const BondList &list, const double *lengths, std::int64_t n_lengths,
           const Cliques &cliques)
        : masses_(masses), list_(list), lengths_(lengths), n_lengths_(n_lengths), implied_(at(list.n_bonds), 0) {
        std::size_t next = 0;
        for (std::size_t b = 0; b < cliques.sizes.size(); ++b)
            for (std::int64_t a = 0; a < cliques.sizes[b]; ++a)
                body_of_[cliques.atoms[next++]] = static_cast<std::int64_t>(b);
        for (const std::int64_t bond : cliques.shared) shares_.insert(list.pairs[2 * bond]);
        for (std::int64_t k = 0; k < list.n_bonds; ++k)
            for (int e = 0; e < 2; ++e) bonds_of_[list.pairs[2 * k + e]].push_back(k);
    }

    std::vector<unsigned char> find() {
        std::unordered_map<std::int64_t, bool> seen;
        for (std::int64_t e = 0; e < 2 * list_.n_bonds; ++e) {
            const std::int64_t atom = list_.pairs[e];
            if (!fixed(atom) && !seen[atom]) look_at_molecule(atom, seen);
        }
        return std::move(implied_);
    }

private:
    bool fixed(std::int64_t atom) const { return masses_.fixed(atom - list_.base); }
    std::int64_t body(std::int64_t atom) const {
        const auto found = body_of_.find(atom);
        return found == body_of_.end() ? -1 : found->second;
    }
    double length(std::int64_t bond) const { return lengths_[bond % n_lengths_]; }

    // A mistake, which is refused elsewhere.
    bool is_twice(std::int64_t bond) const {
        const std::int64_t i = list_.pairs[2 * bond], j = list_.pairs[2 * bond + 1];
        std::int64_t n = 0;
        for (const std::int64_t k : bonds_of_.at(i)) n += list_.pairs[2 * k] == j || list_.pairs[2 * k + 1] == j;
        return n > 1;
    }

    void look_at_molecule(std::int64_t first, std::unordered_map<std::int64_t, bool> &seen) {
        // Atoms in the order in which they are reached: neighbours have near columns.
        std::vector<std::int64_t> atoms{first}, bonds;
        std::unordered_map<std::int64_t, std::int64_t> column;
        seen[first] = true;
        bool has_body = false, shares = false;
        for (std::size_t next = 0; next < atoms.size(); ++next) {
            const std::int64_t atom = atoms[next];
            column[atom] = static_cast<std::int64_t>(next);
            has_body = has_body || body(atom) >= 0;
            shares = shares || shares_.count(atom) > 0;
            for (const std::int64_t k : bonds_of_.at(atom)) {
                const std::int64_t i = list_.pairs[2 * k], other = i == atom ? list_.pairs[2 * k + 1] : i;
                if (fixed(other) || other >= atom) bonds.push_back(k);
                if (fixed(other) || seen[other]) continue;
                seen[other] = true;
                atoms.push_back(other);
            }
        }
        const std::int64_t freedoms = 3 * static_cast<std::int64_t>(atoms.size()) - 6;
        if (!has_body && static_cast<std::int64_t>(bonds.size()) <= freedoms) return;
        std::sort(bonds.begin(), bonds.end(), [this](std::int64_t a, std::int64_t b) {
            return length(a) != length(b) ? length(a) < length(b) : a < b;
        });
        const auto end = [&](std::int64_t e) {
            const std::int64_t atom = list_.pairs[e];
            return fixed(atom) ? Rank::End{-1, -1 - atom} : Rank::End{column.at(atom), column.at(atom)};
        };
        const auto is_within = [&](std::int64_t k) {
            const std::int64_t its = body(list_.pairs[2 * k]);
            return its >= 0 && its == body(list_.pairs[2 * k + 1]);
        };
        Rank all, within;  // bodies have columns of their own
        std::int64_t outside = 0;
        std::vector<std::int64_t> found;
        for (const std::int64_t k : bonds) {
            if (all.add(end(2 * k), end(2 * k + 1))) {
                found.push_back(k);
                ++outside;
            }
            outside -= is_within(k) && within.add(end(2 * k), end(2 * k + 1));
        }
        for (const std::int64_t k : found) implied_[at(k)] = (outside > 0 || shares) && !is_twice(k);
    }

    const Masses &masses_;
    const BondList &list_;
    const double *const lengths_;
    const std::int64_t n_lengths_;
    std::vector<unsigned char> implied_;
    std::unordered_map<std::int64_t, std::int64_t> body_of_;
    std::unordered_set<std::int64_t> shares_;
    std::unordered_map<std::int64_t, std::vector<std::int64_t>> bonds_of_;
};

}  // namespace

std::vector<unsigned char> implied_bonds(const Masses &masses, const BondList &list, const double *lengths,
                                         std::int64_t n_lengths, const Cliques &cliques) {
    return Search(masses, list, lengths, n_lengths, cliques).find();
}

}  // namespace holonomic::rigid
