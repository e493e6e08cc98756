// Position level of one long chain in segments: the elimination of segments.inl with the unsymmetric Jacobian of
// newton.inl. f splits into the coupling of the rows to the separator (down) and of the separator to them (up).
//
// An iteration goes through the blocks three times, each time in any order: `long_positions_solve` eliminates and
// substitutes forward, `long_positions_substitute` backward, `long_positions_correct` moves the bonds. In between the
// separators are joined.

namespace holonomic {
namespace HOL_ISA {

struct NewtonSummary {
    vec E, a, c, down, up;            // what the elimination leaves; `up` starts from
    vec first_up;                     // the coupling of the separator to its neighbour
    vec y, T;                         // and the forward substitution
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

// s = (D.D - a^2) / 2 of the bonds of each segment, and the largest error.
static inline void segment_residuals(const SegmentBlock &s, const Lane &lane, const NewtonSegments &x) {
    vec worst = {}, poison = {};
    for (long k = 0; k < s.own_max; ++k) {
        const vec a2 = a2_of(s, lane, k);
        vec sigma = dot(x.D[k], x.D[k]) - a2;
        if (k >= s.own_min) sigma = keep(owned(s, k), sigma);
        x.s[k] = 0.5 * sigma;
        worst = max(abs(sigma) / a2, worst);
        poison = mul_add(sigma, vec{}, poison);
    }
    x.summary->error = worst + poison;
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
    segment_residuals(s, lane, x);
    const double factor = 2 * call.dt * call.dt * unit_of(lane);
    const int64_t end = lane.first_bond + lane.n_bonds;
    for (long k = 0; k < s.block.n; ++k)
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
            vec X = dot(cross(x.D[k], x.D[k + 1]), cross(x.b[k], x.b[k + 1]));
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

// Forward substitution inside the segments.
static inline void forward_segments(const SegmentBlock &s, const NewtonSegments &x) {
    vec y = x.s[1], T = {}, f = x.summary->first_up, y_end = {}, T_end = {};
    for (long k = 1; k < s.own_max; ++k) {
        const vec u = y * x.rP[k];
        x.s[k] = u;
        T = mul_add(f, u, T);
        if (k + 1 < s.block.n) {
            y = mul_add(x.down[k], y, x.s[k + 1]);
            f = x.up[k] * f;
        }
        if (k + 1 >= s.own_min) {
            const mask m = ends_at(s, k + 1);
            y_end = select(m, y, y_end);
            T_end = select(m, T, T_end);
        }
    }
    x.summary->y = y_end;
    x.summary->T = T_end;
}

// With `renew`, eliminates with the Jacobian at D; then substitutes forward. The bond behind each segment is taken
// from its owner.
static void long_positions_solve(const PositionsCall &, const Lane &lane, int64_t j, bool renew, bool careful,
                                 double *store, double *scratch) {
    const Cut cut(lane.n_bonds);
    const NewtonSegments x(store, cut.longest(), j);
    SegmentBlock s = segment_block(cut, j, lane);
    const bool has_next = j + 1 < cut.blocks;
    const NewtonSegments beyond(store, cut.longest(), has_next ? j + 1 : j);
    for (int i = 0; i < W; ++i) {
        const long k = s.own[i];
        if (k >= s.block.n) continue;
        if (i == s.last) {
            x.s[k][i] = 0;
            continue;
        }
        const NewtonSegments &owner = i + 1 < W ? x : beyond;
        const int from = i + 1 < W ? i + 1 : 0;
        x.s[k][i] = owner.s[0][from];  // no elimination changes s[0]
        x.D[k].x[i] = owner.D[0].x[from];
        x.D[k].y[i] = owner.D[0].y[from];
        x.D[k].z[i] = owner.D[0].z[from];
    }
    if (renew) {
        Arena arena = {scratch};
        set_segment_masses(s, lane, arena);
        if (s.block.uniform_w)
            factorize_segments<true>(s, x, careful);
        else
            factorize_segments<false>(s, x, careful);
    }
    forward_segments(s, x);
}

// Solves for the separators; false if that gives no finite numbers.
static bool long_positions_join(const Lane &lane, bool renew, double *store) {
    const Cut cut(lane.n_bonds);
    const double w0 = relative_w(lane, 0);
    double E = 0, y = 0;
    for (int64_t j = 0; j < cut.blocks; ++j) {
        const NewtonSegments x(store, cut.longest(), j);
        NewtonSummary &s = *x.summary;
        if (j == 0) E = w0 * dot(x.D[0], x.b[0])[0];
        if (j == 0) y = x.s[0][0];
        for (int i = 0; i < W; ++i) {
                if (renew) {
                const double P = E + s.c[i];
                E = (s.E[i] * E + s.a[i]) / P;
                s.P[i] = P;
                s.join_down[i] = s.down[i] / P;
                s.join_up[i] = s.up[i] / P;
            }
            const double yhat = y + s.T[i];
            s.t[i] = yhat / s.P[i];
            y = s.y[i] + s.join_down[i] * yhat;
        }
    }
    double t = 0;
    for (int64_t j = cut.blocks - 1; j >= 0; --j) {
        NewtonSummary &s = *NewtonSegments(store, cut.longest(), j).summary;
        for (int i = W - 1; i >= 0; --i) {
            t = j == cut.blocks - 1 && i == W - 1 ? s.t[i] : s.t[i] + s.join_up[i] * t;
            s.t[i] = t;
            if (!(t - t == 0)) return false;
        }
    }
    return true;
}

// Backward substitution: s becomes the correction of tau.
static void long_positions_substitute(const PositionsCall &, const Lane &lane, int64_t j, double *store) {
    const Cut cut(lane.n_bonds);
    const NewtonSegments x(store, cut.longest(), j);
    const SegmentBlock s = segment_block(cut, j, lane);
    const vec ts = x.summary->t;
    const bool has_next = j + 1 < cut.blocks;
    const vec next =
        next_of(ts, has_next, has_next ? NewtonSegments(store, cut.longest(), j + 1).summary->t[0] : 0.0);
    if (s.own_max < s.block.n) x.s[s.own_max] = keep(ends_at(s, s.own_max), next);
    vec t = next;
    for (long k = s.own_max - 1; k >= 1; --k) {
        t = mul_add(x.fP[k], ts, mul_add(x.up[k], t, x.s[k]));
        if (k >= s.own_min) t = select(ends_at(s, k), next, t);
        x.s[k] = t;
    }
    x.s[0] = ts;
    if (s.last >= 0)
        for (long k = s.own[s.last]; k < s.block.n; ++k) x.s[k][s.last] = 0;
    for (int i = 0; i < W; ++i) {
        const long k = s.own[i] - 1;
        x.summary->last.x[i] = x.s[k][i] * x.b[k].x[i];
        x.summary->last.y[i] = x.s[k][i] * x.b[k].y[i];
        x.summary->last.z[i] = x.s[k][i] * x.b[k].z[i];
    }
}

template <bool uniform>
static inline void correct_segments(const SegmentBlock &s, const NewtonSegments &x, const vec3 &previous) {
    vec c = x.s[0];
    vec3 p = {c * x.b[0].x, c * x.b[0].y, c * x.b[0].z};
    vec w = w_at<uniform>(s.block, 0);
    vec3 left = {w * (p.x - previous.x), w * (p.y - previous.y), w * (p.z - previous.z)};
    for (long k = 0; k < s.own_max; ++k) {
        x.tau[k] = x.tau[k] + c;
        w = w_at<uniform>(s.block, k + 1);
        vec3 p1 = {};
        if (k + 1 < s.block.n) {
            c = x.s[k + 1];
            p1 = {c * x.b[k + 1].x, c * x.b[k + 1].y, c * x.b[k + 1].z};
        }
        const vec3 right = {w * (p1.x - p.x), w * (p1.y - p.y), w * (p1.z - p.z)};
        vec3 &d = x.D[k];
        d = {d.x + (right.x - left.x), d.y + (right.y - left.y), d.z + (right.z - left.z)};
        p = p1;
        left = right;
    }
    if (s.own_max < s.block.n) x.tau[s.own_max] = x.tau[s.own_max] + c;
}

// Moves the bonds by the corrections in s and finds the new residuals; returns the largest error of the block.
static double long_positions_correct(const PositionsCall &, const Lane &lane, int64_t j, double *store,
                                     double *scratch) {
    const Cut cut(lane.n_bonds);
    const NewtonSegments x(store, cut.longest(), j);
    SegmentBlock s = segment_block(cut, j, lane);
    Arena arena = {scratch};
    set_segment_masses(s, lane, arena);
    const vec3 last = x.summary->last;
    vec3 previous = {};
    if (j > 0) {
        const vec3 before = NewtonSegments(store, cut.longest(), j - 1).summary->last;
        previous.x[0] = before.x[W - 1];
        previous.y[0] = before.y[W - 1];
        previous.z[0] = before.z[W - 1];
    }
    for (int i = 1; i < W; ++i) {
        previous.x[i] = last.x[i - 1];
        previous.y[i] = last.y[i - 1];
        previous.z[i] = last.z[i - 1];
    }
    if (s.block.uniform_w)
        correct_segments<true>(s, x, previous);
    else
        correct_segments<false>(s, x, previous);
    segment_residuals(s, lane, x);
    double worst = 0;
    for (int i = 0; i < W; ++i) {
        const double e = x.summary->error[i];
        if (e != e) return e;
        worst = e > worst ? e : worst;
    }
    return worst;
}

}  // namespace HOL_ISA
}  // namespace holonomic
