// Working arrays of the kernels of molecules.
#ifndef HOLONOMIC_KERNELS_MOLECULES_SCRATCH_HPP
#define HOLONOMIC_KERNELS_MOLECULES_SCRATCH_HPP

#include <stdint.h>

#include "core/kernels/arithmetic/vector3.hpp"
#include "core/kernels/arithmetic/width.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

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

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
