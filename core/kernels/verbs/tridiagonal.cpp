// The tridiagonal matrix 1 - gamma by plain products, theory (38)-(41), and what rounding has done to them. Elimination
// begins at both ends and meets in the middle: two recursions that do not wait for each other.
#include <cstddef>

#include "core/kernels/arithmetic/exact.hpp"
#include "core/kernels/isa/lanes.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

namespace {

// A solution below `smallest` has products whose rounding is no double any more; one from a right-hand side above
// `most` could overflow.
constexpr double smallest = 1e-280, most = 1e250;

// Whether no |a| is above the bound. As integers: what is no number must not raise an exception.
bool bounded(int64_t n, const double *a, double bound) {
    const mask limit = as_mask(splat(bound));
    mask above{};
    int64_t k = 0;
    for (; k + W <= n; k += W) above = above | (limit - as_mask(abs(load(a + k))));
    for (; k < n; ++k) above = above | (limit - as_mask(abs(splat(a[k]))));
    return bits(above) == 0;  // their signs
}

struct TwistedFactors {
    int64_t n, middle;
    const double *gamma;  // [k - 1]: between rows k - 1 and k
    double *inverse;      // of the pivots

    double beside(int64_t k) const { return k < middle ? gamma[k] : gamma[k - 1]; }  // towards the middle
};

// Both ends at once: one(row, end) for the rows before the middle upwards, and for those behind it downwards.
template <class One>
HOL_INLINE void inwards(const TwistedFactors &t, const One &one) {
    int64_t low = 0, high = t.n - 1;
    for (; low < t.middle && high > t.middle; ++low, --high) {
        one(low, 0);
        one(high, 1);
    }
    for (; low < t.middle; ++low) one(low, 0);
    for (; high > t.middle; --high) one(high, 1);
}

// T x = b, once what both ends bring to the middle row is known. x holds b and what the outer rows bring to it.
HOL_INLINE void outwards(const TwistedFactors &t, double *x) {
    const int64_t middle = t.middle, n = t.n;
    double low = x[middle] * t.inverse[middle], high = low;
    x[middle] = low;
    const auto one = [&](int64_t k, double inner) {
        return x[k] = mul_add(t.beside(k) * t.inverse[k], inner, x[k] * t.inverse[k]);
    };
    int64_t i = middle - 1, j = middle + 1;
    for (; i >= 0 && j < n; --i, ++j) {
        low = one(i, low);
        high = one(j, high);
    }
    for (; i >= 0; --i) low = one(i, low);
    for (; j < n; ++j) high = one(j, high);
}

// Factorizes and solves T x = b. False if a pivot may not be positive, by a bound of its error.
HOL_INLINE bool factorize_and_solve(const TwistedFactors &t, const double *b, double *x) {
    constexpr double unit = 2 * epsilon;
    double pivot[2] = {1, 1}, error[2] = {0, 0}, y[2] = {0, 0};
    bool good = true;
    inwards(t, [&](int64_t k, int end) {
        good &= error[end] < 0.25 * pivot[end];
        pivot[end] = good ? pivot[end] : 1;
        const double inverse = 1 / pivot[end], g = t.beside(k), factor = g * inverse;
        t.inverse[k] = inverse;
        pivot[end] = mul_add(-g * g, inverse, 1.0);
        error[end] = mul_add(factor * factor, error[end], unit);
        x[k] = b[k] + y[end];
        y[end] = x[k] * factor;
    });
    const double last = pivot[0] + (pivot[1] - 1);
    if (!(good && error[0] + error[1] + unit < 0.25 * last)) return false;
    t.inverse[t.middle] = 1 / last;
    x[t.middle] = b[t.middle] + (y[0] + y[1]);
    outwards(t, x);
    return true;
}

// T x = x.
HOL_INLINE void solve(const TwistedFactors &t, double *x) {
    double y[2] = {0, 0};
    inwards(t, [&](int64_t k, int end) {
        const double factor = t.beside(k) * t.inverse[k];
        x[k] += y[end];
        y[end] = x[k] * factor;
    });
    x[t.middle] += y[0] + y[1];
    outwards(t, x);
}

// b - T x as if in twice the precision, rounded.
template <class V>
HOL_INLINE V residual(V b, V x, V g_before, V x_before, V g_behind, V x_behind) {
    const Pair<V> p = two_product(g_before, x_before), q = two_product(g_behind, x_behind);
    const Pair<V> s = two_difference(b, x), u = two_sum(p.hi, q.hi), r = two_sum(s.hi, u.hi);
    return r.hi + ((s.lo + u.lo) + (r.lo + (p.lo + q.lo)));
}

void residuals(const TwistedFactors &t, const double *b, const double *x, double *r) {
    const double *const g = t.gamma;
    const int64_t n = t.n;
    if (n == 1) {
        r[0] = b[0] - x[0];
        return;
    }
    r[0] = residual(b[0], x[0], 0.0, 0.0, g[0], x[1]);
    int64_t k = 1;
    for (; k + W < n; k += W)
        store(r + k,
              residual(load(b + k), load(x + k), load(g + k - 1), load(x + k - 1), load(g + k), load(x + k + 1)));
    for (; k + 1 < n; ++k) r[k] = residual(b[k], x[k], g[k - 1], x[k - 1], g[k], x[k + 1]);
    r[n - 1] = residual(b[n - 1], x[n - 1], g[n - 2], x[n - 2], 0.0, 0.0);
}

// Adds the correction to x. The largest of |correction| / |x|; infinite where an x is too small for its residual to be
// known.
double correct(int64_t n, const double *correction, double *x) {
    vec worst{};
    const vec least = splat(smallest), huge = splat(__builtin_inf()), zero{};
    const auto take = [&](vec d, vec a) {
        const vec ratio = select(less(abs(a), least), huge, abs(d) / max(abs(a), least));
        const vec known = keep(~(equal(a, zero) & equal(d, zero)), ratio);
        worst = select(less_equal(known, worst), worst, known);  // not max(): what is no number stays
    };
    int64_t k = 0;
    for (; k + W <= n; k += W) {
        const vec d = load(correction + k), a = load(x + k);
        take(d, a);
        store(x + k, a + d);
    }
    for (; k < n; ++k) {
        take(splat(correction[k]), splat(x[k]));
        x[k] += correction[k];
    }
    double largest = 0;
    for (int lane = 0; lane < W; ++lane)
        if (!(worst[lane] <= largest)) largest = worst[lane];
    return largest;
}

}  // namespace

