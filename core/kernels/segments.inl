// One long chain, W segments at a time. The first bond of a segment is its separator; the others are eliminated as a
// chain that starts free behind it, and what they leave is carried along with the same pivots (theory (20)-(23)):
//
//     start      f = w g,  a = w^2 X,  c = w q_s,  T = 0            (of the separator and its neighbour)
//     each bond  c' = (a + w q_k c) / P_k,  a' = w (q_{k+1} a + w X_{k+1} c) / P_k,  f' = l f,  T += f u_k
//
// c is what a segment leaves at its left joint, E and y what it leaves at its right one, f the coupling of the two and
// a = E c - f^2. Joining from left to right again adds only what is not negative:
//
//     P^ = E + c,  y^ = y + T,  E' = (E_free E + a) / P^,  y' = y_free + (f / P^) y^,
//     backwards t_s = y^ / P^ + (f / P^) t_s',  inside t_k = u_k + (f / P)_k t_s + l_{k+1} t_{k+1}.

namespace holonomic {
namespace HOL_ISA {

// How a chain is cut. Depends on its length alone, so that results depend on neither threads nor other chains.
struct Cut {
    int64_t blocks, segments, base, extra;  // the first `extra` segments have base + 1 bonds, the others base
    explicit Cut(int64_t n_bonds) {
        const int64_t bonds_per_block = 1024;  // of all lanes: the working arrays of a block stay in cache
        blocks = (n_bonds + bonds_per_block - 1) / bonds_per_block;
        segments = blocks * W;
        base = n_bonds / segments;
        extra = n_bonds % segments;
    }
    int64_t first(int64_t s) const { return s * base + (s < extra ? s : extra); }
    int64_t length(int64_t s) const { return base + (s < extra ? 1 : 0); }
    int64_t longest() const { return base + (extra > 0 ? 1 : 0); }
};

// What the elimination of the inner bonds of W segments leaves, and the solution at their separators.
struct Summary {
    vec E, y, a, c, f, T;
    vec span;   // largest w times the last q: see join()
    vec t, up;  // at the separator: y^ / P^, then t; f / P^
    mask doubt;
};

// The working arrays of W segments.
struct Segments {
    vec3 *D;
    vec *t, *L, *fP;
    Summary *summary;
    static int64_t vectors(int64_t longest) { return 6 * (longest + 1) + static_cast<int64_t>(sizeof(Summary) / sizeof(vec)); }
    Segments(vec3 *bonds, vec *values) : D(bonds), t(values), L(nullptr), fP(nullptr), summary(nullptr) {}
    Segments(double *store, int64_t longest, int64_t block) {
        vec *p = reinterpret_cast<vec *>(store) + block * vectors(longest);
        summary = reinterpret_cast<Summary *>(p);
        p += sizeof(Summary) / sizeof(vec);
        D = reinterpret_cast<vec3 *>(p);
        t = p + 3 * (longest + 1);
        L = t + (longest + 1);
        fP = L + (longest + 1);
    }
};

static int64_t long_bytes(int64_t n_bonds) {
    const Cut cut(n_bonds);
    return cut.blocks * Segments::vectors(cut.longest()) * static_cast<int64_t>(sizeof(vec));
}

// The lanes of block j as chains of their own: len counts the bonds of the segment and the separator that follows.
struct SegmentBlock {
    Block block;
    long own[W], own_min, own_max;  // bonds of each segment
    int64_t from[W];                // its first bond in the chain
    int last;                       // lane of the chain's last segment, or -1
};

static inline SegmentBlock segment_block(const Cut &cut, int64_t j, const Lane &lane) {
    SegmentBlock s;
    s.block.lanes = W;
    s.block.roomy = false;
    s.block.ahead = 0;
    s.block.n = 0;
    s.block.n_min = s.own_min = cut.longest() + 1;
    s.own_max = 0;
    s.last = j == cut.blocks - 1 ? W - 1 : -1;
    for (int i = 0; i < W; ++i) {
        const int64_t segment = j * W + i;
        s.from[i] = cut.first(segment);
        s.own[i] = cut.length(segment);
        s.block.len[i] = s.own[i] + (i == s.last ? 0 : 1);
        s.block.first_bond[i] = lane.first_bond + s.from[i];
        s.block.chain[i] = lane.chain;
        s.own_min = s.own[i] < s.own_min ? s.own[i] : s.own_min;
        s.own_max = s.own[i] > s.own_max ? s.own[i] : s.own_max;
        s.block.n_min = s.block.len[i] < s.block.n_min ? s.block.len[i] : s.block.n_min;
        s.block.n = s.block.len[i] > s.block.n ? s.block.len[i] : s.block.n;
    }
    return s;
}

static inline void set_segment_masses(SegmentBlock &s, const Lane &lane, Arena &arena) {
    const double *tables[W];
    double uniform[W];
    for (int i = 0; i < W; ++i) {
        tables[i] = lane.w ? lane.w + s.from[i] : nullptr;
        uniform[i] = lane.w_uniform;
    }
    set_masses(s.block, tables, uniform, arena);
}

static inline Packed open_segments(const AtomArray &array, const SegmentBlock &s, const Lane &lane, Arena &arena,
                                   bool read) {
    Packed packed = {};
    if (!array.x) return packed;
    double *staging = nullptr;
    if (!in_place(array, lane)) staging = arena.doubles(W * staged_size(s.block.n));
    for (int i = 0; i < W; ++i)
        open_lane(array, lane, s.from[i], s.block.len[i], s.block.n, packed, i, staging, read);
    return packed;
}

HOL_INLINE mask ends_at(const SegmentBlock &s, long k) {
    mask m;
    for (int i = 0; i < W; ++i) m[i] = s.own[i] == k ? -1 : 0;
    return m;
}

// Eliminates the inner bonds of W segments. t holds the right-hand sides, and u afterwards.
template <bool uniform, bool careful>
static __attribute__((noinline)) void eliminate(const SegmentBlock &s, const Source &source, const Segments &x,
                                                const vec3 *D_low) {
    const Block &block = s.block;
    const vec3 *D = x.D;
    const double least = 4 * joint_tolerance * joint_tolerance;
    Summary sum = {};
    vec w = w_at<uniform>(block, 1), q = dot(D[1], D[1]), w_max = w;
    vec X, g;
    if (careful) {
        const vec3 cr = cross_compensated(D[0], D_low[0], D[1], D_low[1]);
        X = dot(cr, cr);
        g = dot_compensated(D[0], D_low[0], D[1], D_low[1]);
    } else {
        const vec3 cr = cross(D[0], D[1]);
        X = dot(cr, cr);
        g = dot(D[0], D[1]);
        const mask orthogonal = nearly_orthogonal(g, X);
        if (any(orthogonal)) g = exact_dots(source, 1, orthogonal, g);
    }
    vec E = w * q, a = (w * w) * X, c = w * dot(D[0], D[0]);
    vec f = w * g, T = {}, y = x.t[1], slack = {}, E0 = E;
    long chunk = 1;
    for (long k = 1; k < s.own_max; ++k) {
        w = w_at<uniform>(block, k + 1);
        const vec wq = w * q, P = E + wq, rP = splat(1.0) / P, u = y * rP;
        x.t[k] = u;
        x.fP[k] = f * rP;
        T = mul_add(f, u, T);
        // In a straight chain c, f and E shrink by the same factor at each bond. They are rounded in the same way, so
        // that their ratios stay exact: segments of equal bonds would all have the same error in them.
        const vec c_before = c;
        c = mul_add(a, rP, (wq * rP) * c);
        if (k + 1 < block.n) {
            const vec3 d = D[k], d1 = D[k + 1];
            const vec q1 = dot(d1, d1);
            vec step = {};
            if (careful) {
                const vec3 cr = cross_compensated(d, D_low[k], d1, D_low[k + 1]);
                X = dot(cr, cr);
                g = dot_compensated(d, D_low[k], d1, D_low[k + 1]);
            } else {
                const vec3 cr = cross(d, d1);
                X = dot(cr, cr);
                g = dot(d, d1);
                step = mul_add(splat(least), E, -wq);
            }
            if (__builtin_expect(k + 1 >= block.n_min, 0)) {
                const mask m = joint(block, k + 1);
                X = keep(m, X);
                g = keep(m, g);
                step = keep(m, step);
            }
            if (!careful) {
                const mask orthogonal = nearly_orthogonal(g, X);
                if (__builtin_expect(any(orthogonal), 0)) g = exact_dots(source, k + 1, orthogonal, g);
            }
            const vec l = (w * g) * rP, lE = (w * q1) * rP, lX = (w * (w * X)) * rP;
            x.L[k] = l;
            y = mul_add(l, y, x.t[k + 1]);
            f = l * f;
            a = mul_add(lE, a, lX * c_before);
            E = mul_add(lE, E, lX);
            slack = min(slack, step);
            if (!uniform) w_max = max(w_max, w);
            q = q1;
        } else {
            E = a = vec{};
        }
        if (k + 1 >= s.own_min) {
            const mask m = ends_at(s, k + 1);
            sum.E = select(m, E, sum.E);
            sum.a = select(m, a, sum.a);
            sum.c = select(m, c, sum.c);
            sum.y = select(m, y, sum.y);
            sum.f = select(m, f, sum.f);
            sum.T = select(m, T, sum.T);
            sum.span = select(m, (uniform ? w : w_max) * q, sum.span);
        }
        if (!careful && ((k & 3) == 0 || k + 1 == s.own_max)) {
            const mask short_of = less(slack, vec{});
            if (__builtin_expect(any(short_of), 0)) {
                sum.doubt = sum.doubt | (doubtful_joints<uniform>(block, D, chunk + 1, k + 2, E0) & short_of);
                slack = vec{};
            }
            E0 = E;
            chunk = k + 1;
        }
    }
    *x.summary = sum;
}

// Loads block j and eliminates its inner bonds.
template <int terms, bool careful, class Call>
static void eliminate_block(const Call &call, const Lane &lane, int64_t j, const AtomArray &r, const AtomArray &v,
                            const AtomArray &f, double *store, Arena arena) {
    const Cut cut(lane.n_bonds);
    const Segments x(store, cut.longest(), j);
    SegmentBlock s = segment_block(cut, j, lane);
    set_segment_masses(s, lane, arena);
    const Packed pr = open_segments(r, s, lane, arena, true), pv = open_segments(v, s, lane, arena, true);
    const Packed pf = open_segments(f, s, lane, arena, true);
    vec3 *D_low = reinterpret_cast<vec3 *>(arena.vecs(3 * s.block.n));
    const bool boxed = call.box.shape != Box::none;
    if (s.block.uniform_w) {
        if (boxed)
            load_bonds<terms, true, true, careful>(s.block, call.box, pr, pv, pf, x.D, D_low, x.t);
        else
            load_bonds<terms, true, false, careful>(s.block, call.box, pr, pv, pf, x.D, D_low, x.t);
        eliminate<true, careful>(s, Source{&pr, &call.box}, x, D_low);
    } else {
        if (boxed)
            load_bonds<terms, false, true, careful>(s.block, call.box, pr, pv, pf, x.D, D_low, x.t);
        else
            load_bonds<terms, false, false, careful>(s.block, call.box, pr, pv, pf, x.D, D_low, x.t);
        eliminate<false, careful>(s, Source{&pr, &call.box}, x, D_low);
    }
}

template <bool careful>
static void eliminate_forces(const ForcesCall &call, const Lane &lane, int64_t j, double *store, Arena arena) {
    constexpr int both = velocity_squared | force_difference;
    if (call.v.x && call.f.x)
        eliminate_block<both, careful>(call, lane, j, call.r, call.v, call.f, store, arena);
    else if (call.f.x)
        eliminate_block<force_difference, careful>(call, lane, j, call.r, call.v, call.f, store, arena);
    else if (call.v.x)
        eliminate_block<velocity_squared, careful>(call, lane, j, call.r, call.v, call.f, store, arena);
    else
        eliminate_block<none_, careful>(call, lane, j, call.r, call.v, call.f, store, arena);
}

static void long_forces_eliminate(const ForcesCall &call, const Lane &lane, int64_t j, bool careful, double *store,
                                  double *scratch) {
    if (careful)
        eliminate_forces<true>(call, lane, j, store, Arena{scratch});
    else
        eliminate_forces<false>(call, lane, j, store, Arena{scratch});
}

static void long_velocities_eliminate(const VelocitiesCall &call, const Lane &lane, int64_t j, bool careful,
                                      double *store, double *scratch) {
    const AtomArray absent = {};
    if (careful)
        eliminate_block<rate, true>(call, lane, j, call.r, call.v, absent, store, Arena{scratch});
    else
        eliminate_block<rate, false>(call, lane, j, call.r, call.v, absent, store, Arena{scratch});
}

// Solves for the separators. `careful` says how the segments were eliminated.
//
// The rounding of the X of nearly parallel bonds reaches E' through a. With a = sum alpha_j X_j, its error is about
// 2 eps sqrt(a sum alpha_j q_j q_{j+1} / n) <= 2 eps sqrt(a w_max q c), because sum alpha_j q_j q_{j+1} <= n w_max q c;
// it is harmless where that is below join_tolerance (E_free E + a).
static JoinResult long_join(const Lane &lane, bool careful, double *store) {
    const double join_tolerance = 8;
    const Cut cut(lane.n_bonds);
    const double w0 = relative_w(lane, 0);
    double E = 0, y = 0;
    for (int64_t j = 0; j < cut.blocks; ++j) {
        const Segments x(store, cut.longest(), j);
        Summary &s = *x.summary;
        if (j == 0) {
            const vec3 d = x.D[0];
            E = w0 * dot(d, d)[0];
            y = x.t[0][0];
        }
        if (!careful && any(s.doubt)) return join_doubtful;
        for (int i = 0; i < W; ++i) {
            const double P = E + s.c[i], yhat = y + s.T[i], S = s.E[i] * E + s.a[i];
            if (!careful && !(4 * s.a[i] * s.span[i] * s.c[i] <= join_tolerance * join_tolerance * S * S))
                return join_doubtful;
            s.t[i] = yhat / P;
            s.up[i] = s.f[i] / P;
            E = S / P;
            y = s.y[i] + s.up[i] * yhat;
        }
    }
    double t = 0;
    for (int64_t j = cut.blocks - 1; j >= 0; --j) {
        Summary &s = *Segments(store, cut.longest(), j).summary;
        for (int i = W - 1; i >= 0; --i) {
            t = j == cut.blocks - 1 && i == W - 1 ? s.t[i] : s.t[i] + s.up[i] * t;
            s.t[i] = t;
            if (!(t - t == 0)) return careful ? join_bad : join_doubtful;
        }
    }
    return join_good;
}

}  // namespace HOL_ISA
}  // namespace holonomic
