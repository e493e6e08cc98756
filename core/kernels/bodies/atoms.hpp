// The atoms of W rigid bodies of a kind, each body in a lane of its own: reading and writing them, atom by atom.
#ifndef HOLONOMIC_KERNELS_BODIES_ATOMS_HPP
#define HOLONOMIC_KERNELS_BODIES_ATOMS_HPP

#include "core/kernels/arithmetic/image.hpp"
#include "core/kernels/atom.hpp"
#include "core/kernels/bodies/frame.hpp"

namespace holonomic::HOL_ISA {

struct BodyBlock {
    const BodyKind &kind;
    const int64_t *atoms[W];  // lanes without a body repeat the first one
    int count;
    bool consecutive;  // the atoms of each stand one behind the other

    HOL_FORCED bool in_a_row(const AtomArray &array) const { return array.packed && consecutive; }
    HOL_FORCED double *row(const AtomArray &array, int lane) const {
        return reinterpret_cast<double *>(array.x) + 3 * atoms[lane][0];
    }

    // The rows [3 n_atoms] of all lanes in an array; of other layouts a copy.
    HOL_FORCED void rows(const AtomArray &array, double *copy, const double **to) const {
        if (__builtin_expect(!in_a_row(array), 0)) return copy_rows(array, copy, to);
        HOL_UNROLL
        for (int l = 0; l < W; ++l) to[l] = row(array, l);
    }

    // Writes x [n_atoms] of some lanes in any layout.
    __attribute__((noinline)) void write_some(const AtomArray &array, const vec3 *x, unsigned lanes) const {
        for (int l = 0; l < W; ++l)
            for (long a = 0; a < kind.n_atoms && (lanes >> l & 1); ++a) {
                const double one[3] = {x[a].x[l], x[a].y[l], x[a].z[l]};
                write_atom(array, atoms[l][a], one);
            }
    }
    // Adds factor x, in the same way.
    __attribute__((noinline)) void add_some(const AtomArray &array, double factor, const vec3 *x,
                                            unsigned lanes) const {
        for (int l = 0; l < W; ++l)
            for (long a = 0; a < kind.n_atoms && (lanes >> l & 1); ++a) {
                double one[3];
                read_atom(array, atoms[l][a], one);
                one[0] = mul_add(factor, x[a].x[l], one[0]);
                one[1] = mul_add(factor, x[a].y[l], one[1]);
                one[2] = mul_add(factor, x[a].z[l], one[2]);
                write_atom(array, atoms[l][a], one);
            }
    }

private:
    __attribute__((noinline)) void copy_rows(const AtomArray &array, double *copy, const double **to) const {
        for (int l = 0; l < W; ++l) {
            to[l] = copy;
            for (long a = 0; a < kind.n_atoms; ++a, copy += 3) read_atom(array, atoms[l][a], copy);
        }
    }
};

// Atom a of all lanes. Four numbers of each are read at once, the first of which is the one before.
HOL_INLINE vec3 atom_of_rows(const double *const *rows, long a) {
#if HOL_LANES == 4 && defined(__AVX2__)
    vec m[4];
    if (__builtin_expect(a > 0, 1)) {
        HOL_UNROLL
        for (int l = 0; l < 4; ++l) m[l] = load(rows[l] + 3 * a - 1);
    } else {
        HOL_UNROLL
        for (int l = 0; l < 4; ++l) m[l] = _mm256_permute4x64_pd(load(rows[l]), 0x90);
    }
    transpose(m);
    return {m[1], m[2], m[3]};
#else
    vec3 x;
    for (int l = 0; l < W; ++l) {
        x.x[l] = rows[l][3 * a];
        x.y[l] = rows[l][3 * a + 1];
        x.z[l] = rows[l][3 * a + 2];
    }
    return x;
#endif
}

// Writes get(a) for all atoms, in rows of an array.
template <class Get>
HOL_INLINE void write_rows(const BodyKind &kind, double *const *rows, const Get &get) {
#if HOL_LANES == 4 && defined(__AVX2__)
    // A fourth number goes behind each atom, where the next one is written afterwards; before the last atom.
    const long last = kind.n_atoms - 1;
    vec before = {};
    for (long a = 0; a < last; ++a) {
        const vec3 x = get(a);
        before = x.z;
        vec m[4] = {x.x, x.y, x.z, x.z};
        transpose(m);
        HOL_UNROLL
        for (int l = 0; l < 4; ++l) store(rows[l] + 3 * a, m[l]);
    }
    const vec3 x = get(last);
    vec m[4] = {before, x.x, x.y, x.z};
    transpose(m);
    HOL_UNROLL
    for (int l = 0; l < 4; ++l) store(rows[l] + 3 * last - 1, m[l]);
#else
    for (long a = 0; a < kind.n_atoms; ++a) {
        const vec3 x = get(a);
        for (int l = 0; l < W; ++l) {
            rows[l][3 * a] = x.x[l];
            rows[l][3 * a + 1] = x.y[l];
            rows[l][3 * a + 2] = x.z[l];
        }
    }
#endif
}

// Adds moves [n_atoms] to r, and factor times them to v, which may be null.
HOL_INLINE void add_rows(const BodyKind &kind, double *const *r, double *const *v, double factor, const vec3 *moves) {
    const vec *const from = &moves->x;
    const long n = 3L * kind.n_atoms;
    long k = 0;
    for (; k + W <= n; k += W) {
        vec m[W];
        HOL_UNROLL
        for (int l = 0; l < W; ++l) m[l] = from[k + l];
        transpose(m);
        HOL_UNROLL
        for (int l = 0; l < W; ++l) store(r[l] + k, load(r[l] + k) + m[l]);
        if (!v) continue;
        HOL_UNROLL
        for (int l = 0; l < W; ++l) store(v[l] + k, mul_add(splat(factor), m[l], load(v[l] + k)));
    }
    for (; k < n; ++k)
        for (int l = 0; l < W; ++l) {
            r[l][k] += from[k][l];
            if (v) v[l][k] = mul_add(factor, from[k][l], v[l][k]);
        }
}

// Coordinates from the first atom's, images taken from neighbour to neighbour.
HOL_NOINLINE void unfold(const BodyKind &kind, const Box &box, const double *const *rows, vec3 *raw, vec3 *x) {
    for (long a = 0; a < kind.n_atoms; ++a) put(raw[a], atom_of_rows(rows, a));
    put(x[0], raw[0] - raw[0]);
    for (long k = 0; k + 1 < kind.n_atoms; ++k) {
        const long to = kind.steps[2 * k], from = kind.steps[2 * k + 1];
        vec3 d = raw[to] - raw[from], unused = {};
        if (box.shape == Box::triclinic)
            d = triclinic_image(box, d);
        else
            wrap<false>(box, d, unused);
        put(x[to], x[from] + d);
    }
}

}  // namespace holonomic::HOL_ISA
#endif
