// How fast the rows of a molecule change: what velocities do, and a box that changes.
#pragma once

#include "core/rigid/system.hpp"

namespace holonomic::rigid {

inline PairVector flow(const BoxRate *rate, const PairVector &d) {
    if (!rate) return {as_pair(0), as_pair(0), as_pair(0)};
    const double *const L = rate->L;
    return {L[0] * d.x + (L[1] * d.y + L[2] * d.z), L[3] * d.x + (L[4] * d.y + L[5] * d.z),
            L[6] * d.x + (L[7] * d.y + L[8] * d.z)};
}

// The relative velocity of a bond's ends.
inline PairVector bond_rate(const System &system, std::int32_t row, const PairVector *v, const BoxRate *rate,
                            const PairVector &d) {
    const MoleculeKind &s = system.kind();
    PairVector u = flow(rate, d);
    for (std::int32_t e = s.entry_start[static_cast<std::size_t>(row)];
         v && e < s.entry_start[static_cast<std::size_t>(row) + 1]; ++e) {
        const Entry &entry = s.entries[static_cast<std::size_t>(e)];
        u = u + entry.factor * v[entry.node];
    }
    return u;
}

// Calls each(row, bond, p, q, p', q') with the two vectors whose product the row is, and how they change; p is q's
// equal for bonds and for the squares of bodies. v: per node, or null: at rest.
template <class Each>
void for_rates(const System &system, const PairVector *v, const BoxRate *rate, const Each &each) {
    const MoleculeKind &s = system.kind();
    const PairVector none = {as_pair(0), as_pair(0), as_pair(0)};
    for (std::int32_t k = 0; k < s.n_rows; ++k) {
        const std::int32_t bond = s.bond_of_row[static_cast<std::size_t>(k)];
        if (s.is_distance(k)) {
            const PairVector d = system.distance(system.now, k), u = bond_rate(system, k, v, rate, d);
            each(k, bond, true, d, d, u, u);
            continue;
        }
        const Entry &entry = s.entries[static_cast<std::size_t>(s.entry_start[static_cast<std::size_t>(k)])];
        const PairVector &p = system.now.q[entry.node], &q = system.now.q[entry.other];
        each(k, bond, entry.node == entry.other, p, q, (v ? v[entry.node] : none) + flow(rate, p),
             (v ? v[entry.other] : none) + flow(rate, q));
    }
}

}  // namespace holonomic::rigid
