// What a process has, and what it shares: made once.
#include "subdomain.hpp"

#include <cmath>
#include <map>

namespace holonomic_subdomain {

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
    for (std::int64_t k = 0; k < 2 * static_cast<std::int64_t>(cut_lengths_.size()); ++k) {
        if (given.ends[k] < -1 || given.ends[k] >= n_atoms)
            throw Failure{HOL_ERR_INDEX, "cut bond " + std::to_string(k / 2) + " has an atom that is not there"};
        if (given.ends[k] >= 0)
            ends_.push_back({static_cast<int>(k / 2), static_cast<int>(k % 2), static_cast<int>(given.ends[k])});
    }
    graph_ = Graph(std::move(w), std::move(bonds));
    t_.assign(lengths_.size(), 0.0);
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

/** Which cut bonds are coupled, over all processes, and where their elements stand. */
void Subdomain::make_interface() {
    processes.alone([&] { reach_ = Reach(graph_, ends_); });
    std::vector<std::array<int, 2>> mine;
    for (const Reach::Coupling &coupling : reach_.couplings) {
        const std::array<int, 2> pair{ends_[coupling.to].cut, ends_[coupling.from].cut};
        if (pair[0] < pair[1]) mine.push_back(pair);
    }
    std::sort(mine.begin(), mine.end());
    mine.erase(std::unique(mine.begin(), mine.end()), mine.end());
    std::vector<double> counts(processes.n_ranks(), 0.0);
    counts[processes.rank()] = static_cast<double>(mine.size());
    counts.push_back(reach_.exact ? 0 : 1);
    processes.add_up(counts);
    exact_ = counts.back() == 0;
    std::size_t first = 0, all = 0;
    for (int p = 0; p < processes.n_ranks(); ++p) {
        if (p == processes.rank()) first = all;
        all += static_cast<std::size_t>(counts[p]);
    }
    std::vector<double> numbers(2 * all, 0.0);
    for (std::size_t k = 0; k < mine.size(); ++k) {
        numbers[2 * (first + k)] = mine[k][0];
        numbers[2 * (first + k) + 1] = mine[k][1];
    }
    processes.add_up(numbers);
    std::map<std::array<int, 2>, int> entries;
    for (std::size_t k = 0; k < all; ++k)
        entries[{static_cast<int>(numbers[2 * k]), static_cast<int>(numbers[2 * k + 1])}] = 0;
    std::vector<std::array<int, 2>> pairs;
    n_entries_ = n_cut();
    for (auto &entry : entries) {
        entry.second = n_entries_++;
        pairs.push_back(entry.first);
    }
    factors_ = comparison_ = SparseFactors(n_cut(), pairs);
    for (const Reach::Coupling &coupling : reach_.couplings) {
        const int row = ends_[coupling.to].cut, column = ends_[coupling.from].cut;
        entry_.push_back(row == column ? row : row < column ? entries.at({row, column}) : -1);
    }
    t_cut_.assign(cut_lengths_.size(), 0.0);
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
            n_solves_,
            reach_.n_colours,
            n_cut() + static_cast<std::int64_t>(factors_.n_entries()),
            n_refined_,
            last_change_};
}

}  // namespace holonomic_subdomain
