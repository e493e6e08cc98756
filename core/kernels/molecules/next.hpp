// What the next molecules are read from and written to, fetched array by array between the stages of those that are
// worked on. In a large call that is what a block waits for longest: the rows of a few molecules in three or four arrays are
// too short for a processor to notice that they are gone through, and not more than some twenty lines are under way at once.
#pragma once

#include "core/kernels/call.hpp"
#include "core/kernels/isa/lanes.hpp"

namespace holonomic::HOL_ISA::graph {

class NextMolecules {
public:
    NextMolecules() = default;
    // The arrays of a call, in the order in which they are needed, and the multipliers, which are last. Arrays that are
    // not packed, or not there, are left out.
    template <int n>
    explicit NextMolecules(const AtomArray *const (&arrays)[n], const double *lambda) : multipliers(lambda) {
        static_assert(n <= most, "");
        for (const AtomArray *array : arrays)
            if (array->x && array->packed) base[count++] = reinterpret_cast<const char *>(array->x);
    }

    // The next molecules are n in these lanes, of at most so many atoms each.
    void are(const MoleculeLane *lanes, int n, int64_t n_atoms) {
        lane = lanes;
        n_lanes = n;
        most_atoms = n_atoms;
        fetched = 0;
    }
    // Starts to fetch one array more. gcc 12 leaves out calls of functions that do nothing but fetch.
    __attribute__((noinline)) void fetch() {
        __asm__ volatile("");
        if (fetched >= count) return;
        const char *const x = base[fetched++];
        for (int l = 0; l < n_lanes; ++l) {
            if (fetched == count && multipliers) lines(multipliers + lane[l].first_bond, 8 * most_atoms);
            if (fetched == 1 && lane[l].w != lane[0].w) lines(lane[l].w, 8 * most_atoms);
            if (!lane[l].atoms) lines(x + row * lane[l].first_atom, row * most_atoms);
        }
    }
    void fetch_the_rest() {
        while (fetched < count) fetch();
    }

private:
    static constexpr int most = 4;
    static constexpr int64_t row = 3 * sizeof(double), line = 64;
    const char *base[most] = {};
    const double *multipliers = nullptr;
    int count = 0, fetched = most, n_lanes = 0;
    const MoleculeLane *lane = nullptr;
    int64_t most_atoms = 0;

    HOL_STATIC void lines(const void *first, int64_t bytes) {
        for (int64_t i = 0; i < bytes; i += line) __builtin_prefetch(static_cast<const char *>(first) + i, 0, 2);
    }
};

}  // namespace holonomic::HOL_ISA::graph
