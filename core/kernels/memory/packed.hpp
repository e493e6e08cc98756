// Reads a block: bond vectors and right-hand sides of W bonds of W chains at a time. It subtracts numbers as they stand
// in memory and transposes only the differences. Each product of a right-hand side stands here once, for components as
// they stand in memory or for vectors in lanes.
#ifndef HOLONOMIC_KERNELS_MEMORY_PACKED_HPP
#define HOLONOMIC_KERNELS_MEMORY_PACKED_HPP

#include <stdint.h>

#include "core/kernels/arithmetic/image.hpp"
#include "core/kernels/arithmetic/vector3.hpp"
#include "core/kernels/isa/choose.hpp"
#include "core/kernels/memory/block.hpp"
#include "core/kernels/memory/prefetch.hpp"

namespace holonomic::HOL_ISA {

// With d the bond vector, dv the difference of velocities, df that of forces times inverse masses:
//   velocity_squared: dv.dv / unit,  force_difference: d.df,  rate: d.dv
// unit_mass: velocities need no factor. bonds_alone: no right-hand side, not even zero.
enum Terms {
    none_ = 0,
    velocity_squared = 1,
    force_difference = 2,
    rate = 4,
    unit_mass = 8,
    bonds_alone = 16,
    products = velocity_squared | force_difference | rate
};

// Calls body(terms), where terms is a constant: that of velocities, of forces, of both or of neither.
template <class Body>
HOL_INLINE auto choose_terms(const Body &body, bool velocities, bool forces) {
    return choose(
        [&](auto v, auto f)
            HOL_FORCED { return body(Constant<int, (v ? velocity_squared : 0) | (f ? force_difference : 0)>{}); },
        velocities, forces);
}

// A component of velocity_squared.
template <int terms>
HOL_INLINE vec square(vec mass, vec dv) {
    return (terms & unit_mass ? dv : mass * dv) * dv;
}

// A component of the right-hand side; vv is that of square().
template <int terms>
HOL_INLINE vec product(vec d, vec dv, vec df, vec vv) {
    if (terms & rate) return dv * d;
    if (!(terms & force_difference)) return vv;
    return terms & velocity_squared ? mul_add(df, d, vv) : df * d;
}

// The right-hand side of a bond from differences that are in lanes already, rounded as if they had been read from rows.
// `waited`: rounded as products that wait for the images of bonds.
template <int terms>
HOL_INLINE vec right_hand_side(bool waited, vec mass, const vec3 &d, const vec3 &dv, const vec3 &df) {
    if (terms & rate) return dot(d, dv);
    const vec3 vv = {square<terms>(mass, dv.x), square<terms>(mass, dv.y), square<terms>(mass, dv.z)};
    if (waited) {
        vec sum = {};
        if (terms & force_difference) sum = dot(d, df);
        return terms & velocity_squared ? sum + ((vv.x + vv.y) + vv.z) : sum;
    }
    return (product<terms>(d.x, dv.x, df.x, vv.x) + product<terms>(d.y, dv.y, df.y, vv.y)) +
           product<terms>(d.z, dv.z, df.z, vv.z);
}

// How minimum images are taken. In an orthorhombic box, of components as they stand in memory. In a triclinic one, of
// whole bond vectors: then products have to wait until these are transposed.
enum Images { no_images, images_of_components, images_of_bonds };

// Where a chunk of W bonds is read: r(i) is lane i's row of positions from the chunk's first atom on, likewise v, f.
struct LaneRows {
    const double *pr[W], *pv[W], *pf[W];
    HOL_FORCED const double *r(int i) const { return pr[i]; }
    HOL_FORCED const double *v(int i) const { return pv[i]; }
    HOL_FORCED const double *f(int i) const { return pf[i]; }
};

HOL_INLINE uintptr_t number(const double *p) { return reinterpret_cast<uintptr_t>(p); }
HOL_INLINE const double *pointer(uintptr_t p) { return reinterpret_cast<const double *>(p); }

// The same for lanes that are equally far apart. One address per array is enough.
struct EvenRows {
    uintptr_t at, lane, to_v, to_f;
    EvenRows(const Packed &r, const Packed &v, const Packed &f)
        : at(number(r.lane[0])), lane(number(r.lane[W > 1 ? 1 : 0]) - at), to_v(number(v.lane[0]) - at),
          to_f(number(f.lane[0]) - at) {}
    HOL_FORCED EvenRows from(long k0) const {
        EvenRows rows = *this;
        rows.at += static_cast<uintptr_t>(3 * k0) * sizeof(double);
        return rows;
    }
    HOL_FORCED const double *r(int i) const { return pointer(at + static_cast<uintptr_t>(i) * lane); }
    HOL_FORCED const double *v(int i) const { return pointer(at + static_cast<uintptr_t>(i) * lane + to_v); }
    HOL_FORCED const double *f(int i) const { return pointer(at + static_cast<uintptr_t>(i) * lane + to_f); }
};

// The bonds k0 .. k0 + W - 1 of all lanes: see load_bonds. d[W], low[W], rhs[W].
template <int terms, bool uniform, Images images, bool careful, class Rows>
HOL_INLINE void load_chunk_with(const Block &block, const Box &box, long k0, const Rows &rows, vec3 *d3, vec3 *low3,
                                vec *rhs) {
    constexpr bool wait = images == images_of_bonds;
    vec *const d = &d3->x, *const low = careful ? &low3->x : nullptr;
    vec p[3 * W], a[wait ? 3 * W : 1];
    // In the packed layout, component by component, before transposing.
    HOL_UNROLL
    for (int j = 0; j < 3; ++j) {
        vec e[W], l[W];
        HOL_UNROLL
        for (int i = 0; i < W; ++i) {
            const double *const r = rows.r(i) + W * j;
            const vec r0 = load(r), r1 = load(r + 3);
            e[i] = r1 - r0;
            if (careful) l[i] = two_difference<vec>(r1, r0).lo;
            if (images == images_of_components) {
                const int first = W * j % 3;
                e[i] = mul_add(round(e[i] * load(box.per_side + first)), load(box.minus_side + first), e[i]);
            }
            vec dv = {}, df = {}, vv = {};
            if (terms & (velocity_squared | rate)) dv = load(rows.v(i) + W * j + 3) - load(rows.v(i) + W * j);
            if (terms & velocity_squared) vv = square<terms>(splat(block.mass[i]), dv);
            if (terms & force_difference) {
                const vec f0 = load(rows.f(i) + W * j), f1 = load(rows.f(i) + W * j + 3);
                const double *const w3 = uniform ? nullptr : block.w3[i] + 3 * k0 + W * j;
                df = uniform ? f1 - f0 : load(w3 + 3) * f1 - load(w3) * f0;
            }
            if (wait) a[j * W + i] = terms & rate ? dv : df;
            p[j * W + i] = wait ? vv : product<terms>(e[i], dv, df, vv);
        }
        transpose(e);
        HOL_UNROLL
        for (int i = 0; i < W; ++i) d[j * W + i] = e[i];
        if (wait ? (terms & velocity_squared) != 0 : (terms & products) != 0) transpose(p + j * W);
        if (careful) {
            transpose(l);
            for (int i = 0; i < W; ++i) low[j * W + i] = l[i];
        }
        if (wait && (terms & (rate | force_difference))) transpose(a + j * W);
    }
    HOL_UNROLL
    for (int b = 0; b < W; ++b) {
        vec sum = {};
        if (wait) {
            vec3 unused = {};
            wrap<careful>(box, d3[b], careful ? low3[b] : unused);
            const vec3 other = {a[3 * b], a[3 * b + 1], a[3 * b + 2]};
            if (terms & (rate | force_difference)) sum = dot(d3[b], other);
            if (terms & velocity_squared) sum = sum + ((p[3 * b] + p[3 * b + 1]) + p[3 * b + 2]);
        } else if (terms & products) {
            sum = (p[3 * b] + p[3 * b + 1]) + p[3 * b + 2];
        }
        if (!(terms & bonds_alone)) rhs[b] = sum;
    }
}

template <int terms, bool uniform, bool boxed, bool careful, class Rows>
HOL_INLINE void load_chunk(const Block &block, const Box &box, long k0, const Rows &rows, vec3 *d, vec3 *low,
                           vec *rhs) {
    if (!boxed)
        load_chunk_with<terms, uniform, no_images, careful>(block, box, k0, rows, d, low, rhs);
    else if (!careful && box.shape == Box::orthorhombic)
        load_chunk_with<terms, uniform, images_of_components, careful>(block, box, k0, rows, d, low, rhs);
    else
        load_chunk_with<terms, uniform, images_of_bonds, careful>(block, box, k0, rows, d, low, rhs);
}

// Where the lanes are in the arrays of a call. All arrays are in place, or all are staged, so a lane has the same
// distance from the first one in each.
struct Places {
    const double *r, *v, *f;  // of the first lane
    long lane[W];
    Places(const Packed &pr, const Packed &pv, const Packed &pf) : r(pr.lane[0]), v(pv.lane[0]), f(pf.lane[0]) {
        for (int i = 0; i < W; ++i) lane[i] = pr.lane[i] - pr.lane[0];
    }
};

// The full chunk of bonds k0 .. k0 + W - 1.
template <int terms, bool uniform, bool boxed, bool careful>
HOL_INLINE void load_full_chunk(const Block &block, const Box &box, const Places &at, long k0, vec3 *D, vec3 *D_low,
                                vec *B) {
    LaneRows rows;
    HOL_UNROLL
    for (int i = 0; i < W; ++i) {
        rows.pr[i] = at.r + 3 * k0 + at.lane[i];
        if (terms & (velocity_squared | rate)) rows.pv[i] = at.v + 3 * k0 + at.lane[i];
        if (terms & force_difference) rows.pf[i] = at.f + 3 * k0 + at.lane[i];
    }
    if (!(terms & bonds_alone) && __builtin_expect(block.ahead != 0, 0)) {
        fetch_ahead(at.r, k0, block.ahead);
        if (terms & (velocity_squared | rate)) fetch_ahead(at.v, k0, block.ahead);
        if (terms & force_difference) fetch_ahead(at.f, k0, block.ahead);
    }
    load_chunk<terms, uniform, boxed, careful>(block, box, k0, rows, D, D_low, B);
}

// The velocities of the atoms behind a full chunk's bonds.
HOL_INLINE void load_next_atoms(const Block &block, const Places &at, long k0, vec3 *velocities) {
    const double *pv[W];
    HOL_UNROLL
    for (int i = 0; i < W; ++i) pv[i] = at.v + 3 * (k0 + 1) + at.lane[i];
    if (__builtin_expect(block.ahead != 0, 0)) fetch_ahead(at.v, k0, block.ahead);
    load_atoms(pv, velocities + k0 + 1);
}

// The bonds k0 .. k0 + W - 1 where lanes may end. Bonds past the end of a lane are inert: d = (1,0,0), rhs = 0. All W
// are written, even if the block has fewer.
template <int terms, bool uniform, bool boxed, bool careful>
HOL_NOINLINE void load_ragged(const Block &block, const Box &box, const Packed &r, const Packed &v, const Packed &f,
                              long k0, vec3 *d, vec3 *low, vec *rhs) {
    double buffer[3][W][3 * W + 3];
    LaneRows rows;
    for (int i = 0; i < W; ++i) {
        rows.pr[i] = window(r.lane[i], k0, block.len[i], block.roomy, buffer[0][i]);
        if (terms & (velocity_squared | rate))
            rows.pv[i] = window(v.lane[i], k0, block.len[i], block.roomy, buffer[1][i]);
        if (terms & force_difference) rows.pf[i] = window(f.lane[i], k0, block.len[i], block.roomy, buffer[2][i]);
    }
    load_chunk<terms, uniform, boxed, careful>(block, box, k0, rows, d, low, rhs);
    for (long b = 0; b < W; ++b) {
        const mask live = joint(block, k0 + b);
        d[b] = {select(live, d[b].x, splat(1.0)), keep(live, d[b].y), keep(live, d[b].z)};
        if (careful) low[b] = {keep(live, low[b].x), keep(live, low[b].y), keep(live, low[b].z)};
        if (!(terms & bonds_alone)) rhs[b] = keep(live, rhs[b]);
    }
}

// Bond vectors D[k] = r_{k+1} - r_k and right-hand sides B[k] of all lanes, with w in the lane's unit:
//   velocity_squared: |v_{k+1} - v_k|^2 / unit,  force_difference: D . (w_{k+1} f_{k+1} - w_k f_k),
//   rate: D . (v_{k+1} - v_k),  bonds_alone: none, B may be absent.
// careful: D_low gets the low words of the differences. Bonds past the end of a lane are inert: D = (1,0,0), B = 0.
// The arrays have room for W bonds more.
template <int terms, bool uniform, bool boxed, bool careful>
static inline void load_bonds(const Block &block, const Box &box, const Packed &r, const Packed &v, const Packed &f,
                              vec3 *D, vec3 *D_low, vec *B) {
    const Places at(r, v, f);
    long k0 = 0;
    for (; k0 + W <= block.n_min; k0 += W)
        load_full_chunk<terms, uniform, boxed, careful>(block, box, at, k0, D + k0, careful ? D_low + k0 : nullptr,
                                                        terms & bonds_alone ? nullptr : B + k0);
    for (; k0 < block.n; k0 += W)
        load_ragged<terms, uniform, boxed, careful>(block, box, r, v, f, k0, D + k0, careful ? D_low + k0 : nullptr,
                                                    terms & bonds_alone ? nullptr : B + k0);
}

// Bond vectors alone.
static inline void load_bond_vectors(const Block &block, const Box &box, const Packed &r, vec3 *D) {
    if (box.shape == Box::none)
        load_bonds<bonds_alone, true, false, false>(block, box, r, r, r, D, nullptr, nullptr);
    else
        load_bonds<bonds_alone, true, true, false>(block, box, r, r, r, D, nullptr, nullptr);
}

}  // namespace holonomic::HOL_ISA
#endif
