// Lists of distances that depend on each other: three atoms on a line, four in a plane, five and more, each with all of
// the others, and rings that are held in a plane (flat_ring.hpp), are rigid bodies. Their lengths say what they look
// like, but for the mirror image, which a body follows anyway.
#pragma once

#include <cstdint>
#include <vector>

#include "core/molecules/find.hpp"

namespace holonomic::rigid {

// Places of n atoms by their squared distances [n][n], in the least dimension, up to three, above which no atom is
// higher than rounding makes it: in squares, relative to the largest. Returns the dimension.
int places_of(std::int64_t n, const double *squares, double rounding, std::vector<double> &places);

// Whether three atoms are on a line, or four in a plane, to the rounding of their lengths.
bool are_flat(std::int64_t n, const double *squares);

// Whether three or four atoms that can move, each bonded to all others, are on a line or in a plane, by their lengths,
// or a ring is held in a plane.
bool has_dependent_lengths(const holonomic::Shape &shape, const double *w, const double *lengths);

struct Cliques {
    std::vector<std::int64_t> sizes, atoms;  // of the bodies; atoms counted as the list counts them
    std::vector<double> places;              // [..][3]
    std::vector<std::int64_t> bonds;         // of the list, in molecules that have one of these bodies, ascending
};

// Bond k of the list has the length lengths[k % n_lengths]. Throws Error, naming a bond, where lengths of five atoms or
// more are those of no places in space.
Cliques find_cliques(const Masses &masses, const BondList &list, const double *lengths, std::int64_t n_lengths);

}  // namespace holonomic::rigid
