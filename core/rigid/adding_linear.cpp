// Adding linear relations: those that are given, with bonds of their molecules, and those that a list of distances
// means.
#include <algorithm>
#include <cmath>

#include "core/index.hpp"
#include "core/molecules/batch.hpp"
#include "core/molecules/chains.hpp"
#include "core/molecules/memory_limit.hpp"
#include "core/rigid/bodies.hpp"
#include "core/rigid/cliques.hpp"
#include "core/rigid/implied.hpp"

namespace holonomic {

namespace {

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

// Relations as affine parts.
struct RelatedParts {
    std::vector<std::int64_t> sizes, atoms;
    std::vector<double> coordinates;
    rigid::AffineParts parts;
};

// atoms: counted from the base, those of the first copy `first` further on. Throws Error.
RelatedParts parts_of(const Chains &chains, const Masses &masses, std::int64_t n_atoms, std::int64_t first,
                      std::int64_t n_relations, const std::int64_t *sizes, const std::int64_t *atoms,
                      const double *coefficients, std::int64_t n_bonds, const double *lengths) {
    const int base = chains.base;
    if (n_relations < 1)
        throw make_error(Status::value, "n_relations is %lld; it must be at least 1",
                         static_cast<long long>(n_relations));
    RelatedParts found;
    std::vector<rigid::LinearRelation> all;
    for (std::int64_t k = 0; k < n_relations; ++k) {
        if (sizes[k] < 2 || sizes[k] > n_atoms)
            throw of_relation(k, base, "has fewer than two atoms, or more than there are");
        all.emplace_back();
        check({{}, {coefficients, coefficients + sizes[k]}}, k, base);
        std::vector<std::int64_t> held;
        for (std::int64_t a = 0; a < sizes[k]; ++a) {
            if (atoms[a] < base || atoms[a] - base >= n_atoms)
                throw make_error(Status::index, "atom %lld of relation %lld is outside %d .. %lld",
                                 static_cast<long long>(atoms[a]), static_cast<long long>(k + base), base,
                                 static_cast<long long>(n_atoms - 1 + base));
            rigid::LinearRelation &one = all.back();
            if (masses.infinite(atoms[a] - base + first)) {
                one.fixed.push_back(atoms[a]);
                one.of_fixed.push_back(coefficients[a]);
                continue;
            }
            if (!one.atoms.empty()) found.parts.links.emplace_back(atoms[a], one.atoms.back());
            one.atoms.push_back(atoms[a]);
            one.c.push_back(coefficients[a]);
        }
        if (all.back().atoms.empty()) throw of_relation(k, base, "has no atom that can move");
        for (const std::int64_t atom : all.back().fixed) found.parts.links.emplace_back(atom, all.back().atoms[0]);
        atoms += sizes[k];
        coefficients += sizes[k];
    }
    const rigid::LinearParts groups(all, 1e-10);
    if (groups.left_out() >= 0) throw of_relation(groups.left_out(), base, "follows from the others");
    double longest = 0;
    for (std::int64_t k = 0; k < n_bonds; ++k) longest = std::max(longest, lengths[k]);
    for (std::size_t p = 0; p < groups.parts().size(); ++p) {
        const std::vector<std::int64_t> &its = groups.parts()[p];
        found.sizes.push_back(static_cast<std::int64_t>(its.size()));
        found.atoms.insert(found.atoms.end(), its.begin(), its.end());
        found.parts.affine.push_back({groups.relations()[p], longest > 0 ? longest : 1, {}});
        found.parts.fixed.push_back(groups.fixed()[p]);
    }
    found.coordinates.assign(3 * found.atoms.size(), 0);
    return found;
}

}  // namespace

void Chains::add_linear(std::int64_t n_relations, const std::int64_t *sizes, const std::int64_t *atoms,
                        const double *coefficients, std::int64_t n_bonds, const std::int64_t *pairs,
                        const double *lengths) {
    check_lengths(n_bonds, lengths, base);
    const RelatedParts its =
        parts_of(*this, masses_, n_atoms_, 0, n_relations, sizes, atoms, coefficients, n_bonds, lengths);
    check_memory(*this, static_cast<std::int64_t>(its.atoms.size()) + n_bonds, bytes_of_body_atom);
    commit_rigid(sort_rigid(static_cast<std::int64_t>(its.sizes.size()), its.sizes.data(), its.atoms.data(), 0,
                            its.coordinates.data(), n_bonds, pairs, lengths, &its.parts),
                 n_bonds);
}

void Chains::add_linear_molecules(std::int64_t count, std::int64_t n_atoms, std::int64_t first_atom,
                                  std::int64_t n_relations, const std::int64_t *sizes, const std::int64_t *atoms,
                                  const double *coefficients, std::int64_t n_bonds, const std::int64_t *pairs,
                                  const double *lengths) {
    check_lengths(n_bonds, lengths, base);
    const std::int64_t first = check_copies(count, n_atoms, first_atom);
    if (count == 0) return;
    check_of_molecule(pairs, 2 * n_bonds, n_atoms, true);
    const RelatedParts its =
        parts_of(*this, masses_, n_atoms, first, n_relations, sizes, atoms, coefficients, n_bonds, lengths);
    check_memory(*this, count * (static_cast<std::int64_t>(its.atoms.size()) + n_bonds), bytes_of_body_atom);
    commit_rigid(copies_of(count, n_atoms, n_bonds,
                           [&](std::int64_t m) {
                               const std::int64_t offset = first + m * n_atoms;
                               const RelatedParts here = m == 0
                                                             ? its
                                                             : parts_of(*this, masses_, n_atoms, offset, n_relations,
                                                                        sizes, atoms, coefficients, n_bonds, lengths);
                               return sort_rigid(static_cast<std::int64_t>(here.sizes.size()), here.sizes.data(),
                                                 here.atoms.data(), offset, here.coordinates.data(), n_bonds, pairs,
                                                 lengths, &here.parts);
                           }),
                 count * n_bonds);
}

// Linear groups as affine parts, behind the bodies; and what they imply. Bonds of length zero are relations.
rigid::AffineParts Chains::take_linear(const BondList &list, const double *lengths, std::int64_t n_lengths,
                                       rigid::Cliques &cliques, std::vector<unsigned char> &implied) const {
    const rigid::LinearParts groups = rigid::LinearParts::of_groups(cliques.linear.all());
    rigid::AffineParts parts;
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
    parts.affine.resize(cliques.sizes.size());
    for (std::size_t p = 0; p < groups.parts().size(); ++p) {
        const std::vector<std::int64_t> &atoms = groups.parts()[p];
        cliques.sizes.push_back(static_cast<std::int64_t>(atoms.size()));
        cliques.atoms.insert(cliques.atoms.end(), atoms.begin(), atoms.end());
        cliques.coordinates.resize(cliques.coordinates.size() + 3 * atoms.size(), 0);
        parts.affine.push_back({groups.relations()[p], longest > 0 ? longest : 1, {}});
    }
    return parts;
}

}  // namespace holonomic
