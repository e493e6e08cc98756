/**
 * @file wide_functions.hpp
 * Square root, logarithm and decimal digits of wide_float, and vectors of three of them.
 */
#ifndef REFERENCE_WIDE_FUNCTIONS_HPP
#define REFERENCE_WIDE_FUNCTIONS_HPP

#include <cstdio>
#include <string>

#include "wide_float.hpp"

namespace reference
{

template <int BITS>
wide_float<BITS> square_root(const wide_float<BITS> &x)
{
    using real = wide_float<BITS>;
    if (x.sign() <= 0) return real(0);
    const std::int64_t half = (x.exponent() - (x.exponent() % 2 != 0)) / 2;
    const real m = x.scaled(-2 * half);  // between 0.5 and 2
    real y(1 / std::sqrt(static_cast<double>(m)));
    for (int known = 50; known < BITS; known *= 2) y += (y * (real(1) - m * y * y)).scaled(-1);
    const real s = m * y;
    return (s + (y * (m - s * s)).scaled(-1)).scaled(half);
}

/** 2 (z + z^3/3 + z^5/5 + ...) = ln((1 + z) / (1 - z)) for |z| <= 1/3. */
template <int BITS>
wide_float<BITS> log_of_ratio(const wide_float<BITS> &z)
{
    using real = wide_float<BITS>;
    const real square = z * z;
    real sum(0), power = z;
    for (int k = 1; power.sign() != 0 && power.exponent() > z.exponent() - BITS; k += 2) {
        sum += power / real(k);
        power *= square;
    }
    return sum.scaled(1);
}

/** Natural logarithm of a positive number, right to the last digits also where it is small. */
template <int BITS>
wide_float<BITS> logarithm(const wide_float<BITS> &x)
{
    using real = wide_float<BITS>;
    real m = x;
    std::int64_t e = 0;
    if (x < real(0.7) || x > real(1.4)) {
        e = x.exponent();
        m = x.scaled(-e);
        if (m < real(0.7)) {
            m = m.scaled(1);
            --e;
        }
    }
    const real part = log_of_ratio((m - real(1)) / (m + real(1)));
    if (e == 0) return part;
    return part + real(static_cast<long double>(e)) * log_of_ratio(real(1) / real(3));
}

template <int BITS>
wide_float<BITS> power_of_ten(int e)
{
    using real = wide_float<BITS>;
    real result(1), factor(10);
    for (int k = e < 0 ? -e : e; k > 0; k /= 2) {
        if (k % 2) result *= factor;
        factor *= factor;
    }
    return e < 0 ? real(1) / result : result;
}

/** "-1.2345e+02" with this many digits; zero is "0.0". */
template <int BITS>
std::string decimal(const wide_float<BITS> &x, int digits)
{
    using real = wide_float<BITS>;
    if (x.sign() == 0) return "0.0";
    int e = static_cast<int>(std::floor(static_cast<double>(x.exponent()) * 0.30102999566398120));
    real m = absolute(x) * power_of_ten<BITS>(-e);
    const real half_unit = power_of_ten<BITS>(1 - digits).scaled(-1);
    while (m + half_unit >= real(10)) m /= real(10), ++e;
    while (m + half_unit < real(1)) m *= real(10), --e;
    m += half_unit;
    std::string text = x.sign() < 0 ? "-" : "";
    for (int k = 0; k < digits; ++k) {
        const int digit = static_cast<int>(static_cast<double>(m));
        const int exact = real(digit) > m ? digit - 1 : digit;  // the conversion rounds
        text += static_cast<char>('0' + exact);
        if (k == 0) text += '.';
        m = (m - real(exact)) * real(10);
    }
    char exponent[16];
    std::snprintf(exponent, sizeof exponent, "e%c%02d", e < 0 ? '-' : '+', e < 0 ? -e : e);
    return text + exponent;
}

template <class REAL>
using vector3 = std::array<REAL, 3>;

template <class REAL>
vector3<REAL> difference(const vector3<REAL> &a, const vector3<REAL> &b)
{
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

template <class REAL>
void add_times(vector3<REAL> &to, const REAL &s, const vector3<REAL> &x)
{
    for (std::size_t c = 0; c < 3; ++c) to[c] += s * x[c];
}

template <class REAL>
REAL product(const vector3<REAL> &a, const vector3<REAL> &b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/** Sum of |a_x| |b_x|. */
template <class REAL>
REAL product_of_sizes(const vector3<REAL> &a, const vector3<REAL> &b)
{
    return absolute(a[0] * b[0]) + absolute(a[1] * b[1]) + absolute(a[2] * b[2]);
}

template <class REAL>
vector3<REAL> cross_product(const vector3<REAL> &a, const vector3<REAL> &b)
{
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

template <class REAL>
REAL length(const vector3<REAL> &a)
{
    return square_root(product(a, a));
}

}  // namespace reference

#endif
