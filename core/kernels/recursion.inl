// The recursion without subtractions (theory (9)-(12)): pivots P, multipliers l of the elimination, and the two sweeps.
//
//   E_1 = w_0 q_1,  P_k = E_k + w_k q_k,  E_{k+1} = w_k (q_{k+1} E_k + w_k X_{k+1}) / P_k,  l_{k+1} = w_k g_{k+1} / P_k
//   y_1 = b_1,  y_{k+1} = b_{k+1} + l_{k+1} y_k,  t_N = y_N / P_N,  t_k = y_k / P_k + l_{k+1} t_{k+1}
//
// Here bond k = 0 .. n-1 lies between atoms k and k+1; L[k] is the multiplier of the joint at atom k+1.

namespace holonomic {
namespace HOL_ISA {

template <bool uniform>
HOL_INLINE vec w_at(const Block &block, long k) {
    return uniform ? block.w_uniform : block.w[k];
}

// Whether the joint between bonds k and k+1 is one, in each lane.
HOL_INLINE mask joint(const Block &block, long k) {
    return less(splat(static_cast<double>(k + 1)), block.lengths());
}

// X = |d x d'|^2 of two nearly parallel bonds has a relative error of about 2 eps |d| |d'| / sqrt X from the rounding
// of d, d' and of the cross product. It enters E' = w (q' E + w X) / P, so what E' gets of it is harmless where
//     w sqrt(X q q') <= c (q' E + w X),   c = joint_tolerance,
// and this holds for every X if E >= w q / (4 c^2): the cheap test that ordinary chains pass (docs/performance.md).
constexpr double joint_tolerance = 8;

// Exact form of the test, for the joint k of a block whose pivots are rebuilt from E.
template <bool uniform>
static __attribute__((noinline)) mask doubtful_joints(const Block &block, const vec3 *D, long k0, long n, vec E) {
    mask doubt = none();
    for (long k = k0; k < n && k + 1 < block.n; ++k) {
        const vec w = w_at<uniform>(block, k + 1), q = dot(D[k], D[k]), q1 = dot(D[k + 1], D[k + 1]);
        const vec3 c = cross(D[k], D[k + 1]);
        const vec X = dot(c, c), qq = q * q1, S = mul_add(q1, E, w * X);
        const double eps2 = 4.9e-32;  // (2^-52)^2: an X that vanished by rounding
        const vec left = (w * w) * ((X + eps2 * qq) * qq), right = (joint_tolerance * joint_tolerance) * (S * S);
        doubt = doubt | (~less_equal(left, right) & joint(block, k));
        E = w * S / mul_add(w, q, E);
    }
    return doubt;
}

// Where the bond vectors of a block come from.
struct Source {
    const Packed *r;
    const Box *box;
};

// g = d . d' of nearly orthogonal bonds cancels, and what it loses shows where the right-hand side of one bond is larger
// than its neighbour's by orders of magnitude. Below this cosine g is computed anew from the coordinates: a few in a
// hundred joints of a coil.
constexpr double small_cosine = 1.0 / 32;

HOL_INLINE mask nearly_orthogonal(vec g, vec X) {
    const vec scaled = (1 / small_cosine) * g;
    return less(scaled * scaled, X);  // X = q q' (1 - cos^2)
}

// The lanes in `which` of g, for the joint of bonds k and k+1, with compensated products of unrounded differences.
static __attribute__((noinline)) vec exact_dots(const Source &source, long k, mask which, vec g) {
    const unsigned chosen = bits(which);
    for (int i = 0; i < W; ++i) {
        if (!(chosen >> i & 1)) continue;
        const double *r = source.r->lane[i] + 3 * k;
        Vector3<double> d[2], low[2];
        for (int b = 0; b < 2; ++b, r += 3) {
            const Pair<double> x = two_difference(r[3], r[0]), y = two_difference(r[4], r[1]),
                               z = two_difference(r[5], r[2]);
            d[b] = {x.hi, y.hi, z.hi};
            low[b] = {x.lo, y.lo, z.lo};
            if (source.box->shape != Box::none) wrap<true>(*source.box, d[b], low[b]);
        }
        g[i] = dot_compensated(d[0], low[0], d[1], low[1]);
    }
    return g;
}

// Plain forward sweep: B becomes u = y / P, L the multipliers. Four bonds at a time E is carried as a fraction A / F,
// which takes the divisions out of the chain of dependences. Returns the lanes that need careful arithmetic.
template <bool uniform, bool keep_pivots = false, int fixed = 0>
static inline mask forward(const Block &block, const Source &source, const vec3 *D, vec *B, vec *L,
                           vec *pivots = nullptr) {
    const long n = fixed > 0 ? fixed : block.n, n_min = fixed > 0 ? fixed : block.n_min;  // known to the compiler?
    const double least = 4 * joint_tolerance * joint_tolerance + 1;
    mask doubt = none();
    vec3 d = D[0];
    vec q = dot(d, d), E = w_at<uniform>(block, 0) * q, y = B[0];
    for (long k0 = 0; k0 < n; k0 += 4) {
        vec A = E, F = splat(1.0), rF = {}, slack = {};
        const bool full = k0 + 4 < n && k0 + 4 < n_min;
        const auto bond = [&](long k, bool has_joint, bool ragged) __attribute__((always_inline)) {
            const vec w = w_at<uniform>(block, k + 1);
            const vec F1 = mul_add(w * q, F, A);
            rF = splat(1.0) / F1;
            const vec rP = F * rF;
            B[k] = y * rP;
            if (keep_pivots) pivots[k] = rP;
            if (!has_joint) return;
            const vec3 d1 = D[k + 1];
            const vec q1 = dot(d1, d1);
            const vec3 c = cross(d, d1);
            vec g = dot(d, d1), X = dot(c, c), s = mul_add(splat(least), A, -F1);
            if (ragged) {
                const mask m = joint(block, k);
                g = keep(m, g);
                X = keep(m, X);
                s = keep(m, s);
            }
            const mask orthogonal = nearly_orthogonal(g, X);
            if (__builtin_expect(any(orthogonal), 0)) g = exact_dots(source, k, orthogonal, g);
            const vec l = (w * g) * rP;
            L[k] = l;
            y = mul_add(l, y, B[k + 1]);
            A = mul_add((w * w) * X, F, (w * q1) * A);
            F = F1;
            slack = min(slack, s);
            q = q1;
            d = d1;
        };
        const vec E0 = E;
        if (__builtin_expect(full, 1)) {
            bond(k0, true, false);
            bond(k0 + 1, true, false);
            bond(k0 + 2, true, false);
            bond(k0 + 3, true, false);
        } else {
            for (long k = k0; k < k0 + 4 && k < n; ++k) bond(k, k + 1 < n, k + 1 >= n_min);
        }
        E = A * rF;
        const mask short_of = less(slack, vec{});
        if (__builtin_expect(any(short_of), 0))
            doubt = doubt | (doubtful_joints<uniform>(block, D, k0, k0 + 4, E0) & short_of);
    }
    return doubt;
}

// The same with bond vectors D + D_low and compensated products, a division per bond: right for any chain.
template <bool uniform>
static __attribute__((noinline)) void forward_careful(const Block &block, const vec3 *D, const vec3 *D_low, vec *B,
                                                      vec *L, vec *pivots) {
    const long n = block.n;
    vec q = dot(D[0], D[0]), E = w_at<uniform>(block, 0) * q, y = B[0];
    for (long k = 0; k < n; ++k) {
        const vec w = w_at<uniform>(block, k + 1), P = mul_add(w, q, E);
        B[k] = y / P;
        pivots[k] = splat(1.0) / P;
        if (k + 1 == n) break;
        const vec3 c = cross_compensated(D[k], D_low[k], D[k + 1], D_low[k + 1]);
        vec g = dot_compensated(D[k], D_low[k], D[k + 1], D_low[k + 1]), X = dot(c, c);
        if (k + 1 >= block.n_min) {
            const mask m = joint(block, k);
            g = keep(m, g);
            X = keep(m, X);
        }
        const vec q1 = dot(D[k + 1], D[k + 1]), wP = w / P;
        L[k] = wP * g;
        y = mul_add(L[k], y, B[k + 1]);
        E = wP * mul_add(w, X, q1 * E);
        q = q1;
    }
}

// Backward sweep: u becomes t = 2 lambda.
HOL_INLINE void backward(long n, vec *u, const vec *L) {
    vec t = u[n - 1];
    for (long k = n - 2; k >= 0; --k) {
        t = mul_add(L[k], t, u[k]);
        u[k] = t;
    }
}

// Both sweeps for another right-hand side, with 1 / P and L of an elimination that has been done.
HOL_INLINE void substitute(long n, vec *b, const vec *pivots, const vec *L) {
    vec y = b[0];
    b[0] = y * pivots[0];
    for (long k = 1; k < n; ++k) {
        y = mul_add(L[k - 1], y, b[k]);
        b[k] = y * pivots[k];
    }
    backward(n, b, L);
}

}  // namespace HOL_ISA
}  // namespace holonomic
