// Strips of triangles: every atom is bonded to the next one and to the one behind that, as in a chain whose angles are
// rigid. Slots go along the strip; the bonds that end at atom i follow those that end at the atom before it:
//
//     place 2 i - 3: from atom i - 2, a long bond;   place 2 i - 2: from atom i - 1, a short one.
//
// So at atom i the bonds at places 2 i - 3, 2 i - 2 end, those at 2 i, 2 i + 1 begin, and place 2 i - 1 passes by. The
// matrix is a band, whose columns reach four places ahead (theory (55) in that order).
#ifndef HOLONOMIC_KERNELS_GRAPH_STRIP_HPP
#define HOLONOMIC_KERNELS_GRAPH_STRIP_HPP

#include "core/kernels/arithmetic/vector3.hpp"
#include "core/kernels/graph/schedule.hpp"
#include "core/kernels/graph/width.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

// Rows before the first bond and behind the last one: bonds of no length, so that the atoms at the ends are no other
// case than those between them.
constexpr int32_t strip_rows_before = 3, strip_rows_behind = 3, more_strip_rows = strip_rows_before + strip_rows_behind;

// The bonds that take part where atom i is eliminated, counted from its first one: two end, one passes, two begin.
enum StripBond { end_long, end_short, passing, begin_short, begin_long, strip_bonds };

HOL_INLINE int32_t first_place_at(int32_t atom) { return 2 * atom - 3; }

// From the bonds of an atom to those of the next one, whose short bond that begins is `last`.
template <class T>
HOL_INLINE void to_next_atom(T *of_bond, const T &last) {
    HOL_UNROLL
    for (int e = 0; e < begin_short; ++e) of_bond[e] = of_bond[e + 2];
    of_bond[begin_short] = last;
}
// And back; the two that end at the one before are unknown.
template <class T>
HOL_INLINE void to_atom_before(T *of_bond) {
    HOL_UNROLL
    for (int e = begin_long; e >= passing; --e) of_bond[e] = of_bond[e - 2];
}

// What the bonds of a strip pull its atoms with, one atom after the other, from the pulls of the two that begin there.
template <class V>
struct StripSums {
    Vector3<V> in[3];  // of the bonds that end at the next atom, and of the long one that passes by
    HOL_FORCED Vector3<V> next(const Vector3<V> &to_short, const Vector3<V> &to_long) {
        const Vector3<V> sum = (to_short + to_long) - (in[0] + in[1]);
        in[0] = in[2];
        in[1] = to_short;
        in[2] = to_long;
        return sum;
    }
};

// Multipliers of the two columns that are eliminated at an atom, of the first for the bonds 1 .. 4 of StripBond, of the
// second for 2 .. 4.
template <class V>
struct StripColumns {
    V first[4], second[3];

    // y loses what it is coupled to. Numbers of five bonds.
    HOL_FORCED void forward(V *y) const {
        HOL_UNROLL
        for (int e = 1; e < strip_bonds; ++e) y[e] = mul_add(first[e - 1], y[0], y[e]);
        HOL_UNROLL
        for (int e = 2; e < strip_bonds; ++e) y[e] = mul_add(second[e - 2], y[1], y[e]);
    }
    // The solution of the two, whose t is u, the nearest one last.
    HOL_FORCED void back(V *t) const {
        HOL_UNROLL
        for (int e = strip_bonds - 1; e >= 2; --e) t[1] = mul_add(second[e - 2], t[e], t[1]);
        HOL_UNROLL
        for (int e = strip_bonds - 1; e >= 1; --e) t[0] = mul_add(first[e - 1], t[e], t[0]);
    }
};

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
