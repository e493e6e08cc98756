// SPDX-License-Identifier: GPL-2.0-only
#ifndef HOLONOMIC_LAMMPS_PLAN_REGISTRY_HPP
#define HOLONOMIC_LAMMPS_PLAN_REGISTRY_HPP

#include <stdexcept>
#include <string>
#include <unordered_map>

#include "shape.hpp"

namespace holonomic_lammps {

/** What an atom carries with it from rank to rank. */
struct Membership {
    Tag molecule = 0; /**< the lowest tag of the molecule; 0: the atom is in none */
    int place = 0;    /**< of the atom within the molecule */
    int n_atoms = 0;  /**< of the molecule */
    double taken = 0; /**< degrees of freedom that constraints take from the atom */
};

/** The molecules that the bonds of all ranks form. Each is kept by the bookkeeper of its lowest tag. */
class Registry {
public:
    Registry() = default;

    /**
     * Takes the bonds and rigid bodies that each rank knows; a bond that several ranks or both of its atoms report
     * counts once. Bonds within a body are held by it. Collective.
     * @param dimensions  2 or 3, for the degrees of freedom
     * Throws ErrorEverywhere if a bond is given with two lengths or joins an atom with itself, or an atom is in two
     * bodies.
     */
    Registry(MPI_Comm world, const std::vector<Bond> &bonds, const std::vector<BodyAtom> &bodies = {},
             int dimensions = 3);

    /** What to know of atoms, by their tags. Collective. */
    std::vector<Membership> memberships(const std::vector<Tag> &tags) const;

    /** Shapes of molecules, by their numbers. Collective. */
    std::vector<Shape> shapes(const std::vector<Tag> &molecules) const;

    std::int64_t n_molecules() const { return n_molecules_; } /**< on all ranks */
    std::int64_t n_bonds() const { return n_bonds_; }         /**< on all ranks */
    std::int64_t n_atoms() const { return n_atoms_; }         /**< on all ranks */
    std::int64_t n_bodies() const { return n_bodies_; }       /**< on all ranks, those of the shapes */
    bool knows(Tag molecule) const { return molecules_.count(molecule) != 0; }

private:
    std::vector<Node> collect(const std::vector<Bond> &bonds, const std::vector<BodyAtom> &bodies) const;
    void build(const std::vector<Node> &nodes, int dimensions);

    MPI_Comm world_ = MPI_COMM_NULL;
    int n_ranks_ = 0;
    std::int64_t n_molecules_ = 0, n_bonds_ = 0, n_atoms_ = 0, n_bodies_ = 0;
    std::unordered_map<Tag, Shape> molecules_;         // those whose books are kept here
    std::unordered_map<Tag, Membership> memberships_;  // likewise, by atom
};

/** An error that every rank throws, with the same message. */
struct ErrorEverywhere : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/** Throws ErrorEverywhere with the message of the lowest rank that has one (not ""), on every rank. Collective. */
void throw_together(MPI_Comm world, const std::string &message);

}  // namespace holonomic_lammps

#endif
