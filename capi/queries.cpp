// What a set of molecules tells about itself.
#include <algorithm>

#include "boundary.hpp"

using holonomic::Form;
using holonomic::guarded;
using holonomic::make_error;
using holonomic::need;
using holonomic::Status;

namespace {

constexpr bool same(Form form, hol_shape shape) { return static_cast<int>(form) == static_cast<int>(shape); }
static_assert(same(Form::chain, HOL_SHAPE_CHAIN) && same(Form::tree, HOL_SHAPE_TREE) &&
                  same(Form::ring, HOL_SHAPE_RING) && same(Form::triangle, HOL_SHAPE_TRIANGLE) &&
                  same(Form::other, HOL_SHAPE_OTHER) && holonomic::Chains::form_with_bodies == HOL_SHAPE_RIGID,
              "core/molecules/shape.hpp and the public header disagree");

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
int64_t hol_chains_n_chains(const hol_chains *chains) { return chains ? chains->chains.n_molecules() : 0; }
int64_t hol_chains_n_bonds(const hol_chains *chains) { return chains ? chains->chains.n_bonds() : 0; }

int hol_chains_offsets(const hol_chains *chains, int64_t *offsets) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(offsets, "offsets");
        chains->chains.offsets(offsets);
    });
}

int hol_chains_molecule(const hol_chains *chains, int64_t molecule, int *shape, int64_t *n_atoms, int64_t *n_bonds) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        const holonomic::Chains &all = chains->chains;
        const int64_t number = from_zero(all, molecule);
        if (shape) *shape = all.form_of(number);
        if (n_atoms) *n_atoms = all.count_atoms(number);
        if (n_bonds) *n_bonds = all.count_bonds(number);
    });
}

int hol_chains_atoms(const hol_chains *chains, int64_t molecule, int64_t *atoms) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(atoms, "atoms");
        chains->chains.atoms(from_zero(chains->chains, molecule), atoms);
    });
}

int hol_chains_bonds(const hol_chains *chains, int64_t molecule, int64_t *bonds) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(bonds, "bonds");
        chains->chains.bonds(from_zero(chains->chains, molecule), bonds);
    });
}

int hol_chains_molecules_of_bonds(const hol_chains *chains, int64_t *molecules) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(molecules, "molecules");
        chains->chains.molecules_of_bonds(molecules);
    });
}

int64_t hol_chains_n_of_shape(const hol_chains *chains, int shape) {
    return chains ? chains->chains.n_of_form(shape) : 0;
}

int64_t hol_chains_n_kinds(const hol_chains *chains) { return chains ? chains->chains.n_kinds() : 0; }

int64_t hol_chains_degrees_of_freedom(const hol_chains *chains, int dimensions) {
    return chains && (dimensions == 2 || dimensions == 3) ? chains->chains.degrees_of_freedom(dimensions) : -1;
}

int64_t hol_chains_memory(const hol_chains *chains) { return chains ? chains->chains.memory() : 0; }

int hol_chains_adjustment(const hol_chains *chains, double *largest, int64_t *bond) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(largest, "largest");
        const holonomic::Chains::Adjustment &found = chains->chains.adjustment();
        *largest = found.largest;
        if (bond) *bond = found.bond < 0 ? -1 : found.bond + chains->chains.base;
    });
}

int hol_chains_implied(const hol_chains *chains, unsigned char *implied) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(implied, "implied");
        std::fill(implied, implied + chains->chains.n_bonds(), static_cast<unsigned char>(0));
        for (const std::int64_t bond : chains->chains.implied()) implied[bond] = 1;
    });
}
