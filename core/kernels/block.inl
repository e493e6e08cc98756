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
    long list_ahead;      // the same for lists of atoms
    bool staged;          // some lanes lie in staging buffers, so all do
    // Inverse masses are relative to a unit of each lane's own: its inverse mass where that is constant along it, else 1.
    // So equal masses cost nothing, and are rounded the same way whatever stands in the other lanes.
    bool uniform_w;       // they are 1 along every lane
    bool unit_masses;     // and so are the masses
    vec unit, mass;       // the unit, and 1 / unit
    mask movable;         // lanes that do not consist of fixed atoms alone
    const vec *w;         // else [n+1], interleaved, in that unit
    const double *w3[W];  // and [len+1][3], each three times
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

// Unit of the inverse masses of a chain, and the one of its atom k in it: see Block.
HOL_INLINE double unit_of(const Lane &lane) { return !lane.w && lane.w_uniform > 0 ? lane.w_uniform : 1.0; }
HOL_INLINE double relative_w(const Lane &lane, int64_t k) { return lane.w ? lane.w[k] : lane.w_uniform > 0 ? 1.0 : 0.0; }

HOL_INLINE long staged_size(long n_bonds) { return (3 * (n_bonds + 1) + 7) / 8 * 8; }

// Calls each(element, i) for the components of the atoms from .. from + n of a chain, i counting them all; there is none
// for an absent z. The layouts of consecutive atoms that most callers have are loops that the compiler vectorizes.
template <class T, class Each>
HOL_INLINE void for_each_element(const AtomArray &array, const Lane &lane, long from, long n, Each each) {
    const int64_t size = sizeof(T), offset = (lane.first_atom + from) * array.stride;
    if (!lane.atoms && array.z && array.stride == size) {
        T *__restrict const x = reinterpret_cast<T *>(array.x + offset);
        T *__restrict const y = reinterpret_cast<T *>(array.y + offset);
        T *__restrict const z = reinterpret_cast<T *>(array.z + offset);
        for (long k = 0; k <= n; ++k) {
            each(x[k], 3 * k);
            each(y[k], 3 * k + 1);
            each(z[k], 3 * k + 2);
        }
    } else if (!lane.atoms && array.z == array.y + size && array.y == array.x + size && array.stride == 3 * size) {
        T *__restrict const elements = reinterpret_cast<T *>(array.x + offset);
        for (long i = 0; i < 3 * (n + 1); ++i) each(elements[i], i);
    } else {
        for (long k = 0; k <= n; ++k) {
            const int64_t at = (lane.atoms ? lane.atoms[from + k] : lane.first_atom + from + k) * array.stride;
            each(*reinterpret_cast<T *>(array.x + at), 3 * k);
            each(*reinterpret_cast<T *>(array.y + at), 3 * k + 1);
            if (array.z) each(*reinterpret_cast<T *>(array.z + at), 3 * k + 2);
        }
    }
}

// Where a chain's atoms stand one behind the other in arrays of their own for x, y and z; x == nullptr elsewhere.
struct Apart {
    double *x = nullptr, *y = nullptr, *z = nullptr;
    Apart(const AtomArray &array, const Lane &lane, long from) {
        if (array.is_float || lane.atoms || !array.z || array.stride != sizeof(double)) return;
        x = reinterpret_cast<double *>(array.x) + lane.first_atom + from;
        y = reinterpret_cast<double *>(array.y) + lane.first_atom + from;
        z = reinterpret_cast<double *>(array.z) + lane.first_atom + from;
    }
};

// The atoms 0, 1, .. n, four at a time, between x, y, z and packed[n+1][3]; returns the first one that is left. The
// compiler would take twice as many instructions.
#if defined(__AVX2__)
HOL_INLINE long pack(const Apart &from, long n, double *packed) {
    long k = 0;
    for (; k + 3 <= n; k += 4) {
        const __m256d x = _mm256_loadu_pd(from.x + k), y = _mm256_loadu_pd(from.y + k), z = _mm256_loadu_pd(from.z + k);
        const __m256d xy = _mm256_unpacklo_pd(x, y), zx = _mm256_blend_pd(z, x, 10), yz = _mm256_unpackhi_pd(y, z);
        _mm256_storeu_pd(packed + 3 * k, _mm256_permute2f128_pd(xy, zx, 0x20));
        _mm256_storeu_pd(packed + 3 * k + 4, _mm256_blend_pd(yz, xy, 12));
        _mm256_storeu_pd(packed + 3 * k + 8, _mm256_permute2f128_pd(zx, yz, 0x31));
    }
    return k;
}

template <bool add>
HOL_INLINE long unpack(const double *packed, long n, const Apart &to) {
    const auto put = [](double *p, __m256d a) __attribute__((always_inline)) {
        _mm256_storeu_pd(p, add ? _mm256_add_pd(_mm256_loadu_pd(p), a) : a);
    };
    long k = 0;
    for (; k + 3 <= n; k += 4) {
        const __m256d a = _mm256_loadu_pd(packed + 3 * k), b = _mm256_loadu_pd(packed + 3 * k + 4);
        const __m256d c = _mm256_loadu_pd(packed + 3 * k + 8);
        const __m256d xy = _mm256_blend_pd(a, b, 12), zx = _mm256_permute2f128_pd(a, c, 0x21), yz = _mm256_blend_pd(b, c, 12);
        put(to.x + k, _mm256_blend_pd(xy, zx, 10));
        put(to.y + k, _mm256_shuffle_pd(xy, yz, 5));
        put(to.z + k, _mm256_blend_pd(zx, yz, 10));
    }
    return k;
}
#else
HOL_INLINE long pack(const Apart &, long, double *) { return 0; }
template <bool add>
HOL_INLINE long unpack(const double *, long, const Apart &) {
    return 0;
}
#endif

