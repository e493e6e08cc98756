#ifndef HOLONOMIC_SUBDOMAIN_TWICE_HPP
#define HOLONOMIC_SUBDOMAIN_TWICE_HPP

// Small enough to be part of the loops that use them, whatever instructions those are compiled for.
#define HOL_SUBDOMAIN_INLINE __attribute__((always_inline)) inline

// Products in twice the precision take one instruction more where the processor fuses them, and a call elsewhere.
#if defined(__x86_64__) && defined(__gnu_linux__)
#define HOL_SUBDOMAIN_CLONES __attribute__((target_clones("fma", "default")))
#else
#define HOL_SUBDOMAIN_CLONES
#endif

namespace holonomic_subdomain {

/** A number in twice the precision: hi + lo, of which hi is the sum rounded. */
struct Twice {
    double hi = 0, lo = 0;
};

HOL_SUBDOMAIN_INLINE Twice sum_of(double a, double b) {
    const double s = a + b, t = s - a;
    return {s, (a - (s - t)) + (b - t)};
}

HOL_SUBDOMAIN_INLINE Twice product_of(double a, double b) {
    const double p = a * b;
    return {p, __builtin_fma(a, b, -p)};
}

HOL_SUBDOMAIN_INLINE Twice operator+(Twice a, Twice b) {
    const Twice s = sum_of(a.hi, b.hi);
    const double lo = s.lo + (a.lo + b.lo), hi = s.hi + lo;
    return {hi, lo - (hi - s.hi)};
}

HOL_SUBDOMAIN_INLINE Twice operator-(Twice a) { return {-a.hi, -a.lo}; }
HOL_SUBDOMAIN_INLINE Twice operator-(Twice a, Twice b) { return a + -b; }

/** Four numbers that are worked on together; vectors leave the last one zero. They lie where doubles may. */
typedef double Four __attribute__((vector_size(32), aligned(8)));

/** Three components in twice the precision. */
struct TwiceVector {
    Four hi = {0, 0, 0, 0}, lo = {0, 0, 0, 0};
};

/** Component by component, and what the rounding loses. Takes copies: of a member clang forgets that it may lie
 * anywhere.
 */
HOL_SUBDOMAIN_INLINE TwiceVector products_of(const Four &a, const Four &b) {
    TwiceVector p;
    p.hi = a * b;
    for (int c = 0; c < 4; ++c) p.lo[c] = __builtin_fma(a[c], b[c], -p.hi[c]);
    return p;
}

/** y - x of three numbers each. */
HOL_SUBDOMAIN_INLINE TwiceVector difference(const double *y, const double *x) {
    const Four a = {y[0], y[1], y[2], 0}, b = {x[0], x[1], x[2], 0};
    const Four s = a - b, t = s - a;
    return {s, (a - (s - t)) - (b + t)};
}
/** x times three numbers. */
HOL_SUBDOMAIN_INLINE TwiceVector multiple(double x, const double *y) {
    const Four all = {x, x, x, x}, a = {y[0], y[1], y[2], 0};
    return products_of(all, a);
}

/** The lower parts are not rounded into the upper ones, which sums of a few can do without. */
HOL_SUBDOMAIN_INLINE TwiceVector operator+(const TwiceVector &a, const TwiceVector &b) {
    const Four s = a.hi + b.hi, t = s - a.hi;
    return {s, ((a.hi - (s - t)) + (b.hi - t)) + (a.lo + b.lo)};
}
HOL_SUBDOMAIN_INLINE TwiceVector operator-(const TwiceVector &a, const TwiceVector &b) {
    return a + TwiceVector{-b.hi, -b.lo};
}
HOL_SUBDOMAIN_INLINE TwiceVector operator*(double x, const TwiceVector &a) {
    const Four all = {x, x, x, x}, hi = a.hi;
    TwiceVector p = products_of(all, hi);
    p.lo += all * a.lo;
    return p;
}
HOL_SUBDOMAIN_INLINE Twice dot(const TwiceVector &a, const TwiceVector &b) {
    const Four x = a.hi, y = b.hi;
    TwiceVector p = products_of(x, y);
    p.lo += x * b.lo + a.lo * y;
    const Twice s = sum_of(p.hi[0], p.hi[1]), all = sum_of(s.hi, p.hi[2]);
    const double lo = (s.lo + all.lo) + (p.lo[0] + p.lo[1] + p.lo[2]), hi = all.hi + lo;
    return {hi, lo - (hi - all.hi)};
}
/** Rounded, where the lower parts don't matter. */
HOL_SUBDOMAIN_INLINE double plain_dot(const TwiceVector &a, const TwiceVector &b) {
    const Four p = a.hi * b.hi;
    return p[0] + p[1] + p[2];
}

}  // namespace holonomic_subdomain

#endif
