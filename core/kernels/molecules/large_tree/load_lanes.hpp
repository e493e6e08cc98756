// Reads the trees of one large molecule, W atoms of it and their parents at a time: what load.hpp does, with the same
// digits. Parents are read again from the caller's arrays, so that no atom waits for another.
#pragma once

#include "core/kernels/molecules/load.hpp"

namespace holonomic::HOL_ISA::graph {

// Atoms of one molecule, one in each lane.
template <bool packed>
struct AtomsInLanes {
    int64_t number[W];  // in the caller's arrays; of rows of three doubles, where they begin
    HOL_FORCED AtomsInLanes(const Molecules<double> &x, const int32_t *slot) {
        HOL_UNROLL
        for (int i = 0; i < W; ++i) {
            const int32_t atom = x.s.atom_of[slot[i]];
            number[i] = (packed ? 3 : 1) * x.at.number(0, atom);
        }
    }
    HOL_FORCED vec3 read(const AtomArray &array) const {
        vec3 a = {};
        if (!packed) {
            for (int i = 0; i < W; ++i) {
                double one[3];
                read_row(array, number[i], one);
                a.x[i] = one[0];
                a.y[i] = one[1];
                a.z[i] = one[2];
            }
            return a;
        }
        const double *p[W];
        HOL_UNROLL
        for (int i = 0; i < W; ++i) p[i] = reinterpret_cast<const double *>(array.x) + number[i];
        read_rows(p, a);
        return a;
    }
};

// Vectors of W slots.
HOL_INLINE void put_vectors(Vector3<double> *to, const int32_t *slot, const vec3 &a) {
    double *p[W];
    HOL_UNROLL
    for (int i = 0; i < W; ++i) p[i] = &to[slot[i]].x;
    write_rows(p, a);
}
// Four doubles to each of W places.
HOL_INLINE void write_four(double *const *p, const vec *e) {
#if HOL_LANES == 4 && defined(__AVX2__)
    vec m[4] = {e[0], e[1], e[2], e[3]};
    transpose(m);
    HOL_UNROLL
    for (int i = 0; i < 4; ++i) _mm256_storeu_pd(p[i], m[i]);
#else
    for (int i = 0; i < W; ++i)
        for (int c = 0; c < 4; ++c) p[i][c] = e[c][i];
#endif
}

// The bonds of W slots.
HOL_INLINE void put_rows(BondRow<double> *to, const int32_t *slot, const BondRow<vec> &row) {
    static_assert(sizeof(BondRow<double>) == 8 * sizeof(double), "");
    HOL_UNROLL
    for (int half = 0; half < 2; ++half) {
        double *p[W];
        HOL_UNROLL
        for (int i = 0; i < W; ++i) p[i] = half == 0 ? &to[slot[i]].d.x : &to[slot[i]].E;
        write_four(p, half == 0 ? &row.d.x : &row.E);
    }
}

// Inverse masses of W slots, as the caller has them.
HOL_INLINE vec mass_of(const Molecules<double> &x, const int32_t *slot) {
    vec w;
    HOL_UNROLL
    for (int i = 0; i < W; ++i) w[i] = x.lane[0].w[x.s.atom_of[slot[i]]];
    return w;
}

// The masses and bonds of W slots of trees.
template <bool packed>
HOL_INLINE void load_lanes(Linear<double> &z, int terms, const int32_t *slot, bool keep_all) {
    const Molecules<double> &x = z.x;
    int32_t above[W];
    HOL_UNROLL
    for (int i = 0; i < W; ++i) above[i] = x.s.parent[slot[i]];
    const AtomsInLanes<packed> child(x, slot), parent(x, above);
    const vec3 r = child.read(*x.r);
    const vec w = mass_of(x, slot);
    HOL_UNROLL
    for (int i = 0; i < W; ++i) x.w[slot[i]] = w[i];
    BondRow<vec> row = {};
    vec3 unused = {};
    row.d = r - parent.read(*x.r);
    take_image<false>(*x.box, row.d, unused);
    if (keep_all) put_vectors(z.equations.r, slot, r);
    if (terms & (squares | rates)) {
        const vec3 v = child.read(*x.in.v), dv = v - parent.read(*x.in.v);
        if (keep_all) put_vectors(z.equations.velocity, slot, v);
        row.t = terms & rates ? dot(row.d, dv) : dot(dv, dv);
        if ((terms & rates) && x.in.strain) row.t = row.t + stretching(x.in.strain, row.d);
    }
    if (terms & pulls) {
        const vec3 f = child.read(*x.in.f), f0 = parent.read(*x.in.f);
        if (keep_all) put_vectors(z.equations.force, slot, f);
        const vec w0 = mass_of(x, above);
        const vec3 df = {mul_add(w, f.x, -(w0 * f0.x)), mul_add(w, f.y, -(w0 * f0.y)), mul_add(w, f.z, -(w0 * f0.z))};
        row.t = mul_add(row.d.z, df.z, mul_add(row.d.y, df.y, mul_add(row.d.x, df.x, row.t)));
    }
    if (terms & given)
        for (int i = 0; i < W; ++i) row.t[i] = Loader<double>{z, terms}.given_value(slot[i]);
    row.q = dot(row.d, row.d);
    row.E = w * row.q;  // of a leaf
    put_rows(x.row, slot, row);
}

// Starts to fetch the rows of an atom, of all arrays that are read.
HOL_INLINE void fetch_rows(const Linear<double> &z, int terms, int32_t slot) {
    const Molecules<double> &x = z.x;
    const int32_t atom = x.s.atom_of[slot];
    const int64_t row = 3 * x.at.number(0, atom);
    __builtin_prefetch(x.lane[0].w + atom, 0, 2);
    fetch_row(*x.r, row);
    if (terms & (squares | rates)) fetch_row(*x.in.v, row);
    if (terms & pulls) fetch_row(*x.in.f, row);
}

template <bool packed>
HOL_NOINLINE void load_slots_of(Linear<double> &z, int terms, int32_t first, int32_t end, bool keep_all) {
    for (int32_t s = first; s < end; s += W) {
        int32_t slot[W];
        for (int32_t i = s + rows_ahead; packed && i < s + rows_ahead + W && i < end; ++i) fetch_rows(z, terms, i);
        HOL_UNROLL
        for (int i = 0; i < W; ++i) slot[i] = s + i < end ? s + i : end - 1;
        load_lanes<packed>(z, terms, slot, keep_all);
    }
}

HOL_INLINE void load_slots(Linear<double> &z, int terms, int32_t first, int32_t end, bool keep_all) {
    choose([&](auto packed) { load_slots_of<packed>(z, terms, first, end, keep_all); }, z.x.at.layout != elements);
}

}  // namespace holonomic::HOL_ISA::graph
