// The recursion without subtractions (theory (9)-(12)): pivots P, multipliers l of the elimination, and the two sweeps.
//
//   E_1 = w_0 q_1,  P_k = E_k + w_k q_k,  E_{k+1} = w_k (q_{k+1} E_k + w_k X_{k+1}) / P_k,  l_{k+1} = w_k g_{k+1} / P_k
//   y_1 = b_1,  y_{k+1} = b_{k+1} + l_{k+1} y_k,  t_N = y_N / P_N,  t_k = y_k / P_k + l_{k+1} t_{k+1}
//
// Here bond k = 0 .. n-1 lies between atoms k and k+1; joint k is the one between bonds k-1 and k, at atom k, and L[k] its
// multiplier. Inverse masses are in the lane's unit; with equal ones, t is unit * 2 lambda for a right-hand side as it
// is, and 2 lambda for one that has been divided by the unit.

namespace holonomic {
namespace HOL_ISA {

// Inverse mass of atom k in the lane's unit.
template <bool uniform>
HOL_INLINE vec w_at(const Block &block, long k) {
    return uniform ? splat(1.0) : block.w[k];
}

// Whether bonds k-1 and k are both there, in each lane.
HOL_INLINE mask joint(const Block &block, long k) { return less(splat(static_cast<double>(k)), block.lengths()); }

// Interleaved working arrays of a linear solve.
struct System {
    vec3 *D, *D_low;
    vec *t, *L;   // t: right-hand side, then u = y / P, then the solution; L[0 .. n]: L[0] and L[n] are of no joint
    vec *pivots;  // 1 / P
    System(long n, Arena &arena)
        : D(reinterpret_cast<vec3 *>(arena.vecs(3 * n))), D_low(reinterpret_cast<vec3 *>(arena.vecs(3 * n))),
          t(arena.vecs(n)), L(arena.vecs(n + 1)), pivots(arena.vecs(n)) {}
    System(vec3 *bonds, vec *values, vec *multipliers, vec *reciprocals)
        : D(bonds), D_low(nullptr), t(values), L(multipliers), pivots(reciprocals) {}
};

// How X = |d x d'|^2 is found. It enters E' = w (q' E + w X) / P, and what its error does to E' depends on E: with
// e = E / (w q),
//  - q q' - g^2 has an error of a few roundings of q q', of which E' gets a few / (e + sin^2): ordinary chains, in which
//    e >= least_remainder everywhere but in a row of nearly parallel bonds;
//  - the cross product has a relative error of about 2 eps |d| |d'| / sqrt X from the rounding of d and d', which is
//    harmless where w sqrt(X q q') <= c (q' E + w X), c = joint_tolerance. This holds for every X if e >= 1 / (4 c^2);
//  - else the chain needs compensated products of the unrounded bond vectors.
// The tests are cheap to hot: one multiply-add for the first, one more where it fails, the full one where that fails
// (docs/performance.md).
constexpr double least_remainder = 1.0 / 4;
constexpr double joint_tolerance = 8;

// Exact form of the test, for the joints first .. end-1; E is that of bond first-1.
template <bool uniform>
static __attribute__((noinline)) mask doubtful_joints(const Block &block, const vec3 *D, long first, long end, vec E) {
    mask doubt = none();
    for (long k = first; k < end && k < block.n; ++k) {
        const vec w = w_at<uniform>(block, k), q = dot(D[k - 1], D[k - 1]), q1 = dot(D[k], D[k]);
        const vec3 c = cross(D[k - 1], D[k]);
        const vec X = dot(c, c), qq = q * q1, S = mul_add(q1, E, w * X);
        const double eps2 = 4.9e-32;  // (2^-52)^2: an X that vanished by rounding
        const vec left = (w * w) * ((X + eps2 * qq) * qq), right = (joint_tolerance * joint_tolerance) * (S * S);
        doubt = doubt | (~less_equal(left, right) & joint(block, k));
        E = w * S / mul_add(w, q, E);
    }
    return doubt;
}

// Up to this size of |u|, q, 1 / P and w nothing overflows behind the forward sweep, and no product of pivots within it
// has lost digits by underflow.
constexpr double largest_calm = 1e60;

// Lanes in which pivots are extreme, whatever the right-hand sides are: the arithmetic must not depend on their unit.
template <bool uniform>
static __attribute__((noinline)) mask extreme_pivots(const Block &block, const vec3 *D) {
    vec q = dot(D[0], D[0]), E = w_at<uniform>(block, 0) * q, size = {};
    for (long k = 0; k < block.n; ++k) {
        const vec w = w_at<uniform>(block, k + 1), P = mul_add(w, q, E);
        size = size + ((q + splat(1.0) / P) + w);
        if (k + 1 == block.n) break;
        const vec3 c = cross(D[k], D[k + 1]);
        q = dot(D[k + 1], D[k + 1]);
        E = w * mul_add(q, E, w * keep(joint(block, k + 1), dot(c, c))) / P;
    }
    return ~less(size, splat(largest_calm));
}

// Where the bond vectors of a block come from: lanes of coordinates, or lists of atoms in the array `base`.
struct Source {
    const Packed *r;
    const double *base;
    const int64_t *const *atoms;
    const Box *box;
    const long *len;  // of lanes that may end before the joints that are asked for; or nullptr
    const double *atom(int lane, long k) const {
        return atoms ? base + 3 * atoms[lane][k] : r->lane[lane] + 3 * k;
    }
};

// g = d . d' of nearly orthogonal bonds cancels, and what it loses shows where the right-hand side of one bond is larger
// than its neighbour's by orders of magnitude. Below this cosine g is computed anew from the coordinates: a few in a
// hundred joints of a coil.
constexpr double small_cosine = 1.0 / 32;

// Its sign bit is set where |cos| is below that; X = q q' (1 - cos^2).
HOL_INLINE vec not_orthogonal(vec g2, vec X) {
    return mul_sub(splat(1 / (small_cosine * small_cosine)), g2, X);
}

HOL_INLINE mask nearly_orthogonal(vec g, vec X) { return less(not_orthogonal(g * g, X), vec{}); }

// The sum of three numbers and their low words, as if in twice the precision.
template <class Three>
HOL_INLINE double sum_compensated(const Three &hi, const Three &lo) {
    const Pair<double> s = two_sum<double>(hi[0], hi[1]), t = two_sum<double>(s.hi, hi[2]);
    return t.hi + ((t.lo + s.lo) + ((lo[0] + lo[1]) + lo[2]));
}

// g of joint k in one lane, with compensated products of unrounded differences.
#if HOL_LANES != 4
static __attribute__((noinline)) double exact_dot(const Source &source, int lane, long k) {
    Vector3<double> d[2], low[2];
    for (int b = 0; b < 2; ++b)
        unrounded_bond(*source.box, source.atom(lane, k - 1 + b), source.atom(lane, k + b), d[b], low[b]);
    const Pair<double> x = two_product(d[0].x, d[1].x), y = two_product(d[0].y, d[1].y), z = two_product(d[0].z, d[1].z);
    const double hi[3] = {x.hi, y.hi, z.hi};
    const double lo[3] = {mul_add(d[0].x, low[1].x, mul_add(low[0].x, d[1].x, x.lo)),
                          mul_add(d[0].y, low[1].y, mul_add(low[0].y, d[1].y, y.lo)),
                          mul_add(d[0].z, low[1].z, mul_add(low[0].z, d[1].z, z.lo))};
    return sum_compensated(hi, lo);
}
#else
// From the coordinates of the three atoms: x, y and z at once.
HOL_INLINE Pair<vec> unrounded_bond(const Box &box, vec from, vec to) {
    Pair<vec> d = two_difference<vec>(to, from);
    if (box.shape == Box::none) return d;
    const double *const h = box.h, *const in = box.inverse;
    const vec n = round(d.hi[0] * vec{in[0], in[1], in[2], 0} + d.hi[1] * vec{in[3], in[4], in[5], 0} +
                        d.hi[2] * vec{in[6], in[7], in[8], 0});
    for (int i = 0; i < 3; ++i) {
        const Pair<vec> p = two_product<vec>(splat(n[i]), vec{h[3 * i], h[3 * i + 1], h[3 * i + 2], 0});
        const Pair<vec> s = two_difference<vec>(d.hi, p.hi);
        d = fast_two_sum<vec>(s.hi, s.lo - p.lo + d.lo);
    }
    return d;
}

HOL_INLINE double exact_dot(const Box &box, const double *p0, const double *p1, const double *p2) {
    const vec r0 = {p0[0], p0[1], p0[2], 0}, r1 = {p1[0], p1[1], p1[2], 0}, r2 = {p2[0], p2[1], p2[2], 0};
    const Pair<vec> a = unrounded_bond(box, r0, r1), b = unrounded_bond(box, r1, r2), hi = two_product<vec>(a.hi, b.hi);
    return sum_compensated(hi.hi, mul_add(a.hi, b.lo, mul_add(a.lo, b.hi, hi.lo)));
}
#endif

// The lanes in `which` of g, for joint k.
static __attribute__((noinline)) vec exact_dots(const Source &source, long k, mask which, vec g) {
    for (unsigned left = bits(which); left; left &= left - 1) {
        const int i = __builtin_ctz(left);
        if (source.len && k >= source.len[i]) continue;
#if HOL_LANES == 4
        g[i] = exact_dot(*source.box, source.atom(i, k - 1), source.atom(i, k), source.atom(i, k + 1));
#else
        g[i] = exact_dot(source, i, k);
#endif
    }
    return g;
}

// Plain forward sweep, a bond at a time: turns right-hand sides into u = y / P and keeps the multipliers. Within four
// bonds E is carried as a fraction A / F, which takes the divisions out of the chain of dependences.
template <bool uniform, bool keep_pivots>
struct Sweep {
    const Block &block;
    const Source &source;
    const System s;
    vec3 d = {};                                           // the bond before
    vec q = {};
    vec A = splat(1.0), F = {}, F1 = {}, rF = splat(1.0);  // E = A / F and P = F1 / F of the bond before
    vec rP = {}, y = {};
    vec slack = {};                                        // negative where the cheap tests failed
    // Sum of |u|, q, 1 / P and w; without |u| where pivots are kept for a second solve, whose end shows an overflow.
    vec size = {};

