// What the next block of molecules is read from, beside the rows of its atoms, and its multipliers.
#pragma once

#include "core/kernels/memory/prefetch.hpp"

namespace holonomic::HOL_ISA::graph {

class NextMolecules : public NextRows {
public:
    NextMolecules() = default;
    template <int n>
    NextMolecules(const AtomArray *const (&arrays)[n], const double *lambda) : NextRows(arrays), multipliers(lambda) {}

    // The next molecules are n in these lanes, of at most so many atoms each.
    void are(const MoleculeLane *lane, int n, int64_t n_atoms) {
        begin(n_atoms);
        for (int l = 0; l < n; ++l)
            if (!lane[l].atoms) add(lane[l].first_atom);
        lanes = lane;
        n_lanes = n;
    }
    // Masses with the first array, multipliers with the last one.
    __attribute__((noinline)) void fetch() {
        __asm__ volatile("");
        if (fetched >= count) return;
        for (int l = 0; l < n_lanes; ++l) {
            if (fetched == 0 && lanes[l].w != lanes[0].w) lines(lanes[l].w, 8 * most_atoms);
            if (fetched == count - 1 && multipliers) lines(multipliers + lanes[l].first_bond, 8 * most_atoms);
        }
        NextRows::fetch();
    }
    void fetch_the_rest() {
        while (fetched < count) fetch();
    }

private:
    const double *multipliers = nullptr;
    const MoleculeLane *lanes = nullptr;
    int n_lanes = 0;
};

}  // namespace holonomic::HOL_ISA::graph
