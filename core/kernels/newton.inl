// Newton's method for the positions of a block of chains (theory (15)-(19)). With b the bond vectors of the reference
// positions and D the new ones, the corrections w_i (tau_{i+1} b_{i+1} - tau_i b_i) of the atoms must bring every D.D to
// a^2. Newton's Jacobian is tridiagonal and its elimination the one of the forces, with
//     q_k = D_k . b_k,   X_{k+1} = (D_k x D_{k+1}) . (b_k x b_{k+1}).
// The iteration works on D itself, in scratch, so that it reaches the rounding of the bond vectors; the coordinates are
// rounded once, at the end. Chains (lanes) that are done take no more corrections while the rest of the block goes on.

namespace holonomic {
namespace HOL_ISA {

constexpr double epsilon = 2.220446049250313e-16;

// A few roundings of D.D - a^2: what the iteration leaves at best in a chain of many bonds.
constexpr double floor_error = 4 * epsilon;

struct Newton {
    vec3 *b, *D;
    vec *rP, *down, *up;  // 1 / P and the multipliers of the forward and of the backward sweep
    vec *s, *tau;         // s: (D.D - a^2) / 2, then u, then the correction of tau
    vec a2_uniform, a2_min;
    const vec *a2;        // nullptr: a2_uniform
    Newton(long n, Arena &arena)
        : b(reinterpret_cast<vec3 *>(arena.vecs(3 * n))), D(reinterpret_cast<vec3 *>(arena.vecs(3 * n))),
          rP(arena.vecs(n)), down(arena.vecs(n)), up(arena.vecs(n)), s(arena.vecs(n)), tau(arena.vecs(n)) {}
};

HOL_INLINE vec a2_at(const Newton &x, long k) { return x.a2 ? x.a2[k] : x.a2_uniform; }

static inline void set_lengths(const Block &block, const Lane *lane, Newton &x, Arena &arena) {
    bool uniform = block.n == block.n_min;
    for (int i = 0; i < block.lanes; ++i) uniform = uniform && !lane[i].length;
    for (int i = 0; i < W; ++i) {
        const Lane &one = lane[i < block.lanes ? i : 0];
        x.a2_uniform[i] = one.length_uniform * one.length_uniform;
        x.a2_min[i] = x.a2_uniform[i];
        for (long k = 0; one.length && k < one.n_bonds; ++k)
            x.a2_min[i] = __builtin_fmin(x.a2_min[i], one.length[k] * one.length[k]);
    }
    x.a2 = nullptr;
    if (uniform) return;
    vec *a2 = arena.vecs(block.n);
    for (int i = 0; i < W; ++i) {
        const Lane &one = lane[i < block.lanes ? i : 0];
        for (long k = 0; k < block.n; ++k)
            a2[k][i] = k >= one.n_bonds ? 1.0 : (one.length ? one.length[k] * one.length[k] : x.a2_uniform[i]);
    }
    x.a2 = a2;
}

// Largest |coordinate| of each lane.
static inline vec extent(const Block &block, const Packed &r) {
    vec largest;
    for (int i = 0; i < W; ++i) {
        const long count = 3 * (block.len[i] + 1);
        vec m = {};
        long e = 0;
        for (; e + W <= count; e += W) m = max(m, abs(load(r.lane[i] + e)));
        double x = 0;
        for (int j = 0; j < W; ++j) x = m[j] > x ? m[j] : x;
        for (; e < count; ++e) x = abs(r.lane[i][e]) > x ? abs(r.lane[i][e]) : x;
        largest[i] = x;
    }
    return largest;
}

// The error |D.D - a^2| / a^2 that the coordinates carry: each end of a bond is rounded to u |r|, u = half a unit in the
// last place.
HOL_INLINE vec carried_error(const AtomArray &r, vec largest_coordinate, vec a2_min) {
    const double u = r.is_float ? 5.97e-8 : 1.11e-16;
    return (8 * u) * (splat(1.0) + largest_coordinate / sqrt(a2_min));
}

// s = (D.D - a^2) / 2 of every bond; returns the largest |D.D - a^2| / a^2 per lane.
static inline vec residuals(const Block &block, const Newton &x) {
    vec worst = {}, poison = {};
    for (long k = 0; k < block.n; ++k) {
        const vec a2 = a2_at(x, k), sigma = dot(x.D[k], x.D[k]) - a2;
        x.s[k] = 0.5 * sigma;
        worst = max(abs(sigma) / a2, worst);
        poison = mul_add(sigma, vec{}, poison);  // max() may lose a NaN, a sum keeps it
    }
    return worst + poison;
}

// Eliminates with the Jacobian at D; only the lanes in `which` take the new factors, or all, the first time. Fractions
// as in forward().
template <bool uniform, bool careful, bool all>
static __attribute__((noinline)) void factorize(const Block &block, const Newton &x, mask which) {
    const long n = block.n;
    vec q = dot(x.D[0], x.b[0]), A = w_at<uniform>(block, 0) * q, F = splat(1.0);
    for (long k = 0; k < n; ++k) {
        const vec w = w_at<uniform>(block, k + 1);
        const vec F1 = mul_add(w * q, F, A), rF = splat(1.0) / F1, rP = F * rF;
        x.rP[k] = all ? rP : select(which, rP, x.rP[k]);
        if (k + 1 == n) break;
        const vec q1 = dot(x.D[k + 1], x.b[k + 1]);
        vec lower = dot(x.D[k + 1], x.b[k]), upper = dot(x.D[k], x.b[k + 1]);
        vec X = dot(cross(x.D[k], x.D[k + 1]), cross(x.b[k], x.b[k + 1]));
        if (__builtin_expect(k + 1 >= block.n_min, 0)) {
            const mask m = joint(block, k);
            lower = keep(m, lower);
            upper = keep(m, upper);
            X = keep(m, X);
        }
        const vec wP = w * rP;
        x.down[k] = all ? wP * lower : select(which, wP * lower, x.down[k]);
        x.up[k] = all ? wP * upper : select(which, wP * upper, x.up[k]);
        A = w * mul_add(w * X, F, q1 * A);
        F = F1;
        if (careful || (k & 3) == 3) {
            A = A * rF;
            F = splat(1.0);
        }
        q = q1;
    }
}

// s becomes the correction of tau.
static inline void solve_frozen(long n, const Newton &x) {
    vec y = x.s[0];
    for (long k = 0; k + 1 < n; ++k) {
        x.s[k] = y * x.rP[k];
        y = mul_add(x.down[k], y, x.s[k + 1]);
    }
    vec t = y * x.rP[n - 1];
    x.s[n - 1] = t;
    for (long k = n - 2; k >= 0; --k) {
        t = mul_add(x.up[k], t, x.s[k]);
        x.s[k] = t;
    }
}

// Adds the corrections s of the lanes in `which` to tau and D; returns the new largest error and leaves (D.D - a^2) / 2
// in s. A NaN among the corrections is one in all of them, so that the first tells.
template <bool uniform_w, bool uniform_a>
static inline vec correct_bonds(const Block &block, const Newton &x, mask which) {
    const long n = block.n;
    vec worst = {};
    vec s = keep(which, x.s[0]), w = w_at<uniform_w>(block, 0);
    const vec poison = 0.0 * s;
    vec3 p = {s * x.b[0].x, s * x.b[0].y, s * x.b[0].z};
    vec3 left = {w * p.x, w * p.y, w * p.z};  // displacement of the atom left of bond k
    const auto bond = [&](long k, bool last, bool ragged) __attribute__((always_inline)) {
        x.tau[k] = x.tau[k] + s;
        w = w_at<uniform_w>(block, k + 1);
        vec3 p1 = {};
        if (!last) {
            s = keep(which, x.s[k + 1]);
            const vec3 b = x.b[k + 1];
            p1 = {s * b.x, s * b.y, s * b.z};
        }
        const vec3 right = {w * (p1.x - p.x), w * (p1.y - p.y), w * (p1.z - p.z)};
        vec3 move = {right.x - left.x, right.y - left.y, right.z - left.z};
        if (ragged) {  // inert bonds stay where they are
            const mask live = less(splat(static_cast<double>(k)), block.lengths());
            move = {keep(live, move.x), keep(live, move.y), keep(live, move.z)};
        }
        const vec3 d = {x.D[k].x + move.x, x.D[k].y + move.y, x.D[k].z + move.z};
        x.D[k] = d;
        const vec a2 = uniform_a ? x.a2_uniform : x.a2[k], sigma = dot(d, d) - a2;
        x.s[k] = 0.5 * sigma;
        worst = max(uniform_a ? abs(sigma) : abs(sigma) / a2, worst);
        p = p1;
        left = right;
    };
    const long regular = block.n_min < n ? block.n_min : n - 1;
    long k = 0;
    for (; k < regular; ++k) bond(k, false, false);
    for (; k < n - 1; ++k) bond(k, false, true);
    bond(n - 1, true, block.n_min < n);
    return (uniform_a ? worst / x.a2_uniform : worst) + poison;
}

template <bool uniform>
static inline vec correct(const Block &block, const Newton &x, mask which) {
    return x.a2 ? correct_bonds<uniform, false>(block, x, which) : correct_bonds<uniform, true>(block, x, which);
}

// The factors of an earlier D shrink the error by a constant each time, new ones square it at twice the price: they are
// worth it where the old ones would take more than four solves in all.
HOL_INLINE mask worth_renewing(vec error, vec rate, int i) {
    vec expected = error * rate;
    for (int k = i + 2; k < 4; ++k) expected = expected * rate;
    return less(splat(0.1 * epsilon), expected) & (i < 2 ? ~none() : less(splat(1e-4), rate));
}

struct Outcome {
    mask untouched, converged;
    vec error;
    int64_t solves;
};

// Newton's method on the lanes in `wanted`, from tau = 0 or the caller's guess in tau.
template <bool uniform, bool careful>
static inline Outcome iterate(const Block &block, const Newton &x, const PositionsCall &call, vec carried,
                              mask wanted, bool guess) {
    Outcome out = {};
    vec error = residuals(block, x);
    const vec tolerance = splat(call.tolerance), done = max(tolerance, splat(epsilon));
    const vec accepted = max(tolerance, carried);
    out.untouched = less_equal(error, accepted) & wanted;
    out.error = error;
    mask active = wanted & ~out.untouched & finite(error);
    if (guess) {
        vec poison = {};
        for (long k = 0; k < block.n; ++k) {
            x.s[k] = x.tau[k];
            poison = mul_add(x.tau[k], vec{}, poison);  // a guess may be a NaN anywhere
            x.tau[k] = vec{};
        }
        error = correct<uniform>(block, x, active) + poison;
        active = active & less_equal(error, out.error);  // where it did not help: from zero, in the second attempt
        out.converged = active & less_equal(error, done);
        active = active & ~out.converged;
    } else {
        for (long k = 0; k < block.n; ++k) x.tau[k] = vec{};
    }
    mask renew = active;
    vec rate = error;  // new factors square the error
    for (int i = 0; i < call.max_iterations && any(active); ++i) {
        if (i == 0)
            factorize<uniform, careful, true>(block, x, active);
        else if (any(renew & active))
            factorize<uniform, careful, false>(block, x, renew & active);
        solve_frozen(block.n, x);
        // At the floor: the solve should have gone far below a rounding, or it gained little, and what is left is no
        // more than the coordinates carry.
        const vec before = error, expected = rate * before;
        error = select(active, correct<uniform>(block, x, active), error);
        ++out.solves;
        const mask floor = (less(expected, splat(0.125 * epsilon)) & less_equal(error, splat(floor_error))) |
                           less(0.25 * before, error);
        const mask finished = active & (less_equal(error, done) | (floor & less_equal(error, accepted)));
        out.converged = out.converged | finished;
        active = active & ~finished & finite(error);
        rate = error / before;
        renew = careful ? active : active & worth_renewing(error, rate, i);
        rate = select(renew, error, rate);
    }
    out.error = error;
    return out;
}

// A chain of one bond in closed form: with sigma = D.D - a^2, D - s b has the length a for
// s = sigma / (D.b + sqrt((D.b)^2 - b.b sigma)), and tau = s / (w_0 + w_1).
static inline Outcome solve_single_bonds(const Block &block, const Newton &x, const PositionsCall &call, vec carried,
                                         mask wanted) {
    Outcome out = {};
    const vec3 b = x.b[0], d = x.D[0];
    const vec w = block.uniform_w ? 2 * block.w_uniform : block.w[0] + block.w[1];
    const vec a2 = a2_at(x, 0), sigma = dot(d, d) - a2, db = dot(d, b);
    const vec root = sqrt(mul_add(db, db, -(dot(b, b) * sigma)));  // NaN where the length can't be reached
    const vec s = sigma / (db + select(less(db, vec{}), -root, root));
    const vec error = abs(sigma) / a2;
    out.untouched = less_equal(error, max(splat(call.tolerance), carried)) & wanted;
    out.converged = wanted & ~out.untouched & finite(s / w) & less(vec{}, w);
    const vec step = keep(out.converged, s);
    const vec3 moved = {mul_add(-step, b.x, d.x), mul_add(-step, b.y, d.y), mul_add(-step, b.z, d.z)};
    x.D[0] = {select(wanted, moved.x, d.x), select(wanted, moved.y, d.y), select(wanted, moved.z, d.z)};
    const vec left = dot(x.D[0], x.D[0]) - a2;
    x.s[0] = select(wanted, 0.5 * left, x.s[0]);
    x.tau[0] = select(wanted, keep(out.converged, s / w), x.tau[0]);
    out.error = select(out.converged, abs(left) / a2, error);
    out.solves = any(out.converged) ? 1 : 0;
    return out;
}

// All lanes in `wanted`: chains of one bond in closed form, the others by Newton's method.
template <bool uniform, bool careful>
static inline Outcome solve_positions(const Block &block, const Newton &x, const PositionsCall &call, vec carried,
                                      mask wanted, bool guess) {
    const mask single = wanted & less(block.lengths(), splat(1.5));
    Outcome out = {};
    if (any(wanted & ~single))
        out = iterate<uniform, careful>(block, x, call, carried, wanted & ~single, guess);
    else
        for (long k = 0; k < block.n; ++k) x.tau[k] = vec{};
    if (!any(single)) return out;
    const Outcome one = solve_single_bonds(block, x, call, carried, single);
    out.untouched = out.untouched | one.untouched;
    out.converged = out.converged | one.converged;
    out.error = select(single, one.error, out.error);
    out.solves = one.solves > out.solves ? one.solves : out.solves;
    return out;
}

}  // namespace HOL_ISA
}  // namespace holonomic