// Corrections by the residual shrink by about as much as the first one is smaller than x. Where the next one would be
// below 2^-62, with some digits left for what is not known of that, x is the rounded solution.
bool tridiagonal_solve(int64_t n, const double *gamma, const double *b, double *x, double *scratch) {
    if (!bounded(n - 1, gamma, 1) || !bounded(n, b, most)) return false;
    const TwistedFactors t{n, n / 2, gamma, scratch};
    double *const solution = scratch + n, *const correction = scratch + 2 * n;
    if (!factorize_and_solve(t, b, solution)) return false;
    double shrinks = 0;
    for (int round = 0; round < 3; ++round) {
        residuals(t, b, solution, correction);
        solve(t, correction);
        const double ratio = correct(n, correction, solution);
        if (round == 0) shrinks = ratio;
        if (!(shrinks <= 0x1p-15)) return false;
        if (shrinks * ratio > 0x1p-62) continue;
        __builtin_memcpy(x, solution, static_cast<size_t>(n) * sizeof *x);
        return true;
    }
    return false;
}

// Pivots from the first row on, with the first order of what rounding does to them. False if that is too large for the
// second order to be left out.
bool tridiagonal_pivots(int64_t n, const double *gamma, double *pivots) {
    if (!bounded(n - 1, gamma, 1)) return false;
    double pivot = 1, error = 0;  // the exact one is pivot + error
    bool good = true;
    pivots[0] = 1;
    for (int64_t k = 1; k < n && good; ++k) {
        const double g = gamma[k - 1], factor = g / pivot;
        const Pair<double> back = two_product(factor, pivot), removed = two_product(g, factor);
        const double missed = ((g - back.hi) - back.lo) * factor;  // of g factor, as the division has been rounded
        const Pair<double> next = two_difference(1.0, removed.hi);
        error = mul_add(factor * factor, error, next.lo - (removed.lo + missed));
        pivot = next.hi;
        good &= pivot > 0x1p-100 && abs(error) <= 0x1p-34 * pivot && (g == 0 || abs(g) > 1e-140);
        pivots[k] = pivot + error;
    }
    return good;
}

}  // namespace holonomic::HOL_ISA
