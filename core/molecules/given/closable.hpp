// Lengths with which the cycles of a molecule can't close, whatever the positions.
#pragma once

#include <cstdint>

#include "core/error.hpp"
#include "core/molecules/given/labels.hpp"
#include "core/molecules/given/shape.hpp"

namespace holonomic {

// A bond that is longer than the others of its cycle together.
struct Unclosable {
    std::int32_t bond;    // its number within the molecule
    std::int32_t corner;  // the third atom of a triangle; -1: the cycle is a ring
    double length, others;
};

// Looks at triangles, anywhere in a molecule, and at rings: where lengths are mistaken for angles, or given in another
// order. O(n_bonds) but at atoms of many bonds.
bool find_unclosable(const Shape &shape, const double *length, Unclosable *found);

// `atoms` are the names of the bond's two atoms and of the corner; `bond` is its number as the caller counts.
Error unclosable_error(const Unclosable &found, const Name *atoms, std::int64_t bond, int base);

}  // namespace holonomic
