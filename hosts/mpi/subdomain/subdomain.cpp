// What a process has, and what it shares: made once.
#include "subdomain.hpp"

#include <cmath>

namespace holonomic_subdomain {

namespace {

/** A bond inside that is coupled to more, when its turn comes, is left to the interface. */
constexpr int most_coupled = 16;

bool is_length(double length) { return length >= 1e-150 && length <= 1e150; }

}  // namespace

Subdomain::Subdomain(const Processes &p, Given given) : processes(p) {
    lengths_ = std::move(given.lengths);
    cut_lengths_ = std::move(given.cut_lengths);
    processes.alone([&] { make_inside(given); });
    check_ends(given.ends);
    make_interface();
}

void Subdomain::make_inside(const Given &given) {
    const auto n_atoms = static_cast<std::int64_t>(given.masses.size());
    std::vector<double> w(given.masses.size());
    for (std::int64_t i = 0; i < n_atoms; ++i) {
        const double mass = given.masses[i];
        if (!(mass >= 0)) throw Failure{HOL_ERR_VALUE, "mass of atom " + std::to_string(i)};
        w[i] = mass > 0 ? 1 / mass : 0;  // 0 of an infinite one
        if (!std::isfinite(w[i])) throw Failure{HOL_ERR_VALUE, "mass of atom " + std::to_string(i)};
    }
    const auto n_bonds = static_cast<std::int64_t>(lengths_.size());
    std::vector<Graph::Bond> bonds(lengths_.size());
    for (std::int64_t k = 0; k < n_bonds; ++k) {
        const std::int64_t a = given.pairs[2 * k], b = given.pairs[2 * k + 1];
        if (a < 0 || b < 0 || a >= n_atoms || b >= n_atoms)
            throw Failure{HOL_ERR_INDEX, "bond " + std::to_string(k) + " has an atom that is not there"};
        if (a == b) throw Failure{HOL_ERR_INDEX, "bond " + std::to_string(k) + " joins an atom to itself"};
        if (!is_length(lengths_[k])) throw Failure{HOL_ERR_VALUE, "length of bond " + std::to_string(k)};
        bonds[k] = {static_cast<int>(a), static_cast<int>(b)};
    }
    auto n_rows = static_cast<int>(n_bonds);
    for (std::int64_t k = 0; k < 2 * static_cast<std::int64_t>(cut_lengths_.size()); ++k) {
        if (given.ends[k] < -1 || given.ends[k] >= n_atoms)
            throw Failure{HOL_ERR_INDEX, "cut bond " + std::to_string(k / 2) + " has an atom that is not there"};
        if (given.ends[k] < 0) continue;
        if (ends_.empty() || ends_.back().cut != k / 2) ++n_rows;
        ends_.push_back(
            {static_cast<int>(k / 2), static_cast<int>(k % 2), static_cast<int>(given.ends[k]), n_rows - 1});
    }
    graph_ = Graph(std::move(w), std::move(bonds), ends_);
}

/** Every atom of a cut bond belongs to one process; all get to know its mass. */
void Subdomain::check_ends(const std::vector<std::int64_t> &ends) {
    std::vector<double> shared(2 * ends.size(), 0.0);
    for (const End &end : ends_) {
        const std::size_t at = 2 * (2 * static_cast<std::size_t>(end.cut) + end.side);
        shared[at] = graph_.w[end.atom];
        shared[at + 1] = 1;
    }
    processes.add_up(shared);
    cut_w_.resize(ends.size());
    for (std::size_t e = 0; e < ends.size(); ++e) {
        cut_w_[e] = shared[2 * e];
        if (shared[2 * e + 1] != 1)
            throw Failure{HOL_ERR_INDEX, "atom " + std::to_string(e % 2) + " of cut bond " + std::to_string(e / 2) +
                                             " is named by " + std::to_string(static_cast<int>(shared[2 * e + 1])) +
                                             " processes"};
    }
    for (double length : cut_lengths_)
        if (!is_length(length)) throw Failure{HOL_ERR_VALUE, "length of a cut bond"};
}

/**
 * What each process leaves: its cut bonds, and bonds inside that are coupled to many others by then. These are where
 * many parts between cut bonds meet. Without them the interface would have an element for any two cut bonds of a part.
 */
void Subdomain::make_interface() {
    std::vector<std::array<int, 2>> mine;
    std::vector<double> counts(2 * static_cast<std::size_t>(processes.n_ranks()), 0.0);
    processes.alone([&] {
        std::vector<std::array<int, 2>> pairs;
        graph_.for_pairs([&](int, const Graph::At &a, const Graph::At &b) { pairs.push_back({a.row, b.row}); });
        reference_.inside = SparseFactors(graph_.n_rows, pairs, graph_.n_rows - n_bonds(), most_coupled);
        const int n_left = reference_.inside.n_rest() - (graph_.n_rows - n_bonds());
        counts[2 * processes.rank()] = n_left;
        counts[2 * processes.rank() + 1] = static_cast<double>(reference_.inside.rest_pairs().size());
    });
    processes.add_up(counts);
    const SparseFactors &inside = reference_.inside;
    n_interface_ = cut_lengths_.size();
    std::size_t first = 0, n_pairs = 0, first_left = 0;
    for (int p = 0; p < processes.n_ranks(); ++p) {
        if (p == processes.rank()) first = n_pairs, first_left = n_interface_;
        n_interface_ += static_cast<std::size_t>(counts[2 * p]);
        n_pairs += static_cast<std::size_t>(counts[2 * p + 1]);
    }
    std::vector<double> numbers(2 * n_pairs, 0.0);
    processes.alone([&] {
        std::vector<int> row(graph_.n_rows, -1);
        for (const End &end : ends_) row[end.row] = end.cut;
        for (int k = 0; k < inside.n_rest(); ++k) {
            int &its = row[inside.rest_row(k)];
            if (its < 0) its = static_cast<int>(first_left++);
            row_of_rest_.push_back(its);
        }
        for (std::size_t p = 0; p < inside.rest_pairs().size(); ++p)
            for (int side = 0; side < 2; ++side) numbers[2 * (first + p) + side] = row[inside.rest_pairs()[p][side]];
    });
    processes.add_up(numbers);
    std::vector<std::array<int, 2>> pairs(n_pairs);
    for (std::size_t p = 0; p < n_pairs; ++p)
        pairs[p] = {static_cast<int>(numbers[2 * p]), static_cast<int>(numbers[2 * p + 1])};
    reference_.interface = SparseFactors(static_cast<int>(n_interface_), pairs);
    anew_ = reference_;
    for (std::size_t p = 0; p < inside.rest_pairs().size(); ++p) pair_of_rest_.push_back(n_interface_ + first + p);
}

void Subdomain::set_box(const double *rows) { box_ = Box(rows); }

void Subdomain::set_rate(const double *L) {
    has_rate_ = L && std::any_of(L, L + 9, [](double x) { return x != 0; });
    if (has_rate_) std::copy(L, L + 9, rate_);
}

void Subdomain::set_labels(const std::int64_t *atoms) {
    labels_.clear();
    if (atoms) labels_.assign(atoms, atoms + n_atoms());
}

/** A bond by the atoms that it joins, where they are here. */
std::string Subdomain::name_of(int row) const {
    const auto label = [&](int atom) { return std::to_string(labels_.empty() ? atom : labels_[atom]); };
    if (row < n_bonds())
        return "bond of atoms " + label(graph_.bonds[row].from) + " and " + label(graph_.bonds[row].to);
    for (const End &end : ends_)
        if (end.row == row) return "cut bond at atom " + label(end.atom);
    return "bond of another process";
}

hol_subdomain_work Subdomain::work() const {
    return {processes.n_sums,
            processes.n_numbers,
            n_solves_,
            static_cast<std::int64_t>(n_interface_),
            static_cast<std::int64_t>(n_interface_ + reference_.interface.n_entries()),
            last_change_};
}

}  // namespace holonomic_subdomain
