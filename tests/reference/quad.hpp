/**
 * @file quad.hpp
 * Arithmetic of the reference solutions: 113 bits where the compiler has them. Nothing but + - * / and a square root is
 * needed, so that no further library is.
 */
#ifndef REFERENCE_QUAD_HPP
#define REFERENCE_QUAD_HPP

#include <array>
#include <cmath>

#if defined(REFERENCE_ARITHMETIC)  // a header that defines reference::quad, where 113 bits are not enough
#include REFERENCE_ARITHMETIC
#else
namespace reference
{
#if defined(__SIZEOF_FLOAT128__)
__extension__ typedef __float128 quad;
#else
typedef long double quad;
#endif
}  // namespace reference
#endif

namespace reference
{

using quad3 = std::array<quad, 3>;

inline quad absolute(quad x)
{
    return x < 0 ? -x : x;
}

inline quad square_root(quad x)
{
    if (!(x > 0)) return x;
    quad s = std::sqrt(static_cast<long double>(x));
    for (int step = 0; step < 3; ++step) s = (s + x / s) / 2;  // each step doubles the 64 bits of the start
    return s;
}

inline quad dot(const quad3 &a, const quad3 &b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

inline quad norm(const quad3 &a)
{
    return square_root(dot(a, a));
}

inline quad3 cross(const quad3 &a, const quad3 &b)
{
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

inline quad3 operator+(const quad3 &a, const quad3 &b)
{
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline quad3 operator-(const quad3 &a, const quad3 &b)
{
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline quad3 operator*(quad s, const quad3 &a)
{
    return {s * a[0], s * a[1], s * a[2]};
}

}  // namespace reference

#endif
