/**
 * @file atom_array.hpp
 * An array per atom in memory of exactly its size, so that a sanitizer sees each step outside, with a view of it that
 * may be wrong in any of its members.
 */
#ifndef FUZZ_ATOM_ARRAY_HPP
#define FUZZ_ATOM_ARRAY_HPP

#include <holonomic.h>

#include <cstring>
#include <memory>
#include <vector>

#include "byte_reader.hpp"

namespace fuzz
{

/** A block of bytes on the heap, exactly as long as needed. */
class block
{
public:
    explicit block(std::size_t bytes) : bytes_(bytes), data_(new char[bytes])
    {
        std::memset(data_.get(), 0x41, bytes);
    }
    char *data()
    {
        return data_.get();
    }
    double *doubles()
    {
        return reinterpret_cast<double *>(data_.get());
    }
    std::vector<char> copy() const
    {
        return std::vector<char>(data_.get(), data_.get() + bytes_);
    }
    bool holds(const std::vector<char> &other) const
    {
        return bytes_ == 0 || std::memcmp(data_.get(), other.data(), bytes_) == 0;
    }

private:
    std::size_t bytes_;
    std::unique_ptr<char[]> data_;
};

/** Positions of one coil of unit bonds. */
inline void walk(double *x, std::size_t n, unsigned seed)
{
    for (std::size_t i = 0; i < n; i += 3) {
        double d[3], square = 0;
        for (double &c : d) {
            seed = seed * 1664525u + 1013904223u;
            c = static_cast<double>(seed >> 8) / (1 << 23) - 1;
            square += c * c;
        }
        for (std::size_t c = 0; c < 3; ++c) x[i + c] = i < 3 ? 0 : x[i + c - 3] + d[c] / std::sqrt(square);
    }
}

/** Fills with numbers from the reader; a few bytes decide about the whole if they are few. */
inline void fill(block &b, std::size_t n, byte_reader &in, bool positive = false)
{
    double *x = b.doubles();
    const int style = in.byte() % 5;
    if (style == 4 && !positive && n % 3 == 0) return walk(x, n, in.byte());
    for (std::size_t i = 0; i < n; ++i) {
        if (style == 0 || in.done())
            x[i] = positive ? 1.0 : static_cast<double>((i * 7 + i * i * 3) % 11) / 4 + static_cast<double>(i % 3);
        else
            x[i] = positive ? in.size() : in.number();
    }
}

/** The array [n_atoms][3] and what the plain and the view functions are given. */
struct atom_array {
    std::size_t n;
    block plain, laid_out;
    hol_view view;
    hol_const_view read;
    const hol_const_view *input()
    {
        read = hol_view_read(&view);
        return &read;
    }

    atom_array(std::int64_t n_atoms, byte_reader &in)
        : n(static_cast<std::size_t>(n_atoms)), plain(3 * n * sizeof(double)),
          laid_out(16 * (3 * n + 3) * sizeof(double))
    {
        fill(plain, 3 * n, in);
        const int shape = in.byte();
        const bool is_float = shape & 1, backwards = shape & 2, flat = shape & 4, records = shape & 8;
        const std::int64_t element = is_float ? sizeof(float) : sizeof(double),
                           step = records ? 3 + (shape >> 4 & 3) : 1;
        const std::int64_t part = records ? element : n_atoms * element;  // from x to y
        char *first = laid_out.data() + (backwards && n_atoms > 0 ? (n_atoms - 1) * step * element : 0);
        view = {first,
                first + part,
                flat ? nullptr : first + 2 * part,
                (backwards ? -1 : 1) * step * element,
                is_float ? HOL_FLOAT : HOL_DOUBLE,
                0};
        const double *from = plain.doubles();
        for (std::int64_t i = 0; i < n_atoms; ++i)
            for (int x = 0; x < (flat ? 2 : 3); ++x) {
                char *const to = first + i * view.stride + x * part;
                const double value = from[3 * i + x];
                const float small = static_cast<float>(std::fabs(value) < 1e30 || !std::isfinite(value) ? value : 1);
                if (is_float)
                    std::memcpy(to, &small, sizeof small);
                else
                    std::memcpy(to, &value, sizeof value);
            }
        if (!in.often()) spoil(in);
    }

private:
    void spoil(byte_reader &in)
    {
        switch (in.below(6)) {
            case 0:
                view.x = nullptr;
                break;
            case 1:
                view.y = nullptr;
                break;
            case 2:
                view.stride = 0;
                break;
            case 3:
                view.stride = view.stride + 1;
                break;
            case 4:
                view.element = in.byte() - 100;
                if (view.element == HOL_DOUBLE || view.element == HOL_FLOAT) view.element = 7;
                break;
            default:
                view.reserved = in.byte() | 1;
                break;
        }
    }
};

}  // namespace fuzz

#endif