template <class T>
HOL_INLINE void stage_elements(const AtomArray &array, const Lane &lane, long from, long n, double *__restrict packed) {
    for_each_element<T>(array, lane, from, n, [=](const T &element, long i) __attribute__((always_inline)) {
        packed[i] = element;
    });
    for (long k = 0; !array.z && k <= n; ++k) packed[3 * k + 2] = 0;
}

// Copies atoms `from` .. `from + n` of a chain into packed[n+1][3].
static __attribute__((noinline)) void stage(const AtomArray &array, const Lane &lane, long from, long n,
                                            double *packed) {
    const Apart apart(array, lane, from);
    const long done = apart.x ? pack(apart, n, packed) : 0;
    if (done > n) return;
    if (array.is_float)
        stage_elements<float>(array, lane, from, n, packed);
    else
        stage_elements<double>(array, lane, from + done, n - done, packed + 3 * done);
}

template <class T, bool add>
HOL_INLINE void unstage_elements(const AtomArray &array, const Lane &lane, long from, long n,
                                 const double *__restrict packed) {
    for_each_element<T>(array, lane, from, n, [=](T &element, long i) __attribute__((always_inline)) {
        element = static_cast<T>(add ? static_cast<double>(element) + packed[i] : packed[i]);
    });
}

template <bool add>
HOL_INLINE void unstage(const AtomArray &array, const Lane &lane, long from, long n, const double *packed) {
    const Apart apart(array, lane, from);
    const long done = apart.x ? unpack<add>(packed, n, apart) : 0;
    if (done > n) return;
    if (array.is_float)
        unstage_elements<float, add>(array, lane, from, n, packed);
    else
        unstage_elements<double, add>(array, lane, from + done, n - done, packed + 3 * done);
}

static __attribute__((noinline)) void unstage(const AtomArray &array, const Lane &lane, long from, long n,
                                              const double *packed, bool add) {
    add ? unstage<true>(array, lane, from, n, packed) : unstage<false>(array, lane, from, n, packed);
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

// Values along the lanes as vectors [n]: rows[lane][k] while all lanes have one, of count + more; value(lane, k) behind.
template <class Value>
HOL_INLINE void interleave(const double *const *rows, const long *count, long more, long n, vec *out,
                           const Value &value) {
    long full = n, k = 0;
    for (int i = 0; i < W; ++i) full = !rows[i] ? 0 : count[i] + more < full ? count[i] + more : full;
    for (; k + W <= full; k += W) {
        vec m[W];
        for (int i = 0; i < W; ++i) m[i] = load(rows[i] + k);
        transpose(m);
        for (int a = 0; a < W; ++a) out[k + a] = m[a];
    }
    for (; k < n; ++k)
        for (int i = 0; i < W; ++i) out[k][i] = value(i, k);
}

// Inverse masses of the lanes: constant along each, or tables in scratch.
static inline void set_masses(Block &block, const double *const *tables, const double *uniform, Arena &arena) {
    const double *table[W];
    double constant[W];  // where there is no table
    block.uniform_w = true;
    for (int i = 0; i < W; ++i) {
        const int lane = i < block.lanes ? i : 0;
        const bool has_unit = !tables[lane] && uniform[lane] > 0;  // not in a chain of nothing but fixed atoms
        table[i] = tables[lane];
        constant[i] = has_unit ? 1.0 : uniform[lane];
        block.movable[i] = has_unit || tables[lane] ? -1 : 0;
        block.unit[i] = has_unit ? uniform[lane] : 1.0;
        block.uniform_w = block.uniform_w && has_unit;
    }
    block.mass = splat(1.0) / block.unit;
    block.unit_masses = block.uniform_w && !any(reinterpret_cast<mask>(block.mass != splat(1.0)));
    if (block.uniform_w) return;
    vec *w = arena.vecs(block.n + 1);
    bool same = true;
    for (int i = 1; i < W; ++i) same = same && table[i] == table[0] && constant[i] == constant[0] && block.len[i] == block.len[0];
    const auto value = [&](int i, long k) __attribute__((always_inline)) {  // inert bonds past the end: any positive mass
        return k > block.len[i] ? 1.0 : (table[i] ? table[i][k] : constant[i]);
    };
    interleave(table, block.len, 1, block.n + 1, w, value);
    for (int i = 0; i < W; ++i) {
        if (i > 0 && same) {
            block.w3[i] = block.w3[0];
            continue;
        }
        double *const w3 = arena.doubles(3 * (block.n + 1 + W));
        long k = 0;
        for (; table[i] && k + W <= block.len[i] + 1; k += W) {
            const vec x = load(table[i] + k);
            HOL_UNROLL
            for (int j = 0; j < 3; ++j) {
                vec three;
                HOL_UNROLL
                for (int e = 0; e < W; ++e) three[e] = x[(j * W + e) / 3];
                store(w3 + 3 * k + j * W, three);
            }
        }
        for (; k < block.n + 1 + W; ++k) w3[3 * k] = w3[3 * k + 1] = w3[3 * k + 2] = value(i, k);
        block.w3[i] = w3;
    }
    block.w = w;
}

}  // namespace HOL_ISA
}  // namespace holonomic
