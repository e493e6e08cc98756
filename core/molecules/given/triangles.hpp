// Triangles of bonds, wherever they are in a molecule.
#pragma once

#include <cstdint>

#include "core/molecules/given/lists.hpp"

namespace holonomic {

// Calls each(i, k, l, m) for every three atoms that are bonded to each other, the lowest of which is i: it has the
// bonds k and m to the ends of bond l. Stops where that returns true, and returns whether it did. end(k, 0) and
// end(k, 1) are the lower and the higher atom of bond k; bonds ascend by these. O(n_bonds) but at atoms of many bonds.
template <class End, class Each>
bool any_triangle(std::int32_t n_atoms, std::int32_t n_bonds, const End &end, const Each &each) {
    Numbers start(at(n_atoms) + 1, 0), marked(at(n_atoms), -1);  // bonds of each atom to higher ones
    for (std::int32_t k = 0; k < n_bonds; ++k) ++start[at(end(k, 0)) + 1];
    for (std::int32_t i = 0; i < n_atoms; ++i) start[at(i) + 1] += start[at(i)];
    for (std::int32_t i = 0; i < n_atoms; ++i) {
        const std::int32_t first = start[at(i)], last = start[at(i) + 1];
        if (last - first < 2) continue;
        for (std::int32_t k = first; k < last; ++k) marked[at(end(k, 1))] = k;
        for (std::int32_t k = first; k < last; ++k)
            for (std::int32_t l = start[at(end(k, 1))]; l < start[at(end(k, 1)) + 1]; ++l)
                if (const std::int32_t m = marked[at(end(l, 1))]; m >= first && each(i, k, l, m)) return true;
    }
    return false;
}

}  // namespace holonomic
