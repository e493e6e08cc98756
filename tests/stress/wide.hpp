/**
 * @file wide.hpp
 * The arithmetic of the reference solutions with 320 bits: enough for textbook elimination on chains whose condition
 * number is 1e40, which 113 bits are not. MPFR does the work; a number keeps its digits in itself, nothing is
 * allocated.
 */
#ifndef STRESS_WIDE_HPP
#define STRESS_WIDE_HPP

#include <mpfr.h>

namespace reference
{

class wide
{
public:
    wide() : wide(0)
    {
    }
    wide(int x)
    {
        init(), mpfr_set_si(value_, x, MPFR_RNDN);
    }
    wide(double x)
    {
        init(), mpfr_set_d(value_, x, MPFR_RNDN);
    }
    wide(long double x)
    {
        init(), mpfr_set_ld(value_, x, MPFR_RNDN);
    }
    wide(const wide &x)
    {
        init(), mpfr_set(value_, x.value_, MPFR_RNDN);
    }
    wide &operator=(const wide &x)
    {
        mpfr_set(value_, x.value_, MPFR_RNDN);
        return *this;
    }

    explicit operator long double() const
    {
        return mpfr_get_ld(value_, MPFR_RNDN);
    }
    explicit operator double() const
    {
        return mpfr_get_d(value_, MPFR_RNDN);
    }

    wide &operator+=(const wide &x)
    {
        return mpfr_add(value_, value_, x.value_, MPFR_RNDN), *this;
    }
    wide &operator-=(const wide &x)
    {
        return mpfr_sub(value_, value_, x.value_, MPFR_RNDN), *this;
    }
    wide &operator*=(const wide &x)
    {
        return mpfr_mul(value_, value_, x.value_, MPFR_RNDN), *this;
    }
    wide &operator/=(const wide &x)
    {
        return mpfr_div(value_, value_, x.value_, MPFR_RNDN), *this;
    }

    friend wide operator+(wide a, const wide &b)
    {
        return a += b;
    }
    friend wide operator-(wide a, const wide &b)
    {
        return a -= b;
    }
    friend wide operator*(wide a, const wide &b)
    {
        return a *= b;
    }
    friend wide operator/(wide a, const wide &b)
    {
        return a /= b;
    }
    friend wide operator-(wide a)
    {
        return mpfr_neg(a.value_, a.value_, MPFR_RNDN), a;
    }
    friend bool operator<(const wide &a, const wide &b)
    {
        return mpfr_less_p(a.value_, b.value_) != 0;
    }
    friend bool operator>(const wide &a, const wide &b)
    {
        return b < a;
    }
    friend bool operator<=(const wide &a, const wide &b)
    {
        return mpfr_lessequal_p(a.value_, b.value_) != 0;
    }
    friend bool operator==(const wide &a, const wide &b)
    {
        return mpfr_equal_p(a.value_, b.value_) != 0;
    }
    friend bool operator!=(const wide &a, const wide &b)
    {
        return !(a == b);
    }

private:
    static constexpr int bits = 320, limbs = bits / static_cast<int>(8 * sizeof(mp_limb_t));

    void init()
    {
        mpfr_custom_init_set(value_, MPFR_ZERO_KIND, 0, bits, digits_);
    }

    mp_limb_t digits_[limbs];
    mpfr_t value_;
};

using quad = wide;

}  // namespace reference

#endif
