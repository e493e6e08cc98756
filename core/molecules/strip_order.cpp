#include "core/molecules/strip_order.hpp"

#include <cstddef>

namespace holonomic {

namespace {

// The neighbours of each atom, at most four; none at all if an atom has more.
struct Neighbours {
    std::vector<int> count;
    Numbers of;  // [n_atoms][4]
    bool few = true;

    Neighbours(std::int32_t n_atoms, const Numbers &atom_i, const Numbers &atom_j)
        : count(at(n_atoms), 0), of(4 * at(n_atoms)) {
        for (std::size_t k = 0; k < atom_i.size() && few; ++k) {
            add(atom_i[k], atom_j[k]);
            add(atom_j[k], atom_i[k]);
        }
    }
    void add(std::int32_t i, std::int32_t j) {
        int &n = count[at(i)];
        few = few && n < 4;
        if (few) of[4 * at(i) + static_cast<std::size_t>(n++)] = j;
    }
    // The smallest neighbour of atom i that has no place yet, of those with the fewest bonds; -1: none.
    std::int32_t next_of(std::int32_t i, const Numbers &place) const {
        std::int32_t next = -1;
        for (std::size_t e = 0; e < static_cast<std::size_t>(count[at(i)]); ++e) {
            const std::int32_t j = of[4 * at(i) + e];
            if (place[at(j)] >= 0) continue;
            const int more = next < 0 ? -1 : count[at(j)] - count[at(next)];
            if (more < 0 || (more == 0 && j < next)) next = j;
        }
        return next;
    }
};

}  // namespace

Numbers order_of_strip(std::int32_t n_atoms, const Numbers &atom_i, const Numbers &atom_j) {
    if (n_atoms < 4 || atom_i.size() != 2 * at(n_atoms) - 3) return {};
    const Neighbours neighbours(n_atoms, atom_i, atom_j);
    Numbers order, place(at(n_atoms), -1);
    if (!neighbours.few) return {};
    // After an end comes its neighbour with fewer bonds, and then always the one that the atom before the last one has
    // left.
    std::int32_t next = 0;
    while (next < n_atoms && neighbours.count[at(next)] != 2) ++next;
    if (next == n_atoms) return {};
    while (next >= 0) {
        place[at(next)] = static_cast<std::int32_t>(order.size());
        order.push_back(next);
        next = neighbours.next_of(order[order.size() < 2 ? 0 : order.size() - 2], place);
    }
    if (order.size() != at(n_atoms)) return {};
    for (std::size_t k = 0; k < atom_i.size(); ++k) {
        const std::int32_t distance = place[at(atom_i[k])] - place[at(atom_j[k])];
        if (distance < -2 || distance > 2) return {};
    }
    return order;
}

}  // namespace holonomic
