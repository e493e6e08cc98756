// SPDX-License-Identifier: GPL-2.0-only
#ifndef HOLONOMIC_LAMMPS_FIX_SELECTION_HPP
#define HOLONOMIC_LAMMPS_FIX_SELECTION_HPP

#include <mpi.h>

#include <set>
#include <string>
#include <vector>

#include "../plan/registry.hpp"
#include "bodies.hpp"
#include "pointers.h"

namespace holonomic_lammps {

/** What the fix keeps of each atom: its place in a molecule, and which of its bonds and angles are rigid by this fix.
 */
struct Belonging : Membership {
    std::uint32_t bonds = 0; /**< bit k: entry k of the atom's list of bonds, whose type is negative for that */
    std::uint32_t angles = 0;
    /** Of the lists when they were last looked at: bits mean nothing if it has changed. At first that of no lists. */
    std::uint32_t topology = never_seen;
    static constexpr std::uint32_t never_seen = 0xFFFFFFFFu;
};

/** Which bonds and angles are to be rigid: those of given types, or bonds of atoms of given types or masses. */
class Selection : protected LAMMPS_NS::Pointers {
public:
    explicit Selection(LAMMPS_NS::LAMMPS *lmp) : Pointers(lmp), bodies(lmp) {}

    /** Reads "b 1 2 a 1 t 3 m 1.0" from arg[first] on; gives the number of the argument behind. */
    int read(int narg, char **arg, int first);

    /** Which molecules are rigid bodies. */
    Bodies bodies;

    /** Whether there is anything to select. */
    bool empty() const;

    /**
     * Of some atoms here selects what is not yet rigid, by this fix or another, makes its types negative, so that no
     * force acts along it, and gives their rigid distances. What is new must have both ends among them, on whatever
     * rank. Collective.
     */
    std::vector<RigidBond> select(int groupbit, std::vector<Belonging> &atoms, const std::vector<int> &which);

    /** Atoms here whose bonds or angles are others than when they were last selected, and atoms that are new. */
    std::vector<int> changed(const std::vector<Belonging> &atoms) const;

    /** The first atom of this fix's molecules that has a bond whose force another fix has switched off, 0 if there is
     * none. Collective. */
    Tag held_elsewhere(const std::vector<Belonging> &atoms) const;

    /** Makes the types of an atom's rigid bonds and angles positive again. */
    void release(std::vector<Belonging> &atoms);

private:
    struct Ends;
    std::vector<double> lengths_of_types();
    std::vector<RigidBond> select_bonds(int groupbit, std::vector<Belonging> &atoms, const std::vector<int> &which);
    void select_angles(std::vector<Belonging> &atoms, const std::vector<int> &which, std::vector<RigidBond> &bonds);
    bool wants(int i) const;
    std::uint32_t topology(int i) const;
    void release_atom(int i, Belonging &belonging);
    /** Of an atom; atom styles without bonds have no such lists. */
    int n_bonds(int i) const;
    int n_angles(int i) const;

    std::set<int> bond_types_, angle_types_, atom_types_;
    std::vector<double> masses_;
};

}  // namespace holonomic_lammps

#endif
