/** A problem's arrays in other layouts than [n_atoms][3] of double: what a view or an index list describes. */
#ifndef BENCH_METHODS_HOLONOMIC_ARRAYS_HPP
#define BENCH_METHODS_HOLONOMIC_ARRAYS_HPP

#include <holonomic.h>

#include <vector>

#include "../problem.hpp"

namespace bench {

/// One vector per atom, of doubles or floats, x y z together or in arrays of their own, atoms in any order within a
/// chain.
template <class T>
class Array {
public:
    enum class Components { together, apart };
    Array(const Problem &p, Components components, std::vector<std::int64_t> order)
        : problem_(p), apart_(components == Components::apart), order_(std::move(order)), data_(3 * p.atoms()) {}

    void copy_from(const std::vector<double> &values) {
        for_each([&](std::size_t here, std::size_t there) { data_[here] = static_cast<T>(values[there]); });
    }
    void copy_to(std::vector<double> &values) const {
        for_each([&](std::size_t here, std::size_t there) { values[there] = static_cast<double>(data_[here]); });
    }
    T *data() { return data_.data(); }
    hol_view view() {
        hol_view v = {};
        const std::size_t step = apart_ ? problem_.atoms() : 1;
        v.x = data_.data();
        v.y = data_.data() + step;
        v.z = data_.data() + 2 * step;
        v.stride = static_cast<std::int64_t>(sizeof(T) * (apart_ ? 1 : 3));
        v.element = sizeof(T) == sizeof(float) ? HOL_FLOAT : HOL_DOUBLE;
        return v;
    }

private:
    template <class Do>
    void for_each(Do act) const {
        const std::size_t atoms = problem_.atoms();
        for (std::size_t c = 0; c < problem_.n_chains(); ++c)
            for (std::size_t i = 0; i <= problem_.n(); ++i) {
                const std::size_t atom = problem_.first_atom(c);
                const std::size_t here = atom + (order_.empty() ? i : static_cast<std::size_t>(order_[i]));
                for (std::size_t x = 0; x < 3; ++x) act(apart_ ? x * atoms + here : 3 * here + x, 3 * (atom + i) + x);
            }
    }
    const Problem &problem_;
    bool apart_;
    std::vector<std::int64_t> order_;
    std::vector<T> data_;
};

}  // namespace bench

#endif
