// Molecules in units so far from ordinary ones that products of theirs overflow or underflow. Such a molecule is worked
// on by itself, in a copy: lengths and masses are divided by powers of two, and what is found is multiplied by them,
// which changes no digit. So powers of two of the units change no bit of a result.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/kernels/tally.hpp"
#include "core/molecules/given/ordinary.hpp"
#include "core/plan/elimination.hpp"
#include "core/run/lane.hpp"

namespace holonomic {

// A molecule as a kernel has it, of whatever shape.
struct KernelMolecule {
    std::int64_t n_atoms, n_bonds, first_atom;
    const std::int64_t *atoms;  // or nullptr, as in the lanes of call.hpp; likewise below
    const double *w, *length;
    double w_uniform, length_uniform;
    std::int64_t first_bond;
    const std::int64_t *bonds;
    const unsigned char *shared;
    const EliminationPlan *elimination;  // or nullptr: each bond joins an atom to the next
    std::int64_t number;

    explicit KernelMolecule(const Lane &lane);
    KernelMolecule(const EliminationPlan &elimination, const MoleculeLane &lane);
    std::int64_t bond(std::int64_t k) const { return bonds ? bonds[k] : first_bond + k; }
};

// The copy of one molecule: its arrays, masses and lengths.
class Rescaled {
public:
    // Takes memory of the calling thread. Throws std::bad_alloc.
    Rescaled(const KernelMolecule &molecule, const Powers &units);

    // Copies of the caller's arrays, over 2^e. Those that are only read; those that are read and written; and results.
    AtomArray inputs(const AtomArray &callers, int e);
    AtomArray moved(const AtomArray &callers, int e) { return add(callers, e, true); }
    AtomArray results(const AtomArray &callers, int e, bool are_added) { return add(callers, e, are_added); }
    const double *inputs(const double *callers, int e);
    const double *rates(const double *strain, int e);  // the six of VelocitiesCall
    double *results(double *callers, int e, bool are_read = false);

    // The lane of the copy, of a unit of its own.
    Lane lane_of(const Lane &lane) const;
    MoleculeLane lane_of(const MoleculeLane &lane) const;

    // Writes what kernels have written, times 2^e; false, with nothing written, if a number overflows.
    bool put_back() const;

    const Powers units;
    double log_det = 0, log_det_z = 0;  // of the metric: sums, which no power of two multiplies

private:
    struct CopiedAtoms {
        AtomArray callers, copy, before;  // before: as it was given to the kernel
        int e;
    };
    struct CopiedValues {
        double *callers, *copy, *before;
        int e;
    };
    AtomArray copy_of(const AtomArray &callers, int e, bool read);
    AtomArray add(const AtomArray &callers, int e, bool read);
    double *take(std::int64_t n);

    const KernelMolecule one_;
    char *memory_;
    double *w_ = nullptr, *length_ = nullptr;
    double strain_[6];
    CopiedAtoms atoms_[3];
    CopiedValues values_[2];
    int n_atoms_ = 0, n_values_ = 0;
};

// The units in which the longest bond and the lightest mass are about 1, from positions and their box, or from the
// lengths of the bonds. False if there are none: an infinity, or nothing but bonds of length zero.
bool find_units(const KernelMolecule &molecule, const AtomArray &r, const Box &box, Powers &units);
bool find_units(const KernelMolecule &molecule, Powers &units);

Box rescaled(const Box &box, int e);

// The calls of the verbs for a copy.
ForcesCall rescaled(const ForcesCall &call, Rescaled &copy);
VelocitiesCall rescaled(const VelocitiesCall &call, Rescaled &copy);
SolveCall rescaled(const SolveCall &call, Rescaled &copy);
PositionsCall rescaled(const PositionsCall &call, Rescaled &copy);
MetricCall rescaled(const MetricCall &call, Rescaled &copy);
bool find_units(const KernelMolecule &molecule, const ForcesCall &call, Powers &units);
bool find_units(const KernelMolecule &molecule, const VelocitiesCall &call, Powers &units);
bool find_units(const KernelMolecule &molecule, const SolveCall &call, Powers &units);
inline bool find_units(const KernelMolecule &m, const MetricCall &c, Powers &u) { return find_units(m, c.r, c.box, u); }
inline bool find_units(const KernelMolecule &m, const PositionsCall &, Powers &u) { return find_units(m, u); }

template <class Call>
void mark(Call &call) {
    call.rescaled = true;
}
inline void mark(MetricCall &) {}  // its extended ways take any units

// Whether it may be good in them if it was bad as it is: else what does not converge would be tried twice.
template <class Call>
bool may_help(const Call &, const Powers &) {
    return true;
}
inline bool may_help(const PositionsCall &, const Powers &units) { return !are_ordinary(units); }

// Writes the determinants of a copy, if the verb has any.
template <class Call>
void put_determinants(const Call &, const KernelMolecule &, const Rescaled &) {}
void put_determinants(const MetricCall &call, const KernelMolecule &molecule, const Rescaled &copy);

// Adds what a copy gives to the sums of its molecule.
void add_rescaled(const KernelMolecule &molecule, const Powers &units, Tally own, Tally &tally);

inline Unit unit_of(const Rescaled &copy, const Unit &one, Lane *lane) {
    *lane = copy.lane_of(one.lanes[0]);
    return {lane, 1, true, false};
}
inline MoleculeUnit unit_of(const Rescaled &copy, const MoleculeUnit &one, MoleculeLane *lane) {
    *lane = copy.lane_of(one.lanes[0]);
    return {one.elimination, lane, 1, true, false, nullptr, one.tree_batches, one.n_batches};
}
inline KernelMolecule one_of(const Unit &one) { return KernelMolecule(one.lanes[0]); }
inline KernelMolecule one_of(const MoleculeUnit &one) { return KernelMolecule(*one.elimination, one.lanes[0]); }

// Does a unit of one molecule in ordinary units: run(call, unit, tally) calls the kernel. Returns false, with nothing
// written, if that is bad, too.
template <class Call, class AnyUnit, class Run>
bool work_in_ordinary_units(const Call &call, const AnyUnit &unit, Tally &tally, const Run &run) {
    const KernelMolecule one = one_of(unit);
    Powers units;
    if (!find_units(one, call, units) || !may_help(call, units)) return false;
    Rescaled copy(one, units);
    Call of_copy = rescaled(call, copy);
    mark(of_copy);
    LaneOf<AnyUnit> lane;
    Tally own = empty_tally();
    run(of_copy, unit_of(copy, unit, &lane), own);
    if (own.n_bad > 0 || !copy.put_back()) return false;
    put_determinants(call, one, copy);
    add_rescaled(one, units, own, tally);
    return true;
}

}  // namespace holonomic
