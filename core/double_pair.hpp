// Numbers of twice the precision, hi + lo, outside the kernels: for what is evaluated once and must not lose digits.
#pragma once

#include <cstdint>

#include "core/kernels/atom.hpp"

#define HOL_ISA plain
#define HOL_LANES 2
#include "core/kernels/extended/image.hpp"
#undef HOL_ISA
#undef HOL_LANES

namespace holonomic {

using plain::Vector3;
using DoublePair = plain::Wide;
using PairVector = plain::Wide3;

inline DoublePair as_pair(double a) { return {a, 0}; }
inline PairVector vector_of_atom(const AtomArray &array, std::int64_t atom) {
    double x[3];
    read_atom(array, atom, x);
    return {as_pair(x[0]), as_pair(x[1]), as_pair(x[2])};
}
using plain::dot;
using plain::rounded;

// (a + a_lo).(b + b_lo) as if in three times the precision (Ogita, Rump and Oishi, SumK): for vectors that are square
// to their last digits.
inline double dot_exact(const Vector3<double> &a, const Vector3<double> &a_lo, const Vector3<double> &b,
                        const Vector3<double> &b_lo) {
    const double factors[3][4] = {{a.x, a_lo.x, b.x, b_lo.x}, {a.y, a_lo.y, b.y, b_lo.y}, {a.z, a_lo.z, b.z, b_lo.z}};
    double terms[24];
    int n = 0;
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < 2; ++i)
            for (int j = 2; j < 4; ++j) {
                const DoublePair p = plain::two_product(factors[c][i], factors[c][j]);
                terms[n++] = p.hi;
                terms[n++] = p.lo;
            }
    for (int pass = 0; pass < 2; ++pass)
        for (int i = 1; i < n; ++i) {
            const DoublePair s = plain::two_sum(terms[i], terms[i - 1]);
            terms[i] = s.hi;
            terms[i - 1] = s.lo;
        }
    double sum = 0;
    for (int i = 0; i < n; ++i) sum += terms[i];
    return sum;
}

}  // namespace holonomic
