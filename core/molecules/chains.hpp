// Which atoms are joined by rigid bonds: what a handle of the C interface holds.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "core/caller/box.hpp"
#include "core/kernels/call.hpp"
#include "core/molecules/given/atom_use.hpp"
#include "core/molecules/given/copied.hpp"
#include "core/molecules/given/find.hpp"
#include "core/molecules/given/group.hpp"
#include "core/molecules/given/kind.hpp"
#include "core/molecules/given/labels.hpp"
#include "core/molecules/given/masses.hpp"
#include "core/molecules/given/molecule.hpp"
#include "core/molecules/planned/plan.hpp"
#include "core/molecules/planned/shapes.hpp"
#include "core/molecules/settings.hpp"

namespace holonomic {

namespace rigid {
class Bodies;
struct Cliques;
struct Given;
struct AffineParts;
}  // namespace rigid

// What a bond is. The values are those of hol_role, which capi/queries.cpp asserts.
enum class Role { own = 0, body = 1, implied = 2, fixed = 3 };

// When positions are compared with the lengths. The values are those of hol_when, which capi/chains.cpp asserts.
enum class Checks { never = 0, at_start = 1, always = 2 };

class Batch;

class Chains : public Settings {
public:
    Chains(std::int64_t n_atoms, const double *masses);
    Chains(const Chains &);  // shares what has been found out about shapes
    ~Chains();

    // adding.cpp. On an Error or std::bad_alloc nothing is added.
    void add(std::int64_t n_bonds, const std::int64_t *atoms, const double *lengths);
    void add_block(std::int64_t n_chains, std::int64_t n_bonds, std::int64_t first_atom, const double *lengths);
    void add_bonds(std::int64_t n_bonds, const std::int64_t *pairs, const double *lengths);
    // sum c_i r_i = 0, and bonds of the molecules in which these are (rigid/linear.hpp).
    void add_linear(std::int64_t n_relations, const std::int64_t *sizes, const std::int64_t *atoms,
                    const double *coefficients, std::int64_t n_bonds, const std::int64_t *pairs, const double *lengths);
    // The same for many copies.
    void add_linear_molecules(std::int64_t count, std::int64_t n_atoms, std::int64_t first_atom,
                              std::int64_t n_relations, const std::int64_t *sizes, const std::int64_t *atoms,
                              const double *coefficients, std::int64_t n_bonds, const std::int64_t *pairs,
                              const double *lengths);
    void add_molecules(std::int64_t n_molecules, std::int64_t n_atoms, std::int64_t first_atom, std::int64_t n_bonds,
                       const std::int64_t *pairs, const double *lengths);

    // core/rigid/adding.cpp. Bodies of sizes[b] atoms each, one after the other in `atoms`, at these places [..][3],
    // and bonds between them, or of them and other atoms; the same for `count` molecules of n_atoms consecutive ones.
    void add_rigid(std::int64_t n_bodies, const std::int64_t *sizes, const std::int64_t *atoms, const double *places,
                   std::int64_t n_bonds, const std::int64_t *pairs, const double *lengths);
    void add_rigid_molecules(std::int64_t count, std::int64_t n_atoms, std::int64_t first_atom, std::int64_t n_bodies,
                             const std::int64_t *sizes, const std::int64_t *atoms, const double *places,
                             std::int64_t n_bonds, const std::int64_t *pairs, const double *lengths);
    // Molecules with rigid bodies, or null: there are none. What is asked of the others below does not count these.
    const rigid::Bodies *bodies() const { return bodies_.get(); }
    // Nothing but molecules of bonds, and nobody asks for outcomes: a verb is no more than its part for these. It asks
    // so first: what is set up for others would be felt in calls on one molecule.
    bool is_plain() const { return !keeps_outcomes && !bodies_; }

    // values.cpp. On an Error or std::bad_alloc nothing is changed.
    void set_lengths(const double *lengths);
    void set_length(std::int64_t bond, double length);
    void set_masses(const double *masses);

    void set_active(const unsigned char *active);
    void set_labels(const std::int64_t *atoms, const std::int64_t *molecules) {
        labels_.set(n_atoms_, atoms, n_molecules(), molecules);
    }
    const Labels &labels() const { return labels_; }
    void set_base(int counted_from);  // before anything is added. Throws Error
    void set_box(const double *h);
    void set_reference_box(const double *h);
    void set_box_rate(const double *L);

    // core/rigid/images.cpp. Bonds whose images are told, [n_bonds][3] of the vectors of the box; of all bonds of the
    // set.
    void add_with_images(std::int64_t n_bonds, const std::int64_t *pairs, const double *lengths,
                         const std::int64_t *images);
    void set_images(const std::int64_t *images);
    void images(std::int64_t *out) const;
    const std::int32_t *images() const { return images_.data(); }

