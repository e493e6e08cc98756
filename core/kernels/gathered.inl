// Blocks of equally long chains with lists of atoms, in packed arrays: every vector is read where the list says, and
// results are written there, with the same arithmetic as for chains over consecutive atoms. What needs more than the
// plain path is left to the general one, which copies such chains into staging buffers.

namespace holonomic {
namespace HOL_ISA {

// The lists of the lanes.
struct AtomLists {
    const int64_t *atoms[W];
    explicit AtomLists(const Lane *lane) {
        for (int i = 0; i < W; ++i) atoms[i] = lane[i].atoms;
    }
};

#if HOL_LANES >= 4 && defined(__AVX2__)
typedef double vec4 __attribute__((vector_size(32)));

// x y z of four atoms, from and to rows of three.
HOL_INLINE void gather4(const double *base, const int64_t *const *atoms, long k, vec4 &x, vec4 &y, vec4 &z) {
    const __m256i three = _mm256_setr_epi64x(-1, -1, -1, 0);
    vec4 row[4];
    HOL_UNROLL
    for (int i = 0; i < 4; ++i) row[i] = _mm256_maskload_pd(base + 3 * atoms[i][k], three);
    const vec4 a = _mm256_unpacklo_pd(row[0], row[1]), b = _mm256_unpackhi_pd(row[0], row[1]);
    const vec4 c = _mm256_unpacklo_pd(row[2], row[3]), d = _mm256_unpackhi_pd(row[2], row[3]);
    x = _mm256_permute2f128_pd(a, c, 0x20);
    y = _mm256_permute2f128_pd(b, d, 0x20);
    z = _mm256_permute2f128_pd(a, c, 0x31);
}

HOL_INLINE void scatter4(double *base, const int64_t *const *atoms, long k, vec4 x, vec4 y, vec4 z) {
    const vec4 even = _mm256_unpacklo_pd(x, y), odd = _mm256_unpackhi_pd(x, y);
    HOL_UNROLL
    for (int i = 0; i < 4; ++i) {
        double *const p = base + 3 * atoms[i][k];
        const vec4 pair = i % 2 ? odd : even;
        _mm_storeu_pd(p, i < 2 ? _mm256_castpd256_pd128(pair) : _mm256_extractf128_pd(pair, 1));
        p[2] = z[i];
    }
}
#endif

HOL_INLINE vec3 gather(const double *base, const AtomLists &at, long k) {
    vec3 a;
#if HOL_LANES == 4 && defined(__AVX2__)
    gather4(base, at.atoms, k, a.x, a.y, a.z);
#elif HOL_LANES == 8 && defined(__AVX512F__)
    vec4 x[2], y[2], z[2];
    for (int h = 0; h < 2; ++h) gather4(base, at.atoms + 4 * h, k, x[h], y[h], z[h]);
    a.x = _mm512_insertf64x4(_mm512_castpd256_pd512(x[0]), x[1], 1);
    a.y = _mm512_insertf64x4(_mm512_castpd256_pd512(y[0]), y[1], 1);
    a.z = _mm512_insertf64x4(_mm512_castpd256_pd512(z[0]), z[1], 1);
#else
    for (int i = 0; i < W; ++i) {
        const double *const p = base + 3 * at.atoms[i][k];
        a.x[i] = p[0];
        a.y[i] = p[1];
        a.z[i] = p[2];
    }
#endif
    return a;
}

template <Update update>
HOL_INLINE void scatter(double *base, const AtomLists &at, long k, vec3 a) {
    if (update == add_) {
        const vec3 b = gather(base, at, k);
        a = {b.x + a.x, b.y + a.y, b.z + a.z};
    }
#if HOL_LANES == 4 && defined(__AVX2__)
    scatter4(base, at.atoms, k, a.x, a.y, a.z);
#elif HOL_LANES == 8 && defined(__AVX512F__)
    scatter4(base, at.atoms, k, _mm512_castpd512_pd256(a.x), _mm512_castpd512_pd256(a.y), _mm512_castpd512_pd256(a.z));
    scatter4(base, at.atoms + 4, k, _mm512_extractf64x4_pd(a.x, 1), _mm512_extractf64x4_pd(a.y, 1),
             _mm512_extractf64x4_pd(a.z, 1));
#else
    for (int i = 0; i < W; ++i) {
        double *const p = base + 3 * at.atoms[i][k];
        p[0] = a.x[i];
        p[1] = a.y[i];
        p[2] = a.z[i];
    }
#endif
}

// As forward(), from the lists; of rates, the velocities go to `velocities`. Returns the lanes for which plain
// arithmetic will do, nothing overflowing.
template <int terms, bool uniform>
static __attribute__((noinline)) mask forward_gathered(const Block &block, const Box &box, const AtomLists &at,
                                                       const double *r, const double *v, const double *f,
                                                       const System &s, vec3 *velocities) {
    const Source source = {nullptr, r, at.atoms, &box, nullptr};
    Sweep<uniform, terms == rate> sweep{block, source, s};
    const bool boxed = box.shape != Box::none;
    vec3 r0 = gather(r, at, 0), v0 = {}, f0 = {};
    if (terms & (velocity_squared | rate)) v0 = gather(v, at, 0);
    if (terms & force_difference) f0 = gather(f, at, 0);
    if (terms & rate) velocities[0] = v0;
    const auto bond = [&](long k, bool starts_group) __attribute__((always_inline)) {
        if (block.list_ahead)
            for (int i = 0; i < W; ++i) {
                const int64_t next = 3 * at.atoms[i][k + block.list_ahead];
                __builtin_prefetch(r + next, 0, 2);
                if (terms & (velocity_squared | rate)) __builtin_prefetch(v + next, 0, 2);
                if (terms & force_difference) __builtin_prefetch(f + next, 0, 2);
            }
        const vec3 r1 = gather(r, at, k + 1);
        vec3 d = difference(r0, r1), dv = {}, df = {}, unused = {};
        if (boxed) wrap<false>(box, d, unused);
        s.D[k] = d;
        r0 = r1;
        if (terms & (velocity_squared | rate)) {
            const vec3 v1 = gather(v, at, k + 1);
            dv = difference(v0, v1);
            v0 = v1;
            if (terms & rate) velocities[k + 1] = v1;
        }
        if (terms & force_difference) {
            const vec3 f1 = gather(f, at, k + 1);
            const vec w0 = w_at<uniform>(block, k), w1 = w_at<uniform>(block, k + 1);
            df = {w1 * f1.x - w0 * f0.x, w1 * f1.y - w0 * f0.y, w1 * f1.z - w0 * f0.z};
            f0 = f1;
        }
        sweep.step(k, right_hand_side<terms>(box.shape == Box::triclinic, block.mass, d, dv, df), starts_group, false);
    };
    long k = 0;
    for (; k + 4 <= block.n; k += 4) {
        bond(k, true);
        bond(k + 1, false);
        bond(k + 2, false);
        bond(k + 3, false);
    }
    for (; k < block.n; ++k) bond(k, k % 4 == 0);
    return ~sweep.doubt() & sweep.calm();
}

// As substitute_and_store(), to the lists.
template <Update update>
static __attribute__((noinline)) void substitute_and_scatter(const Block &block, const System &s, const AtomLists &at,
                                                             double *out, double *value_out, vec factor) {
    vec t = {}, values[W];
    vec3 after = {};
    s.L[block.n] = vec{};
    const auto pull = [&](long k, const vec3 &before) __attribute__((always_inline)) {
        if (out) scatter<update>(out, at, k, difference(before, after));
    };
    const auto bond = [&](long k) __attribute__((always_inline)) {
        t = mul_add(s.L[k + 1], t, s.t[k]);
        const vec3 p = scaled_bond(s.D[k], t);
        pull(k + 1, p);
        after = p;
        return mul_add(factor, t, vec{});  // zeros as +0
    };
    const long full = block.n / W * W;
    for (long k = block.n - 1; k >= full; --k) {
        const vec value = bond(k);
        for (int i = 0; value_out && i < W; ++i) value_out[block.first_bond[i] + k] = value[i];
    }
    for (long k0 = full - W; k0 >= 0; k0 -= W) {
        HOL_UNROLL
        for (long b = W - 1; b >= 0; --b) values[b] = bond(k0 + b);
        if (!value_out) continue;
        transpose(values);
        for (int i = 0; i < W; ++i) store(value_out + block.first_bond[i] + k0, values[i]);
    }
    if (out) scatter<update>(out, at, 0, after);
}

HOL_INLINE double *base_of(const AtomArray &array) { return reinterpret_cast<double *>(array.x); }

// Lists in packed arrays, in all lanes of a full block?
HOL_INLINE bool listed(const Block &block, const Lane *lane) {
    if (block.lanes < W || block.n != block.n_min) return false;
    for (int i = 0; i < W; ++i)
        if (!lane[i].atoms) return false;
    return true;
}

template <int terms>
static inline mask forward_listed(const Block &block, const Box &box, const AtomLists &at, const AtomArray &r,
                                  const AtomArray &v, const AtomArray &f, const System &s, vec3 *velocities) {
    return block.uniform_w
               ? forward_gathered<terms, true>(block, box, at, base_of(r), base_of(v), base_of(f), s, velocities)
               : forward_gathered<terms, false>(block, box, at, base_of(r), base_of(v), base_of(f), s, velocities);
}

// Whether this did all that there was to do; else nothing has been written.
static inline bool listed_forces(const Block &block, const Lane *lane, const ForcesCall &call, Arena arena) {
    if (!call.r.packed || (call.g.x && !call.g.packed) || call.tension || call.virial || !listed(block, lane))
        return false;
    const AtomLists at(lane);
    const System s(block.n, arena);
    mask good;
    if (call.v.x && call.f.x)
        good = forward_listed<velocity_squared | force_difference>(block, call.box, at, call.r, call.v, call.f, s,
                                                                  nullptr);
    else if (call.f.x)
        good = forward_listed<force_difference>(block, call.box, at, call.r, call.v, call.f, s, nullptr);
    else if (call.v.x)
        good = forward_listed<velocity_squared>(block, call.box, at, call.r, call.v, call.f, s, nullptr);
    else
        return false;
    if (any(~good)) return false;
    if (call.add)
        substitute_and_scatter<add_>(block, s, at, base_of(call.g), call.lambda, splat(0.5));
    else
        substitute_and_scatter<write_>(block, s, at, base_of(call.g), call.lambda, splat(0.5));
    return true;
}

}  // namespace HOL_ISA
}  // namespace holonomic
