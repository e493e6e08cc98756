// SPDX-License-Identifier: GPL-2.0-only
#ifndef HOLONOMIC_LAMMPS_PLAN_PLAN_HPP
#define HOLONOMIC_LAMMPS_PLAN_PLAN_HPP

#include <map>

#include "exchange.hpp"
#include "registry.hpp"
#include "table.hpp"

namespace holonomic_lammps {

/** A molecule that lives on this rank: its atoms have the slots first .. first + n_atoms - 1, by their places. */
struct Resident {
    Tag molecule;
    int shape; /**< number in Plan::shapes() */
    int first;
};

/**
 * Which molecules live on this rank, wherever their atoms are. A molecule whose atoms are all on one rank lives there;
 * another on one of those that own most of them, each as often as the others.
 */
class Plan {
public:
    explicit Plan(MPI_Comm world) : world_(world), n_ranks_(size_of_world()) {}

    /**
     * Plans anew after atoms have moved between ranks. Collective.
     * @param members, tags  of this rank's atoms, [n_atoms]
     * @return whether the molecules that live here are others than before, or stand in another order
     * Throws ErrorEverywhere, naming a molecule whose atoms are not all there.
     */
    bool renew(const Registry &registry, const Membership *members, const Tag *tags, int n_atoms);

    /** Molecules that are no more, or may have other bonds now. */
    void forget(const std::unordered_set<Tag> &molecules);

    const std::vector<Resident> &residents() const { return residents_; }
    const std::vector<Shape> &shapes() const { return shapes_; }
    const Walk &walk_of(int shape) const { return walks_[shape]; }
    int numbering() const { return numbering_; }             /**< changes when shapes get other numbers */
    const std::vector<int> &atoms() const { return atoms_; } /**< by slot; -1: another rank's */
    const std::vector<Tag> &tags() const { return tags_; }   /**< by slot */
    int n_slots() const { return static_cast<int>(atoms_.size()); }
    int n_away() const { return n_away_; } /**< own atoms whose molecule lives elsewhere */

    Exchange exchange;

private:
    struct Part;
    int size_of_world() const;
    void count(const Membership *members, int n_atoms);
    void choose_homes();
    int choose(const Part *begin, const Part *end);
    bool settle(const Registry &registry);
    void find_shapes(const Registry &registry, const std::vector<Tag> &molecules);
    void forget_shapes();
    void fill_slots(const Membership *members, const Tag *tags, int n_atoms);

    MPI_Comm world_;
    int n_ranks_;
    Table numbers_;  // of the molecules below: residents first, in their order
    std::vector<Tag> molecules_;
    std::vector<int> present_, wanted_, home_;  // atoms of them that are here, that they have; where they live
    std::vector<Resident> residents_;
    std::vector<int> atoms_;
    std::vector<Tag> tags_;
    int n_away_ = 0;
    std::vector<Shape> shapes_;
    std::vector<Walk> walks_;   // by shape
    std::size_t n_listed_ = 0;  // bonds and atoms of the shapes
    int numbering_ = 0;
    bool stale_ = false;  // of a molecule that has lived here the shape was forgotten
    std::map<Shape, int> shape_numbers_;
    std::unordered_map<Tag, int> shape_of_;   // of molecules that have lived here
    std::unordered_map<Tag, int> last_home_;  // of divided molecules whose books are kept here
};

}  // namespace holonomic_lammps

#endif
