// How long a list would be.
#include <algorithm>

#include "core/molecules/flat_list.hpp"

namespace holonomic {

// A list has so many updates, or so many for each bond.
constexpr std::int64_t short_list = 65536, updates_of_bond = 16;

bool takes_flat_list(const Schedule &s) {
    if (s.type != Schedule::graph && (s.type != Schedule::tree || s.n_bonds <= largest_in_lanes)) return false;
    Numbers bonds(at(s.n_atoms));
    for (std::int32_t k = 0; k < s.n_bonds; ++k)
        for (const std::int32_t i : {s.atom_i[k], s.atom_j[k]}) ++bonds[at(i)];
    std::int64_t updates = 0;
    for (const std::int64_t n : bonds) {
        if (n > 3000) return false;  // more than the most of the largest list
        updates += n * (n - 1) / 2 * (n - 2) / 3;
    }
    return s.n_bonds <= largest_in_list &&
           updates <= std::max(short_list, updates_of_bond * static_cast<std::int64_t>(s.n_bonds));
}

}  // namespace holonomic
