// Reading a block: bond vectors and right-hand sides of W bonds of W chains at a time. Differences are taken of the
// numbers as they stand in memory, and only those are transposed.
#ifndef HOLONOMIC_KERNELS_MEMORY_PACKED_HPP
#define HOLONOMIC_KERNELS_MEMORY_PACKED_HPP

#include "core/kernels/arithmetic/image.hpp"
#include "core/kernels/memory/block.hpp"
#include "core/kernels/memory/prefetch.hpp"
#include "core/kernels/memory/rows.hpp"
#include "core/kernels/memory/terms.hpp"

namespace holonomic {
namespace HOL_ISA {

// When the minimum image is taken: never; of the components as they stand in memory, which will do if the box is
// orthorhombic; of bond vectors, for which the products have to wait until they are transposed.
enum Images { no_images, images_of_components, images_of_bonds };

// The bonds k0 .. k0 + W - 1 of all lanes, from pointers to atom k0: see load_bonds. d[W], low[W], rhs[W].
template <int terms, bool uniform, Images images, bool careful>
HOL_INLINE void load_chunk_with(const Block &block, const Box &box, long k0, const double *const *pr,
                                const double *const *pv, const double *const *pf, vec3 *d3, vec3 *low3, vec *rhs) {
    constexpr bool wait = images == images_of_bonds;
    vec *const d = &d3->x, *const low = careful ? &low3->x : nullptr;
    vec p[3 * W], a[wait ? 3 * W : 1];
    // In the packed layout, component by component, before transposing.
    HOL_UNROLL
    for (int j = 0; j < 3; ++j) {
        vec e[W], l[W];
        HOL_UNROLL
        for (int i = 0; i < W; ++i) {
            const vec r0 = load(pr[i] + W * j), r1 = load(pr[i] + W * j + 3);
            e[i] = r1 - r0;
            if (careful) l[i] = two_difference<vec>(r1, r0).lo;
            if (images == images_of_components) {
                const int first = W * j % 3;
                e[i] = mul_add(round(e[i] * load(box.per_side + first)), load(box.minus_side + first), e[i]);
            }
            vec dv = {}, df = {}, vv = {};
            if (terms & (velocity_squared | rate)) dv = load(pv[i] + W * j + 3) - load(pv[i] + W * j);
            if (terms & velocity_squared) vv = (terms & unit_mass ? dv : block.mass[i] * dv) * dv;
            if (terms & force_difference) {
                const vec f0 = load(pf[i] + W * j), f1 = load(pf[i] + W * j + 3);
                if (uniform) {
                    df = f1 - f0;
                } else {
                    const double *w3 = block.w3[i] + 3 * k0 + W * j;
                    df = load(w3 + 3) * f1 - load(w3) * f0;
                }
            }
            if (wait) {
                a[j * W + i] = terms & rate ? dv : df;
                p[j * W + i] = vv;
            } else if (terms & rate) {
                p[j * W + i] = dv * e[i];
            } else if (terms & force_difference) {
                p[j * W + i] = terms & velocity_squared ? mul_add(df, e[i], vv) : df * e[i];
            } else {
                p[j * W + i] = vv;
            }
        }
        transpose(e);
        HOL_UNROLL
        for (int i = 0; i < W; ++i) d[j * W + i] = e[i];
        if (wait ? (terms & velocity_squared) != 0 : terms != 0) transpose(p + j * W);
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
        } else if (terms) {
            sum = (p[3 * b] + p[3 * b + 1]) + p[3 * b + 2];
        }
        rhs[b] = sum;
    }
}

template <int terms, bool uniform, bool boxed, bool careful>
HOL_INLINE void load_chunk(const Block &block, const Box &box, long k0, const double *const *pr,
                           const double *const *pv, const double *const *pf, vec3 *d, vec3 *low, vec *rhs) {
    if (!boxed)
        load_chunk_with<terms, uniform, no_images, careful>(block, box, k0, pr, pv, pf, d, low, rhs);
    else if (!careful && box.shape == Box::orthorhombic)
        load_chunk_with<terms, uniform, images_of_components, careful>(block, box, k0, pr, pv, pf, d, low, rhs);
    else
        load_chunk_with<terms, uniform, images_of_bonds, careful>(block, box, k0, pr, pv, pf, d, low, rhs);
}

// The lanes' places in the arrays of a call. All arrays are laid out in the same way (all in place or all staged), so
// that a lane is at the same distance from the first in each.
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
    const double *pr[W], *pv[W] = {}, *pf[W] = {};
    HOL_UNROLL
    for (int i = 0; i < W; ++i) {
        pr[i] = at.r + 3 * k0 + at.lane[i];
        if (terms & (velocity_squared | rate)) pv[i] = at.v + 3 * k0 + at.lane[i];
        if (terms & force_difference) pf[i] = at.f + 3 * k0 + at.lane[i];
    }
    if (__builtin_expect(block.ahead != 0, 0)) {
        fetch_ahead(at.r, k0, block.ahead);
        if (terms & (velocity_squared | rate)) fetch_ahead(at.v, k0, block.ahead);
        if (terms & force_difference) fetch_ahead(at.f, k0, block.ahead);
    }
    load_chunk<terms, uniform, boxed, careful>(block, box, k0, pr, pv, pf, D, D_low, B);
}

