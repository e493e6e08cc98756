// SPDX-License-Identifier: GPL-2.0-only
#ifndef HOLONOMIC_LAMMPS_FIX_BODIES_HPP
#define HOLONOMIC_LAMMPS_FIX_BODIES_HPP

#include <string>
#include <unordered_map>
#include <vector>

#include "../plan/shape.hpp"
#include "../plan/superpose.hpp"
#include "pointers.h"
#include "template.hpp"

namespace holonomic_lammps {

/** Which molecules are rigid bodies: those that look like a molecule file's, or all as they stand; and bodies that a
 * file lists by their atoms, which they may share. */
class Bodies : protected LAMMPS_NS::Pointers {
public:
    explicit Bodies(LAMMPS_NS::LAMMPS *lmp) : Pointers(lmp) {}

    /** Molecules that look like that of a molecule file are rigid bodies. Collective. */
    void add_file(const char *file);

    /** So are all others of the group, with the shapes that they have when they are first selected. */
    void take_as_they_stand();

    /** Bodies by their atoms, one a line: its number, a type that means nothing, its atoms (as fix poems reads them).
     * They have the shapes that they have when they are first selected. Collective. */
    void add_list(const char *file);

    bool empty() const { return templates_.empty() && !as_they_stand_ && lists_.empty(); }

    /**
     * Of some atoms those of the group's molecules that have the atoms of a template, type by type in the order of IDs;
     * of several such templates that which fits best; and listed bodies. Collective. Throws ErrorEverywhere where none
     * fits, or an atom of a list is missing.
     */
    std::vector<BodyAtom> select(int groupbit, const std::vector<int> &which);

    /** How far an atom is from where its template has it, once that is put onto the molecule as well as can be. */
    struct Displacement {
        double part = 0; /**< of the template's shortest distance */
        double distance = 0;
        std::string whose; /**< "molecule 3" */
        std::string name;  /**< of the template */
    };
    /** The largest of those last selected, on all ranks. */
    const Displacement &most_displaced() const { return most_; }

    /** Parts of the shortest distance: positions with some digits have less than the first; what has more than the
     * second is another molecule. */
    static constexpr double unremarkable = 1e-3, too_far = 0.1;

private:
    struct Part;
    struct Group;
    struct Fit;
    std::vector<Part> gather(int groupbit, const std::vector<int> &which) const;
    std::vector<Group> group(const std::vector<Part> &parts) const;
    Points whole(const Group &molecule, const Points &shape) const;
    void try_template(std::size_t t, const std::vector<Group> &groups, std::vector<Fit> &fits) const;
    bool adopt_next(double within, const std::vector<Group> &groups, const std::vector<Fit> &fits);
    void check(const std::vector<Group> &groups, const std::vector<Fit> &fits);
    void needs_molecule_ids() const;
    bool stands(const Group &group) const;
    std::string words(Tag name) const;

    std::vector<Template> templates_;
    /** A body of a list. Its name is above all molecule IDs. */
    struct Listed {
        std::size_t size;
        std::string words;
    };
    static constexpr Tag first_name = Tag(1) << 40;
    std::vector<Listed> lists_;
    std::unordered_map<Tag, std::vector<Tag>> listed_;  // by atom: the names of its bodies
    bool as_they_stand_ = false, selected_ = false;
    Displacement most_;
};

}  // namespace holonomic_lammps

#endif
