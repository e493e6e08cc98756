// A block: up to W chains (or W segments of one), one per lane, read from the caller's memory into interleaved arrays
// in cache and written back. Packed coordinates are read in place, a transposition of W x W elements at a time; any
// other layout is first copied into packed staging buffers.

namespace holonomic {
namespace HOL_ISA {

typedef Vector3<vec> vec3;

// Scratch memory handed out front to back.
struct Arena {
    double *next;
    vec *vecs(long n) {
        vec *p = reinterpret_cast<vec *>(next);
        next += n * W;
        return p;
    }
    double *doubles(long n) {
        double *p = next;
        next += (n + 7) / 8 * 8;
        return p;
    }
};

struct Block {
    long n, n_min;        // bonds of the longest and of the shortest lane
    long len[W];          // bonds of each lane
    int lanes;            // lanes in use; the others repeat the first one and are never stored
    bool roomy;           // W atoms more can be read behind each lane
    long ahead;           // doubles from a lane's vectors to those of the next block, to be fetched early; or 0
    bool uniform_w;       // the inverse mass is constant along each lane
    vec w_uniform;
    const vec *w;         // else [n+1], interleaved
    const double *w3[W];  // and [len+1][3], each inverse mass three times
    bool lane_uniform[W]; // lanes of constant mass: rounded as in a block of such, whatever the others are
    long first_bond[W];
    long chain[W];

