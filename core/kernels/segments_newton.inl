// Position level of one long chain in segments: the elimination of segments.inl with the unsymmetric Jacobian of
// newton.inl. f splits into the coupling of the rows to the separator (down) and of the separator to them (up).
//
// An iteration with the factors at hand goes through the blocks once, in any order: `long_positions_step` substitutes
// backward, moves the bonds and substitutes forward what that leaves of their lengths. In between the separators are
// joined. `long_positions_factorize` eliminates anew.

namespace holonomic {
namespace HOL_ISA {

struct NewtonSummary {
    vec E, a, c, down, up;            // what the elimination leaves; `up` starts from
    vec first_up;                     // the coupling of the separator to its neighbour
    vec s, y, T;                      // and the forward substitution; s: right-hand side of the separator
    vec last_u, last_fP, last_up;     // of each segment's last bond
    vec3 last_b;
    vec P, join_down, join_up;        // pivots and multipliers of the separators
    vec t;                            // their corrections
    vec3 last;                        // correction times b of each segment's last bond
    vec error;                        // largest |D.D - a^2| / a^2 of the segment
};

struct NewtonSegments {
    vec3 *b, *D;
    vec *rP, *down, *up, *fP, *s, *tau;
    NewtonSummary *summary;
    static constexpr int64_t head = static_cast<int64_t>(sizeof(NewtonSummary) / sizeof(vec));
    static int64_t vectors(int64_t longest) { return 12 * (longest + 1) + head; }
    NewtonSegments(double *store, int64_t longest, int64_t block) {
        const int64_t n = longest + 1;
        vec *p = reinterpret_cast<vec *>(store) + block * vectors(longest);
        summary = reinterpret_cast<NewtonSummary *>(p);
        p += head;
        b = reinterpret_cast<vec3 *>(p);
        D = reinterpret_cast<vec3 *>(p + 3 * n);
        rP = p + 6 * n;
        down = rP + n;
        up = down + n;
        fP = up + n;
        s = fP + n;
        tau = s + n;
    }
};

static int64_t long_positions_bytes(int64_t n_bonds) {
    const Cut cut(n_bonds);
    return cut.blocks * NewtonSegments::vectors(cut.longest()) * static_cast<int64_t>(sizeof(vec));
}

HOL_INLINE vec a2_of(const SegmentBlock &s, const Lane &lane, long k) {
    if (!lane.length) return splat(lane.length_uniform * lane.length_uniform);
    vec a2;
    for (int i = 0; i < W; ++i) {
        const double a = k < s.own[i] ? lane.length[s.from[i] + k] : 1.0;
        a2[i] = a * a;
    }
    return a2;
}

HOL_INLINE mask owned(const SegmentBlock &s, long k) {
    mask m;
    for (int i = 0; i < W; ++i) m[i] = k < s.own[i] ? -1 : 0;
    return m;
}

HOL_INLINE vec half_excess(const vec3 &d, vec a2) {
    return 0.5 * mul_add(d.z, d.z, mul_add(d.y, d.y, mul_add(d.x, d.x, -a2)));
}

// The largest error of each segment, as the bonds are loaded.
static inline void segment_errors(const SegmentBlock &s, const Lane &lane, const NewtonSegments &x) {
    vec worst = {}, poison = {};
    for (long k = 0; k < s.own_max; ++k) {
        const vec a2 = a2_of(s, lane, k);
        vec sigma = half_excess(x.D[k], a2);
        if (k >= s.own_min) sigma = keep(owned(s, k), sigma);
        if (k == 0) x.summary->s = sigma;
        worst = max(lane.length ? abs(sigma) / a2 : abs(sigma), worst);
        poison = mul_add(sigma + dot(x.D[k], x.b[k]), vec{}, poison);  // reference positions are bad data, too
    }
    x.summary->error = 2.0 * (lane.length ? worst : worst / a2_of(s, lane, 0)) + poison;
    for (int i = 0; i < W; ++i) {
        const long k = s.own[i] - 1;
        x.summary->last_b.x[i] = x.b[k].x[i];
        x.summary->last_b.y[i] = x.b[k].y[i];
        x.summary->last_b.z[i] = x.b[k].z[i];
    }
}

// The value of the next segment's first bond for each lane, from arrays [first bond] of this and the next block.
static inline vec next_of(const vec here, bool has_next, double beyond) {
    vec next;
    for (int i = 0; i + 1 < W; ++i) next[i] = here[i + 1];
    next[W - 1] = has_next ? beyond : 0.0;
    return next;
}

static void long_positions_load(const PositionsCall &call, const Lane &lane, int64_t j, double *store,
                                double *scratch, LongTally &tally) {
    const Cut cut(lane.n_bonds);
    const NewtonSegments x(store, cut.longest(), j);
    SegmentBlock s = segment_block(cut, j, lane);
    Arena arena = {scratch};
    const Packed absent = {}, r_ref = open_segments(call.r_ref, s, lane, arena, true),
                 r = open_segments(call.r, s, lane, arena, true);
    s.block.uniform_w = true;
    if (call.box.shape == Box::none) {
        load_bonds<none_, true, false, false>(s.block, call.box, r_ref, absent, absent, x.b, nullptr, x.s);
        load_bonds<none_, true, false, false>(s.block, call.box, r, absent, absent, x.D, nullptr, x.s);
    } else {
        load_bonds<none_, true, true, false>(s.block, call.box, r_ref, absent, absent, x.b, nullptr, x.s);
        load_bonds<none_, true, true, false>(s.block, call.box, r, absent, absent, x.D, nullptr, x.s);
    }
    *x.summary = NewtonSummary{};
    segment_errors(s, lane, x);
    const double factor = 2 * call.dt * call.dt * unit_of(lane);
    const int64_t end = lane.first_bond + lane.n_bonds;
    for (long k = 0; k < s.block.n; ++k) x.tau[k] = vec{};
    for (long k = 0; call.guess && k < s.block.n; ++k)
        for (int i = 0; i < W; ++i) {
            const int64_t bond = s.block.first_bond[i] + k;
            x.tau[k][i] = call.guess && k < s.block.len[i] && bond < end ? factor * call.lambda[bond] : 0.0;
        }
    const vec largest = extent(s.block, r);
    for (int i = 0; i < W; ++i) {
        tally.extent = largest[i] > tally.extent ? largest[i] : tally.extent;
        const double e = x.summary->error[i];
        tally.error = e > tally.error || e != e ? e : tally.error;
        if (tally.error != tally.error) return;
    }
}

// Starts from the guess in tau: it becomes the first correction.
static void long_positions_guess(const PositionsCall &, const Lane &lane, int64_t j, double *store) {
    const Cut cut(lane.n_bonds);
    const NewtonSegments x(store, cut.longest(), j);
    const SegmentBlock s = segment_block(cut, j, lane);
    for (long k = 0; k < s.block.n; ++k) {
        x.s[k] = x.tau[k];
        x.tau[k] = vec{};
    }
    for (int i = 0; i < W; ++i) {
        const long k = s.own[i] - 1;
        x.summary->last.x[i] = x.s[k][i] * x.b[k].x[i];
        x.summary->last.y[i] = x.s[k][i] * x.b[k].y[i];
        x.summary->last.z[i] = x.s[k][i] * x.b[k].z[i];
    }
}

// Drops a guess in tau.
static void long_positions_forget(const Lane &lane, int64_t j, double *store) {
    const Cut cut(lane.n_bonds);
    const NewtonSegments x(store, cut.longest(), j);
    for (int64_t k = 0; k <= cut.longest(); ++k) x.tau[k] = vec{};
}

template <bool uniform>
static __attribute__((noinline)) void factorize_segments(const SegmentBlock &s, const NewtonSegments &x, bool careful) {
    const Block &block = s.block;
    NewtonSummary sum = *x.summary;
    vec w = w_at<uniform>(block, 1), q = dot(x.D[1], x.b[1]);
    vec A = w * q, F = splat(1.0), c = w * dot(x.D[0], x.b[0]);
    vec a = (w * w) * dot(cross(x.D[0], x.D[1]), cross(x.b[0], x.b[1]));
    vec f_down = w * dot(x.D[1], x.b[0]), f_up = w * dot(x.D[0], x.b[1]);
    sum.first_up = f_up;
    for (long k = 1; k < s.own_max; ++k) {
        w = w_at<uniform>(block, k + 1);
        const vec wq = w * q, F1 = mul_add(wq, F, A), c1 = mul_add(wq, c, a), rF = splat(1.0) / F1, rP = F * rF;
        x.rP[k] = rP;
        x.fP[k] = f_down * rP;
        if (k + 1 < block.n) {
            const vec q1 = dot(x.D[k + 1], x.b[k + 1]);
            vec lower = dot(x.D[k + 1], x.b[k]), upper = dot(x.D[k], x.b[k + 1]);
            // Where the cross products are needed, the first attempt does not converge as it should.
            vec X = careful ? dot(cross(x.D[k], x.D[k + 1]), cross(x.b[k], x.b[k + 1]))
                            : mul_add(q, q1, -(lower * upper));
            if (k + 1 >= block.n_min) {
                const mask m = joint(block, k + 1);
                lower = keep(m, lower);
                upper = keep(m, upper);
                X = keep(m, X);
            }
            const vec wP = w * rP, wX = w * X;
            x.down[k] = wP * lower;
            x.up[k] = wP * upper;
            f_down = x.down[k] * f_down;
            f_up = x.up[k] * f_up;
            A = w * mul_add(wX, F, q1 * A);
            a = w * mul_add(wX, c, q1 * a);
            q = q1;
        } else {
            A = a = vec{};
        }
        F = F1;
        c = c1;
        if (k + 1 >= s.own_min) {
            const mask m = ends_at(s, k + 1);
            sum.E = select(m, A * rF, sum.E);
            sum.a = select(m, a * rF, sum.a);
            sum.c = select(m, c * rF, sum.c);
            sum.down = select(m, f_down, sum.down);
            sum.up = select(m, f_up, sum.up);
        }
        if (careful || (k & 3) == 0) {
            A = A * rF;
            a = a * rF;
            c = c * rF;
            F = splat(1.0);
        }
    }
    *x.summary = sum;
}

// One bond on the way up: u = y / P in place of the right-hand side.
struct Ascent {
    vec y, T, f;
    HOL_INLINE void bond(Ascent &a, const SegmentBlock &s, const NewtonSegments &x, long k, vec sigma, bool ragged) {
        a.y = a.y + sigma;
        const vec u = a.y * x.rP[k];
        x.s[k] = u;
        a.T = mul_add(a.f, u, a.T);
        a.y = x.down[k] * a.y;
        a.f = x.up[k] * a.f;
        if (!ragged) return;
        const mask m = ends_at(s, k + 1);
        NewtonSummary &sum = *x.summary;
        sum.y = select(m, a.y, sum.y);
        sum.T = select(m, a.T, sum.T);
        sum.last_u = select(m, u, sum.last_u);
        sum.last_fP = select(m, x.fP[k], sum.last_fP);
        sum.last_up = select(m, x.up[k], sum.last_up);
    }
};

// Eliminates with the Jacobian at D and substitutes forward. The bond behind each segment is taken from its owner.
static void long_positions_factorize(const PositionsCall &, const Lane &lane, int64_t j, bool careful, double *store,
                                     double *scratch) {
    const Cut cut(lane.n_bonds);
    const NewtonSegments x(store, cut.longest(), j);
    SegmentBlock s = segment_block(cut, j, lane);
    const bool has_next = j + 1 < cut.blocks;
    const NewtonSegments beyond(store, cut.longest(), has_next ? j + 1 : j);
    for (int i = 0; i < W; ++i) {
        const long k = s.own[i];
        if (k >= s.block.n || i == s.last) continue;
        const NewtonSegments &owner = i + 1 < W ? x : beyond;
        const int from = i + 1 < W ? i + 1 : 0;
        x.D[k].x[i] = owner.D[0].x[from];
        x.D[k].y[i] = owner.D[0].y[from];
        x.D[k].z[i] = owner.D[0].z[from];
    }
    Arena arena = {scratch};
    set_segment_masses(s, lane, arena);
    if (s.block.uniform_w)
        factorize_segments<true>(s, x, careful);
    else
        factorize_segments<false>(s, x, careful);
    Ascent a = {vec{}, vec{}, x.summary->first_up};
    for (long k = 1; k < s.own_max; ++k) {
        vec sigma = half_excess(x.D[k], a2_of(s, lane, k));
        if (k >= s.own_min) sigma = keep(owned(s, k), sigma);
        Ascent::bond(a, s, x, k, sigma, k + 1 >= s.own_min);
    }
}

}  // namespace HOL_ISA
}  // namespace holonomic
