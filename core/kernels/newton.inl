// Newton's method for the positions of a block of chains (theory (15)-(19)). With b the bond vectors of the reference
// positions and D the new ones, the corrections w_i (tau_{i+1} b_{i+1} - tau_i b_i) of the atoms must bring every D.D to
// a^2. Newton's Jacobian is tridiagonal and its elimination the one of the forces, with
//     q_k = D_k . b_k,   X_{k+1} = (D_k x D_{k+1}) . (b_k x b_{k+1}) = q_k q_{k+1} - (D_{k+1} . b_k) (D_k . b_{k+1}).
// The bonds are moved from D, in scratch, by all corrections so far: each step is one sweep up the chain, which moves the
// bonds, finds what is left of D.D - a^2 and substitutes forward at once, and one sweep down. The coordinates are rounded
// once, at the end. Chains (lanes) that are done take no more corrections while the rest of the block goes on.

namespace holonomic {
namespace HOL_ISA {

constexpr double epsilon = 2.220446049250313e-16;

// A few roundings of D.D - a^2: what the iteration leaves at best in a chain of many bonds.
constexpr double floor_error = 4 * epsilon;

// The factors of a bond's row: what it gets of the row before on the way up, 1 / (2 P), what it gets of the row behind on
// the way down; and y / (2 P).
struct Row {
    vec down, half_rP, up, u;
};

struct Newton {
    vec3 *b, *D;  // [n+1]: behind the last bond is one of length 0, whose multiplier is 0
    Row *row;
    vec *tau;         // [n+1], times `unit`
    vec *correction;  // [n+1], the last one
    vec *step;        // what D has not been moved by yet: tau, or the last correction
    const vec *w;     // [n+1] inverse masses, those of the block; not if all are 1
    const vec *a2;    // nullptr: a2_uniform
    vec a2_uniform, a_min, a_max;
    Newton(long n, Arena &arena)
        : b(reinterpret_cast<vec3 *>(arena.vecs(3 * (n + 1)))), D(reinterpret_cast<vec3 *>(arena.vecs(3 * (n + 1)))),
          row(reinterpret_cast<Row *>(arena.vecs(4 * n))), tau(arena.vecs(n + 1)), correction(arena.vecs(n + 1)),
          step(tau) {
        b[n] = vec3{};
        tau[n] = correction[n] = vec{};
    }
};

template <bool uniform_w>
HOL_INLINE vec times_w(const Newton &x, long k, vec a) {
    return uniform_w ? a : x.w[k] * a;
}

template <bool uniform_w>
HOL_INLINE vec3 times_w(const Newton &x, long k, const vec3 &a) {
    return {times_w<uniform_w>(x, k, a.x), times_w<uniform_w>(x, k, a.y), times_w<uniform_w>(x, k, a.z)};
}

HOL_INLINE vec3 times(vec s, const vec3 &a) { return {s * a.x, s * a.y, s * a.z}; }
HOL_INLINE vec3 minus(const vec3 &a, const vec3 &b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
HOL_INLINE vec3 plus(const vec3 &a, const vec3 &b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }

HOL_INLINE mask live(const Block &block, long k) { return less(splat(static_cast<double>(k)), block.lengths()); }

// Calls body(k, ragged) for the bonds of a block upwards, two at a time where all lanes have them; `fixed` bonds, if that
// is known to the compiler, one by one.
template <int fixed, int k = 0, class Body>
HOL_INLINE void go_up(const Block &block, const Body &body) {
    if constexpr (fixed > 0) {
        body(k, false);
        if constexpr (k + 1 < fixed) go_up<fixed, k + 1>(block, body);
    } else {
        long i = 0;
        for (; i + 2 <= block.n_min; i += 2) {
            body(i, false);
            body(i + 1, false);
        }
        for (; i < block.n; ++i) body(i, true);
    }
}

template <int fixed, int k = fixed - 1, class Body>
HOL_INLINE void go_down(const Block &block, const Body &body) {
    if constexpr (fixed > 0) {
        body(k);
        if constexpr (k > 0) go_down<fixed, k - 1>(block, body);
    } else {
        long i = block.n - 1;
        for (; i >= 3; i -= 4) {
            body(i);
            body(i - 1);
            body(i - 2);
            body(i - 3);
        }
        for (; i >= 0; --i) body(i);
    }
}

// The bond vectors as the corrections `step` have moved them, one after the other.
template <bool uniform_w>
struct Mover {
    vec3 pull, left;  // of the last bond, and the displacement of the atom behind it
    HOL_INLINE Mover start(const Newton &x) {
        const vec3 p = times(x.step[0], x.b[0]);
        return {p, times_w<uniform_w>(x, 0, p)};
    }
    HOL_INLINE vec3 bond(Mover &m, const Newton &x, long k) {
        const vec3 p = times(x.step[k + 1], x.b[k + 1]), right = times_w<uniform_w>(x, k + 1, minus(p, m.pull));
        const vec3 d = plus(x.D[k], minus(right, m.left));
        m = {p, right};
        return d;
    }
};

// D.D - a^2 of bond k, and its largest size, relative to a^2 if that differs among the bonds.
template <bool uniform_a>
HOL_INLINE vec length_error(const Block &block, const Newton &x, long k, bool ragged, const vec3 &d, vec &worst) {
    const vec a2 = uniform_a ? x.a2_uniform : x.a2[k];
    vec sigma = mul_add(d.z, d.z, mul_add(d.y, d.y, mul_add(d.x, d.x, -a2)));
    if (ragged) sigma = keep(live(block, k), sigma);
    worst = max(uniform_a ? abs(sigma) : abs(sigma) / a2, worst);
    return sigma;
}

// Largest |D.D - a^2| / a^2; max() may lose a NaN, the sum y over all bonds keeps it.
template <bool uniform_a>
HOL_INLINE vec largest_error(const Newton &x, vec worst, vec y) {
    return mul_add(y, vec{}, uniform_a ? worst / x.a2_uniform : worst);
}

enum Factors { first_factors, renewed_factors, careful_factors };

// Eliminates with the Jacobian at D and substitutes forward; returns the largest error. first_factors: of D as loaded, in
// all lanes; renewed_factors: of D as moved by the corrections so far, in the lanes in `which`; careful_factors: of D as
// it stands, in the lanes in `which`, with a division per bond and nothing that cancels. Fractions as in forward().
template <bool uniform_w, bool uniform_a, Factors factors, int fixed = 0>
HOL_INLINE vec eliminate(const Block &block, const Newton &x, mask which) {
    constexpr bool moved = factors == renewed_factors, all = factors == first_factors,
                   careful = factors == careful_factors;
    const long n = fixed > 0 ? fixed : block.n;
    Mover<uniform_w> mover = {};
    if (moved) mover = Mover<uniform_w>::start(x);
    vec3 d = moved ? Mover<uniform_w>::bond(mover, x, 0) : x.D[0];
    vec worst = {}, y = {}, down = {}, q = dot(d, x.b[0]), A = times_w<uniform_w>(x, 0, q), F = splat(1.0);
    const auto bond = [&](long k, bool ragged) __attribute__((always_inline)) {
        Row &row = x.row[k];
        const vec F1 = mul_add(times_w<uniform_w>(x, k + 1, q), F, A), rF = splat(1.0) / F1, rP = F * rF;
        row.half_rP = all ? 0.5 * rP : select(which, 0.5 * rP, row.half_rP);
        row.down = down = all ? down : select(which, down, row.down);
        y = mul_add(down, y, length_error<uniform_a>(block, x, k, ragged, moved ? d : x.D[k], worst));
        row.u = y * row.half_rP;
        if (k + 1 == n) {
            row.up = vec{};
            return;
        }
        const vec3 d1 = moved ? Mover<uniform_w>::bond(mover, x, k + 1) : x.D[k + 1], b1 = x.b[k + 1];
        if (!moved) d = x.D[k];
        const vec q1 = dot(d1, b1);
        vec lower = dot(d1, x.b[k]), upper = dot(b1, d);
        vec X = careful ? dot(cross(d, d1), cross(x.b[k], b1)) : mul_add(q, q1, -(lower * upper));
        if (ragged) {
            const mask m = joint(block, k + 1);
            lower = keep(m, lower);
            upper = keep(m, upper);
            X = keep(m, X);
        }
        const vec wP = times_w<uniform_w>(x, k + 1, rP), up = wP * upper;
        row.up = all ? up : select(which, up, row.up);
        down = wP * lower;
        A = times_w<uniform_w>(x, k + 1, mul_add(times_w<uniform_w>(x, k + 1, X), F, q1 * A));
        F = F1;
        if (careful || (k & 3) == 3) {
            A = A * rF;
            F = splat(1.0);
        }
        q = q1;
        if (moved) d = d1;
    };
    if constexpr (fixed > 0) {
        go_up<fixed>(block, bond);
    } else {
        long k = 0;
        if (all)
            for (; k + 4 < block.n_min; k += 4) {
                bond(k, false);
                bond(k + 1, false);
                bond(k + 2, false);
                bond(k + 3, false);
            }
        for (; k < n; ++k) bond(k, k + 1 >= block.n_min);
    }
    return largest_error<uniform_a>(x, worst, y);
}

// Moves the bonds by the corrections `step`, and substitutes forward what that leaves of their lengths; returns the
// largest error. `keep_bonds`: D becomes the moved bonds.
template <bool uniform_w, bool uniform_a, bool keep_bonds, int fixed = 0>
HOL_INLINE vec correct(const Block &block, const Newton &x) {
    Mover<uniform_w> mover = Mover<uniform_w>::start(x);
    vec worst = {}, y = {};
    go_up<fixed>(block, [&](long k, bool ragged) __attribute__((always_inline)) {
        const vec3 d = Mover<uniform_w>::bond(mover, x, k);
        if (keep_bonds) {
            const mask m = live(block, k);
            x.D[k] = {select(m, d.x, x.D[k].x), select(m, d.y, x.D[k].y), select(m, d.z, x.D[k].z)};
        }
        y = mul_add(x.row[k].down, y, length_error<uniform_a>(block, x, k, ragged, d, worst));
        x.row[k].u = y * x.row[k].half_rP;
    });
    return largest_error<uniform_a>(x, worst, y);
}

// The largest error alone.
template <bool uniform_w, bool uniform_a>
static inline vec residuals(const Block &block, const Newton &x) {
    Mover<uniform_w> mover = Mover<uniform_w>::start(x);
    vec worst = {}, y = {};
    for (long k = 0; k < block.n; ++k)
        y = y + length_error<uniform_a>(block, x, k, true, Mover<uniform_w>::bond(mover, x, k), worst);
    return largest_error<uniform_a>(x, worst, y);
}

// Goes down the chain: adds the corrections of the lanes in `which` to tau, which is 0 the first time.
template <bool first, bool separate, int fixed = 0>
HOL_INLINE void substitute_back(const Block &block, const Newton &x, mask which) {
    vec t = {};
    go_down<fixed>(block, [&](long k) __attribute__((always_inline)) {
        t = mul_add(x.row[k].up, t, x.row[k].u);
        const vec change = keep(which, t);
        if (separate) x.step[k] = change;
        x.tau[k] = first ? change : x.tau[k] + change;
    });
}

// Largest |coordinate| of each lane.
static __attribute__((noinline)) vec extent(const Block &block, const Packed &r) {
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

// What the coordinates carry: each end of a bond is rounded to u |r|, u = half a unit in the last place. Their largest is
// looked for when a decision hangs on it, which is rare.
class Carried {
public:
    Carried(const Block &block, const Newton &x, const PositionsCall &call, const Packed &r)
        : block_(block), x_(x), r_(r), tolerance_(call.tolerance), u_(call.r.is_float ? 5.97e-8 : 1.11e-16),
          boxed_(call.box.shape != Box::none) {}

    vec largest_coordinate() {
        if (!known_) largest_ = extent(block_, r_);
        known_ = true;
        return largest_;
    }
    // An error |D.D - a^2| / a^2 no larger than this one is accepted.
    vec accepted(vec largest) const {
        return max(splat(tolerance_), (8 * u_) * (splat(1.0) + largest / x_.a_min));
    }
    vec accepted() { return accepted(largest_coordinate()); }
    vec always_accepted() const { return splat(tolerance_ > 8 * u_ ? tolerance_ : 8 * u_); }

    // Whether the errors of bonds as they came may be accepted as they are. No atom is farther from the first one of
    // its chain than the bonds are long, unless there are images.
    mask within(vec error) {
        vec first = {};
        for (int c = 0; c < 3; ++c) {
            vec component;
            for (int i = 0; i < W; ++i) component[i] = r_.lane[i][c];
            first = max(abs(component), first);
        }
        const vec reach = static_cast<double>(block_.n) * (x_.a_max * (splat(1.0) + error));
        if (!boxed_ && !any(less_equal(error, accepted(first + reach)))) return none();
        return less_equal(error, accepted());
    }

private:
    const Block &block_;
    const Newton &x_;
    const Packed &r_;
    const double tolerance_, u_;
    const bool boxed_;
    bool known_ = false;
    vec largest_ = {};
};

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
template <bool uniform_w, bool uniform_a, bool careful, int fixed = 0>
HOL_INLINE Outcome iterate(const Block &block, Newton &x, const PositionsCall &call, Carried &carried, mask wanted,
                           bool guess) {
    Outcome out = {};
    const vec done = splat(call.tolerance > epsilon ? call.tolerance : epsilon);
    x.step = careful ? x.correction : x.tau;
    vec error = eliminate<uniform_w, uniform_a, careful ? careful_factors : first_factors, fixed>(block, x, wanted);
    out.untouched = wanted & carried.within(error);
    mask active = wanted & block.movable & ~out.untouched & finite(error);
    if (guess) {
        for (long k = 0; k < block.n; ++k) x.tau[k] = keep(active, x.tau[k]);
        const vec before = error;
        error = eliminate<uniform_w, uniform_a, renewed_factors, fixed>(block, x, active);
        active = active & less_equal(error, before);  // where it did not help: from zero, in the second attempt
        out.converged = active & less_equal(error, done);
        active = active & ~out.converged;
    }
    vec rate = error;  // new factors square the error
    for (int i = 0; i < call.max_iterations && any(active); ++i) {
        if (i == 0 && !guess)
            substitute_back<true, careful, fixed>(block, x, active);
        else
            substitute_back<false, careful, fixed>(block, x, active);
        const vec before = error, expected = rate * before;
        error = correct<uniform_w, uniform_a, careful, fixed>(block, x);
        ++out.solves;
        // At the floor: the solve should have gone far below a rounding, or it gained little, and what is left is no
        // more than the coordinates carry.
        const mask floor = (less(expected, splat(0.125 * epsilon)) & less_equal(error, splat(floor_error))) |
                           less(0.25 * before, error);
        const mask near = active & (less_equal(error, done) | floor);
        if (any(near)) {
            const mask sure = less_equal(error, max(done, carried.always_accepted()));
            const mask finished = any(near & ~sure) ? near & (less_equal(error, done) | less_equal(error, carried.accepted()))
                                                    : near;
            out.converged = out.converged | finished;
            active = active & ~finished & finite(error);
            if (!any(active)) break;
        }
        active = active & finite(error);
        rate = error / before;
        const mask renew = careful ? active : active & worth_renewing(error, rate, i);
        if (!any(renew)) continue;
        eliminate<uniform_w, uniform_a, careful ? careful_factors : renewed_factors, fixed>(block, x, renew);
        rate = select(renew, error, rate);
    }
    if (out.solves == 0 && !guess)
        for (long k = 0; k <= block.n; ++k) x.tau[k] = vec{};
    out.error = error;
    return out;
}

// A chain of one bond in closed form: with sigma = D.D - a^2, D - s b has the length a for
// s = sigma / (D.b + sqrt((D.b)^2 - b.b sigma)), and tau = s / (w_0 + w_1).
template <bool uniform_w>
HOL_INLINE Outcome solve_single_bonds(const Newton &x, Carried &carried, mask wanted) {
    Outcome out = {};
    const vec3 b = x.b[0], d = x.D[0];
    const vec w = uniform_w ? splat(2.0) : x.w[0] + x.w[1];
    const vec a2 = x.a2 ? x.a2[0] : x.a2_uniform, db = dot(d, b);
    const vec sigma = mul_add(d.z, d.z, mul_add(d.y, d.y, mul_add(d.x, d.x, -a2)));
    const vec root = sqrt(mul_add(db, db, -(dot(b, b) * sigma)));  // NaN where the length can't be reached
    const vec s = sigma / (db + select(less(db, vec{}), -root, root)), error = abs(sigma) / a2;
    out.untouched = wanted & carried.within(error);
    out.converged = wanted & ~out.untouched & finite(s / w) & less(vec{}, w);
    const vec step = keep(out.converged, s);
    const vec3 moved = {mul_add(-step, b.x, d.x), mul_add(-step, b.y, d.y), mul_add(-step, b.z, d.z)};
    const vec left = mul_add(moved.z, moved.z, mul_add(moved.y, moved.y, mul_add(moved.x, moved.x, -a2)));
    x.tau[0] = select(wanted, keep(out.converged, s / w), x.tau[0]);
    out.error = abs(left) / a2;
    out.solves = any(out.converged) ? 1 : 0;
    return out;
}

}  // namespace HOL_ISA
}  // namespace holonomic
