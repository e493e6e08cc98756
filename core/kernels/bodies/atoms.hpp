// The atoms of W rigid bodies of a kind, each body in a lane of its own: reading and writing them, atom by atom.
#pragma once

#include "core/kernels/arithmetic/image.hpp"
#include "core/kernels/atom.hpp"
#include "core/kernels/bodies/frame.hpp"
#include "core/kernels/molecules/atoms/consecutive.hpp"

namespace holonomic::HOL_ISA {

// Where the rows x y z of each lane begin.
struct BodyRows {
    double *base;
    const int64_t *first;  // [W]
};

struct BodyBlock {
    const BodyKind &kind;
    const int64_t *const *atoms;  // [W]
    const int64_t *first;         // [W], as in the unit
    int count;                    // of lanes with bodies of their own
    bool consecutive;             // the atoms of each stand one behind the other

    explicit BodyBlock(const BodyKind &k) : kind(k) {}
    // The bodies of a unit from this one on.
    HOL_FORCED void set(const BodyUnit &unit, int body) {
        atoms = unit.atoms + body;
        first = unit.first + body;
        count = unit.count - body < W ? unit.count - body : W;
        consecutive = unit.consecutive;
    }
    HOL_FORCED bool in_a_row(const AtomArray &array) const { return array.packed && consecutive; }
    HOL_FORCED BodyRows rows(const AtomArray &array) const { return {reinterpret_cast<double *>(array.x), first}; }

    // Copies the rows [3 n_atoms] of all lanes. without_sites: zeros in their place.
    __attribute__((noinline)) BodyRows copy_rows(const AtomArray &array, double *copy, int64_t *first_of_copy,
                                                 bool without_sites) const {
        double *to = copy;
        for (int l = 0; l < W; ++l) {
            first_of_copy[l] = to - copy;
            for (long a = 0; a < kind.n_atoms; ++a, to += 3)
                if (without_sites && kind.masses[a] == 0)
                    to[0] = to[1] = to[2] = 0;
                else
                    read_atom(array, atoms[l][a], to);
        }
        return {copy, first_of_copy};
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
};

HOL_INLINE void rows_at(const BodyRows &rows, long k, double **to) {
    HOL_UNROLL
    for (int l = 0; l < W; ++l) to[l] = rows.base + rows.first[l] + k;
}
HOL_INLINE void rows_at(double *const *rows, long k, double **to) {
    HOL_UNROLL
    for (int l = 0; l < W; ++l) to[l] = rows[l] + k;
}

// Calls each(a, vector) for the atoms a .. n - 1, which are read two by two.
template <class Each>
HOL_INLINE void for_each_of_rows(const BodyRows &rows, long a, long n, const Each &each) {
    double *r[W], *p[W];
    rows_at(rows, 0, r);
    for (; a + 2 <= n; a += 2) {
        rows_at(r, 3 * a, p);
#if HOL_LANES == 4 && defined(__AVX2__)
        // What belongs to the second atom alone is read behind the first one: all would not fit into registers.
        vec e[6];
        graph::read_elements<4>(p, e);
        each(a, vec3{e[0], e[1], e[2]});
        graph::read_pair(p, 4, e[4], e[5]);
        each(a + 1, vec3{e[3], e[4], e[5]});
#else
        vec3 two[2];
        graph::read_elements<6>(p, two);
        each(a, two[0]);
        each(a + 1, two[1]);
#endif
    }
    if (a == n) return;
    vec3 one;
    rows_at(r, 3 * a, p);
    graph::read_elements<3>(p, &one);
    each(a, one);
}

HOL_INLINE vec3 first_of(const BodyRows &rows) {
    double *r[W];
    rows_at(rows, 0, r);
    vec3 x;
    graph::read_elements<3>(r, &x);
    return x;
}

HOL_NOINLINE void read_vectors(const BodyRows rows, long n, vec3 *x) {
    for_each_of_rows(rows, 0, n, [&](long a, const vec3 &r) HOL_FORCED { put(x[a], r); });
}

// Hands get(a) for n atoms to put, as put(Constant, k, vectors) of two or of one, which go to element k.
template <class Get, class Put>
HOL_INLINE void for_each_to_rows(long n, const Get &get, const Put &put) {
    long a = 0;
    for (; a + 2 <= n; a += 2) {
        vec3 x[2] = {get(a), get(a + 1)};
        put(Constant<int, 6>{}, 3 * a, x);
    }
    if (a == n) return;
    vec3 x = get(a);
    put(Constant<int, 3>{}, 3 * a, &x);
}

// Writes get(a) for n atoms.
template <class Get>
HOL_INLINE void write_rows(const BodyRows &rows, long n, const Get &get) {
    double *r[W];
    rows_at(rows, 0, r);
    for_each_to_rows(n, get, [&](auto elements, long k, vec3 *x) HOL_FORCED {
        double *p[W];
        rows_at(r, k, p);
        graph::write_elements<elements>(p, x);
    });
}

// Adds get(a) to r, and factor times it to v, whose base may be null.
template <class Get>
HOL_INLINE void add_rows(const BodyRows &to_r, const BodyRows &to_v, long n, double factor, const Get &get) {
    double *r[W], *v[W];
    rows_at(to_r, 0, r);
    rows_at(to_v.base ? to_v : to_r, 0, v);
    for_each_to_rows(n, get, [&](auto elements, long k, vec3 *x) HOL_FORCED {
        double *p[W], *u[W];
        rows_at(r, k, p);
        if (!to_v.base) return graph::add_elements<elements>(p, nullptr, 0, x);
        rows_at(v, k, u);
        graph::add_elements<elements>(p, u, factor, x);
    });
}

// Coordinates from the first atom's, images taken from neighbour to neighbour.
HOL_NOINLINE void unfold(const BodyKind &kind, const Box &box, const vec3 *raw, vec3 *x) {
    put(x[0], raw[0] - raw[0]);
    for (long k = 0; k + 1 < kind.n_atoms; ++k) {
        const long to = kind.steps[2 * k], from = kind.steps[2 * k + 1];
        vec3 d = raw[to] - raw[from], unused = {};
        if (box.lattice == Box::triclinic)
            d = triclinic_image(box, d);
        else
            wrap<false>(box, d, unused);
        put(x[to], x[from] + d);
    }
}

}  // namespace holonomic::HOL_ISA
