// Atoms that stand anywhere in packed arrays: at.atom(base, i, k) is where atom k of lane i is. They are read and
// written one of each lane at a time; the arithmetic is that of rows.
#ifndef HOLONOMIC_KERNELS_MEMORY_LISTED_HPP
#define HOLONOMIC_KERNELS_MEMORY_LISTED_HPP

#include "core/kernels/memory/atom_rows.hpp"
#include "core/kernels/memory/block.hpp"
#include "core/kernels/memory/sink.hpp"

namespace holonomic::HOL_ISA {

// The lanes' lists of atoms.
struct AtomLists {
    const int64_t *atoms[W];
    explicit AtomLists(const Lane *lane) {
        for (int i = 0; i < W; ++i) atoms[i] = lane[i].atoms;
    }
    // Lists of n_atoms each, one behind the other.
    AtomLists(const int64_t *first, int64_t n_atoms) {
        for (int i = 0; i < W; ++i) atoms[i] = first + i * n_atoms;
    }
    HOL_FORCED const double *atom(const double *base, int i, long k) const { return base + 3 * atoms[i][k]; }
};

template <class Place>
HOL_INLINE vec3 gather(const double *base, const Place &at, long k) {
    const double *p[W];
    HOL_UNROLL
    for (int i = 0; i < W; ++i) p[i] = at.atom(base, i, k);
    vec3 a;
    read_rows(p, a);
    return a;
}

template <Update update, class Place>
HOL_INLINE void scatter(double *base, const Place &at, long k, vec3 a) {
    if (update == add_) a = gather(base, at, k) + a;
    double *p[W];
    HOL_UNROLL
    for (int i = 0; i < W; ++i) p[i] = const_cast<double *>(at.atom(base, i, k));
    write_rows(p, a);
}

HOL_INLINE double *base_of(const AtomArray &array) { return reinterpret_cast<double *>(array.x); }

// True if the block is full, its chains are equally long, and all have lists.
HOL_INLINE bool listed(const Block &block, const Lane *lane) {
    if (block.lanes < W || block.n != block.n_min) return false;
    for (int i = 0; i < W; ++i)
        if (!lane[i].atoms) return false;
    return true;
}

}  // namespace holonomic::HOL_ISA
#endif
