// What a process has, and what it shares: made once.
#include "subdomain.hpp"

#include <cmath>

namespace holonomic_subdomain {

namespace {

/** A bond inside that is coupled to more, when its turn comes, is left to the interface. */
constexpr int most_coupled = 16;

}  // namespace

void check(int status) {
    if (status != HOL_OK) throw Failure{status, hol_error_message()};
}

Subdomain::Subdomain(const Processes &p, Given given) : processes(p), chains_(nullptr, hol_chains_destroy) {
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
    if (n_bonds == 0) return;
    hol_chains *chains = nullptr;
    check(hol_chains_create(n_atoms, given.masses.data(), &chains));
    chains_.reset(chains);
    check(hol_chains_add_bonds(chains, n_bonds, given.pairs.data(), lengths_.data()));
    if (hol_chains_n_of_shape(chains, HOL_SHAPE_RIGID) > 0)
        throw Failure{HOL_ERR_DEGENERATE,
                      "distances that depend on each other: rigid parts can't be in a divided molecule"};
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
        if (!(length >= 1e-150 && length <= 1e150)) throw Failure{HOL_ERR_VALUE, "length of a cut bond"};
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
        inside_ = SparseFactors(graph_.n_rows, pairs, graph_.n_rows - n_bonds(), most_coupled);
        const int n_left = inside_.n_rest() - (graph_.n_rows - n_bonds());
        counts[2 * processes.rank()] = n_left;
        counts[2 * processes.rank() + 1] = static_cast<double>(inside_.rest_pairs().size());
    });
    processes.add_up(counts);
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
        for (int k = 0; k < inside_.n_rest(); ++k) {
            int &its = row[inside_.rest_row(k)];
            if (its < 0) its = static_cast<int>(first_left++);
            row_of_rest_.push_back(its);
        }
        for (std::size_t p = 0; p < inside_.rest_pairs().size(); ++p)
            for (int side = 0; side < 2; ++side) numbers[2 * (first + p) + side] = row[inside_.rest_pairs()[p][side]];
    });
    processes.add_up(numbers);
    std::vector<std::array<int, 2>> pairs(n_pairs);
    for (std::size_t p = 0; p < n_pairs; ++p)
        pairs[p] = {static_cast<int>(numbers[2 * p]), static_cast<int>(numbers[2 * p + 1])};
    interface_ = SparseFactors(static_cast<int>(n_interface_), pairs);
    for (std::size_t p = 0; p < inside_.rest_pairs().size(); ++p) pair_of_rest_.push_back(n_interface_ + first + p);
}

void Subdomain::set_box(const double *rows) {
    if (chains_) check(hol_chains_set_box(chains_.get(), rows));
    box_ = Box(rows);
}

void Subdomain::set_rate(const double *L) {
    has_rate_ = L && std::any_of(L, L + 9, [](double x) { return x != 0; });
    if (has_rate_) std::copy(L, L + 9, rate_);
}

void Subdomain::set_labels(const std::int64_t *atoms) {
    if (chains_) check(hol_chains_set_labels(chains_.get(), atoms, nullptr));
}

hol_subdomain_work Subdomain::work() const {
    return {processes.n_sums,
            processes.n_numbers,
            n_passes_,
            n_solves_,
            static_cast<std::int64_t>(n_interface_),
            static_cast<std::int64_t>(n_interface_ + interface_.n_entries()),
            last_change_};
}

}  // namespace holonomic_subdomain
