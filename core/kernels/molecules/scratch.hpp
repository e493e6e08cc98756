// Working arrays of the kernels of molecules.
#pragma once

#include <stdint.h>

#include "core/kernels/arithmetic/vector3.hpp"
#include "core/kernels/arithmetic/width.hpp"

namespace holonomic::HOL_ISA::graph {

// Working arrays, handed out front to back.
template <class V>
struct Memory {
    double *next;
    V *values(int64_t n) {
        V *p = reinterpret_cast<V *>(next);
        next += n * Width<V>::lanes;
        return p;
    }
    Vector3<V> *vectors(int64_t n) { return reinterpret_cast<Vector3<V> *>(values(3 * n)); }
};

}  // namespace holonomic::HOL_ISA::graph