    inline __attribute__((always_inline)) void step(long k, vec b, bool starts_group, bool ragged) {
        const vec w = w_at<uniform>(block, k), w1 = w_at<uniform>(block, k + 1);
        const vec3 d1 = s.D[k];
        const vec q1 = dot(d1, d1);
        if (__builtin_constant_p(k) && k == 0) {  // what the rest comes to without a bond before
            y = b + 0.0;
            A = w * q1;
            F = splat(1.0);
            return finish_step(k, d1, q1, w1, true);
        }
        vec g = dot(d, d1), g2 = g * g, X = q * q1 - g2;
        if (ragged) {
            const mask m = joint(block, k);
            g = keep(m, g);
            g2 = keep(m, g2);
            X = keep(m, X);
        }
        const vec remainder = mul_sub(splat(1 + 1 / least_remainder), A, F1);
        const mask signs = as_mask(not_orthogonal(g2, X)) | as_mask(remainder);
        if (__builtin_expect(any(signs), 0)) delicate_joint(k, d1, remainder, ragged, g, X);
        const vec l = (w * g) * rP;
        s.L[k] = l;
        y = mul_add(l, y, b);
        A = mul_add(w * q1, A, ((w * w) * X) * F);
        F = F1;
        if (starts_group) {
            A = A * rF;
            F = splat(1.0);
        }
        finish_step(k, d1, q1, w1, starts_group);
    }

