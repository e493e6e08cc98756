// Bonds whose periodic images are told and not looked for: a bond may be longer than half the box then, or go round it.
// Such molecules have no bodies. They are worked on here because nodes and images are apart: a bond's vector is the
// difference of two nodes and a shift (system.hpp), which is the lattice vector that the caller tells.
#include <algorithm>
#include <limits>
#include <unordered_map>

#include "core/index.hpp"
#include "core/molecules/batch.hpp"
#include "core/molecules/chains.hpp"
#include "core/molecules/given/find.hpp"
#include "core/molecules/memory_limit.hpp"
#include "core/rigid/bodies.hpp"

namespace holonomic {

namespace {

void check_images(std::int64_t n_bonds, const std::int64_t *images, int base) {
    constexpr std::int64_t most = std::numeric_limits<std::int32_t>::max();
    for (std::int64_t e = 0; e < 3 * n_bonds; ++e)
        if (images[e] < -most || images[e] > most) {
            Error error = make_error(Status::value, "the image of bond %lld has %lld along box vector %lld: too many",
                                     static_cast<long long>(e / 3 + base), static_cast<long long>(images[e]),
                                     static_cast<long long>(e % 3));
            error.bond = e / 3;
            error.base = base;
            throw error;
        }
}

// Atoms that can move and then fixed ones, each once; bonds with the atom first that was given first.
rigid::Given given_of(const FoundMolecules &found, const FoundMolecule &molecule, const BondList &list,
                      const double *lengths, const Masses &masses, std::int64_t first_bond) {
    rigid::Given given;
    given.has_images = true;
    std::unordered_map<std::int64_t, std::int32_t> local;
    for (const bool fixed : {false, true}) {
        for (std::int32_t a = 0; a < molecule.n_atoms; ++a) {
            const std::int64_t index = molecule.first_atom + a, atom = found.atoms[at(index)];
            if ((found.fixed[at(index)] != 0) != fixed) continue;
            if (!local.emplace(atom, static_cast<std::int32_t>(given.atoms.size())).second) continue;
            given.atoms.push_back(atom);
            given.masses.push_back(masses.mass(atom));
        }
        if (!fixed) given.n_movable = static_cast<std::int32_t>(given.atoms.size());
    }
    std::vector<std::int64_t> bonds(found.bonds.begin() + molecule.first_bond,
                                    found.bonds.begin() + molecule.first_bond + molecule.n_bonds);
    const auto ends = [&](std::int64_t k) {
        return std::minmax({list.pairs[2 * k], list.pairs[2 * k + 1]});  // copies
    };
    std::sort(bonds.begin(), bonds.end(), [&](std::int64_t a, std::int64_t b) { return ends(a) < ends(b); });
    for (const std::int64_t k : bonds) {
        given.bonds.push_back(
            {local.at(list.pairs[2 * k] - list.base), local.at(list.pairs[2 * k + 1] - list.base), lengths[k], -1});
        given.bond_numbers.push_back(first_bond + k);
    }
    return given;
}

}  // namespace

void Chains::add_with_images(std::int64_t n_bonds, const std::int64_t *pairs, const double *lengths,
                             const std::int64_t *images) {
    check_lengths(n_bonds, lengths, base);
    check_images(n_bonds, images, base);
    if (n_bonds == 0) return;
    check_memory(*this, 2 * n_bonds, bytes_of_body_atom);
    const BondList list{n_bonds, pairs, base, &labels_, 1};
    const FoundMolecules found = find_molecules(masses_, n_atoms_, list);
    std::vector<rigid::Given> molecules;
    for (const FoundMolecule &molecule : found.molecules) {
        molecules.push_back(given_of(found, molecule, list, lengths, masses_, n_bonds_));
        const rigid::Given &given = molecules.back();
        for (std::size_t i = 0; i < given.atoms.size(); ++i) {
            const std::int64_t atom = given.atoms[i];
            if (i < at(given.n_movable) ? use_.used(atom) : bodies_ && bodies_->is_site(atom))
                throw Batch::in_use(*this, atom);
        }
    }
    // Bonds between two fixed atoms are in no equation.
    FoundMolecules held;
    held.unconstrained = found.unconstrained;
    held.unconstrained_atoms = found.unconstrained_atoms;
    Batch batch(*this);
    batch.append_found(held, list, lengths, n_bonds);
    images_.resize(3 * at(n_bonds_), 0);  // what a call that failed has left is behind
    images_.insert(images_.end(), images, images + 3 * n_bonds);
    if (molecules.empty()) return batch.commit();
    commit_rigid(molecules, 0, &batch);
}

namespace {

// Calls each(bond) for those whose images are told.
template <class Each>
void for_told(const rigid::Bodies *bodies, const Each &each) {
    for (std::int64_t m = 0; bodies && m < bodies->n_molecules(); ++m) {
        const rigid::MoleculeKind &kind = bodies->kind(m);
        for (std::size_t k = 0; kind.has_images && k < kind.bonds.size(); ++k) each(bodies->bonds(m)[k]);
    }
}

}  // namespace

void Chains::set_images(const std::int64_t *images) {
    check_images(n_bonds_, images, base);
    std::vector<std::int32_t> told(3 * at(n_bonds_), 0);
    for_told(bodies(), [&](std::int64_t bond) { std::copy_n(images + 3 * bond, 3, told.begin() + 3 * bond); });
    for (std::int64_t e = 0; e < 3 * n_bonds_; ++e) {
        if (images[e] == told[at(e)] || std::binary_search(unconstrained_.begin(), unconstrained_.end(), e / 3))
            continue;
        Error error = make_error(Status::value,
                                 "bond %lld has an image, but was added without: hol_chains_add_bonds_with_images adds "
                                 "bonds whose images are told",
                                 static_cast<long long>(e / 3 + base));
        error.bond = e / 3;
        error.base = base;
        throw error;
    }
    images_ = std::move(told);
}

void Chains::images(std::int64_t *out) const {
    std::fill(out, out + 3 * n_bonds_, 0);
    for_told(bodies(), [&](std::int64_t bond) { std::copy_n(images_.begin() + 3 * bond, 3, out + 3 * bond); });
}

}  // namespace holonomic