// The bonds k0 .. k0 + W - 1 where lanes may end: those past the end of a lane are inert, D = (1,0,0), B = 0.
template <int terms, bool uniform, bool boxed, bool careful>
HOL_NOINLINE void load_ragged_chunk(const Block &block, const Box &box, const Packed &r, const Packed &v,
                                    const Packed &f, long k0, vec3 *D, vec3 *D_low, vec *B) {
    double buffer[3][W][3 * W + 3];
    const double *pr[W], *pv[W], *pf[W];
    for (int i = 0; i < W; ++i) {
        pr[i] = window(r.lane[i], k0, block.len[i], block.roomy, buffer[0][i]);
        if (terms & (velocity_squared | rate)) pv[i] = window(v.lane[i], k0, block.len[i], block.roomy, buffer[1][i]);
        if (terms & force_difference) pf[i] = window(f.lane[i], k0, block.len[i], block.roomy, buffer[2][i]);
    }
    vec3 d[W], low[W];
    vec rhs[W];
    load_chunk<terms, uniform, boxed, careful>(block, box, k0, pr, pv, pf, d, low, rhs);
    for (long b = 0; b < W && k0 + b < block.n; ++b) {
        const mask live = less(splat(static_cast<double>(k0 + b)), block.lengths());
        D[b] = {select(live, d[b].x, splat(1.0)), keep(live, d[b].y), keep(live, d[b].z)};
        if (careful) D_low[b] = {keep(live, low[b].x), keep(live, low[b].y), keep(live, low[b].z)};
        B[b] = keep(live, rhs[b]);
    }
}

// Bond vectors D[k] = r_{k+1} - r_k and right-hand sides B[k] of all lanes, with w in the lane's unit:
//   velocity_squared: |v_{k+1} - v_k|^2 / unit,  force_difference: D . (w_{k+1} f_{k+1} - w_k f_k),
//   rate: D . (v_{k+1} - v_k).
// careful: D_low gets the low words of the differences. Bonds past the end of a lane are inert: D = (1,0,0), B = 0.
template <int terms, bool uniform, bool boxed, bool careful>
static inline void load_bonds(const Block &block, const Box &box, const Packed &r, const Packed &v, const Packed &f,
                              vec3 *D, vec3 *D_low, vec *B) {
    const Places at(r, v, f);
    long k0 = 0;
    for (; k0 + W <= block.n_min; k0 += W)
        load_full_chunk<terms, uniform, boxed, careful>(block, box, at, k0, D + k0, careful ? D_low + k0 : nullptr,
                                                        B + k0);
    for (; k0 < block.n; k0 += W)
        load_ragged_chunk<terms, uniform, boxed, careful>(block, box, r, v, f, k0, D + k0,
                                                          careful ? D_low + k0 : nullptr, B + k0);
}

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
