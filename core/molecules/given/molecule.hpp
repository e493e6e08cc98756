// One molecule of a set, of whatever shape.
#pragma once

#include <cstdint>

#include "core/kernels/call.hpp"
#include "core/molecules/given/shape.hpp"

namespace holonomic {

// Atoms and bonds counted within the molecule: along a linear chain, else as in its shape.
struct Molecule {
    std::int64_t number;
    std::int64_t n_atoms, n_bonds;
    const Shape *shape;  // or null: each bond joins an atom to the next
    std::int64_t first_atom;
    const std::int64_t *atom_list;         // or null: from first_atom on
    const double *w_table, *length_table;  // or null: uniform
    double w_uniform, length_uniform;
    std::int64_t first_bond;
    const std::int64_t *bond_list;  // or null: from first_bond on

    Topology topology() const { return shape ? shape->topology : Topology::chain; }
    std::int64_t atom(std::int64_t i) const { return atom_list ? atom_list[i] : first_atom + i; }
    double w(std::int64_t i) const { return w_table ? w_table[i] : w_uniform; }
    // The two atoms of bond k, d = r_j - r_i.
    std::int64_t i(std::int64_t k) const { return shape ? shape->i(k) : k; }
    std::int64_t j(std::int64_t k) const { return shape ? shape->j(k) : k + 1; }
    double length(std::int64_t k) const { return length_table ? length_table[k] : length_uniform; }
    // Its place in the caller's arrays per bond.
    std::int64_t bond(std::int64_t k) const { return bond_list ? bond_list[k] : first_bond + k; }
};

}  // namespace holonomic
