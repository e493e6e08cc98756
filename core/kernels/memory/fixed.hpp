// Small molecules of one kind over consecutive atoms: the same arithmetic as for any block, with the number of bonds
// known to the compiler, so that everything stays in registers. What needs more than plain arithmetic, and the last
// molecules of a unit, behind which nothing may be read, are left to the general path.
#ifndef HOLONOMIC_KERNELS_MEMORY_FIXED_HPP
#define HOLONOMIC_KERNELS_MEMORY_FIXED_HPP

#include "core/kernels/arithmetic/image.hpp"
#include "core/kernels/arithmetic/vector3.hpp"
#include "core/kernels/memory/block.hpp"
#include "core/kernels/memory/listed.hpp"
#include "core/kernels/memory/sink.hpp"
#include "core/kernels/memory/terms.hpp"

namespace holonomic {
namespace HOL_ISA {

constexpr int largest_molecule = 5;        // over consecutive atoms, without a box
constexpr int largest_boxed_molecule = 3;  // in a box, or with lists of atoms

// Vectors of W molecules' atoms, rounded up to what is transposed at a time.
template <int N>
constexpr int vectors_of = (3 * (N + 1) + W - 1) / W *W;

// The atoms of W molecules: element 3 a + c is component c of atom a. Up to W - 1 doubles behind each are read.
template <int N>
HOL_INLINE void load_molecules(const double *p, vec *elements) {
    HOL_UNROLL
    for (int j = 0; j < vectors_of<N> / W; ++j) {
        HOL_UNROLL
        for (int i = 0; i < W; ++i) elements[j * W + i] = load(p + 3 * (N + 1) * i + j * W);
        transpose(elements + j * W);
    }
}

// Bonds D[k] from atoms; `boxed`: a box may be there.
template <int N, bool boxed>
HOL_INLINE void take_bonds(const Box &box, const vec *atoms, vec3 *D) {
    vec *const d = &D[0].x;
    HOL_UNROLL
    for (int c = 0; c < 3 * N; ++c) d[c] = atoms[c + 3] - atoms[c];
    if (!boxed || box.shape == Box::none) return;
    if (box.shape == Box::triclinic) {
        vec3 unused = {};
        HOL_UNROLL
        for (int k = 0; k < N; ++k) wrap<false>(box, D[k], unused);
        return;
    }
    HOL_UNROLL
    for (int c = 0; c < 3 * N; ++c)
        d[c] = mul_add(round(d[c] * box.per_side[c % 3]), splat(box.minus_side[c % 3]), d[c]);
}

// Bonds D[k] of W molecules and their right-hand sides t[k], rounded as load_chunk() does.
template <int N, int terms, bool uniform, bool boxed, class Place>
HOL_INLINE void load_molecules(const Block &block, const Box &box, const Place &place, const double *r, const double *v,
                               const double *f, vec3 *D, vec *t) {
    const bool wait = boxed && box.shape == Box::triclinic;  // as in load_chunk_with()
    vec e[vectors_of<N>], p[3 * N] = {}, *const d = &D[0].x;
    vec3 other[boxed ? N : 1];
    place.load(r, e);
    take_bonds<N, boxed>(box, e, D);
    if (terms == none_) return;
    if (terms & velocity_squared) {
        place.load(v, e);
        HOL_UNROLL
        for (int c = 0; c < 3 * N; ++c) {
            const vec dv = e[c + 3] - e[c];
            p[c] = square<terms>(block.mass, dv);
        }
    }
    if (terms & force_difference) {
        place.load(f, e);
        HOL_UNROLL
        for (int c = 0; c < 3 * N; ++c) {
            const vec df = uniform ? e[c + 3] - e[c] : block.w[c / 3 + 1] * e[c + 3] - block.w[c / 3] * e[c];
            if (wait)
                (&other->x)[c] = df;
            else
                p[c] = product<terms>(d[c], vec{}, df, p[c]);
        }
    }
    HOL_UNROLL
    for (int k = 0; k < N; ++k) {
        t[k] = (p[3 * k] + p[3 * k + 1]) + p[3 * k + 2];
        if (wait) t[k] = terms & velocity_squared ? dot(D[k], other[k]) + t[k] : dot(D[k], other[k]);
    }
}

// Writes the atoms of W molecules, elements as above, transposed in place.
template <int N, Update update>
HOL_INLINE void store_elements(vec *value, double *out) {
    constexpr int elements = 3 * (N + 1), full = elements / W, rest = elements % W;
    HOL_UNROLL
    for (int j = 0; j < full; ++j) transpose(value + j * W);
    for (int i = 0; i < W; ++i)  // in the order of the addresses: faster from memory
        for (int j = 0; j < full; ++j) {
            double *p = out + elements * i + j * W;
            store(p, update == add_ ? load(p) + value[j * W + i] : value[j * W + i]);
        }
    HOL_UNROLL
    for (int e = 0; e < rest; ++e)
        for (int i = 0; i < W; ++i) {
            double &p = out[elements * i + full * W + e];
            p = update == add_ ? p + value[full * W + e][i] : value[full * W + e][i];
        }
}

// Writes factor times a value per bond of W molecules; zeros as +0. Rows of W elements, the rest of which the next
// molecule's row overwrites, as long as they stay inside.
template <int N>
HOL_INLINE void store_multipliers(const vec *t, vec factor, double *out) {
    constexpr int whole = N < W ? N : W;
    vec row[W] = {};
    HOL_UNROLL
    for (int k = 0; k < whole; ++k) row[k] = mul_add(factor, t[k], vec{});
    if (N == 1) return store(out, row[0]);
    transpose(row);
    HOL_UNROLL
    for (int i = 0; i < W; ++i) {
        if (N * i + W <= N * W)
            store(out + N * i, row[i]);
        else
            for (int k = 0; k < whole; ++k) out[N * i + k] = row[i][k];
    }
    HOL_UNROLL
    for (int k = whole; k < N; ++k) {
        const vec value = mul_add(factor, t[k], vec{});
        for (int i = 0; i < W; ++i) out[N * i + k] = value[i];
    }
}

// Where W molecules of a regular unit stand, in the arrays of a call, from molecule `first` on: what all its places
// have.
template <int N>
struct InOrder {
    static constexpr bool loose = false;
    int64_t bond, chain;  // of the first one
    InOrder(const Unit &unit, int64_t first)
        : bond(unit.lanes[0].first_bond + N * first), chain(unit.lanes[0].chain + first) {}
    // How many of the molecules first .. end - 1 are a block; 0: no more of them.
    HOL_INLINE int64_t next(int64_t first, int64_t end) { return end - first >= W ? W : 0; }
    HOL_FORCED const Lane *lanes() const { return nullptr; }
    HOL_FORCED int64_t chain_of(int lane) const { return chain + lane; }
    HOL_FORCED void store_multipliers(const vec *t, vec factor, double *base) const {
        holonomic::HOL_ISA::store_multipliers<N>(t, factor, base + bond);
    }
};

// One behind the other, ..
template <int N>
struct InRow : InOrder<N> {
    static constexpr bool listed = false;
    int64_t at;  // the first one's first element
    InRow(const Unit &unit, int64_t first, int64_t)
        : InOrder<N>(unit, first), at(3 * (unit.lanes[0].first_atom + (N + 1) * first)) {}
    // The end of those from `first` on that may be done: W atoms behind them can be read.
    HOL_INLINE int64_t end(const Unit &unit, int64_t) { return unit.count - (W == 1 ? 0 : (W + N) / (N + 1)); }
    HOL_FORCED void load(const double *base, vec *elements) const { load_molecules<N>(base + at, elements); }
    template <Update update>
    HOL_FORCED void store(vec *value, double *base) const {
        store_elements<N, update>(value, base + at);
    }
    HOL_FORCED Packed first_atoms(const double *base) const {
        Packed p;
        for (int i = 0; i < W; ++i) p.lane[i] = const_cast<double *>(base) + at + 3 * (N + 1) * i;
        return p;
    }
    HOL_FORCED const int64_t *const *lists() const { return nullptr; }
    HOL_FORCED void fetch_next(const double *) const {}  // the processor does that
};

// Atoms anywhere: Where::element(i, k) is the first element of atom k of lane i.
template <int N, class Where>
struct ByNumber {
    static constexpr bool listed = true;
    HOL_FORCED vec3 gather(const double *base, int k) const {
        const double *p[W];
        HOL_UNROLL
        for (int i = 0; i < W; ++i) p[i] = base + static_cast<const Where *>(this)->element(i, k);
        vec3 a;
        read_rows(p, a);
        return a;
    }
    HOL_FORCED void load(const double *base, vec *elements) const {
        HOL_UNROLL
        for (int k = 0; k <= N; ++k) {
            const vec3 a = gather(base, k);
            elements[3 * k] = a.x;
            elements[3 * k + 1] = a.y;
            elements[3 * k + 2] = a.z;
        }
    }
    template <Update update>
    HOL_FORCED void store(const vec *value, double *base) const {
        HOL_UNROLL
        for (int k = 0; k <= N; ++k) {
            vec3 a = {value[3 * k], value[3 * k + 1], value[3 * k + 2]};
            if (update == add_) a = plus(gather(base, k), a);
            double *p[W];
            HOL_UNROLL
            for (int i = 0; i < W; ++i) p[i] = base + static_cast<const Where *>(this)->element(i, k);
            write_rows(p, a);
        }
    }
    HOL_FORCED Packed first_atoms(const double *base) const {
        Packed p;
        for (int i = 0; i < W; ++i)
            p.lane[i] = const_cast<double *>(base) + static_cast<const Where *>(this)->element(i, 0);
        return p;
    }
};

// .. or as their lists say.
template <int N>
struct ByList : InOrder<N>, ByNumber<N, ByList<N>> {
    AtomLists at;
    ByList(const Unit &unit, int64_t first, int64_t)
        : InOrder<N>(unit, first), at(unit.lanes[0].atoms + (N + 1) * first, N + 1) {}
    HOL_INLINE int64_t end(const Unit &unit, int64_t) { return unit.count; }
    HOL_FORCED int64_t element(int i, int k) const { return 3 * at.atoms[i][k]; }
    HOL_FORCED const int64_t *const *lists() const { return at.atoms; }
    HOL_FORCED void fetch_next(const double *base) const {
        for (int i = 0; base && i < W; ++i)
            for (int k = 0; k <= N; ++k) __builtin_prefetch(base + 3 * at.atoms[i][W * (N + 1) + k], 0, 2);
    }
};

// G of the atoms of W molecules.
template <int N, Update update, class Place>
HOL_INLINE void store_pulls(const vec3 *D, const vec *t, const Place &place, double *out) {
    vec value[vectors_of<N>];
    vec3 before = {};
    HOL_UNROLL
    for (int k = 0; k <= N; ++k) {
        const vec3 after = k < N ? times(t[k], D[k]) : vec3{}, g = minus(after, before);
        value[3 * k] = g.x;
        value[3 * k + 1] = g.y;
        value[3 * k + 2] = g.z;
        before = after;
    }
    place.template store<update>(value, out);
}

// Whether those behind them may be fetched, and are worth it.
template <class Place>
HOL_INLINE bool fetches_next(const Unit &unit, int64_t first) {
    return Place::listed && unit.large && unit.count - first >= 2 * W;
}

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
