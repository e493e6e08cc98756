// SPDX-License-Identifier: GPL-2.0-only
#include "library.hpp"

#include <memory>

namespace holonomic_lammps {

int add_molecules(hol_chains *chains, const Shape &shape, std::int64_t n_molecules, std::int64_t first_atom) {
    const auto n_bonds = static_cast<std::int64_t>(shape.pairs.size());
    if (shape.linear) return hol_chains_add_block(chains, n_molecules, n_bonds, first_atom, shape.lengths.data());
    const int status = hol_chains_set_length_tolerance(chains, shape.tolerance);
    if (status != HOL_OK) return status;
    std::vector<std::int64_t> pairs, sizes, atoms;
    for (const auto &pair : shape.pairs) pairs.insert(pairs.end(), {pair[0], pair[1]});
    if (shape.bodies.empty())
        return hol_chains_add_molecules(chains, n_molecules, shape.n_atoms, first_atom, n_bonds, pairs.data(),
                                        shape.lengths.data());
    std::vector<double> at;
    for (const Body &body : shape.bodies) {
        sizes.push_back(static_cast<std::int64_t>(body.places.size()));
        atoms.insert(atoms.end(), body.places.begin(), body.places.end());
        for (const auto &x : body.at) at.insert(at.end(), x.begin(), x.end());
    }
    return hol_chains_add_rigid_molecules(chains, n_molecules, shape.n_atoms, first_atom,
                                          static_cast<std::int64_t>(sizes.size()), sizes.data(), atoms.data(),
                                          at.data(), n_bonds, pairs.data(), shape.lengths.data());
}

Adjustment examine(Shape &shape, int dimensions) {
    shape.taken = static_cast<int>(shape.pairs.size());
    // Bonds without a cycle can't depend on each other.
    if (shape.bodies.empty() && shape.taken < shape.n_atoms) return {};
    const std::vector<double> masses(shape.n_atoms, 1.0);
    hol_chains *made = nullptr;
    if (hol_chains_create(shape.n_atoms, masses.data(), &made) != HOL_OK) return {};
    const std::unique_ptr<hol_chains, void (*)(hol_chains *)> chains(made, hol_chains_destroy);
    if (add_molecules(made, shape, 1, 0) != HOL_OK) return {};
    shape.rigid = hol_chains_n_of_shape(made, HOL_SHAPE_RIGID) > 0;
    shape.taken = dimensions * shape.n_atoms - static_cast<int>(hol_chains_degrees_of_freedom(made, dimensions));
    Adjustment found;
    std::int64_t bond = -1;
    if (hol_chains_adjustment(made, &found.part, &bond) == HOL_OK && bond >= 0) found.places = shape.pairs[bond];
    return found;
}

}  // namespace holonomic_lammps
