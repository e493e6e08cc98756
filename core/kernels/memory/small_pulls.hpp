// What bonds of small molecules pull at their atoms.
#pragma once

#include "core/kernels/memory/small.hpp"

namespace holonomic::HOL_ISA {

// G of the atoms of W molecules, written or added.
template <class View, class Array>
HOL_INLINE void store_pulls(const vec3 *D, const vec *t, const View &view, const Array &out, bool add) {
    constexpr int N = View::bonds;
    vec value[vectors_of<N>] = {};
    vec3 before = {};
    HOL_UNROLL
    for (int k = 0; k <= N; ++k) {
        const vec3 after = k < N ? t[k] * D[k] : vec3{}, g = after - before;
        value[3 * k] = g.x;
        value[3 * k + 1] = g.y;
        value[3 * k + 2] = g.z;
        before = after;
    }
    add ? store_molecules<add_>(view, value, out) : store_molecules<write_>(view, value, out);
}

}  // namespace holonomic::HOL_ISA
