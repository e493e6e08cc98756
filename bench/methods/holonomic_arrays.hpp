/** A problem's arrays in other layouts than [n_atoms][3] of double: what a view or an index list describes. */
#ifndef BENCH_METHODS_HOLONOMIC_ARRAYS_HPP
#define BENCH_METHODS_HOLONOMIC_ARRAYS_HPP

#include <holonomic.h>

#include <vector>

#include "../problem.hpp"

namespace bench {

struct Shape {
    std::size_t dimensions;  ///< 2: z is left out
    std::size_t stride;      ///< numbers from an atom to the next
    bool apart;              ///< an array for each component
};

/// One vector per atom, of doubles or floats, atoms in any order within a chain.
template <class T>
class Array {
public:
    Array(const Problem &p, const Shape &shape, std::vector<std::int64_t> order)
        : problem_(p), shape_(shape), step_(shape.apart ? shape.stride * p.atoms() : 1), order_(std::move(order)),
          data_((shape.apart ? shape.dimensions : 1) * shape.stride * p.atoms()) {}

    void copy_from(const std::vector<double> &values) {
        for_each([&](std::size_t here, std::size_t there) { data_[here] = static_cast<T>(values[there]); });
    }
    void copy_to(std::vector<double> &values) const {
        for_each([&](std::size_t here, std::size_t there) { values[there] = static_cast<double>(data_[here]); });
    }
    hol_view view() {
        hol_view v = {};
        v.x = data_.data();
        v.y = data_.data() + step_;
        if (shape_.dimensions == 3) v.z = data_.data() + 2 * step_;
        v.stride = static_cast<std::int64_t>(sizeof(T) * shape_.stride);
        v.element = sizeof(T) == sizeof(float) ? HOL_FLOAT : HOL_DOUBLE;
        return v;
    }

private:
    template <class Do>
    void for_each(Do act) const {
        for (std::size_t c = 0; c < problem_.n_chains(); ++c)
            for (std::size_t i = 0; i <= problem_.n(); ++i) {
                const std::size_t atom = problem_.first_atom(c);
                const std::size_t here = atom + (order_.empty() ? i : static_cast<std::size_t>(order_[i]));
                for (std::size_t x = 0; x < shape_.dimensions; ++x)
                    act(shape_.stride * here + x * step_, 3 * (atom + i) + x);
            }
    }
    const Problem &problem_;
    Shape shape_;
    std::size_t step_;  ///< numbers from a component to the next
    std::vector<std::int64_t> order_;
    std::vector<T> data_;
};

}  // namespace bench

#endif
