// Reads a block into scratch: bond vectors and right-hand sides of some bonds of all lanes at a time. All eliminations
// begin with this, so that none of them depends on boxes, layouts, or on what right-hand sides are made of.
#pragma once

#include "core/kernels/arithmetic/exact.hpp"
#include "core/kernels/memory/atom_rows.hpp"
#include "core/kernels/memory/block.hpp"
#include "core/kernels/memory/packed.hpp"

namespace holonomic::HOL_ISA {

// So many bonds of each lane are read before they are worked on: they are in the first cache then, and what a sweep
// carries from bond to bond leaves its registers only between two such stages.
constexpr long stage_bonds = 32;

// Rows of lanes, by distances from the first lane.
struct RowsOfLanes {
    const double *first;
    long lane[W];
    explicit RowsOfLanes(const Packed &rows) : first(rows.lane[0]) {
        for (int i = 0; i < W; ++i) lane[i] = rows.lane[i] - first;
    }
};

// Differences out[W] of a vector per atom, x_{k+1} - x_k from atom k0 on, and what rounding leaves off them: numbers
// are subtracted as they stand in memory. weigh: vectors times the inverse masses w3, as Block has them.
template <bool extended, bool weigh = false>
HOL_INLINE void subtract_chunk(const RowsOfLanes &at, long k0, vec3 *out, vec3 *low,
                               const double *const *w3 = nullptr) {
    HOL_UNROLL
    for (int j = 0; j < 3; ++j) {
        vec e[W], l[W];
        HOL_UNROLL
        for (int i = 0; i < W; ++i) {
            const double *const x = at.first + 3 * k0 + W * j + at.lane[i];
            e[i] = load(x + 3) - load(x);
            if (weigh) {
                const double *const w = w3[i] + 3 * k0 + W * j;
                e[i] = load(w + 3) * load(x + 3) - load(w) * load(x);
            }
            if (extended) l[i] = two_difference<vec>(load(x + 3), load(x)).lo;
        }
        transpose(e);
        if (extended) transpose(l);
        HOL_UNROLL
        for (int i = 0; i < W; ++i) (&out->x)[j * W + i] = e[i];
        for (int i = 0; extended && i < W; ++i) (&low->x)[j * W + i] = l[i];
    }
}

// Where a block is read from, and what. It refers to its arguments.
struct Reader {
    const Block &block;
    const Box &box;
    const int terms;
    const bool extended = false;
    long ahead;                                                                        // as block.ahead
    const double *strain = nullptr;                                                    // added to rates
    const Packed *r = nullptr, *v = nullptr, *f = nullptr;                             // rows,
    const AtomLists *const lists = nullptr;                                            // or lists of atoms
    const double *const of_r = nullptr, *const of_v = nullptr, *const of_f = nullptr;  // in these arrays
    typedef void LoadChunks(const Reader &, long k0, long end, vec3 *D, vec *B);
    LoadChunks *const load_chunks = nullptr;

    // From rows. `terms`: of right-hand sides; w in the lane's unit. extended: the low words of differences, too.
    Reader(const Block &, const Box &, int terms, const Packed &r, const Packed &v, const Packed &f,
           bool extended = false);
    // From lists of atoms in packed arrays, of lanes that are equally long, where there are forces, or for kept rates.
    Reader(const Block &, const Box &, int terms, const AtomLists &, const AtomArray &r, const AtomArray &v,
           const AtomArray &f);

    // Bond vectors D[k - from] = r_{k+1} - r_k and right-hand sides B[k - from] of the bonds from .. end - 1, where
    // `from` is a multiple of W; of kept rates also the velocities[k] of the atoms from .. end. Bonds past the end of a
    // lane are inert: D = (1,0,0), B = 0. What is not asked for may be nullptr.
    HOL_FORCED inline void load(long from, long end, vec3 *D, vec3 *low, vec *B, vec3 *velocities = nullptr) const {
        if (load_chunks && !velocities && !strain && end <= block.n_min && (end - from) % W == 0)
            load_chunks(*this, from, end, D, B);
        else
            load_any(from, end, D, low, B, velocities);
    }
    HOL_FORCED inline Source source() const {
        if (lists) return {&box, nullptr, of_r, lists->atoms};
        return {&box, r};
    }

private:
    void load_any(long from, long end, vec3 *D, vec3 *low, vec *B, vec3 *velocities) const;
};

// Reader::load() of lists.
void load_listed(const Reader &, long from, long end, vec3 *D, vec *B, vec3 *velocities);

// The bond vectors of all bonds.
void load_bond_vectors(const Block &, const Box &, const Packed &r, vec3 *D);

}  // namespace holonomic::HOL_ISA
