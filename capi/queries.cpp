// What a set of molecules tells about itself.
#include <algorithm>

#include "boundary.hpp"
#include "which_box.hpp"

using holonomic::guarded;
using holonomic::is_reference;
using holonomic::make_error;
using holonomic::need;
using holonomic::Status;
using holonomic::Topology;

namespace {

constexpr bool same(Topology topology, hol_shape shape) {
    return static_cast<int>(topology) == static_cast<int>(shape);
}
static_assert(same(Topology::chain, HOL_SHAPE_CHAIN) && same(Topology::tree, HOL_SHAPE_TREE) &&
                  same(Topology::ring, HOL_SHAPE_RING) && same(Topology::triangle, HOL_SHAPE_TRIANGLE) &&
                  same(Topology::other, HOL_SHAPE_OTHER) && holonomic::Chains::topology_with_bodies == HOL_SHAPE_RIGID,
              "core/molecules/shape.hpp and the public header disagree");

using holonomic::Role;
constexpr bool same(Role role, hol_role code) { return static_cast<int>(role) == static_cast<int>(code); }
static_assert(same(Role::own, HOL_ROLE_OWN) && same(Role::body, HOL_ROLE_BODY) &&
                  same(Role::implied, HOL_ROLE_IMPLIED) && same(Role::fixed, HOL_ROLE_FIXED),
              "core/molecules/chains.hpp and the public header disagree");

// The number of a molecule counted from 0. Throws Error if there is none of that number.
std::int64_t from_zero(const holonomic::Chains &chains, std::int64_t molecule) {
    if (molecule >= chains.base && molecule - chains.base < chains.n_molecules()) return molecule - chains.base;
    holonomic::Error error =
        make_error(Status::index, "molecule %lld is outside %d .. %lld", static_cast<long long>(molecule), chains.base,
                   static_cast<long long>(chains.n_molecules() - 1 + chains.base));
    error.base = chains.base;
    throw error;
}

}  // namespace

int64_t hol_chains_n_atoms(const hol_chains *chains) { return chains ? chains->chains.n_atoms() : 0; }
int64_t hol_chains_n_molecules(const hol_chains *chains) { return chains ? chains->chains.n_molecules() : 0; }
int64_t hol_chains_n_bonds(const hol_chains *chains) { return chains ? chains->chains.n_bonds() : 0; }

int hol_chains_offsets(const hol_chains *chains, int64_t *offsets) {
    return guarded(__func__, chains, [&] {
        need(offsets, "offsets");
        chains->chains.offsets(offsets);
    });
}

int hol_chains_molecule(const hol_chains *chains, int64_t molecule, int *shape, int64_t *n_atoms, int64_t *n_bonds) {
    return guarded(__func__, chains, [&] {
        const holonomic::Chains &all = chains->chains;
        const int64_t number = from_zero(all, molecule);
        if (shape) *shape = all.topology_of(number);
        if (n_atoms) *n_atoms = all.count_atoms(number);
        if (n_bonds) *n_bonds = all.count_bonds(number);
    });
}

int hol_chains_atoms(const hol_chains *chains, int64_t molecule, int64_t *atoms) {
    return guarded(__func__, chains, [&] {
        need(atoms, "atoms");
        chains->chains.atoms(from_zero(chains->chains, molecule), atoms);
    });
}

int hol_chains_bonds(const hol_chains *chains, int64_t molecule, int64_t *bonds) {
    return guarded(__func__, chains, [&] {
        need(bonds, "bonds");
        chains->chains.bonds(from_zero(chains->chains, molecule), bonds);
    });
}

int hol_chains_molecules_of_bonds(const hol_chains *chains, int64_t *molecules) {
    return guarded(__func__, chains, [&] {
        need(chains->n_bonds(), molecules, "molecules");
        chains->chains.molecules_of_bonds(molecules);
    });
}

int hol_chains_pairs(const hol_chains *chains, int64_t *pairs) {
    return guarded(__func__, chains, [&] {
        need(chains->n_bonds(), pairs, "pairs");
        chains->chains.pairs(pairs);
    });
}

int hol_chains_lengths(const hol_chains *chains, double *lengths) {
    return guarded(__func__, chains, [&] {
        need(chains->n_bonds(), lengths, "lengths");
        chains->chains.lengths(lengths);
    });
}

int hol_chains_masses(const hol_chains *chains, double *masses) {
    return guarded(__func__, chains, [&] {
        need(chains->n_atoms(), masses, "masses");
        chains->chains.masses(masses);
    });
}

int hol_chains_images(const hol_chains *chains, int64_t *images) {
    return guarded(__func__, chains, [&] {
        need(chains->n_bonds(), images, "images");
        chains->chains.images(images);
    });
}

int hol_chains_box(const hol_chains *chains, hol_which_box which, double *box) {
    return guarded(__func__, chains, [&] {
        need(box, "box");
        const double *const given = holonomic::box_of(chains, which).given;
        std::copy(given, given + 9, box);
    });
}

int hol_chains_roles(const hol_chains *chains, int *roles, int64_t *removed) {
    return guarded(__func__, chains, [&] { chains->chains.roles(roles, removed); });
}

int64_t hol_chains_n_of_shape(const hol_chains *chains, hol_shape shape) {
    return chains ? chains->chains.n_of_topology(shape) : 0;
}

int64_t hol_chains_n_kinds(const hol_chains *chains) { return chains ? chains->chains.n_kinds() : 0; }

int64_t hol_chains_degrees_of_freedom(const hol_chains *chains, int dimensions) {
    return chains && (dimensions == 2 || dimensions == 3) ? chains->chains.degrees_of_freedom(dimensions) : -1;
}

int64_t hol_chains_memory(const hol_chains *chains) { return chains ? chains->chains.memory() : 0; }

int hol_chains_adjustment(const hol_chains *chains, double *largest, int64_t *bond) {
    return guarded(__func__, chains, [&] {
        need(largest, "largest");
        const holonomic::Chains::Adjustment &found = chains->chains.adjustment();
        *largest = found.largest;
        if (bond) *bond = found.bond < 0 ? -1 : found.bond + chains->chains.base;
    });
}

int hol_chains_held_sites(const hol_chains *chains, unsigned char *held) {
    return guarded(__func__, chains, [&] {
        need(chains->n_atoms(), held, "held");
        chains->chains.held_sites(held);
    });
}

int hol_chains_implied(const hol_chains *chains, unsigned char *implied) {
    return guarded(__func__, chains, [&] {
        need(implied, "implied");
        std::fill(implied, implied + chains->chains.n_bonds(), static_cast<unsigned char>(0));
        for (const std::int64_t bond : chains->chains.implied()) implied[bond] = 1;
    });
}
