/**
 * @file byte_reader.hpp
 * Decisions and numbers out of a fuzzer's bytes; when they run out everything is zero.
 */
#ifndef FUZZ_BYTE_READER_HPP
#define FUZZ_BYTE_READER_HPP

#include <cfloat>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace fuzz
{

class byte_reader
{
public:
    byte_reader(const std::uint8_t *data, std::size_t size) : at_(data), end_(data + size)
    {
    }

    bool done() const
    {
        return at_ == end_;
    }
    std::uint8_t byte()
    {
        return done() ? std::uint8_t{0} : *at_++;
    }
    int below(int n)
    {
        return byte() % n;
    }
    bool often()
    {
        return byte() % 16 != 15;
    }  ///< mostly true, and true when the bytes have run out

    /** A coordinate, mass, force and so on: mostly a harmless one, sometimes as bad as can be. */
    double number()
    {
        const int kind = byte();
        if (kind < 200) return static_cast<double>(kind) / 16 - 6 + static_cast<double>(byte()) / 256;
        if (kind < 220) return std::ldexp(static_cast<double>(byte()) + 1, byte() * 8 - 1024);
        static const double special[] = {0.0,       -0.0,    1.0,      -1.0,    NAN,    INFINITY,
                                         -INFINITY, DBL_MAX, -DBL_MAX, DBL_MIN, 5e-324, 1e300,
                                         1e-300,    1e150,   1e-150,   1e154,   1e16,   DBL_EPSILON};
        return special[static_cast<std::size_t>(kind) % (sizeof special / sizeof *special)];
    }

    /** A positive number of ordinary size, or, seldom, anything. */
    double size()
    {
        return often() ? 0.25 + static_cast<double>(byte()) / 64 : number();
    }

    /** A whole number near the interesting ones. */
    std::int64_t whole()
    {
        const int kind = byte();
        if (kind < 216) return kind % 24;
        static const std::int64_t special[] = {-1,        -2, INT64_MAX, INT64_MIN, INT64_MAX - 1, 1000, INT32_MAX,
                                               INT32_MIN, 64, 63,        65};
        return special[static_cast<std::size_t>(kind) % (sizeof special / sizeof *special)];
    }

private:
    const std::uint8_t *at_, *end_;
};

}  // namespace fuzz

#endif
