// Newton's method for the positions of a block of chains, by the sweeps of newton_sweeps.inl: what is done when.

namespace holonomic {
namespace HOL_ISA {

// Largest |coordinate| of each lane. With lists of atoms, r is where the first ones are.
static __attribute__((noinline)) vec extent(const Block &block, const Packed &r, const int64_t *const *lists = nullptr) {
    vec largest;
    for (int i = 0; i < W; ++i) {
        if (lists) {
            double x = 0;
            for (long k = 0; k <= block.len[i]; ++k)
                for (int c = 0; c < 3; ++c) {
                    const double y = abs(r.lane[i][3 * (lists[i][k] - lists[i][0]) + c]);
                    x = y > x ? y : x;
                }
            largest[i] = x;
            continue;
        }
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

// What the coordinates carry: each end of a bond is rounded to u |r|, u = half a unit in the last place. Their largest
// is looked for when a decision hangs on it, which is rare.
class Carried {
public:
    Carried(const Block &block, const Newton &x, const PositionsCall &call, const Packed &r,
            const int64_t *const *lists = nullptr)
        : block_(block), x_(x), r_(r), lists_(lists), tolerance_(call.tolerance), u_(call.r.is_float ? 5.97e-8 : 1.11e-16),
          boxed_(call.box.shape != Box::none) {}

    vec largest_coordinate() {
        if (!known_) largest_ = extent(block_, r_, lists_);
        known_ = true;
        return largest_;
    }
    // An error |D.D - a^2| / a^2 no larger than this one is accepted.
    vec accepted() { return max(splat(tolerance_), (8 * u_) * (splat(1.0) + largest_coordinate() / x_.a_min)); }
    vec always_accepted() const { return splat(tolerance_ > 8 * u_ ? tolerance_ : 8 * u_); }

    // Whether the bonds as they came may be accepted: `error` is their |D.D - a^2| in units of `a2`. No atom is farther
    // from the first one of its chain than the bonds are long, unless there are images: where that bound, on the safe
    // side by much more than its roundings, excludes it, nothing is looked for.
    mask within(vec error, vec a2) {
        if (!boxed_) {
            vec first = {};
            for (int c = 0; c < 3; ++c) {
                vec component;
                for (int i = 0; i < W; ++i) component[i] = r_.lane[i][c];
                first = max(abs(component), first);
            }
            const vec per_a = x_.per_a_min, a = mul_add(error * x_.a_max, per_a * per_a, x_.a_max);
            const vec most = mul_add(mul_add(a, splat(static_cast<double>(block_.n)), first), per_a, splat(1.0));
            if (!any(~less(a2 * max(splat(2 * tolerance_), (16 * u_) * most), error))) return none();
        }
        return less_equal(error, a2 * accepted());
    }

private:
    const Block &block_;
    const Newton &x_;
    const Packed &r_;
    const int64_t *const *const lists_;
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

// From an error no larger than this, a solve with factors that have just taken the error down to less than `steady` of
// itself needs no look at what it has done: it leaves less than a rounding, and could not leave more than this.
constexpr double last_error = 64 * epsilon;
constexpr double steady = 1.0 / 256;

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
    vec error = careful ? renew<uniform_w, uniform_a, careful_factors>(block, x, wanted)
                        : eliminate<uniform_w, uniform_a, first_factors, fixed>(block, x, wanted);
    out.untouched = wanted & carried.within(error, splat(1.0));
    mask active = wanted & block.movable & ~out.untouched & finite(error);
    if (guess) {
        for (long k = 0; k < block.n; ++k) x.tau[k] = keep(active, x.tau[k]);
        const vec before = error;
        error = renew<uniform_w, uniform_a, renewed_factors>(block, x, active);
        active = active & less_equal(error, before);  // where it did not help: from zero, in the second attempt
        out.converged = active & less_equal(error, done);
        active = active & ~out.converged;
    }
    vec rate = error;  // new factors square the error
    mask proven = none();
    for (int i = 0; i < call.max_iterations && any(active); ++i) {
        if (i == 0 && !guess)
            substitute_back<true, careful, fixed>(block, x, active);
        else
            substitute_back<false, careful, fixed>(block, x, active);
        const mask last = active & proven & less(rate * error, splat(0.125 * epsilon));
        out.converged = out.converged | last;  // whatever the other lanes have to do
        active = active & ~last;
        if (!any(active)) {
            ++out.solves;
            if (call.report) error = correct<uniform_w, uniform_a, careful, fixed>(block, x, nullptr);
            break;
        }
        const vec before = error, expected = rate * before;
        error = correct<uniform_w, uniform_a, careful, fixed>(block, x, i < 3 ? x.next[i] : nullptr);
        ++out.solves;
        // At the floor: the solve should have gone far below a rounding, or it gained little, and what is left is no
        // more than the coordinates carry.
        const mask floor = (less(expected, splat(0.125 * epsilon)) & less_equal(error, splat(floor_error))) |
                           less(0.25 * before, error);
        const mask near = active & (less_equal(error, done) | floor);
        if (any(near)) {
            const mask sure = less_equal(error, max(done, carried.always_accepted()));
            mask finished = near;
            if (any(near & ~sure)) finished = near & less_equal(error, max(done, carried.accepted()));
            out.converged = out.converged | finished;
            active = active & ~finished & finite(error);
            if (!any(active)) break;
        }
        active = active & finite(error);
        rate = error / before;
        const mask renewed = careful ? active : active & worth_renewing(error, rate, i);
        if (!careful) proven = ~renewed & less(rate, splat(steady)) & less_equal(error, splat(last_error));
        if (!any(renewed)) continue;
        renew<uniform_w, uniform_a, careful ? careful_factors : renewed_factors>(block, x, renewed);
        rate = select(renewed, error, rate);
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
    const vec s = sigma / (db + select(less(db, vec{}), -root, root));
    const mask known = wanted & finite(db);
    out.untouched = known & carried.within(abs(sigma), a2);
    const mask reached = known & ~out.untouched & finite(s / w) & less(vec{}, w);
    vec step = keep(reached, s);
    vec3 moved;
    const auto excess = [&]() __attribute__((always_inline)) {  // of D.D over a^2 once it is moved
        moved = {mul_add(-step, b.x, d.x), mul_add(-step, b.y, d.y), mul_add(-step, b.z, d.z)};
        return mul_add(moved.z, moved.z, mul_add(moved.y, moved.y, mul_add(moved.x, moved.x, -a2)));
    };
    vec left = excess();
    const vec enough = 4.0 * a2 * carried.always_accepted();
    mask unsure = reached & ~less_equal(abs(left), enough);
    out.converged = reached & ~unsure;
    if (__builtin_expect(any(unsure), 0)) {
        // D much longer than a, or squares that overflow or underflow: on by Newton's method.
        for (int i = 0; i < 3; ++i) {
            step = step + keep(unsure & ~less_equal(abs(left), enough), left / (2.0 * dot(moved, b)));
            left = excess();
        }
        out.converged = out.converged | (unsure & finite(step / w) & carried.within(0.25 * abs(left), a2));
    }
    x.tau[0] = select(wanted, keep(out.converged, step / w), x.tau[0]);
    out.error = abs(left) * (x.a2 ? x.per_a2[0] : x.per_a2_uniform);
    out.solves = any(out.converged) ? 1 : 0;
    return out;
}

}  // namespace HOL_ISA
}  // namespace holonomic
