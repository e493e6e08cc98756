#include "core/rigid/cliques.hpp"

#include "core/rigid/flat_ring.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <unordered_map>

namespace holonomic::rigid {

namespace {

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

constexpr double epsilon = std::numeric_limits<double>::epsilon();

// What lengths of a body may be off; and where they decide whether it is one.
constexpr double same_length = 1e-6, same_to_rounding = 16 * epsilon;

double distance_between(const double *a, const double *b) {
    const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

// Cholesky's factors of the inner products from atom 0, the largest remaining height first.
class Heights {
public:
    Heights(std::int64_t n, const double *squares) : n_(n), squares_(squares), x_(3 * at(n), 0), height_(at(n)) {
        for (std::int64_t i = 0; i < n; ++i) height_[at(i)] = squares[i];
        for (std::int64_t e = 0; e < n * n; ++e) largest_ = std::max(largest_, squares[e]);
    }
    bool is_done(double rounding) const { return dimension_ == 3 || highest() <= rounding * largest_; }
    void go_on() {
        const std::int64_t p = std::max_element(height_.begin(), height_.end()) - height_.begin();
        const long double root = std::sqrt(height_[at(p)]);
        for (std::int64_t i = 0; i < n_; ++i) {
            long double product = (static_cast<long double>(squares_[i]) + squares_[p] - squares_[i * n_ + p]) / 2;
            for (int c = 0; c < dimension_; ++c) product -= x_[at(3 * i + c)] * x_[at(3 * p + c)];
            x_[at(3 * i + dimension_)] = i == 0 ? 0 : product / root;
        }
        for (std::int64_t i = 0; i < n_; ++i) height_[at(i)] -= x_[at(3 * i + dimension_)] * x_[at(3 * i + dimension_)];
        height_[at(p)] = 0;
        ++dimension_;
    }
    int dimension() const { return dimension_; }
    const std::vector<long double> &places() const { return x_; }

private:
    double highest() const { return static_cast<double>(*std::max_element(height_.begin(), height_.end())); }

    const std::int64_t n_;
    const double *const squares_;
    std::vector<long double> x_, height_;
    double largest_ = 0;
    int dimension_ = 0;
};

class Search {
public:
    using Atom = std::int64_t;  // what FlatRing asks for
    template <class Each>
    void for_partners(Atom atom, const Each &each) const {
        for (const Partner &partner : bonds_of_.at(atom))
            if (is_free(partner.atom)) each(partner.atom);
    }
    Atom with_fewer(Atom i, Atom j) const { return bonds_of_.at(i).size() < bonds_of_.at(j).size() ? i : j; }
    double square(Atom i, Atom j) const {
        const std::int64_t bond = bond_between(i, j);
        return bond < 0 ? -1 : lengths_[bond % n_lengths_] * lengths_[bond % n_lengths_];
    }

    Search(const Masses &masses, const BondList &list, const double *lengths, std::int64_t n_lengths)
        : list_(list), lengths_(lengths), n_lengths_(n_lengths) {
        for (std::int64_t k = 0; k < list.n_bonds; ++k) {
            const std::int64_t i = list.pairs[2 * k], j = list.pairs[2 * k + 1];
            if (masses.fixed(i - list.base) || masses.fixed(j - list.base) || i == j) continue;
            bonds_of_[i].push_back({j, k});
            bonds_of_[j].push_back({i, k});
        }
        for (auto &bonds : bonds_of_) std::sort(bonds.second.begin(), bonds.second.end());
    }

    Cliques find() {
        for (const bool five : {true, false})
            for (std::int64_t k = 0; k < list_.n_bonds; ++k) look_around(k, five);
        std::int64_t steps = steps_for_rings(list_.n_bonds);
        for (std::int64_t k = 0; k < list_.n_bonds; ++k) look_for_ring(k, steps);
        if (!found_.sizes.empty()) collect_bonds();
        return std::move(found_);
    }

private:
    struct Partner {
        std::int64_t atom, bond;
        bool operator<(const Partner &other) const {
            return atom != other.atom ? atom < other.atom : bond < other.bond;
        }
    };

    bool is_free(std::int64_t atom) const { return bonds_of_.count(atom) && !body_of_.count(atom); }

    std::int64_t bond_between(std::int64_t i, std::int64_t j) const {
        const std::vector<Partner> &partners = bonds_of_.at(i);
        const auto found = std::lower_bound(partners.begin(), partners.end(), Partner{j, 0});
        return found != partners.end() && found->atom == j ? found->bond : -1;
    }

    std::vector<double> squares(const std::vector<std::int64_t> &atoms) const {
        std::vector<double> all(atoms.size() * atoms.size(), 0);
        for (std::size_t i = 0; i < atoms.size(); ++i)
            for (std::size_t j = 0; j < atoms.size(); ++j)
                if (i != j) all[i * atoms.size() + j] = square(atoms[i], atoms[j]);
        return all;
    }

    // Atoms, one after the other, that are bonded to all there are.
    void grow(std::vector<std::int64_t> &clique, const std::vector<std::int64_t> &candidates) const {
        for (const std::int64_t atom : candidates) {
            bool all = true;
            for (const std::int64_t other : clique) all = all && other != atom && bond_between(atom, other) >= 0;
            if (all) clique.push_back(atom);
        }
    }

    bool is_flat(const std::vector<std::int64_t> &atoms) const {
        return are_flat(static_cast<std::int64_t>(atoms.size()), squares(atoms).data());
    }

    void look_around(std::int64_t bond, bool five) {
        const std::int64_t i = list_.pairs[2 * bond], j = list_.pairs[2 * bond + 1];
        if (i == j || !is_free(i) || !is_free(j)) return;
        std::vector<std::int64_t> both;
        const Atom fewer = with_fewer(i, j), other = i + j - fewer;
        for (const Partner &partner : bonds_of_.at(fewer))
            if (partner.atom != other && is_free(partner.atom) && bond_between(partner.atom, other) >= 0 &&
                (both.empty() || both.back() != partner.atom))
                both.push_back(partner.atom);
        if (five) {
            if (both.size() < 3) return;
            std::vector<std::int64_t> clique{i, j};
            grow(clique, both);
            if (clique.size() >= 5) take(clique);
            return;
        }
        for (std::size_t a = 0; a < both.size(); ++a) {
            std::vector<std::int64_t> clique{i, j, both[a]};
            bool flat = is_flat(clique);
            for (std::size_t b = 0; !flat && b < a; ++b) {
                if (bond_between(both[a], both[b]) < 0) continue;
                clique = {i, j, both[b], both[a]};
                flat = is_flat(clique);
            }
            if (!flat) continue;
            grow(clique, both);
            return take(clique);
        }
    }

    void take(std::vector<std::int64_t> clique) {
        std::sort(clique.begin(), clique.end());
        std::vector<double> places;
        places_of(static_cast<std::int64_t>(clique.size()), squares(clique).data(), 32 * epsilon, places);
        take(clique, places);
    }

    void look_for_ring(std::int64_t bond, std::int64_t &steps) {
        const std::int64_t i = list_.pairs[2 * bond], j = list_.pairs[2 * bond + 1];
        if (i == j || !is_free(i) || !is_free(j)) return;
        FlatRing<Search> flat(*this, std::min(i, j), std::max(i, j), steps);
        if (flat.find()) take(flat.ring(), flat.places());
    }

    void take(const std::vector<std::int64_t> &clique, const std::vector<double> &places) {
        check_lengths_of(clique, places);
        for (const std::int64_t atom : clique) body_of_[atom] = found_.sizes.size();
        found_.sizes.push_back(static_cast<std::int64_t>(clique.size()));
        found_.atoms.insert(found_.atoms.end(), clique.begin(), clique.end());
        found_.places.insert(found_.places.end(), places.begin(), places.end());
    }

    // A length that all others contradict is off most.
    void check_lengths_of(const std::vector<std::int64_t> &clique, const std::vector<double> &places) const {
        double worst = same_length, distance = 0;
        std::int64_t bad = -1;
        for (std::size_t i = 0; i < clique.size(); ++i)
            for (std::size_t j = 0; j < i; ++j) {
                const double length = distance_between(&places[3 * i], &places[3 * j]);
                const std::int64_t bond = bond_between(clique[i], clique[j]);
                if (bond < 0) continue;
                const double wanted = lengths_[bond % n_lengths_], error = std::fabs(length - wanted) / wanted;
                if (error <= worst) continue;
                worst = error;
                distance = length;
                bad = bond;
            }
        if (bad < 0) return;
        char words[256];
        std::snprintf(
            words, sizeof words,
            "has the length %.10g, which does not fit the others between its %zu atoms, a rigid body: by these it "
            "would be %.10g (hol_chains_add_rigid takes coordinates)",
            lengths_[bad % n_lengths_], clique.size(), distance);
        throw bond_error(list_, Status::degenerate, bad, words);
    }

    // All bonds that hang together with a body, but not through fixed atoms.
    void collect_bonds() {
        std::unordered_map<std::int64_t, bool> reached;
        std::vector<std::int64_t> stack(found_.atoms);
        for (const std::int64_t atom : stack) reached[atom] = true;
        while (!stack.empty()) {
            const std::int64_t atom = stack.back();
            stack.pop_back();
            for (const Partner &partner : bonds_of_.at(atom))
                if (reached.emplace(partner.atom, true).second) stack.push_back(partner.atom);
        }
        for (std::int64_t k = 0; k < list_.n_bonds; ++k)
            if (reached.count(list_.pairs[2 * k]) || reached.count(list_.pairs[2 * k + 1])) found_.bonds.push_back(k);
    }

    const BondList &list_;
    const double *const lengths_;
    const std::int64_t n_lengths_;
    std::unordered_map<std::int64_t, std::vector<Partner>> bonds_of_;  // of atoms that can move
    std::unordered_map<std::int64_t, std::size_t> body_of_;
    Cliques found_;
};

}  // namespace

int places_of(std::int64_t n, const double *squares, double rounding, std::vector<double> &places) {
    Heights heights(n, squares);
    while (!heights.is_done(rounding)) heights.go_on();
    places.resize(3 * at(n));
    for (std::size_t i = 0; i < places.size(); ++i) places[i] = static_cast<double>(heights.places()[i]);
    return heights.dimension();
}

bool are_flat(std::int64_t n, const double *squares) {
    std::vector<double> places;
    if (places_of(n, squares, 2 * epsilon * static_cast<double>(n - 2), places) >= n - 1) return false;
    for (std::int64_t i = 0; i < n; ++i)
        for (std::int64_t j = 0; j < i; ++j) {
            const double wanted = std::sqrt(squares[i * n + j]);
            if (!(std::fabs(distance_between(&places[at(3 * i)], &places[at(3 * j)]) - wanted) <=
                  same_to_rounding * wanted))
                return false;
        }
    return true;
}

Cliques find_cliques(const Masses &masses, const BondList &list, const double *lengths, std::int64_t n_lengths) {
    return Search(masses, list, lengths, n_lengths).find();
}

}  // namespace holonomic::rigid
