// What each lane of a batch of trees reads and writes by numbers of its own: atoms of the caller's arrays, and rows
// of working arrays.
#pragma once

#include <cstddef>

#include "core/kernels/molecules/molecules.hpp"
#include "core/plan/tree_batch.hpp"

namespace holonomic::HOL_ISA::graph {

inline Vector3<double> one_of(const vec3 &a, int i) { return {a.x[i], a.y[i], a.z[i]}; }

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

// Where an element (core/plan/tree_batch.hpp) of working values of type Row = n vectors begins.
template <class Row>
HOL_INLINE double *element_of(Row *first, int32_t element) {
    constexpr int64_t n = sizeof(Row) / sizeof(vec);
    return reinterpret_cast<double *>(first) + (element + (n - 1) * (element & ~(W - 1)));
}

// Working values at an element of its own in each lane.
template <class Row>
struct AtRows {
    double *p[W];
    HOL_FORCED AtRows(Row *first, const int32_t *element) {
        HOL_UNROLL
        for (int i = 0; i < W; ++i) p[i] = element_of(first, element[i]);
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
struct BatchAtom {
    int64_t number[W];

    // atom[] has a local number for each lane.
    HOL_FORCED BatchAtom(const Atoms<vec> &at, const int32_t *atom) {
        constexpr int64_t step = packed ? 3 : 1;
        if (at.layout == rows_in_order) {
            HOL_UNROLL
            for (int i = 0; i < W; ++i) number[i] = step * (at.first[i] + atom[i]);
        } else if (packed) {  // all lanes have lists
            HOL_UNROLL
            for (int i = 0; i < W; ++i) number[i] = step * at.list[i][atom[i]];
        } else {
            HOL_UNROLL
            for (int i = 0; i < W; ++i) number[i] = step * at.number(i, atom[i]);
        }
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
    template <class T>
    HOL_STATIC vec component_of(const char *p, int64_t stride, const int64_t *number) {
        vec a = {};
        if (!p) return a;
#if HOL_LANES == 4
        return vec{element<T>(p + number[0] * stride), element<T>(p + number[1] * stride),
                   element<T>(p + number[2] * stride), element<T>(p + number[3] * stride)};
#else
        for (int i = 0; i < W; ++i) a[i] = element<T>(p + number[i] * stride);
        return a;
#endif
    }
    template <class T>
    HOL_STATIC vec3 read_as(const AtomArray &array, const int64_t *number) {
        const int64_t stride = array.stride;
        return {component_of<T>(array.x, stride, number), component_of<T>(array.y, stride, number),
                component_of<T>(array.z, stride, number)};
    }
    __attribute__((noinline)) static void read_anywhere(const AtomArray &array, const int64_t *number, vec3 &a) {
        a = holds_floats(array) ? read_as<float>(array, number) : read_as<double>(array, number);
    }
};

// Inverse masses of an atom of each lane, in the trees' tables.
HOL_INLINE vec masses_of(const MoleculeLane *lane, const int32_t *atom) {
    const double *p[W];
    HOL_UNROLL
    for (int i = 0; i < W; ++i) p[i] = lane[i].w + atom[i];
    return numbers_at(p, 0);
}

// Trees of fewer tiles stand in a cache.
constexpr int32_t pieces_of_cache = 16;

// The trees of a batch of trees, step by step.
struct BatchTrees {
    const TreeBatch &f;
    const MoleculeLane *lane;  // of all lanes; those without a tree repeat the first one
    const Atoms<vec> at;

    BatchTrees(const TreeBatch &batch, const MoleculeLane *lanes, bool packed)
        : f(batch), lane(lanes), at(lanes, batch.n_trees, packed) {}

    const int32_t *atom_of(int32_t step) const { return f.atom + static_cast<int64_t>(step) * W; }
    const int32_t *above_of(int32_t step) const { return f.above + static_cast<int64_t>(step) * W; }
    const int32_t *lower_of(int32_t p) const { return f.lower + static_cast<int64_t>(p) * W; }
    // Starts to fetch what atoms some numbers further on are read from, numbers[i ..] of n times as many as there are
    // lanes, where they don't stand in a cache.
    template <bool packed, bool masses, class... Arrays>
    HOL_FORCED void fetch(const int32_t *numbers, int32_t i, int32_t n, const Arrays &...arrays) const {
        constexpr int32_t ahead = rows_ahead / W;
        if (!packed || f.n_tiles < pieces_of_cache || i + ahead >= n) return;
        const int32_t *const number = numbers + static_cast<int64_t>(i + ahead) * W;
        const BatchAtom<true> atom(at, number);
        HOL_UNROLL
        for (int l = 0; l < W; ++l) {
            if (masses) __builtin_prefetch(lane[0].w + number[l], 0, 2);
            (fetch_row(arrays, atom.number[l]), ...);
        }
    }
    // Where the value of a bond stands in the caller's arrays.
    int64_t bond_of(int i, int32_t p) const { return lane[i].first_bond + f.bond[static_cast<int64_t>(p) * W + i]; }

    // Writes the bonds' values of a row, in some lanes.
    HOL_FORCED void write_values(int32_t p, unsigned lanes, const vec &a, double *out) const {
        if (__builtin_expect(lanes == all_lanes, 1)) {
            HOL_UNROLL
            for (int i = 0; i < W; ++i) out[bond_of(i, p)] = a[i];
            return;
        }
        for (int i = 0; i < W; ++i)
            if (lanes >> i & 1) out[bond_of(i, p)] = a[i];
    }

    // Steps, and their rows; `root`: the last of them is that of the roots.
    struct Range {
        int32_t step, end_step, row, end_row;
        bool root;
        int32_t inner_end() const { return root ? end_step - 1 : end_step; }
    };
    Range all() const { return {0, f.n_steps, 0, f.n_bond_rows, true}; }
    int32_t row_of(int32_t step) const { return step < f.n_steps ? f.step[step].first : f.n_bond_rows; }
    // Of one large tree; tile n_tiles is the top.
    Range tile(int32_t p) const {
        const int32_t step = f.tile_start[p], end = f.tile_start[p + 1];
        return {step, end, row_of(step), row_of(end), p == f.n_tiles};
    }

    // Calls body(p, bits of the lanes of `which` that hold a bond there).
    template <class Body>
    HOL_FORCED void for_held(const Range &range, unsigned which, const Body &body) const {
        for (int32_t p = range.row; p < range.end_row; ++p)
            if (const unsigned held = f.held[p] & which) body(p, held);
    }
    // Calls write(p, atom, lanes) for the atoms of these arrays in the lanes of which & ~but(p).
    template <class But, class Write, class... Arrays>
    HOL_FORCED void for_atoms(const Range &range, unsigned which, const But &but, const Write &write,
                              const Arrays &...arrays) const {
        choose(
            [&](auto packed) HOL_FORCED {
                for_held(range, which, [&](int32_t p, unsigned lanes) HOL_FORCED {
                    fetch<packed, false>(f.lower, p, f.n_bond_rows, arrays...);
                    write(p, BatchAtom<packed>(at, lower_of(p)), lanes & ~but(p));
                });
                if (!range.root) return;
                write(f.n_bond_rows, BatchAtom<packed>(at, atom_of(f.n_steps - 1)),
                      which & bits(first_lanes(f.n_trees)) & ~but(f.n_bond_rows));
            },
            at.layout != elements);
    }
    // Writes value(p, atom) of the atoms' vectors.
    template <class Value>
    HOL_FORCED void write_atoms(const Range &range, const AtomArray &array, unsigned which, const Value &value) const {
        for_atoms(
            range, which, [](int32_t) HOL_FORCED { return 0u; },
            [&](int32_t p, const auto &atom, unsigned lanes) HOL_FORCED { atom.write(array, value(p, atom), lanes); },
            array);
    }
};

}  // namespace holonomic::HOL_ISA::graph
