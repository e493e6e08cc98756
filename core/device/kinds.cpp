#include "core/device/kinds.hpp"

#include <algorithm>
#include <map>
#include <numeric>

#include "core/device/elimination.hpp"
#include "core/index.hpp"
#include "core/molecules/chains.hpp"
#include "core/molecules/given/lists.hpp"

namespace holonomic::device {

namespace {

using Pairs = std::vector<std::pair<int, int>>;

// Atoms from the one with the most bonds outwards, so that molecules that are written alike, a methyl group with its
// carbon first or last, get the same numbers. Gives the number of each.
std::vector<int> numbered_outwards(int n_atoms, const Pairs &bonds) {
    const Lists near = group(n_atoms, [&](const auto &give) {
        for (const auto &bond : bonds) give(bond.first, bond.second), give(bond.second, bond.first);
    });
    const auto more = [&](int a, int b) { return near.size(a) > near.size(b); };
    std::vector<int> order(at(n_atoms)), number(at(n_atoms), -1);
    std::iota(order.begin(), order.end(), 0);
    order = {*std::min_element(order.begin(), order.end(), more)};
    number[at(order[0])] = 0;
    for (std::size_t next = 0; next < order.size(); ++next) {
        std::vector<int> beyond(near.begin(order[next]), near.end(order[next]));
        std::sort(beyond.begin(), beyond.end(), [&](int a, int b) { return more(a, b) || (!more(b, a) && a < b); });
        for (const int atom : beyond)
            if (number[at(atom)] < 0) {
                number[at(atom)] = static_cast<int>(order.size());
                order.push_back(atom);
            }
    }
    return number;
}

// How a molecule whose atoms and bonds stand in this order becomes one of a kind.
struct Arrangement {
    std::vector<int> atoms, bonds;  // the place of each in the kind
    std::size_t kind;
};

class Sorter {
public:
    explicit Sorter(std::int64_t max_entries) : max_entries_(max_entries) {}

    void add(const Molecule &m);
    Sorted finished();

private:
    const Arrangement *arrangement(int n_atoms, const Pairs &ends);
    const Arrangement *make(int n_atoms, const Pairs &ends);

    const std::int64_t max_entries_;
    Sorted sorted_;
    std::map<KernelKind, std::size_t> known_;
    // By the ends of the bonds as a molecule has them; those with no kind are left out.
    std::map<Pairs, std::pair<bool, Arrangement>> arranged_;
};

void Sorter::add(const Molecule &m) {
    std::vector<std::int64_t> atoms;  // each once: a shape may have a fixed atom several times
    for (std::int64_t i = 0; i < m.n_atoms; ++i) atoms.push_back(m.atom(i));
    std::sort(atoms.begin(), atoms.end());
    atoms.erase(std::unique(atoms.begin(), atoms.end()), atoms.end());
    const auto number_of = [&](std::int64_t atom) {
        return static_cast<int>(std::lower_bound(atoms.begin(), atoms.end(), atom) - atoms.begin());
    };
    Pairs ends;
    for (std::int64_t k = 0; k < m.n_bonds; ++k)
        ends.emplace_back(number_of(m.atom(m.i(k))), number_of(m.atom(m.j(k))));
    const Arrangement *const found = arrangement(static_cast<int>(atoms.size()), ends);
    if (!found) {
        sorted_.left.push_back(m.number);
        return;
    }
    Member member{m.number, std::vector<int>(atoms.size()), std::vector<double>(ends.size())};
    for (std::size_t i = 0; i < atoms.size(); ++i) member.atoms[at(found->atoms[i])] = static_cast<int>(atoms[i]);
    for (std::size_t k = 0; k < ends.size(); ++k)
        member.lengths[at(found->bonds[k])] = m.length(static_cast<std::int64_t>(k));
    sorted_.kinds[found->kind].members.push_back(std::move(member));
}

const Arrangement *Sorter::arrangement(int n_atoms, const Pairs &ends) {
    const auto known = arranged_.find(ends);
    if (known != arranged_.end()) return known->second.first ? &known->second.second : nullptr;
    return make(n_atoms, ends);
}

const Arrangement *Sorter::make(int n_atoms, const Pairs &ends) {
    auto &[has_kind, arrangement] = arranged_[ends];
    arrangement.atoms = numbered_outwards(n_atoms, ends);
    // Bonds by their new ends: the kind does not depend on the order in which they were given.
    std::vector<std::pair<std::pair<int, int>, std::size_t>> named;
    for (std::size_t k = 0; k < ends.size(); ++k)
        named.emplace_back(std::minmax({arrangement.atoms[at(ends[k].first)], arrangement.atoms[at(ends[k].second)]}),
                           k);
    std::sort(named.begin(), named.end());
    KernelKind kind{n_atoms, {}, {}, {}};
    for (const auto &bond : named) kind.bonds.push_back(bond.first);
    std::vector<int> placed = eliminate_one_by_one(kind, max_entries_);
    if (placed.empty()) placed = eliminate_by_levels(kind);
    has_kind = !placed.empty();
    if (!has_kind) return nullptr;
    arrangement.bonds.resize(ends.size());
    for (std::size_t k = 0; k < named.size(); ++k) arrangement.bonds[named[k].second] = placed[k];
    const auto found = known_.emplace(kind, sorted_.kinds.size());
    if (found.second) sorted_.kinds.push_back({kind, {}});
    arrangement.kind = found.first->second;
    return &arrangement;
}

Sorted Sorter::finished() {
    std::sort(sorted_.kinds.begin(), sorted_.kinds.end(), [](const Sorted::OfKind &a, const Sorted::OfKind &b) {
        if (a.kind.is_for_group() != b.kind.is_for_group()) return b.kind.is_for_group();
        if (a.kind.n_bonds() != b.kind.n_bonds()) return a.kind.n_bonds() > b.kind.n_bonds();
        return a.kind < b.kind;
    });
    return std::move(sorted_);
}

}  // namespace

Sorted sorted_by_kind(const Chains &chains, std::int64_t max_entries) {
    Sorter sorter(max_entries);
    for (std::int64_t number = 0; number < chains.n_chains(); ++number) sorter.add(chains.molecule(number));
    Sorted sorted = sorter.finished();
    for (std::int64_t number = chains.n_chains(); number < chains.n_molecules(); ++number)
        sorted.left.push_back(number);
    return sorted;
}

}  // namespace holonomic::device
