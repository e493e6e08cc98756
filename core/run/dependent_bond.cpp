#include "core/run/dependent_bond.hpp"

#include <cmath>
#include <functional>
#include <map>
#include <queue>
#include <utility>
#include <vector>

#include "core/caller/box.hpp"
#include "core/caller/view.hpp"
#include "core/double_pair.hpp"
#include "core/inverse/bond_vectors.hpp"

namespace holonomic {

namespace {

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

// Pivots below this part of their diagonal are taken for zero: dependent constraints leave 1e-31, others 1e-18 at
// least.
constexpr double least_pivot = 1e-22;
constexpr std::size_t most_elements = 20000000;

using Row = std::map<std::int64_t, DoublePair>;

// The matrix A of unit bond vectors over the masses: theory (m1), rows and columns scaled.
class Elimination {
public:
    Elimination(const Molecule &m, const AtomArray &r, const Box &box)
        : row_(at(m.n_bonds)), diagonal_(at(m.n_bonds)), whole_(at(m.n_bonds)) {
        std::vector<PairVector> d = bond_vectors(m, r, box);
        std::vector<std::vector<std::int64_t>> arms(at(m.n_atoms));
        for (std::int64_t k = 0; k < m.n_bonds; ++k) {
            const ScaledBond s = scaled(d[at(k)]);
            const DoublePair over = as_pair(1 / s.length);
            for (DoublePair *c : {&d[at(k)].x, &d[at(k)].y, &d[at(k)].z})
                *c = DoublePair{std::scalbn(c->hi, -s.exponent), std::scalbn(c->lo, -s.exponent)} * over;
            arms[at(m.i(k))].push_back(k);
            arms[at(m.j(k))].push_back(k);
        }
        double heaviest = 0;
        for (std::int64_t i = 0; i < m.n_atoms; ++i) heaviest = std::fmax(heaviest, m.w(i));
        for (std::int64_t i = 0; i < m.n_atoms; ++i) {
            if (m.w(i) == 0) continue;
            const DoublePair w = as_pair(m.w(i) / heaviest);
            for (const std::int64_t k : arms[at(i)])
                for (const std::int64_t l : arms[at(i)]) {
                    const DoublePair value = w * dot(d[at(k)], d[at(l)]);
                    if (k == l)
                        diagonal_[at(k)] = diagonal_[at(k)] + value;
                    else if ((m.i(k) == i) == (m.i(l) == i))
                        row_[at(k)][l] = row_[at(k)][l] + value;
                    else
                        row_[at(k)][l] = row_[at(k)][l] - value;
                    if (k != l && ++elements_ > most_elements) return;
                }
        }
        whole_ = diagonal_;
    }

    std::int64_t first_vanishing() {
        using Entry = std::pair<std::size_t, std::int64_t>;  // how many neighbours, bond
        std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> next;
        for (std::size_t k = 0; k < row_.size(); ++k) next.push({row_[k].size(), static_cast<std::int64_t>(k)});
        std::vector<unsigned char> done(row_.size(), 0);
        while (!next.empty()) {
            const Entry entry = next.top();
            next.pop();
            const std::size_t k = at(entry.second);
            if (done[k] || entry.first != row_[k].size()) continue;
            if (elements_ > most_elements) return -2;
            done[k] = 1;
            if (!std::isfinite(diagonal_[k].hi)) return -2;
            if (!(diagonal_[k].hi > least_pivot * whole_[k].hi)) return entry.second;
            eliminate(k);
            for (const auto &a : row_[k]) next.push({row_[at(a.first)].size(), a.first});
        }
        return -1;
    }

private:
    static DoublePair dot(const PairVector &a, const PairVector &b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

    void eliminate(std::size_t k) {
        for (const auto &a : row_[k]) {
            const DoublePair factor = a.second / diagonal_[k];
            Row &row = row_[at(a.first)];
            row.erase(static_cast<std::int64_t>(k));
            for (const auto &b : row_[k]) {
                if (b.first == a.first) {
                    diagonal_[at(a.first)] = diagonal_[at(a.first)] - factor * b.second;
                    continue;
                }
                const std::size_t before = row.size();
                row[b.first] = row[b.first] - factor * b.second;
                elements_ += row.size() - before;
            }
        }
    }

    std::vector<Row> row_;
    std::vector<DoublePair> diagonal_, whole_;
    std::size_t elements_ = 0;
};

void vector_of(const Molecule &m, std::int64_t k, const AtomArray &r, const Box &box, double *d) {
    double a[3], b[3];
    read_atom(r, m.atom(m.i(k)), a);
    read_atom(r, m.atom(m.j(k)), b);
    for (int c = 0; c < 3; ++c) d[c] = b[c] - a[c];
    minimum_image(box, d);
}

}  // namespace

std::int64_t dependent_bond(const Molecule &molecule, const AtomArray &r, const Box &box) {
    return Elimination(molecule, r, box).first_vanishing();
}

std::int64_t open_cycle(const Molecule &m, const AtomArray &r, const Box &box) {
    if (box.shape == Box::none || m.n_bonds < m.n_atoms) return -1;
    std::vector<std::vector<std::int64_t>> arms(at(m.n_atoms));
    for (std::int64_t k = 0; k < m.n_bonds; ++k) {
        arms[at(m.i(k))].push_back(k);
        arms[at(m.j(k))].push_back(k);
    }
    std::vector<double> place(at(3 * m.n_atoms));
    std::vector<unsigned char> reached(at(m.n_atoms), 0);
    std::vector<std::int64_t> stack{0};
    reached[0] = 1;
    std::int64_t open = -1;
    while (!stack.empty()) {
        const std::int64_t i = stack.back();
        stack.pop_back();
        for (const std::int64_t k : arms[at(i)]) {
            double d[3];
            vector_of(m, k, r, box, d);
            const std::int64_t j = m.i(k) == i ? m.j(k) : m.i(k);
            const double sign = m.i(k) == i ? 1 : -1;
            double size = 0, gap = 0;
            for (int c = 0; c < 3; ++c) {
                const double x = place[at(3 * i + c)] + sign * d[c];
                if (!reached[at(j)]) place[at(3 * j + c)] = x;
                gap = std::fmax(gap, std::fabs(x - place[at(3 * j + c)]));
                size = std::fmax(size, std::fabs(d[c]));
            }
            if (gap > 1e-3 * size && (open < 0 || k < open)) open = k;
            if (!reached[at(j)]) stack.push_back(j);
            reached[at(j)] = 1;
        }
    }
    return open;
}

}  // namespace holonomic
