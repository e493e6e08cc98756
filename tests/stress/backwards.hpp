/**
 * @file backwards.hpp
 * A layout of the caller's arrays that is far from packed.
 */
#ifndef STRESS_BACKWARDS_HPP
#define STRESS_BACKWARDS_HPP

#include <holonomic.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace stress
{

/** An array per atom as three arrays that begin with the last atom. */
struct backwards {
    std::vector<double> memory;
    hol_view view;
    hol_const_view read;
    const hol_const_view *input()
    {
        read = hol_view_read(&view);
        return &read;
    }
    explicit backwards(const std::vector<double> &from) : memory(from.size())
    {
        const std::size_t n = from.size() / 3;
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t x = 0; x < 3; ++x) memory[x * n + n - 1 - i] = from[3 * i + x];
        double *last = memory.data() + n - 1;
        view = {last, last + n, last + 2 * n, -static_cast<std::int64_t>(sizeof(double)), HOL_DOUBLE, 0};
    }
    void give_back(std::vector<double> &to) const
    {
        const std::size_t n = to.size() / 3;
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t x = 0; x < 3; ++x) to[3 * i + x] = memory[x * n + n - 1 - i];
    }
};

}  // namespace stress

#endif
