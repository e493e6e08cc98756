// Recognises strips of triangles.
#ifndef HOLONOMIC_STRIP_ORDER_HPP
#define HOLONOMIC_STRIP_ORDER_HPP

#include "core/molecules/lists.hpp"

namespace holonomic {

// The atoms of a strip of triangles in their order along it, at least four of them: each one is bonded to the next and
// to the one behind that, and there are no other bonds. Of its two ends the one with the smaller number comes first.
// Empty if the bonds atom_i[k], atom_j[k] are none; no pair twice.
Numbers order_of_strip(std::int32_t n_atoms, const Numbers &atom_i, const Numbers &atom_j);

// The place in the order of elimination of a bond between the atoms first < second of that order, which are neighbours
// or next to them: (0, 1), (0, 2), (1, 2), (1, 3), (2, 3) ..
inline std::int32_t place_in_strip(std::int32_t first, std::int32_t second) { return first + second - 1; }

}  // namespace holonomic
#endif
