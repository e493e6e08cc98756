// Reading a block: bond vectors and right-hand sides of W bonds of W chains at a time. Differences are taken of the
// numbers as they stand in memory, and only those are transposed.

namespace holonomic {
namespace HOL_ISA {

// Minimum image of bond vectors, of all lanes or of one; `lo` gets what d's rounding left off.
template <bool careful, class V>
HOL_INLINE void wrap(const Box &box, Vector3<V> &d, Vector3<V> &lo) {
    const double *h = box.h, *in = box.inverse;
    if (!careful && box.shape == Box::orthorhombic) {
        d.x = mul_add(round(d.x * in[0]), V{} - h[0], d.x);
        d.y = mul_add(round(d.y * in[4]), V{} - h[4], d.y);
        d.z = mul_add(round(d.z * in[8]), V{} - h[8], d.z);
        return;
    }
    const V n[3] = {round(d.x * in[0] + d.y * in[3] + d.z * in[6]), round(d.x * in[1] + d.y * in[4] + d.z * in[7]),
                    round(d.x * in[2] + d.y * in[5] + d.z * in[8])};
    V *component[3] = {&d.x, &d.y, &d.z}, *low[3] = {&lo.x, &lo.y, &lo.z};
    HOL_UNROLL
    for (int c = 0; c < 3; ++c) {
        HOL_UNROLL
        for (int i = 0; i < 3; ++i) {
            const V side = V{} + h[3 * i + c];
            if (careful) {
                const Pair<V> p = two_product<V>(n[i], side);
                const Pair<V> s = two_difference<V>(*component[c], p.hi);
                const Pair<V> t = fast_two_sum<V>(s.hi, s.lo - p.lo + *low[c]);
                *component[c] = t.hi;
                *low[c] = t.lo;
            } else {
                *component[c] = mul_add(n[i], -side, *component[c]);
            }
        }
    }
}

// The vector from one atom to another, unrounded: d + lo.
HOL_INLINE void unrounded_bond(const Box &box, const double *from, const double *to, Vector3<double> &d,
                               Vector3<double> &lo) {
    const Pair<double> x = two_difference(to[0], from[0]), y = two_difference(to[1], from[1]),
                       z = two_difference(to[2], from[2]);
    d = {x.hi, y.hi, z.hi};
    lo = {x.lo, y.lo, z.lo};
    if (box.shape != Box::none) wrap<true>(box, d, lo);
}

// What the right-hand side of a bond is made of.
enum Terms { none_ = 0, velocity_squared = 1, force_difference = 2, rate = 4, unit_mass = 8 };

// Starts to fetch a piece of the next block's vectors, `ahead` doubles from those of this one, when this one is at atom
// k0, as many as `atoms` of each lane: its lanes lie one behind the other, and are fetched in that order, as the
// processor's own prefetchers like it. The addresses may lie behind the array.
template <int atoms = W>
HOL_INLINE void fetch_ahead(const double *first_lane, long k0, long ahead) {
    const uintptr_t address =
        reinterpret_cast<uintptr_t>(first_lane) + static_cast<uintptr_t>(ahead + 3 * W * k0) * sizeof(double);
    HOL_UNROLL
    for (int line = 0; line < (3 * W * atoms + 7) / 8; ++line)
        __builtin_prefetch(reinterpret_cast<const void *>(address + static_cast<uintptr_t>(line) * 64), 0, 2);
}

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
static __attribute__((noinline)) void load_ragged_chunk(const Block &block, const Box &box, const Packed &r,
                                                        const Packed &v, const Packed &f, long k0, vec3 *D,
                                                        vec3 *D_low, vec *B) {
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

// The right-hand side of a bond as load_chunk() finds it, from differences already in lanes: dv of the velocities, df of
// the forces times their inverse masses. `waited`: for images of bonds.
template <int terms>
HOL_INLINE vec right_hand_side(bool waited, vec mass, const vec3 &d, const vec3 &dv, const vec3 &df) {
    if (terms & rate) return dot(d, dv);
    const vec3 vv = {(mass * dv.x) * dv.x, (mass * dv.y) * dv.y, (mass * dv.z) * dv.z};
    if (waited) {
        vec sum = {};
        if (terms & force_difference) sum = dot(d, df);
        return terms & velocity_squared ? sum + ((vv.x + vv.y) + vv.z) : sum;
    }
    if (!(terms & force_difference)) return (vv.x + vv.y) + vv.z;
    if (!(terms & velocity_squared)) return (df.x * d.x + df.y * d.y) + df.z * d.z;
    return (mul_add(df.x, d.x, vv.x) + mul_add(df.y, d.y, vv.y)) + mul_add(df.z, d.z, vv.z);
}

}  // namespace HOL_ISA
}  // namespace holonomic
