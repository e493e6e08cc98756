// Two blocks of W molecules side by side, as if there were 2 W lanes. While one waits for a quotient, or for the end of
// a chain of products, the processor works on the other.
#ifndef HOLONOMIC_KERNELS_GRAPH_TWIN_HPP
#define HOLONOMIC_KERNELS_GRAPH_TWIN_HPP

#include "core/kernels/graph/consecutive.hpp"

namespace holonomic {
namespace HOL_ISA {

struct Twin {
    vec a, b;
};
struct TwinMask {
    mask a, b;
};

// True if twins pay: the bits of their masks fit, and there is more than one lane.
constexpr bool twins = W > 1 && W <= 8;

HOL_INLINE Twin operator+(const Twin &x, const Twin &y) { return {x.a + y.a, x.b + y.b}; }
HOL_INLINE Twin operator-(const Twin &x, const Twin &y) { return {x.a - y.a, x.b - y.b}; }
HOL_INLINE Twin operator*(const Twin &x, const Twin &y) { return {x.a * y.a, x.b * y.b}; }
HOL_INLINE Twin operator/(const Twin &x, const Twin &y) { return {x.a / y.a, x.b / y.b}; }
HOL_INLINE Twin operator-(const Twin &x) { return {-x.a, -x.b}; }
HOL_INLINE Twin operator+(const Twin &x, double y) { return {x.a + y, x.b + y}; }
HOL_INLINE Twin operator-(const Twin &x, double y) { return {x.a - y, x.b - y}; }
HOL_INLINE Twin operator-(double x, const Twin &y) { return {x - y.a, x - y.b}; }
HOL_INLINE Twin operator*(const Twin &x, double y) { return {x.a * y, x.b * y}; }
HOL_INLINE Twin operator*(double x, const Twin &y) { return {x * y.a, x * y.b}; }
HOL_INLINE Twin mul_add(const Twin &x, const Twin &y, const Twin &z) {
    return {mul_add(x.a, y.a, z.a), mul_add(x.b, y.b, z.b)};
}
HOL_INLINE Twin max(const Twin &x, const Twin &y) { return {max(x.a, y.a), max(x.b, y.b)}; }
HOL_INLINE Twin min(const Twin &x, const Twin &y) { return {min(x.a, y.a), min(x.b, y.b)}; }
HOL_INLINE Twin abs(const Twin &x) { return {abs(x.a), abs(x.b)}; }
HOL_INLINE Twin sqrt(const Twin &x) { return {sqrt(x.a), sqrt(x.b)}; }
HOL_INLINE Twin round(const Twin &x) { return {round(x.a), round(x.b)}; }

HOL_INLINE TwinMask operator&(const TwinMask &x, const TwinMask &y) { return {x.a & y.a, x.b & y.b}; }
HOL_INLINE TwinMask operator|(const TwinMask &x, const TwinMask &y) { return {x.a | y.a, x.b | y.b}; }
HOL_INLINE TwinMask operator~(const TwinMask &x) { return {~x.a, ~x.b}; }
HOL_INLINE bool any(const TwinMask &x) { return any(x.a | x.b); }
HOL_INLINE unsigned bits(const TwinMask &x) { return bits(x.a) | bits(x.b) << W; }
HOL_INLINE TwinMask less(const Twin &x, const Twin &y) { return {less(x.a, y.a), less(x.b, y.b)}; }
HOL_INLINE TwinMask less_equal(const Twin &x, const Twin &y) { return {less_equal(x.a, y.a), less_equal(x.b, y.b)}; }
HOL_INLINE TwinMask finite(const Twin &x) { return {finite(x.a), finite(x.b)}; }
HOL_INLINE Twin select(const TwinMask &m, const Twin &x, const Twin &y) {
    return {select(m.a, x.a, y.a), select(m.b, x.b, y.b)};
}
HOL_INLINE Twin keep(const TwinMask &m, const Twin &x) { return {keep(m.a, x.a), keep(m.b, x.b)}; }

template <>
struct Width<Twin> {
    typedef TwinMask Mask;
    static constexpr int lanes = 2 * W;
    HOL_INLINE Twin all(double x) { return {splat(x), splat(x)}; }
    HOL_INLINE TwinMask none() { return {mask{}, mask{}}; }
    HOL_INLINE TwinMask first(int n) { return {first_lanes(n), first_lanes(n - W)}; }
    HOL_INLINE TwinMask of_bits(unsigned b) { return {Width<vec>::of_bits(b), Width<vec>::of_bits(b >> W)}; }
    HOL_INLINE double get(const Twin &x, int i) { return i < W ? x.a[i % W] : x.b[i % W]; }
    HOL_INLINE void set(Twin &x, int i, double y) {
        if (i < W)
            x.a[i] = y;
        else
            x.b[i - W] = y;  // not through a reference to either: gcc 12 loses elements then
    }
};

// Found by their argument from where single blocks are read and written.
HOL_INLINE Vector3<Twin> side_by_side(const vec3 &a, const vec3 &b) { return {{a.x, b.x}, {a.y, b.y}, {a.z, b.z}}; }

HOL_INLINE void read_rows(const double *const *p, Vector3<Twin> &x) {
    vec3 a, b;
    read_rows(p, a);
    read_rows(p + W, b);
    x = side_by_side(a, b);
}
HOL_INLINE void write_rows(double *const *p, const Vector3<Twin> &x) {
    write_rows(p, vec3{x.x.a, x.y.a, x.z.a});
    write_rows(p + W, vec3{x.x.b, x.y.b, x.z.b});
}
template <int n>
HOL_INLINE void read_elements(const double *const *p, Vector3<Twin> *x) {
    vec3 a[n / 3], b[n / 3];
    graph::read_elements<n>(p, a);
    graph::read_elements<n>(p + W, b);
    HOL_UNROLL
    for (int k = 0; k < n / 3; ++k) x[k] = side_by_side(a[k], b[k]);
}
template <int n>
HOL_INLINE void write_elements(double *const *p, Vector3<Twin> *x) {
    vec3 a[n / 3], b[n / 3];
    HOL_UNROLL
    for (int k = 0; k < n / 3; ++k) {
        a[k] = {x[k].x.a, x[k].y.a, x[k].z.a};
        b[k] = {x[k].x.b, x[k].y.b, x[k].z.b};
    }
    graph::write_elements<n>(p, a);
    graph::write_elements<n>(p + W, b);
}

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
