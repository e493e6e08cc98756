// Lists of distances that depend on each other: three atoms on a line, four in a plane, five and more, each with all of
// the others, and rings that are held in a plane (planar_ring.hpp), are rigid bodies, with all atoms that are held to
// them by more distances than they need for a position. Their lengths say what they look
// like, but for the mirror image, which a body follows anyway.
#pragma once

#include <cstdint>
#include <vector>

#include "core/molecules/given/find.hpp"
#include "core/rigid/linear_groups.hpp"

namespace holonomic::rigid {

// Whether three or four atoms that can move, each bonded to all others, are on a line or in a plane, by their lengths,
// or a ring is held in a plane. tolerance: by what part of them lengths may be adjusted (fit.hpp).
bool has_dependent_lengths(const holonomic::Shape &shape, const double *w, const double *lengths, double tolerance);

struct Cliques {
    std::vector<std::int64_t> sizes, atoms;  // of the bodies; atoms counted as the list counts them
    std::vector<double> coordinates;         // [..][3]
    std::vector<std::int64_t> bonds;         // of the list, in molecules that have one of these bodies, ascending
    std::vector<std::int64_t> shared;        // of the list, in groups that depend and share atoms with bodies
    LinearGroups linear;                     // on a line or in a plane, which share atoms, and bonds of length zero
    std::vector<std::int64_t> linear_bonds;  // of those above, in molecules with such groups, ascending
    double adjusted = 0;                     // by which part of it a body changes a length, at most
    std::int64_t adjusted_bond = -1;         // of the list
};

// Bond k of the list has the length lengths[k % n_lengths]. Throws Error, naming a bond and the atoms, where lengths
// are those of no position in space by more than the tolerance. left_out: of each bond, or empty: one that others
// imply, and that is compared with them alone (implied.hpp). With it, groups that share atoms are linear ones.
Cliques find_cliques(const Masses &masses, const BondList &list, const double *lengths, std::int64_t n_lengths,
                     double tolerance, const std::vector<unsigned char> &left_out = {});

}  // namespace holonomic::rigid
