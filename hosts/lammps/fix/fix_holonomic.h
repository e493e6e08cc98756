// SPDX-License-Identifier: GPL-2.0-only
#ifndef LMP_FIX_HOLONOMIC_H
#define LMP_FIX_HOLONOMIC_H

#include <array>
#include <memory>
#include <vector>

#include "../plan/blocks.hpp"
#include "../plan/divided.hpp"
#include "release.hpp"
#include "selection.hpp"

namespace LAMMPS_NS {

/** Rigid bonds in molecules of any shape, with the library holonomic. */
class FixHolonomic : public Fix {
public:
    FixHolonomic(LAMMPS *, int, char **);
    ~FixHolonomic() override;

    int setmask() override;
    void init() override;
    void setup_pre_neighbor() override;
    void setup(int) override;
    void min_setup(int) override;
    void min_pre_neighbor() override;
    void min_pre_force(int) override;
    void min_post_force(int) override;
    void pre_neighbor() override;
    void post_integrate() override;
    void post_force(int) override;

    void grow_arrays(int) override;
    void copy_arrays(int, int, int) override;
    void set_arrays(int) override;
    int pack_exchange(int, double *) override;
    int unpack_exchange(int, double *) override;
    void write_restart(FILE *) override;
    void restart(char *) override;

    holonomic_lammps::Dof dof(int) override;
    double compute_scalar() override;
    double compute_vector(int) override;
    double memory_usage() override;

private:
    using Vector = std::array<double, 3>;
    using Shifts = std::array<int, 3>;

    /** Molecules that are worked on together, few enough for the cache, and where their parts of lists begin and end.
     */
    struct Block {
        holonomic_lammps::Packed packed;
        int first_shifted, end_shifted;
        int first_away, end_away;
    };

    /** A slot whose atom another rank owns, and its place in the messages to the owners. */
    struct Away {
        int slot, order;
    };

    /** A slot whose atom is another image than the one that makes its molecule whole. */
    struct Shifted {
        int slot;
        Shifts images;
    };

    void read_options(int narg, char **arg, int first);
    void check_other_fixes();
    void find_molecules();
    void tell_displacement();
    void tell_adjustment();
    bool renew_molecules(const std::vector<int> &changed, bool other_atoms);
    holonomic_lammps::Registry register_molecules(const std::vector<int> &which);
    void take_memberships(const std::vector<int> &which);
    template <class Function>
    void guarded(Function function);  // turns exceptions into errors of LAMMPS

    // Plan and positions
    bool replan(bool fresh);
    void settle();
    void take_masses();
    void make_whole();
    void make_blocks();
    void collect_all_positions();
    bool constrain_positions(bool from_themselves, double time);
    void collect_positions(const Block &);
    void return_positions(const Block &, double inverse_time);
    void add_images(const Block &, int sign);

    // Velocities and forces
    void measure_rate();
    template <class Give>
    void constrain_velocities(bool half_kick, bool with_forces, Give give);
    void receive_velocities(double half, bool with_forces);
    void collect_velocities(const Block &, double half);
    template <class Give>
    void give_changes(const Block &, Give give);
    bool add_streaming(const Block &);
    template <class Add>
    void return_reactions(Add add);
    void exact_forces();
    double mass_of(int atom) const;
    bool reruns() const;
    bool minimises() const;

    // Divided molecules
    std::int64_t size_to_divide() const;
    void renew_divided(const std::vector<holonomic_lammps::Membership> &members,
                       const std::vector<holonomic_lammps::Tag> &tags, bool fresh);
    void take_divided_positions();
    bool constrain_divided_positions(bool from_themselves, double time);
    std::vector<double> divided_changes(double half);
    void divided_forces();
    std::vector<holonomic_lammps::Divided::Known> divided_bonds() const;
    void tally_divided_atoms();
    hol_worst divided_errors();

    // Outputs
    bool due(int every) const;
    void tally(int vflag);
    void tally_atoms();
    void tally_body(const holonomic_lammps::Resident &, double *parts) const;
    void keep_forces();
    void keep_tensions();
    hol_worst errors();

    holonomic_lammps::Selection selection_;
    int forces_every_ = 0;      // steps between constraint forces per atom; 0: none
    int tensions_every_ = 0;    // steps between tensions per bond
    std::int64_t divide_ = -1;  // molecules of at least as many atoms are divided; -1: as size_to_divide says
    int fixed_bit_ = 0;         // group whose atoms are held fixed

    std::vector<holonomic_lammps::Belonging> atoms_;  // by local atom
    holonomic_lammps::Registry registry_;
    std::unique_ptr<holonomic_lammps::Plan> plan_;
    bigint n_atoms_ = 0;           // of the whole system, when molecules were found
    std::vector<tagint> planned_;  // the atoms here, in their order, when it was made
    std::vector<Block> blocks_;

    // By slot, three numbers each; molecules are whole.
    std::vector<double> before_, now_, velocities_, forces_, reactions_;
    std::vector<double> masses_, inverse_masses_;  // by slot; 0: held fixed
    std::vector<double> tensions_;                 // by bond
    double virial_[9] = {0};
    std::vector<Shifted> shifted_;  // by slot
    std::vector<Away> away_;        // by slot
    std::vector<double> answers_;   // three numbers for each of those, in the order of the messages
    std::vector<double> whole_;     // of a block, shifted_'s positions
    std::vector<double> given_;     // of a block, its velocities as the atoms have them

    std::unique_ptr<holonomic_lammps::Divided> divided_;
    std::vector<double> divided_r_, divided_v_, divided_f_, divided_g_;  // of its atoms

    double rate_[6] = {0};       // d(box)/dt box^-1, xx yy zz yz xz xy, with which atoms move beside their velocities
    double step_rate_[6] = {0};  // its mean over the last step
    double last_box_[6] = {0};   // at the end of that step
    bool reruns_ = false;

    int max_rows_ = 0;            // of array_local
    double tolerance_ = 1e-3;     // by which part lengths that depend on each other may be adjusted
    double told_adjustment_ = 0;  // of those, the part that a warning has named
    double told_ = 0;  // of the bodies' displacements, the part of the shortest distance that a warning has named
};

}  // namespace LAMMPS_NS

#endif
