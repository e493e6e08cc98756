// Blocks of equally long chains with lists of atoms in packed arrays. Vectors are read and written where the list says;
// the arithmetic is that of chains over consecutive atoms. What needs more than the plain path is left to the general
// one, which copies such chains into staging buffers.
#ifndef HOLONOMIC_KERNELS_MEMORY_LISTED_HPP
#define HOLONOMIC_KERNELS_MEMORY_LISTED_HPP

#include "core/kernels/memory/atom_rows.hpp"
#include "core/kernels/memory/block.hpp"
#include "core/kernels/memory/sink.hpp"

namespace holonomic::HOL_ISA {

// The lists of the lanes.
struct AtomLists {
    const int64_t *atoms[W];
    explicit AtomLists(const Lane *lane) {
        for (int i = 0; i < W; ++i) atoms[i] = lane[i].atoms;
    }
    // Lists of so many atoms each, one behind the other.
    AtomLists(const int64_t *first, int64_t n_atoms) {
        for (int i = 0; i < W; ++i) atoms[i] = first + i * n_atoms;
    }
};

HOL_INLINE vec3 gather(const double *base, const AtomLists &at, long k) {
    const double *p[W];
    HOL_UNROLL
    for (int i = 0; i < W; ++i) p[i] = base + 3 * at.atoms[i][k];
    vec3 a;
    read_rows(p, a);
    return a;
}

template <Update update>
HOL_INLINE void scatter(double *base, const AtomLists &at, long k, vec3 a) {
    if (update == add_) {
        const vec3 b = gather(base, at, k);
        a = {b.x + a.x, b.y + a.y, b.z + a.z};
    }
    double *p[W];
    HOL_UNROLL
    for (int i = 0; i < W; ++i) p[i] = base + 3 * at.atoms[i][k];
    write_rows(p, a);
}

HOL_INLINE double *base_of(const AtomArray &array) { return reinterpret_cast<double *>(array.x); }

// Whether all lanes of a full block have lists.
HOL_INLINE bool listed(const Block &block, const Lane *lane) {
    if (block.lanes < W || block.n != block.n_min) return false;
    for (int i = 0; i < W; ++i)
        if (!lane[i].atoms) return false;
    return true;
}

}  // namespace holonomic::HOL_ISA
#endif