    // queries.cpp; those up to `memory` know molecules with bodies, too. Molecules, atoms and bonds are counted from 0,
    // but in what is written for the caller.
    std::int64_t n_atoms() const { return n_atoms_; }
    std::int64_t n_chains() const { return groups_.n_molecules(); }
    std::int64_t n_molecules() const;  // with those that have bodies, which come last
    std::int64_t n_bonds() const { return n_bonds_; }
    std::int64_t n_of_topology(int topology) const;
    int topology_of(std::int64_t molecule) const;  // a Topology, or:
    static constexpr int topology_with_bodies = 5;
    std::int64_t n_kinds() const;
    void offsets(std::int64_t *out) const;
    std::int64_t count_atoms(std::int64_t molecule) const;  // that `atoms` writes
    void atoms(std::int64_t molecule, std::int64_t *out) const;
    std::int64_t count_bonds(std::int64_t molecule) const;  // that `bonds` writes
    void bonds(std::int64_t molecule, std::int64_t *out) const;
    void molecules_of_bonds(std::int64_t *out) const;
    void pairs(std::int64_t *out) const;                            // [n_bonds][2]
    void lengths(double *out) const;                                // [n_bonds]
    void masses(double *out) const { masses_.copy(out); }           // [n_atoms]
    void active(unsigned char *out) const;                          // [n_molecules]
    void roles(std::int32_t *role, std::int64_t *n_removed) const;  // [n_bonds] a Role each, [n_molecules]; or null
    void held_sites(unsigned char *held) const;                     // held_sites.cpp [n_atoms] 1 or 0
    std::int64_t degrees_of_freedom(int dimensions) const;
    Name name_of_atom(std::int64_t atom) const { return labels_.of_atom(atom, base); }
    // The length that a body changed most, by which part of it; 0 and bond -1: none.
    struct Adjustment {
        double largest = 0;
        std::int64_t bond = -1;
    };
    const Adjustment &adjustment() const { return adjustment_; }
    const std::vector<std::int64_t> &implied() const { return implied_; }
    Name name_of_molecule(std::int64_t molecule) const;
    Name name_of_rigid(std::int64_t molecule, std::int64_t atom) const {  // of a molecule with bodies, by one atom
        return labels_.of_molecule(molecule, atom, base);
    }
    std::int64_t memory() const;
    bool is_active(std::int64_t molecule) const;
    Molecule molecule(std::int64_t molecule) const;
    // Calls each(molecule) for all that are active, as long as it returns true; returns whether it always did.
    template <class Each>
    bool for_active(const Each &each) const {
        for (const Group &group : groups_.all()) {
            Molecule m = molecule_of(group, 0);
            for (std::int64_t index = 0; index < group.count; ++index) {
                if (index > 0) place_molecule(group, index, m);
                if (is_active(m.number) && !each(static_cast<const Molecule &>(m))) return false;
            }
        }
        return true;
    }
    const Cell &box_of_reference() const { return has_reference_box_ ? reference_box_ : box; }
    const BoxRate *box_rate() const { return has_box_rate_ ? &box_rate_ : nullptr; }

    // plan.cpp
    const Plan &plan() const {  // thread-safe
        const Plan *const made = plan_.there();
        return made ? *made : make_plan();
    }
    const Plan &plan_of_parts() const;  // likewise; no molecule of it is linear
    // units.cpp
    Unit unit(const Plan &plan, const Plan::Chunk &chunk, Lane *lane) const;  // lane: memory for the first of a group
    MoleculeUnit unit(const Plan &plan, const Plan::Chunk &chunk, MoleculeLane *lane) const;
    MoleculeUnit unit_of_group(const Plan &plan, const Plan::Chunk &chunk, MoleculeLane *lane) const;
    std::int64_t chunk_bonds(const Plan::Chunk &chunk) const;  // of one molecule of the chunk; 0 if gathered ones
    const std::vector<std::int64_t> &reordered_bonds() const { return groups_.reordered(); }
    const std::vector<std::int64_t> &unconstrained() const { return unconstrained_; }
    // Whether a bond was given from the atom at which it ends here; by its place in the caller's arrays.
    bool is_backwards(std::int64_t bond) const {
        return !backwards_.empty() && backwards_[static_cast<std::size_t>(bond)] != 0;
    }

    // Another one after each change of the molecules, their masses, lengths, or which are active.
    std::int64_t revision() const { return revision_; }
    bool shares_fixed_atoms() const { return use_.any_shared(); }

