// SPDX-License-Identifier: GPL-2.0-only
#ifndef HOLONOMIC_LAMMPS_PLAN_REGISTRY_HPP
#define HOLONOMIC_LAMMPS_PLAN_REGISTRY_HPP

#include <stdexcept>
#include <string>
#include <unordered_map>
#include <unordered_set>

#include "shape.hpp"

namespace holonomic_lammps {

/** What an atom carries with it from rank to rank. */
struct Membership {
    Tag molecule = 0; /**< the lowest tag of the molecule; 0: the atom is in none */
    int place = 0;    /**< of the atom within the molecule; divided: no rank has the whole molecule */
    int n_atoms = 0;  /**< of the molecule */
    double taken = 0; /**< degrees of freedom that constraints take from the atom */
};

constexpr int divided = -1;

/** A bond as one of its atoms knows it. */
struct Partner {
    Tag atom;
    double length;
};

/** The molecules that the bonds of all ranks form. Each is kept by the bookkeeper of its lowest tag. */
class Registry {
public:
    Registry() = default;

    /**
     * Takes the bonds and rigid bodies that each rank knows; a bond that several ranks or both of its atoms report
     * counts once. Bonds within a body are held by it. Collective.
     * @param dimensions  2 or 3, for the degrees of freedom
     * @param divide  molecules of at least as many atoms, whose distances do not depend on each other and which have no
     * bodies, are divided among the ranks; 0: none
     * @param tolerance  by which part lengths of distances that depend on each other may be adjusted
     * Throws ErrorEverywhere if a bond is given with two lengths or joins an atom with itself, or an atom is twice in a
     * body.
     */
    Registry(MPI_Comm world, const std::vector<RigidBond> &bonds, const std::vector<BodyAtom> &bodies = {},
             int dimensions = 3, std::int64_t divide = 0, double tolerance = 1e-3);

    /** Of the molecules whose books are kept here, those of which atoms are missing. Collective.
     * @param members  of all atoms that there are, each on one rank */
    std::vector<Tag> incomplete(const std::vector<Membership> &members) const;

    /**
     * Takes other molecules in the place of some; the names of those, the same on all ranks. Collective.
     * @return whether divided molecules are among them
     */
    bool replace(const std::unordered_set<Tag> &gone, Registry come);

    /** What to know of atoms, by their tags. Collective. */
    std::vector<Membership> memberships(const std::vector<Tag> &tags) const;

    /** Shapes of molecules, by their numbers. Collective. */
    std::vector<Shape> shapes(const std::vector<Tag> &molecules) const;

    /** What atoms of divided molecules are bonded to, by their tags. Collective. */
    std::vector<std::vector<Partner>> partners(const std::vector<Tag> &tags) const;

    std::int64_t n_divided() const { return n_divided_; }     /**< of the molecules, on all ranks */
    std::int64_t n_molecules() const { return n_molecules_; } /**< on all ranks */
    std::int64_t n_bonds() const { return n_bonds_; }         /**< on all ranks */
    std::int64_t n_atoms() const { return n_atoms_; }         /**< on all ranks */
    std::int64_t n_bodies() const { return n_bodies_; }       /**< on all ranks, those of the shapes */

    /** The length that has been adjusted most of those that depend on each other, when these molecules were found. */
    struct Adjusted {
        double part = 0; /**< of the length */
        Tag from = 0, to = 0;
    };
    const Adjusted &most_adjusted() const { return adjusted_; } /**< on all ranks */
    bool knows(Tag molecule) const { return molecules_.count(molecule) != 0; }

private:
    std::vector<Node> collect(const std::vector<RigidBond> &bonds, const std::vector<BodyAtom> &bodies) const;
    void build(const std::vector<Node> &nodes, int dimensions, double tolerance);
    void add_up();
    bool divides(const Shape &shape) const;

    MPI_Comm world_ = MPI_COMM_NULL;
    int n_ranks_ = 0;
    std::int64_t divide_ = 0;
    Adjusted adjusted_;
    std::int64_t n_molecules_ = 0, n_bonds_ = 0, n_atoms_ = 0, n_bodies_ = 0, n_divided_ = 0;
    std::unordered_map<Tag, Shape> molecules_;                // those whose books are kept here
    std::unordered_map<Tag, Membership> memberships_;         // likewise, by atom
    std::unordered_map<Tag, std::vector<Partner>> partners_;  // likewise, of divided molecules
};

/** An error that every rank throws, with the same message. */
struct ErrorEverywhere : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/** Throws ErrorEverywhere with the message of the lowest rank that has one (not ""), on every rank. Collective. */
void throw_together(MPI_Comm world, const std::string &message);

}  // namespace holonomic_lammps

#endif