    inline __attribute__((always_inline)) void finish_step(long k, const vec3 &d1, vec q1, vec w1, bool starts_group) {
        F1 = starts_group ? w1 * q1 + A : mul_add(w1 * q1, F, A);
        rF = splat(1.0) / F1;
        rP = starts_group ? rF : F * rF;
        const vec u = y * rP;
        s.t[k] = u;
        if (keep_pivots) s.pivots[k] = rP;
        size = size + (keep_pivots ? q1 + rP : (abs(u) + q1) + rP);
        if (!uniform) size = size + w1;
        d = d1;
        q = q1;
    }

    // A joint of nearly orthogonal bonds, or one before which little of E is left.
    inline __attribute__((always_inline)) void delicate_joint(long k, const vec3 &d1, vec remainder, bool ragged, vec &g,
                                                              vec &X) {
        mask little = less(remainder, vec{});
        if (ragged) little = little & joint(block, k);
        if (any(little)) {
            const vec3 c = cross(d, d1);
            X = select(little, dot(c, c), X);
            const vec spare = mul_sub(splat(1 + 4 * joint_tolerance * joint_tolerance), A, F1);
            slack = min(slack, keep(little, spare));
        }
        const mask orthogonal = nearly_orthogonal(g, X);
        if (any(orthogonal)) g = exact_dots(source, k, orthogonal, g);
    }

