// Adding linear relations: those that are given, with bonds of their molecules, and those that a list of distances
// means.
#include <algorithm>
#include <cmath>

#include "core/molecules/batch.hpp"
#include "core/molecules/chains.hpp"
#include "core/molecules/memory_limit.hpp"
#include "core/rigid/bodies.hpp"
#include "core/rigid/cliques.hpp"
#include "core/rigid/implied.hpp"

namespace holonomic {

namespace {

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

Error of_relation(std::int64_t relation, int base, const char *what) {
    return make_error(Status::value, "relation %lld %s", static_cast<long long>(relation + base), what);
}

void check(const rigid::LinearRelation &one, std::int64_t number, int base) {
    double sum = 0, size = 0;
    for (const double c : one.c) {
        if (!std::isfinite(c)) throw of_relation(number, base, "has a coefficient that is not finite");
        sum += c;
        size += std::fabs(c);
    }
    if (!(size > 0)) throw of_relation(number, base, "has no coefficient but zeros");
    if (!(std::fabs(sum) <= 1e-9 * size))
        throw of_relation(number, base,
                          "has coefficients that do not add up to 0: it would hold atoms relative to the origin");
}

}  // namespace

void Chains::add_linear(std::int64_t n_relations, const std::int64_t *sizes, const std::int64_t *atoms,
                        const double *coefficients, std::int64_t n_bonds, const std::int64_t *pairs,
                        const double *lengths) {
    if (n_relations < 1)
        throw make_error(Status::value, "n_relations is %lld; it must be at least 1",
                         static_cast<long long>(n_relations));
    check_lengths(n_bonds, lengths, base);
    std::vector<rigid::LinearRelation> all;
    double longest = 0;
    for (std::int64_t k = 0; k < n_bonds; ++k) longest = std::max(longest, lengths[k]);
    rigid::LooseParts parts;
    for (std::int64_t k = 0; k < n_relations; ++k) {
        if (sizes[k] < 2 || sizes[k] > n_atoms_)
            throw of_relation(k, base, "has fewer than two atoms, or more than there are");
        all.push_back({{atoms, atoms + sizes[k]}, {coefficients, coefficients + sizes[k]}});
        for (std::int64_t a = 0; a < sizes[k]; ++a) {
            if (atoms[a] < base || atoms[a] - base >= n_atoms_)
                throw make_error(Status::index, "atom %lld of relation %lld is outside %d .. %lld",
                                 static_cast<long long>(atoms[a]), static_cast<long long>(k + base), base,
                                 static_cast<long long>(n_atoms_ - 1 + base));
            if (a > 0) parts.links.emplace_back(atoms[a], atoms[a - 1]);
        }
        check(all.back(), k, base);
        atoms += sizes[k];
        coefficients += sizes[k];
    }
    const rigid::Linear groups(all, 1e-10);
    if (groups.left_out() >= 0) throw of_relation(groups.left_out(), base, "follows from the others");
    std::vector<std::int64_t> part_sizes, part_atoms;
    for (std::size_t p = 0; p < groups.parts().size(); ++p) {
        const std::vector<std::int64_t> &its = groups.parts()[p];
        part_sizes.push_back(static_cast<std::int64_t>(its.size()));
        part_atoms.insert(part_atoms.end(), its.begin(), its.end());
        parts.loose.push_back({groups.relations()[p], longest > 0 ? longest : 1});
    }
    const std::vector<double> places(3 * part_atoms.size(), 0);
    check_memory(*this, static_cast<std::int64_t>(part_atoms.size()) + n_bonds, bytes_of_body_atom);
    commit_rigid(sort_rigid(static_cast<std::int64_t>(part_sizes.size()), part_sizes.data(), part_atoms.data(), 0,
                            places.data(), n_bonds, pairs, lengths, &parts),
                 n_bonds);
}

// Linear groups as loose parts, behind the bodies; and what they imply. Bonds of length zero are relations.
rigid::LooseParts Chains::take_linear(const BondList &list, const double *lengths, std::int64_t n_lengths,
                                      rigid::Cliques &cliques, std::vector<unsigned char> &implied) const {
    const rigid::Linear groups = rigid::Linear::of_groups(cliques.linear.all());
    rigid::LooseParts parts;
    double longest = 0;
    for (const std::int64_t k : cliques.linear_bonds) longest = std::max(longest, lengths[k % n_lengths]);
    for (const std::int64_t k : rigid::implied_beside(groups, masses_, list, lengths, n_lengths, cliques)) {
        implied[at(k)] = 1;
        parts.links.emplace_back(list.pairs[2 * k], list.pairs[2 * k + 1]);
    }
    for (std::int64_t k = 0; k < list.n_bonds; ++k) {
        if (lengths[k % n_lengths] > 0) continue;
        const std::int64_t i = list.pairs[2 * k], j = list.pairs[2 * k + 1];
        if (masses_.fixed(i - list.base) || masses_.fixed(j - list.base))
            throw bond_error(list, Status::value, k, "has the length 0, and one of its atoms is held fixed");
        implied[at(k)] = 1;
        parts.links.emplace_back(i, j);
    }
    parts.loose.resize(cliques.sizes.size());
    for (std::size_t p = 0; p < groups.parts().size(); ++p) {
        const std::vector<std::int64_t> &atoms = groups.parts()[p];
        cliques.sizes.push_back(static_cast<std::int64_t>(atoms.size()));
        cliques.atoms.insert(cliques.atoms.end(), atoms.begin(), atoms.end());
        cliques.places.resize(cliques.places.size() + 3 * atoms.size(), 0);
        parts.loose.push_back({groups.relations()[p], longest > 0 ? longest : 1});
    }
    return parts;
}

}  // namespace holonomic