    Checks checks() const { return checks_; }
    void set_checks(Checks when) {
        if (checks_ != when) fits_.set(false);
        checks_ = when;
    }
    // Whether positions are to be compared with the lengths before they are used (core/check.hpp): at the first call
    // after a change of the molecules, their lengths or the box. Thread-safe: several threads may find that it is so.
    bool wants_fit() const { return checks_ == Checks::always || (checks_ == Checks::at_start && !fits_.get()); }
    void note_fit() const { fits_.set(true); }

private:
    friend class Batch;
    friend class Planner;
    const Plan &make_plan() const;
    void changed() {
        ++revision_;
        plan_.clear();
        plan_of_parts_.clear();
        fits_.set(false);
    }
    void box_changed(const Box &next, Box &seen);
    Molecule molecule_of(const Group &group, std::int64_t index) const;
    void place_molecule(const Group &group, std::int64_t index, Molecule &m) const;
    const Kind &kind_of(const Group &group) const { return kinds_[group.kind]; }
    Lane lane_of(const Group &group, std::int64_t index, std::int64_t stage) const;
    MoleculeLane molecule_lane_of(const Plan &plan, const Group &group, std::int64_t index, std::int64_t stage,
                                  std::int64_t part) const;
    void rebuild(const Masses &masses, const double *lengths);
    // Throws Error, naming a bond of this length, if the box is narrower than twice that. lengths: those that molecules
    // are to have, in the caller's order, or null: as they are.
    void check_width(const Box &next, double longest, const double *lengths) const;
    // What many copies of molecules ask: the first atom; whether a list is within one; all of them, each made by
    // make(number) unless it is as the first one is.
    std::int64_t check_copies(std::int64_t count, std::int64_t n_atoms, std::int64_t first_atom) const;
    void check_of_molecule(const std::int64_t *list, std::int64_t n, std::int64_t n_atoms, bool bonds) const;
    std::vector<rigid::Given> copies_of(std::int64_t count, std::int64_t n_atoms, std::int64_t n_bonds,
                                        const std::function<std::vector<rigid::Given>(std::int64_t)> &make) const;
    std::vector<rigid::Given> sort_rigid(std::int64_t n_bodies, const std::int64_t *sizes, const std::int64_t *atoms,
                                         std::int64_t offset, const double *places, std::int64_t n_bonds,
                                         const std::int64_t *pairs, const double *lengths,
                                         const rigid::AffineParts *parts = nullptr) const;
    // `also`, of another addition in the same call: done when nothing else can fail but it.
    void commit_rigid(const std::vector<rigid::Given> &molecules, std::int64_t n_bonds, Batch *also = nullptr);
    // Bond k of the list has the length lengths[k % n_lengths]. Parts that depend become bodies (rigid/cliques.hpp).
    void add_listed(const BondList &list, const double *lengths, std::int64_t n_lengths);
    void add_with_bodies(const BondList &list, const double *lengths, std::int64_t n_lengths);
    rigid::AffineParts take_linear(const BondList &list, const double *lengths, std::int64_t n_lengths,
                                   rigid::Cliques &cliques, std::vector<unsigned char> &implied) const;
    std::unique_ptr<rigid::Bodies> rebuild_bodies(const Masses &masses, const double *lengths) const;
    double longest() const;
    template <class Each>
    void for_bonds(const Each &each) const;

    std::int64_t n_atoms_, n_bonds_ = 0;
    std::int64_t revision_ = 0;
    Masses masses_;
    AtomUse use_;
    Kinds kinds_;
    Shapes shapes_;
    Groups groups_;
    std::vector<std::int64_t> unconstrained_;  // bonds in no equation, in the caller's arrays: between two fixed atoms,
    std::vector<std::int64_t> implied_;        // or those that others imply (rigid/implied.hpp), which ascend
    struct LeftOut {
        std::int64_t atoms[2];
        double length;
    };
    std::vector<LeftOut> of_unconstrained_;  // as they were given
    std::vector<unsigned char> backwards_;   // [n_bonds], or empty: no bond is
    std::vector<unsigned char> active_;      // [n_chains] or empty: all
    Owned<rigid::Bodies> bodies_;
    Adjustment adjustment_;
    std::vector<std::int32_t> images_;  // [..][3] of the first bonds; looked at for those that have been told alone
    Labels labels_;
    Cell reference_box_{};
    BoxRate box_rate_{};
    bool has_reference_box_ = false, has_box_rate_ = false;
    Checks checks_ = Checks::at_start;
    double longest_ = 0;                 // of the bonds' lengths
    Box seen_box_{}, seen_reference_{};  // those that positions were last to be compared in
    mutable Flag fits_;
    mutable Made<Plan> plan_, plan_of_parts_;
};

}  // namespace holonomic
