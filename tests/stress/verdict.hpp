/**
 * @file verdict.hpp
 * By how much each of a set of quantities was off: its error over its bound, so that more than 1 is an exceedance.
 */
#ifndef STRESS_VERDICT_HPP
#define STRESS_VERDICT_HPP

#include <array>
#include <cmath>
#include <cstdio>
#include <string>

namespace stress
{

/** Of an enumeration of quantities: how many there are, `count`; name(q); and whether one is counted but promised
 * nowhere, for_information(q). */
template <class Quantity>
struct quantities;

/** The largest error over bound of each quantity; negative where it was not checked. */
template <class Quantity>
struct verdict_of {
    using about = quantities<Quantity>;
    std::array<long double, about::count> ratio;
    verdict_of()
    {
        ratio.fill(-1);
    }

    void note(Quantity q, long double value)
    {
        if (!(value <= ratio[q])) ratio[q] = std::isnan(value) ? HUGE_VALL : value;
    }
    void note(Quantity q, bool wrong)
    {
        note(q, wrong ? HUGE_VALL : 0.0L);
    }
    /** A number against its reference; allowed is the largest error that is right, 0: the number must be met exactly.
     */
    void compare(Quantity q, double value, long double reference, long double allowed)
    {
        const long double error = std::fabs(value - reference);
        note(q, error == 0 ? 0 : error / allowed);
    }
    void add(const verdict_of &other)
    {
        for (std::size_t q = 0; q < ratio.size(); ++q)
            if (other.ratio[q] > ratio[q]) ratio[q] = other.ratio[q];
    }

    bool exceeded(std::size_t q) const
    {
        return ratio[q] > 1 && !about::for_information(static_cast<Quantity>(q));
    }
    bool exceeded() const
    {
        for (std::size_t q = 0; q < ratio.size(); ++q)
            if (exceeded(q)) return true;
        return false;
    }
    /** What exceeds its bound, for people. */
    std::string words() const
    {
        std::string all;
        char text[64];
        for (std::size_t q = 0; q < ratio.size(); ++q) {
            if (!exceeded(q)) continue;
            std::snprintf(text, sizeof text, " %s %.3Lg times its bound;", about::name(static_cast<Quantity>(q)),
                          ratio[q]);
            all += text;
        }
        return all;
    }
    void print() const
    {
        for (std::size_t q = 0; q < ratio.size(); ++q)
            if (ratio[q] >= 0)
                std::printf("%-14s %12.3Lg of its bound\n", about::name(static_cast<Quantity>(q)), ratio[q]);
    }
};

}  // namespace stress

#endif
