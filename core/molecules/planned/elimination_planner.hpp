// Finds the order of elimination of a shape, and lists what goes with it (core/plan/elimination.hpp).
#pragma once

#include <cstdint>

#include "core/molecules/given/lists.hpp"
#include "core/molecules/planned/elimination_order.hpp"
#include "core/molecules/planned/plan_memory.hpp"

namespace holonomic {

class EliminationPlanner {
public:
    // What it is made for: a junction of paths, any molecule, a large graph that has to be a network, the
    // extended-precision solver.
    enum For { junction, molecule, network, extended };
    // The numbers of atoms and bonds, the bonds and the fixed atoms are there. Throws TooMuchMemory.
    EliminationPlanner(EliminationPlan &s, EliminationWork &work, std::int64_t most_bytes, For what)
        : s_(s), m_(work), most_bytes_(most_bytes), for_(what), bonds_(work.bonds), upper_bond_(work.upper_bond) {}
    void make();
    bool is_network() const { return is_network_; }

private:
    bool stays(std::int32_t atom) const { return for_ == network && m_.fixed[at(atom)]; }
    std::int32_t other_end(std::int32_t bond, std::int32_t atom) const {
        return m_.atom_i[at(bond)] ^ m_.atom_j[at(bond)] ^ atom;  // which of both it is, no processor could foresee
    }
    bool is_child(std::int32_t bond, std::int32_t atom) const { return upper_bond_[at(other_end(bond, atom))] == bond; }

    void strip();
    void hang_from_leaf(std::int32_t centre);
    void number_trees();
    std::int32_t most_trees_at_core() const;
    void number_ring();
    void number_core();
    void order_core(const Numbers &core, const Numbers &core_number, std::int64_t most_bytes);
    std::int64_t ends_of_strands() const;
    void check_atoms(std::int64_t most_bytes) const;
    void invert_numbers();
    void list_children();
    Lists meetings() const;
    void list_fill(const Lists &meeting);

    EliminationPlan &s_;
    EliminationWork &m_;
    const std::int64_t most_bytes_;
    const For for_;
    bool is_network_ = false;
    const Lists &bonds_;
    Numbers &upper_bond_;  // of the atoms of trees, by local atom; -1: a root, or of the core
};

}  // namespace holonomic
