// Working arrays of an elimination.
#ifndef HOLONOMIC_KERNELS_ELIMINATE_SYSTEM_HPP
#define HOLONOMIC_KERNELS_ELIMINATE_SYSTEM_HPP

#include "core/kernels/arithmetic/vector3.hpp"
#include "core/kernels/memory/arena.hpp"

namespace holonomic {
namespace HOL_ISA {

// Interleaved working arrays of a linear solve, with room for W bonds more in what is read from memory.
struct System {
    vec3 *D, *D_low;
    vec *t, *L;   // t: right-hand side, then u = y / P, then the solution; L[0 .. n]: L[0] and L[n] are of no joint
    vec *pivots;  // 1 / P
    System(long n, Arena &arena)
        : D(reinterpret_cast<vec3 *>(arena.vecs(3 * (n + W)))),
          D_low(reinterpret_cast<vec3 *>(arena.vecs(3 * (n + W)))), t(arena.vecs(n + W)), L(arena.vecs(n + 1)),
          pivots(arena.vecs(n)) {}
    System(vec3 *bonds, vec *values, vec *multipliers, vec *reciprocals)
        : D(bonds), D_low(nullptr), t(values), L(multipliers), pivots(reciprocals) {}
};

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
