// What each lane of a forest reads and writes by numbers of its own: atoms of the caller's arrays, and places of
// working arrays.
#ifndef HOLONOMIC_KERNELS_MOLECULES_FOREST_FOREST_LANES_HPP
#define HOLONOMIC_KERNELS_MOLECULES_FOREST_FOREST_LANES_HPP

#include "core/kernels/molecules/forest/forest.hpp"
#include "core/kernels/molecules/molecules.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

// One double of each lane.
HOL_INLINE vec numbers_at(const double *const *p, int64_t offset) {
#if HOL_LANES == 4
    return vec{p[0][offset], p[1][offset], p[2][offset], p[3][offset]};
#else
    vec a = {};
    for (int i = 0; i < W; ++i) a[i] = p[i][offset];
    return a;
#endif
}

// Working values of type Row = n vectors, at a place of its own in each lane.
template <class Row>
struct AtPlaces {
    double *p[W];
    HOL_FORCED AtPlaces(Row *first, const uint16_t *place) {
        HOL_UNROLL
        for (int i = 0; i < W; ++i) p[i] = reinterpret_cast<double *>(first + place[i]) + i;
    }
    // The vector that begins with byte `offset` of the row.
    HOL_FORCED vec get(size_t offset) const { return numbers_at(p, static_cast<int64_t>(offset / sizeof(double))); }
    HOL_FORCED vec3 get3(size_t offset) const {
        return {get(offset), get(offset + sizeof(vec)), get(offset + 2 * sizeof(vec))};
    }
    HOL_FORCED void put(size_t offset, const vec &a) const {
        HOL_UNROLL
        for (int i = 0; i < W; ++i) p[i][offset / sizeof(double)] = a[i];
    }
    HOL_FORCED void put3(size_t offset, const vec3 &a) const {
        put(offset, a.x);
        put(offset + sizeof(vec), a.y);
        put(offset + 2 * sizeof(vec), a.z);
    }
};

// The lanes of these bits.
HOL_INLINE mask lanes_of(unsigned bits) {
    mask bit = {};
    HOL_UNROLL
    for (int i = 0; i < W; ++i) bit[i] = 1LL << i;
    const mask set = (mask{} + static_cast<long long>(bits)) & bit;
#if HOL_LANES == 1
    return mask{set.element ? -1 : 0};
#else
    return set == bit;
#endif
}

// One atom of each lane in the caller's arrays: its number, or in packed arrays where its row begins.
template <bool packed>
struct ForestAtom {
    int64_t number[W];

    // atom[] has a local number for each lane.
    HOL_FORCED ForestAtom(const Atoms<vec> &at, const uint16_t *atom) {
        HOL_UNROLL
        for (int i = 0; i < W; ++i) number[i] = packed ? 3 * at.number(i, atom[i]) : at.number(i, atom[i]);
    }
    HOL_FORCED void rows_of(const AtomArray &array, double **p) const {
        HOL_UNROLL
        for (int i = 0; i < W; ++i) p[i] = reinterpret_cast<double *>(array.x) + number[i];
    }
    HOL_FORCED vec3 read(const AtomArray &array) const {
        vec3 a = {};
        if (packed) {
            double *p[W];
            rows_of(array, p);
            read_rows(p, a);
        } else {
            read_anywhere(array, number, a);
        }
        return a;
    }
    // Writes to the lanes of `which`.
    HOL_FORCED void write(const AtomArray &array, const vec3 &a, unsigned which) const {
        if (packed && __builtin_expect(which == all_lanes, 1)) {
            double *p[W];
            rows_of(array, p);
            return write_rows(p, a);
        }
        const double *const x = reinterpret_cast<const double *>(&a.x), *const y = x + W, *const z = y + W;
        for (unsigned left = which; left; left &= left - 1) {
            const int i = __builtin_ctz(left);
            if (packed) {
                double *const p = reinterpret_cast<double *>(array.x) + number[i];
                p[0] = x[i];
                p[1] = y[i];
                p[2] = z[i];
            } else {
                write_one(array, number[i], {x[i], y[i], z[i]});
            }
        }
    }

private:
    __attribute__((noinline)) static void read_anywhere(const AtomArray &array, const int64_t *number, vec3 &a) {
        for (int i = 0; i < W; ++i) {
            double one[3];
            read_row(array, number[i], one);
            a.x[i] = one[0];
            a.y[i] = one[1];
            a.z[i] = one[2];
        }
    }
};

// Inverse masses of an atom of each lane, in the trees' tables.
HOL_INLINE vec masses_of(const MoleculeLane *lane, const uint16_t *atom) {
    const double *p[W];
    HOL_UNROLL
    for (int i = 0; i < W; ++i) p[i] = lane[i].w + atom[i];
    return numbers_at(p, 0);
}

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
