// Position level of a block of chains (theory (15)-(19)). With b the bond vectors of the reference positions and D the
// new ones, the corrections w_i (tau_{i+1} b_{i+1} - tau_i b_i) of the atoms must bring every D.D to a^2. Newton's
// Jacobian is tridiagonal and its elimination the one of the forces, with
//     q_k = D_k . b_k,   X_{k+1} = (D_k x D_{k+1}) . (b_k x b_{k+1}).
// The iteration works on D itself, in scratch, so that it reaches the rounding of the bond vectors; the coordinates are
// rounded once, at the end. Chains (lanes) that are done take no more corrections while the rest of the block goes on.

namespace holonomic {
namespace HOL_ISA {

constexpr double epsilon = 2.220446049250313e-16;

// An error at which the iteration has nothing left to gain: a few roundings of D.D - a^2.
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

// Eliminates with the Jacobian at D; only the lanes in `which` take the new factors. Fractions as in forward().
template <bool uniform, bool careful>
static __attribute__((noinline)) void factorize(const Block &block, const Newton &x, mask which) {
    const long n = block.n;
    vec q = dot(x.D[0], x.b[0]), A = w_at<uniform>(block, 0) * q, F = splat(1.0);
    for (long k = 0; k < n; ++k) {
        const vec w = w_at<uniform>(block, k + 1);
        const vec F1 = mul_add(w * q, F, A), rF = splat(1.0) / F1, rP = F * rF;
        x.rP[k] = select(which, rP, x.rP[k]);
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
        x.down[k] = select(which, wP * lower, x.down[k]);
        x.up[k] = select(which, wP * upper, x.up[k]);
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
static inline void substitute(long n, const Newton &x) {
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
// in s.
template <bool uniform>
static inline vec correct(const Block &block, const Newton &x, mask which) {
    const long n = block.n;
    vec worst = {}, poison = {};
    vec s = keep(which, x.s[0]);
    vec3 p = {s * x.b[0].x, s * x.b[0].y, s * x.b[0].z};
    vec w = w_at<uniform>(block, 0);
    vec3 left = {w * p.x, w * p.y, w * p.z};  // displacement of the atom left of bond k
    for (long k = 0; k < n; ++k) {
        x.tau[k] = x.tau[k] + s;
        w = w_at<uniform>(block, k + 1);
        vec3 p1 = {};
        if (k + 1 < n) {
            s = keep(which, x.s[k + 1]);
            const vec3 b = x.b[k + 1];
            p1 = {s * b.x, s * b.y, s * b.z};
        }
        const vec3 right = {w * (p1.x - p.x), w * (p1.y - p.y), w * (p1.z - p.z)};
        vec3 d = x.D[k];
        d = {d.x + (right.x - left.x), d.y + (right.y - left.y), d.z + (right.z - left.z)};
        x.D[k] = d;
        const vec a2 = a2_at(x, k), sigma = dot(d, d) - a2;
        x.s[k] = 0.5 * sigma;
        worst = max(abs(sigma) / a2, worst);
        poison = mul_add(sigma, vec{}, poison);
        p = p1;
        left = right;
    }
    return worst + poison;
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
    vec done = max(splat(call.tolerance), splat(floor_error));
    const vec accepted = max(done, carried);
    out.untouched = less_equal(error, max(splat(call.tolerance), carried)) & wanted;
    out.error = error;
    mask active = wanted & ~out.untouched & finite(error);
    if (guess) {
        for (long k = 0; k < block.n; ++k) {
            x.s[k] = x.tau[k];
            x.tau[k] = vec{};
        }
        error = correct<uniform>(block, x, active);
        const mask helped = less_equal(error, out.error);
        const mask undo = active & ~helped;
        if (any(undo)) {  // back to where these lanes were
            for (long k = 0; k < block.n; ++k) x.s[k] = -x.tau[k];
            error = correct<uniform>(block, x, undo);
        }
        out.converged = active & less_equal(error, done);
        active = active & ~out.converged;
    } else {
        for (long k = 0; k < block.n; ++k) x.tau[k] = vec{};
    }
    mask renew = active;
    for (int i = 0; i < call.max_iterations && any(active); ++i) {
        if (any(renew & active)) factorize<uniform, careful>(block, x, renew & active);
        substitute(block.n, x);
        const vec before = error;
        error = select(active, correct<uniform>(block, x, active), error);
        ++out.solves;
        const mask stalled = less(0.25 * before, error) & less_equal(error, accepted);
        const mask finished = active & (less_equal(error, done) | stalled);
        out.converged = out.converged | finished;
        active = active & ~finished & finite(error);
        // The factors of an earlier D shrink the error by a constant each time; new ones are worth their price where
        // that constant is large.
        const vec rate = error / before;
        renew = careful ? active : active & less(splat(1e-3), rate);
    }
    out.error = error;
    return out;
}

static inline void note_worst(const Block &block, const Newton &x, mask which, vec error, Tally &tally) {
    const unsigned chosen = bits(which);
    for (int i = 0; i < block.lanes; ++i) {
        if (!(chosen >> i & 1)) continue;
        if (!(error[i] > tally.worst || tally.worst_chain < 0 ||
              (error[i] == tally.worst && block.chain[i] < tally.worst_chain)))
            continue;
        tally.worst = error[i];
        tally.worst_chain = block.chain[i];
        double largest = -1;
        for (long k = 0; k < block.len[i]; ++k) {
            const double e = abs(2 * x.s[k][i]) / (x.a2 ? x.a2[k][i] : x.a2_uniform[i]);
            if (e > largest) {
                largest = e;
                tally.worst_bond = k;
            }
        }
    }
}

template <bool uniform>
static void store_positions(const Block &block, const Lane *lane, const PositionsCall &call, const Newton &x,
                            const Outcome &out, const Packed &r, const Packed &v, Arena arena, Tally &tally) {
    const mask done = out.converged | out.untouched;
    if (any(out.converged)) {
        store_pulls<true, uniform>(block, x.b, x.tau, out.converged, add_, r);
        close(call.r, block, lane, out.converged, r, false);
        if (call.v.x) {
            scale_into(block.n, x.tau, 1 / call.dt, x.up);
            store_pulls<true, uniform>(block, x.b, x.up, out.converged, add_, v);
            close(call.v, block, lane, out.converged, v, false);
        }
        if (call.virial) add_virial(block.n, x.b, x.tau, out.converged, 1 / (call.dt * call.dt), tally);
    }
    if (call.lambda) {
        vec *value = arena.vecs(block.n);
        const double factor = 0.5 / (call.dt * call.dt);
        for (long k = 0; k < block.n; ++k) value[k] = keep(out.converged, factor * x.tau[k]);
        store_bonds(block, value, done, call.lambda);
    }
    note_worst(block, x, done, out.error, tally);
    tally.n_corrected += __builtin_popcount(bits(out.converged));
    if (out.solves > tally.iterations) tally.iterations = out.solves;
}

template <bool uniform>
static void load_positions(const Block &block, const PositionsCall &call, const Packed &r_ref, const Packed &r,
                           const Newton &x) {
    const Packed absent = {};
    if (call.box.shape == Box::none) {
        load_bonds<none_, true, false, false>(block, call.box, r_ref, absent, absent, x.b, nullptr, x.s);
        load_bonds<none_, true, false, false>(block, call.box, r, absent, absent, x.D, nullptr, x.s);
    } else {
        load_bonds<none_, true, true, false>(block, call.box, r_ref, absent, absent, x.b, nullptr, x.s);
        load_bonds<none_, true, true, false>(block, call.box, r, absent, absent, x.D, nullptr, x.s);
    }
    if (!call.guess) return;
    const double factor = 2 * call.dt * call.dt;
    for (long k = 0; k < block.n; ++k)
        for (int i = 0; i < W; ++i) {
            const int lane = i < block.lanes ? i : 0;
            x.tau[k][i] = k < block.len[i] ? factor * call.lambda[block.first_bond[lane] + k] : 0.0;
        }
}

template <bool uniform>
static void positions_block_of(const Block &block, const Lane *lane, const PositionsCall &call, Arena arena,
                               Tally &tally) {
    const Packed r_ref = open(call.r_ref, block, lane, arena, true), r = open(call.r, block, lane, arena, true);
    const Packed v = open(call.v, block, lane, arena, true);
    Newton x(block.n, arena);
    set_lengths(block, lane, x, arena);
    // What the coordinates carry: each end of a bond is rounded to u |r|, u = half a unit in the last place.
    const double u = call.r.is_float ? 5.97e-8 : 1.11e-16;
    const vec carried = (8 * u) * (splat(1.0) + extent(block, r) / sqrt(x.a2_min));
    load_positions<uniform>(block, call, r_ref, r, x);
    Outcome out = iterate<uniform, false>(block, x, call, carried, block.in_use(), call.guess);
    store_positions<uniform>(block, lane, call, x, out, r, v, arena, tally);
    mask rest = block.in_use() & ~(out.converged | out.untouched);
    if (__builtin_expect(!any(rest), 1)) return;
    // Once more from the start, with new factors at every step and nothing that can overflow on the way.
    load_positions<uniform>(block, call, r_ref, r, x);
    out = iterate<uniform, true>(block, x, call, carried, rest, false);
    out.untouched = out.untouched & rest;
    store_positions<uniform>(block, lane, call, x, out, r, v, arena, tally);
    rest = rest & ~(out.converged | out.untouched);
    if (any(rest)) note_bad(block, rest, tally);
}

static void positions_block(const Block &block, const Lane *lane, const PositionsCall &call, Arena arena,
                            Tally &tally) {
    if (block.uniform_w)
        positions_block_of<true>(block, lane, call, arena, tally);
    else
        positions_block_of<false>(block, lane, call, arena, tally);
}

static void positions(const PositionsCall &call, const Unit &unit, double *scratch, Tally &tally) {
    for_each_block(call, unit, scratch, tally, positions_block);
}

}  // namespace HOL_ISA
}  // namespace holonomic
