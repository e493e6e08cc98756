/**
 * @file wide_float.hpp
 * Floating-point numbers of any width, for reference solutions: textbook elimination on matrices whose condition number
 * is 1e40 needs hundreds of bits. Results are truncated, not rounded: each is right to two units in its last place.
 * Exponents have 64 bits, so nothing over- or underflows.
 */
#ifndef REFERENCE_WIDE_FLOAT_HPP
#define REFERENCE_WIDE_FLOAT_HPP

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace reference
{

#if defined(__SIZEOF_INT128__)
using limb = std::uint64_t;
__extension__ typedef unsigned __int128 double_limb;
#else
using limb = std::uint32_t;
using double_limb = std::uint64_t;
#endif
constexpr int limb_bits = 8 * static_cast<int>(sizeof(limb));

/** sign * 0.digits * 2^exponent; the topmost bit of the digits is 1 unless the number is zero. */
template <int BITS>
class wide_float
{
public:
    static constexpr int bits = BITS;

    wide_float() = default;
    wide_float(int x) : wide_float(static_cast<long double>(x))
    {
    }
    wide_float(double x) : wide_float(static_cast<long double>(x))
    {
    }
    wide_float(long double x)
    {
        if (x == 0) return;
        sign_ = x < 0 ? -1 : 1;
        int exponent = 0;
        x = std::frexp(std::fabs(x), &exponent);
        exponent_ = exponent;
        for (std::size_t k = n; k-- > 0 && x > 0;) {
            for (int half = 0; half < limb_bits / 16; ++half) {  // 16 bits at a time: whatever a long double holds
                x *= 0x1p16L;
                const unsigned part = static_cast<unsigned>(x);
                x -= part;
                digit_[k] |= static_cast<limb>(part) << (limb_bits - 16 - 16 * half);
            }
        }
    }

    /** Fewer digits, cut off, or zeros behind those that there are. */
    template <int OTHER>
    explicit wide_float(const wide_float<OTHER> &x) : exponent_(x.exponent_), sign_(x.sign_)
    {
        constexpr std::size_t theirs = OTHER / limb_bits;
        for (std::size_t k = 1; k <= n && k <= theirs; ++k) digit_[n - k] = x.digit_[theirs - k];
    }

    explicit operator long double() const
    {
        if (sign_ == 0) return 0;
        long double x = 0;
        for (std::size_t k = n > 5 ? n - 5 : 0; k < n; ++k) x = (x + static_cast<long double>(digit_[k])) * unit();
        if (exponent_ > 20000) return sign_ * HUGE_VALL;
        return exponent_ < -20000 ? 0 : std::ldexp(sign_ * x, static_cast<int>(exponent_));
    }
    explicit operator double() const
    {
        return static_cast<double>(static_cast<long double>(*this));
    }

    int sign() const
    {
        return sign_;
    }
    /** The power of two above the number: 0.5 <= |x| / 2^exponent < 1. */
    std::int64_t exponent() const
    {
        return exponent_;
    }
    /** x 2^by, exactly. */
    wide_float scaled(std::int64_t by) const
    {
        wide_float x = *this;
        if (sign_ != 0) x.exponent_ += by;
        return x;
    }

    friend wide_float operator-(wide_float x)
    {
        x.sign_ = -x.sign_;
        return x;
    }
    friend wide_float operator+(const wide_float &a, const wide_float &b)
    {
        return sum(a, b, b.sign_);
    }
    friend wide_float operator-(const wide_float &a, const wide_float &b)
    {
        return sum(a, b, -b.sign_);
    }
    friend wide_float operator*(const wide_float &a, const wide_float &b)
    {
        wide_float x;
        x.sign_ = a.sign_ * b.sign_;
        if (x.sign_ == 0) return x;
        std::array<limb, 2 * n> product{};
        for (std::size_t i = 0; i < n; ++i) {
            if (a.digit_[i] == 0) continue;
            limb carry = 0;
            for (std::size_t j = i + 2 < n ? n - 2 - i : 0; j < n;
                 ++j) {  // what is two limbs below the last is cut off
                const double_limb p = static_cast<double_limb>(a.digit_[i]) * b.digit_[j] + product[i + j] + carry;
                product[i + j] = static_cast<limb>(p);
                carry = static_cast<limb>(p >> limb_bits);
            }
            product[i + n] = carry;
        }
        x.exponent_ = a.exponent_ + b.exponent_;
        x.take_top(product);
        return x;
    }
    friend wide_float operator/(const wide_float &a, const wide_float &b)
    {
        const std::int64_t e = b.exponent_;
        const wide_float m = b.scaled(-e);
        wide_float inverse(1 / static_cast<double>(m));
        for (int known = 50; known < BITS; known *= 2) inverse += inverse * (wide_float(1) - m * inverse);
        const wide_float q = a * inverse;
        return (q + inverse * (a - m * q)).scaled(-e);
    }

    wide_float &operator+=(const wide_float &x)
    {
        return *this = *this + x;
    }
    wide_float &operator-=(const wide_float &x)
    {
        return *this = *this - x;
    }
    wide_float &operator*=(const wide_float &x)
    {
        return *this = *this * x;
    }
    wide_float &operator/=(const wide_float &x)
    {
        return *this = *this / x;
    }

    friend bool operator<(const wide_float &a, const wide_float &b)
    {
        if (a.sign_ != b.sign_) return a.sign_ < b.sign_;
        return a.sign_ > 0 ? smaller(a, b) : a.sign_ < 0 && smaller(b, a);
    }
    friend bool operator>(const wide_float &a, const wide_float &b)
    {
        return b < a;
    }
    friend bool operator<=(const wide_float &a, const wide_float &b)
    {
        return !(b < a);
    }
    friend bool operator>=(const wide_float &a, const wide_float &b)
    {
        return !(a < b);
    }
    friend bool operator==(const wide_float &a, const wide_float &b)
    {
        return !(a < b) && !(b < a);
    }
    friend bool operator!=(const wide_float &a, const wide_float &b)
    {
        return !(a == b);
    }

private:
    template <int OTHER>
    friend class wide_float;

    static constexpr std::size_t n = BITS / limb_bits;
    static_assert(BITS % 64 == 0, "whole limbs");

    static long double unit()
    {
        return 1 / (static_cast<long double>(~limb{0} / 2 + 1) * 2);
    }

    /** Whether |a| < |b|. */
    static bool smaller(const wide_float &a, const wide_float &b)
    {
        if (a.sign_ == 0 || b.sign_ == 0) return a.sign_ == 0 && b.sign_ != 0;
        if (a.exponent_ != b.exponent_) return a.exponent_ < b.exponent_;
        for (std::size_t k = n; k-- > 0;)
            if (a.digit_[k] != b.digit_[k]) return a.digit_[k] < b.digit_[k];
        return false;
    }

    /** Digits and exponent from a number 0.from * 2^exponent_, leading zeros removed; its sign is set already. */
    template <std::size_t M>
    void take_top(const std::array<limb, M> &from)
    {
        std::size_t top = M;
        while (top > 0 && from[top - 1] == 0) --top;
        if (top == 0) {
            *this = wide_float();
            return;
        }
        int shift = 0;
        while (!(from[top - 1] << shift >> (limb_bits - 1))) ++shift;
        exponent_ -= static_cast<std::int64_t>(M - top) * limb_bits + shift;
        for (std::size_t k = 0; k < n; ++k) {  // digit n-1-k is made of from[top-1-k] and the one below
            limb x = top >= k + 1 ? from[top - 1 - k] << shift : 0;
            if (shift > 0 && top >= k + 2) x |= from[top - 2 - k] >> (limb_bits - shift);
            digit_[n - 1 - k] = x;
        }
    }

    static wide_float sum(const wide_float &a, const wide_float &b, int sign_b)
    {
        const bool b_larger = smaller(a, b);
        const wide_float &big = b_larger ? b : a, &small = b_larger ? a : b;
        wide_float x = big;
        x.sign_ = b_larger ? sign_b : a.sign_;
        const std::int64_t shift = big.exponent_ - small.exponent_;
        if (small.sign_ == 0 || shift >= BITS + limb_bits) return x;
        const bool add = a.sign_ == sign_b;
        // one limb more at the bottom for what is shifted out, one at the top for the carry
        std::array<limb, n + 2> s{}, t{};
        for (std::size_t k = 0; k < n; ++k) s[k + 1] = big.digit_[k];
        const std::size_t whole = static_cast<std::size_t>(shift / limb_bits);
        const int part = static_cast<int>(shift % limb_bits);
        for (std::size_t k = 0; k < n; ++k) {
            if (k + 1 >= whole) t[k + 1 - whole] |= small.digit_[k] >> part;
            if (part > 0 && k >= whole) t[k - whole] |= small.digit_[k] << (limb_bits - part);
        }
        limb carry = 0;
        for (std::size_t k = 0; k < n + 2; ++k) {
            const double_limb term = static_cast<double_limb>(t[k]) + carry, here = s[k];
            const double_limb result = add ? here + term : here - term;
            s[k] = static_cast<limb>(result);
            carry = static_cast<limb>(result >> limb_bits) ? 1 : 0;
        }
        x.exponent_ = big.exponent_ + limb_bits;
        x.take_top(s);
        return x;
    }

    std::array<limb, n> digit_{};  // the lowest first
    std::int64_t exponent_ = 0;
    int sign_ = 0;
};

template <int BITS>
wide_float<BITS> absolute(const wide_float<BITS> &x)
{
    return x.sign() < 0 ? -x : x;
}

}  // namespace reference

#endif
