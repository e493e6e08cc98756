#ifndef HOLONOMIC_SUBDOMAIN_TWICE_HPP
#define HOLONOMIC_SUBDOMAIN_TWICE_HPP

// Small enough to be part of the loops that use them, whatever instructions those are compiled for.
#define HOL_SUBDOMAIN_INLINE __attribute__((always_inline)) inline

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

HOL_SUBDOMAIN_INLINE Twice operator*(Twice a, Twice b) {
    const Twice p = product_of(a.hi, b.hi);
    const double lo = p.lo + (a.hi * b.lo + a.lo * b.hi), hi = p.hi + lo;
    return {hi, lo - (hi - p.hi)};
}

/** Three components in twice the precision. */
struct TwiceVector {
    Twice c[3];
};

HOL_SUBDOMAIN_INLINE TwiceVector operator+(const TwiceVector &a, const TwiceVector &b) {
    return {{a.c[0] + b.c[0], a.c[1] + b.c[1], a.c[2] + b.c[2]}};
}
HOL_SUBDOMAIN_INLINE TwiceVector operator-(const TwiceVector &a, const TwiceVector &b) {
    return {{a.c[0] - b.c[0], a.c[1] - b.c[1], a.c[2] - b.c[2]}};
}
HOL_SUBDOMAIN_INLINE TwiceVector operator*(Twice x, const TwiceVector &a) {
    return {{x * a.c[0], x * a.c[1], x * a.c[2]}};
}
HOL_SUBDOMAIN_INLINE Twice dot(const TwiceVector &a, const TwiceVector &b) {
    return a.c[0] * b.c[0] + a.c[1] * b.c[1] + a.c[2] * b.c[2];
}
HOL_SUBDOMAIN_INLINE TwiceVector difference(const double *a, const double *b) {
    return {{sum_of(a[0], -b[0]), sum_of(a[1], -b[1]), sum_of(a[2], -b[2])}};
}

/** sum += t d, with what each rounding loses. */
HOL_SUBDOMAIN_INLINE void add_multiple(TwiceVector &sum, double t, const TwiceVector &d) {
    for (int c = 0; c < 3; ++c) {
        const Twice p = product_of(t, d.c[c].hi), s = sum_of(sum.c[c].hi, p.hi);
        sum.c[c] = {s.hi, sum.c[c].lo + (s.lo + (p.lo + t * d.c[c].lo))};
    }
}

}  // namespace holonomic_subdomain

#endif