    mask in_use() const { return first_lanes(lanes); }
    vec lengths() const {
        vec v;
        for (int i = 0; i < W; ++i) v[i] = static_cast<double>(len[i]);
        return v;
    }
};

// One vector per atom as the lanes of a block see it: [len+1][3], in the caller's memory or staged.
struct Packed {
    double *lane[W];
};

HOL_INLINE double element(const char *p, bool is_float) {
    return is_float ? static_cast<double>(*reinterpret_cast<const float *>(p)) : *reinterpret_cast<const double *>(p);
}

HOL_INLINE int64_t atom_of(const Lane &lane, int64_t k) { return lane.atoms ? lane.atoms[k] : lane.first_atom + k; }

HOL_INLINE long staged_size(long n_bonds) { return (3 * (n_bonds + 1) + 7) / 8 * 8; }

// Copies atoms `from` .. `from + n` of a chain into packed[n+1][3].
static inline void stage(const AtomArray &array, const Lane &lane, long from, long n, double *packed) {
    for (long k = 0; k <= n; ++k) {
        const int64_t offset = atom_of(lane, from + k) * array.stride;
        packed[3 * k] = element(array.x + offset, array.is_float);
        packed[3 * k + 1] = element(array.y + offset, array.is_float);
        packed[3 * k + 2] = array.z ? element(array.z + offset, array.is_float) : 0.0;
    }
}

HOL_INLINE void put(char *p, bool is_float, double value, bool add) {
    if (is_float) {
        float *q = reinterpret_cast<float *>(p);
        *q = static_cast<float>(add ? static_cast<double>(*q) + value : value);
    } else {
        double *q = reinterpret_cast<double *>(p);
        *q = add ? *q + value : value;
    }
}

static inline void unstage(const AtomArray &array, const Lane &lane, long from, long n, const double *packed,
                           bool add) {
    for (long k = 0; k <= n; ++k) {
        const int64_t offset = atom_of(lane, from + k) * array.stride;
        put(array.x + offset, array.is_float, packed[3 * k], add);
        put(array.y + offset, array.is_float, packed[3 * k + 1], add);
        if (array.z) put(array.z + offset, array.is_float, packed[3 * k + 2], add);
    }
}

HOL_INLINE bool in_place(const AtomArray &array, const Lane &lane) { return array.packed && !lane.atoms; }

// Where lane i of the block finds its vectors: in place, or staged from atom `from` on.
HOL_INLINE void open_lane(const AtomArray &array, const Lane &lane, long from, long n, long n_max, Packed &packed,
                          int i, double *staging, bool read) {
    if (in_place(array, lane)) {
        packed.lane[i] = reinterpret_cast<double *>(array.x) + 3 * (lane.first_atom + from);
    } else {
        packed.lane[i] = staging + i * staged_size(n_max);
        if (read) stage(array, lane, from, n, packed.lane[i]);
    }
}

// The lanes past the last one in use repeat the first.
HOL_INLINE void repeat_first(Packed &packed, int lanes) {
    for (int i = lanes; i < W; ++i) packed.lane[i] = packed.lane[0];
}

// 3 W doubles from p + 3 k on of a vector [len+1][3], where the last may lie past its end: then through `buffer`
// [3 W + 3], padded with zeros.
HOL_INLINE const double *window(const double *p, long k, long len, bool roomy, double *buffer) {
    if (__builtin_expect(roomy || k + W <= len, 1)) return p + 3 * k;
    const long left = len - k + 1 > 0 ? 3 * (len - k + 1) : 0;
    for (long i = 0; i < 3 * W + 3; ++i) buffer[i] = i < left ? p[3 * k + i] : 0.0;
    return buffer;
}

// Inverse masses of the lanes: constant along each, or tables in scratch.
static inline void set_masses(Block &block, const double *const *tables, const double *uniform, Arena &arena) {
    block.uniform_w = true;
    for (int i = 0; i < block.lanes; ++i) block.uniform_w = block.uniform_w && tables[i] == nullptr;
    for (int i = 0; i < W; ++i) {
        block.w_uniform[i] = uniform[i < block.lanes ? i : 0];
        block.lane_uniform[i] = tables[i < block.lanes ? i : 0] == nullptr;
    }
    if (block.uniform_w) return;
    vec *w = arena.vecs(block.n + 1);
    bool same = true;
    for (int i = 1; i < block.lanes; ++i) same = same && tables[i] == tables[0] && block.len[i] == block.len[0];
    for (int i = 0; i < W; ++i) {
        const int lane = i < block.lanes ? i : 0;
        const double *table = tables[lane];
        for (long k = 0; k <= block.n; ++k)  // inert bonds past the end: any positive mass
            w[k][i] = k > block.len[i] ? 1.0 : (table ? table[k] : uniform[lane]);
        if (i > 0 && (same || i >= block.lanes)) {
            block.w3[i] = block.w3[0];
            continue;
        }
        double *w3 = arena.doubles(3 * (block.n + 1 + W));
        for (long k = 0; k < 3 * (block.n + 1 + W); ++k)
            w3[k] = k / 3 > block.len[i] ? 1.0 : (table ? table[k / 3] : uniform[lane]);
        block.w3[i] = w3;
    }
    block.w = w;
}

// Minimum image of bond vectors, of all lanes or of one; `lo` gets what d's rounding left off.
template <bool careful, class V>
HOL_INLINE void wrap(const Box &box, Vector3<V> &d, Vector3<V> &lo) {
    const double *h = box.h, *in = box.inverse;
    const V n[3] = {round(d.x * in[0] + d.y * in[3] + d.z * in[6]), round(d.x * in[1] + d.y * in[4] + d.z * in[7]),
                    round(d.x * in[2] + d.y * in[5] + d.z * in[8])};
    V *component[3] = {&d.x, &d.y, &d.z}, *low[3] = {&lo.x, &lo.y, &lo.z};
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < 3; ++i) {
            if (h[3 * i + c] == 0) continue;
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

// What the right-hand side of a bond is made of.
enum Terms { none_ = 0, velocity_squared = 1, force_difference = 2, rate = 4 };

// Starts to fetch W atoms of the next block, `ahead` doubles from p: an address that may lie behind the array.
HOL_INLINE void fetch_ahead(const double *p, long ahead) {
    const uintptr_t address = reinterpret_cast<uintptr_t>(p) + static_cast<uintptr_t>(ahead) * sizeof(double);
    for (int line = 0; line < (W > 4 ? 4 : 2); ++line)
        __builtin_prefetch(reinterpret_cast<const void *>(address + static_cast<uintptr_t>(line) * 64), 0, 2);
}

// The bonds k0 .. k0 + W - 1 of all lanes, from pointers to atom k0: see load_bonds. d[W], low[W], rhs[W].
template <int terms, bool uniform, bool boxed, bool careful>
HOL_INLINE void load_chunk(const Block &block, const Box &box, long k0, const double *const *pr,
                           const double *const *pv, const double *const *pf, vec3 *d3, vec3 *low3, vec *rhs) {
    vec *const d = &d3->x, *const low = careful ? &low3->x : nullptr;
    vec p[3 * W], a[boxed ? 3 * W : 1];
    // In the packed layout, component by component, before transposing; with a box the products have to wait.
    for (int j = 0; j < 3; ++j) {
        vec e[W], l[W];
        for (int i = 0; i < W; ++i) {
            const vec r0 = load(pr[i] + W * j), r1 = load(pr[i] + W * j + 3);
            e[i] = r1 - r0;
            if (careful) l[i] = two_difference<vec>(r1, r0).lo;
            vec dv = {}, df = {};
            if (terms & (velocity_squared | rate)) dv = load(pv[i] + W * j + 3) - load(pv[i] + W * j);
            if (terms & force_difference) {
                const vec f0 = load(pf[i] + W * j), f1 = load(pf[i] + W * j + 3);
                if (uniform || block.lane_uniform[i]) {
                    df = splat(block.w_uniform[i]) * (f1 - f0);
                } else {
                    const double *w3 = block.w3[i] + 3 * k0 + W * j;
                    df = load(w3 + 3) * f1 - load(w3) * f0;
                }
            }
            if (boxed) {
                a[j * W + i] = terms & rate ? dv : df;
                p[j * W + i] = dv * dv;
            } else if (terms & rate) {
                p[j * W + i] = dv * e[i];
            } else if ((terms & velocity_squared) && (terms & force_difference)) {
                p[j * W + i] = mul_add(df, e[i], dv * dv);
            } else if (terms & force_difference) {
                p[j * W + i] = df * e[i];
            } else {
                p[j * W + i] = dv * dv;
            }
        }
        transpose(e);
        for (int i = 0; i < W; ++i) d[j * W + i] = e[i];
        if (terms) transpose(p + j * W);
        if (careful) {
            transpose(l);
            for (int i = 0; i < W; ++i) low[j * W + i] = l[i];
        }
        if (boxed) transpose(a + j * W);
    }
    for (int b = 0; b < W; ++b) {
        vec sum = {};
        if (boxed) {
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

// Bond vectors D[k] = r_{k+1} - r_k and right-hand sides B[k] of all lanes:
//   velocity_squared: |v_{k+1} - v_k|^2,  force_difference: D . (w_{k+1} f_{k+1} - w_k f_k),  rate: D . (v_{k+1} - v_k).
// careful: D_low gets the low words of the differences. Bonds past the end of a lane are inert: D = (1,0,0), B = 0.
template <int terms, bool uniform, bool boxed, bool careful>
static inline void load_bonds(const Block &block, const Box &box, const Packed &r, const Packed &v, const Packed &f,
                              vec3 *D, vec3 *D_low, vec *B) {
    const double *pr[W], *pv[W], *pf[W];
    long k0 = 0;
    for (; k0 + W <= block.n_min; k0 += W) {
        for (int i = 0; i < W; ++i) {
            pr[i] = r.lane[i] + 3 * k0;
            if (terms & (velocity_squared | rate)) pv[i] = v.lane[i] + 3 * k0;
            if (terms & force_difference) pf[i] = f.lane[i] + 3 * k0;
        }
        if (block.ahead)
            for (int i = 0; i < W; ++i) {
                fetch_ahead(pr[i], block.ahead);
                if (terms & (velocity_squared | rate)) fetch_ahead(pv[i], block.ahead);
                if (terms & force_difference) fetch_ahead(pf[i], block.ahead);
            }
        load_chunk<terms, uniform, boxed, careful>(block, box, k0, pr, pv, pf, D + k0, careful ? D_low + k0 : nullptr,
                                                   B + k0);
    }
    for (; k0 < block.n; k0 += W) {
        double buffer[3][W][3 * W + 3];
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
            D[k0 + b] = {select(live, d[b].x, splat(1.0)), keep(live, d[b].y), keep(live, d[b].z)};
            if (careful) D_low[k0 + b] = {keep(live, low[b].x), keep(live, low[b].y), keep(live, low[b].z)};
            B[k0 + b] = keep(live, rhs[b]);
        }
    }
}

// The rates D . (v_{k+1} - v_k) of the bonds k0 .. k0 + W - 1, with D as loaded before.
HOL_INLINE void rate_chunk(const double *const *pv, const vec3 *D, vec *rates) {
    vec e[3 * W];
    for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < W; ++i) e[j * W + i] = load(pv[i] + W * j + 3) - load(pv[i] + W * j);
        transpose(e + j * W);
    }
    for (int b = 0; b < W; ++b) rates[b] = dot(D[b], vec3{e[3 * b], e[3 * b + 1], e[3 * b + 2]});
}

static inline void load_rates(const Block &block, const Packed &v, const vec3 *D, vec *B) {
    const double *pv[W];
    long k0 = 0;
    for (; k0 + W <= block.n_min; k0 += W) {
        for (int i = 0; i < W; ++i) pv[i] = v.lane[i] + 3 * k0;
        rate_chunk(pv, D + k0, B + k0);
    }
    for (; k0 < block.n; k0 += W) {
        double buffer[W][3 * W + 3];
        vec3 d[W];
        vec rates[W];
        for (int i = 0; i < W; ++i) pv[i] = window(v.lane[i], k0, block.len[i], false, buffer[i]);
        for (long b = 0; b < W; ++b) d[b] = k0 + b < block.n ? D[k0 + b] : vec3{};
        rate_chunk(pv, d, rates);
        for (long b = 0; b < W && k0 + b < block.n; ++b)
            B[k0 + b] = keep(less(splat(static_cast<double>(k0 + b)), block.lengths()), rates[b]);
    }
}

// Writes factor times a value per bond of the lanes in `which` into the caller's array per bond.
static inline void store_bonds(const Block &block, const vec *value, double factor, mask which, double *out) {
    const unsigned chosen = bits(which & block.in_use());
    double *p[W];
    for (int i = 0; i < block.lanes; ++i) p[i] = out + block.first_bond[i];
    long k0 = 0;
    if (chosen == (1u << W) - 1)
        for (; k0 + W <= block.n_min; k0 += W) {
            vec m[W];
            for (int b = 0; b < W; ++b) m[b] = factor * value[k0 + b] + 0.0;  // a zero is +0, whatever the padding
            transpose(m);
            for (int i = 0; i < W; ++i) store(p[i] + k0, m[i]);
        }
    for (int i = 0; i < block.lanes; ++i)
        if (chosen >> i & 1)
            for (long k = k0; k < block.len[i]; ++k) p[i][k] = factor * value[k][i] + 0.0;
}

enum Update { write_, add_ };

// Writes W consecutive atoms from atom k0 on, given component by component (value[3 W], transposed in place), of all
// lanes.
template <Update update>
HOL_INLINE void store_chunk(long k0, vec *value, const Packed &out) {
    for (int j = 0; j < 3; ++j) {
        transpose(value + j * W);
        for (int i = 0; i < W; ++i) {
            double *p = out.lane[i] + 3 * k0 + j * W;
            store(p, update == add_ ? load(p) + value[j * W + i] : value[j * W + i]);
        }
    }
}

// The same where lanes may end, or be left out.
template <Update update>
HOL_INLINE void store_ragged(const Block &block, long k0, vec *value, unsigned chosen, const Packed &out) {
    for (int j = 0; j < 3; ++j) transpose(value + j * W);
    for (int i = 0; i < block.lanes; ++i) {
        if (!(chosen >> i & 1)) continue;
        double *p = out.lane[i] + 3 * k0;
        long left = 3 * (block.len[i] + 1 - k0);
        for (int j = 0; j < 3 && left > 0; ++j, left -= W, p += W) {
            const vec x = value[j * W + i];
            if (left >= W)
                store(p, update == add_ ? load(p) + x : x);
            else
                for (long e = 0; e < left; ++e) p[e] = update == add_ ? p[e] + x[e] : x[e];
        }
    }
}

}  // namespace HOL_ISA
}  // namespace holonomic
