// Iterative refinement of multipliers against exact residuals: which corrections are good, and when to stop.
#pragma once

#include <cstdint>

#include "core/kernels/arithmetic/width.hpp"

namespace holonomic::HOL_ISA::graph {

// A correction of a multiplier, |b_k| / P_k or the same with a sign, |d|^2, and the multiplier.
template <class V>
struct Correction {
    V change, alone, q;
    V &t;
};

// The square of the largest tension of bonds first .. end.
template <class V, class Bond>
HOL_INLINE V largest_tension2(int32_t first, int32_t end, const Bond &bond) {
    V largest = {};
    for (int32_t k = first; k < end; ++k) {
        const Correction<V> c = bond(k);
        largest = max((c.t * c.t) * c.q, largest);
    }
    return largest;
}
// Adds the corrections of these bonds. Returns the square of the largest one, relative to its multiplier's size. That
// is the largest of |t_k|, |b_k| / P_k - which is no more than the multiplier's scale, as P_k is at least 1 /
// (A^-1)_kk - and a millionth of the molecule's largest tension. Not a number if one of them is none.
template <class V, class Bond>
HOL_INLINE V add_corrections(int32_t first, int32_t end, const V &tension2, const Bond &bond) {
    const V least = mul_add(Width<V>::all(1e-12), tension2, Width<V>::all(1e-290));
    V part = {}, sum = {};  // max() may lose a NaN, the sum keeps it
    for (int32_t k = first; k < end; ++k) {
        const Correction<V> c = bond(k);
        c.t = c.t + c.change;
        sum = sum + c.change;
        const V size = mul_add(c.t, c.t, c.alone * c.alone);
        part = max((c.change * c.change) * c.q / mul_add(size, c.q, least), part);
    }
    return mul_add(sum, V{}, part);
}

// Corrects the lanes in `active` until another correction would be less than a rounding. Returns those in which each
// was no more than an eighth of the one before. The first is no more than that of the multipliers themselves, or it is
// what rounding does to right-hand sides, which tells nothing about the factors.
//
// solve(): corrections from residuals, and the lanes in which they have been found; correct(active): adds them, and
// returns add_corrections(); rounded(): lanes whose corrections are what rounding does to right-hand sides.
template <class V, class Solve, class Correct, class Rounded>
HOL_INLINE MaskOf<V> correct_until_right(MaskOf<V> active, const Solve &solve, const Correct &correct,
                                         const Rounded &rounded) {
    typedef MaskOf<V> Mask;
    Mask good = Width<V>::none();
    V before = Width<V>::all(1);  // squares
    for (int pass = 0; pass < 8 && any(active); ++pass) {
        active = active & solve();
        if (!any(active)) break;
        const V part = correct(active);
        Mask contracts = less_equal(part, (0.125 * 0.125) * before);
        if (pass == 0 && any(active & ~contracts)) contracts = contracts | (active & rounded());
        const Mask done = active & contracts & less_equal(part * part, (epsilon * epsilon) * before);
        good = good | done;
        active = active & contracts & ~done;
        before = part;
    }
    return good;
}

}  // namespace holonomic::HOL_ISA::graph