    // Lanes in which the backward sweep can't overflow: |t_k| |d_k| <= sum_j |u_j| |d_j|, because |l_k| |d_{k-1}| <= |d_k|,
    // and |t_k| <= |u_k| + |l_{k+1} t_{k+1}|, |l_{k+1}| <= w |d_k| |d_{k+1}| / P_k. Nor have the products of five pivots
    // that make up A lost digits by underflow.
    mask calm() const { return less(size, splat(largest_calm)); }
    // Lanes that need careful arithmetic.
    mask doubt() const {
        const mask failed = less(slack, vec{}), wild = ~calm();
        if (__builtin_expect(!any(failed | wild), 1)) return none();
        const mask doubtful =
            doubtful_joints<uniform>(block, s.D, 1, block.n, w_at<uniform>(block, 0) * dot(s.D[0], s.D[0])) & failed;
        return any(wild) ? doubtful | (extreme_pivots<uniform>(block, s.D) & wild) : doubtful;
    }
};

// Products of two pivots underflow where their reciprocals are not below this.
constexpr double largest_reciprocal = 1e140;

// The same with bond vectors D + D_low and compensated products, a division per bond: right for any chain whose numbers
// don't overflow or underflow; u_0 is NaN where they do.
template <bool uniform>
static __attribute__((noinline)) void forward_careful(const Block &block, const System &s) {
    const long n = block.n;
    vec size = {};
    vec q = dot(s.D[0], s.D[0]), E = w_at<uniform>(block, 0) * q, y = s.t[0];
    for (long k = 0; k < n; ++k) {
        const vec w = w_at<uniform>(block, k + 1), P = mul_add(w, q, E);
        s.t[k] = y / P;
        s.pivots[k] = splat(1.0) / P;
        size = size + s.pivots[k];
        if (k + 1 == n) break;
        const vec3 c = cross_compensated(s.D[k], s.D_low[k], s.D[k + 1], s.D_low[k + 1]);
        vec g = dot_compensated(s.D[k], s.D_low[k], s.D[k + 1], s.D_low[k + 1]), X = dot(c, c);
        if (k + 1 >= block.n_min) {
            const mask m = joint(block, k + 1);
            g = keep(m, g);
            X = keep(m, X);
        }
        const vec q1 = dot(s.D[k + 1], s.D[k + 1]), wP = w / P;
        s.L[k + 1] = wP * g;
        y = mul_add(s.L[k + 1], y, s.t[k + 1]);
        E = wP * mul_add(w, X, q1 * E);
        q = q1;
    }
    s.t[0] = select(less(size, splat(largest_reciprocal)), s.t[0], splat(__builtin_nan("")));
}

// Backward sweep over the bonds from .. n-1: u becomes t. The last one is added to zero as all others are to something,
// so that a chain's zeros have the same sign whether or not inert bonds follow it.
HOL_INLINE void backward(long from, long n, vec *u, const vec *L) {
    vec t = u[n - 1] + 0.0;
    u[n - 1] = t;
    for (long k = n - 2; k >= from; --k) {
        t = mul_add(L[k + 1], t, u[k]);
        u[k] = t;
    }
}

// The forward sweep for another right-hand side, with 1 / P and L of an elimination that has been done.
HOL_INLINE void substitute(long n, const System &s) {
    vec y = s.t[0];
    s.t[0] = y * s.pivots[0];
#pragma GCC unroll 4
    for (long k = 1; k < n; ++k) {
        y = mul_add(s.L[k], y, s.t[k]);
        s.t[k] = y * s.pivots[k];
    }
}

}  // namespace HOL_ISA
}  // namespace holonomic
