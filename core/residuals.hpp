// What is left of each constraint.
#pragma once

#include "core/caller/box.hpp"
#include "core/molecules/chains.hpp"

namespace holonomic {

// (d.d - a^2) / a^2 and d.(v_j - v_i + L d).
struct Residual {
    double length, rate;
};
// Of a bond of vector d and length a, whose atoms have these velocities. box_rate: that of L, or nullptr.
inline Residual residual_of(const double *d, const double *v_i, const double *v_j, double a, const BoxRate *box_rate) {
    double dd = 0, du = 0;
    for (int c = 0; c < 3; ++c) {
        dd += d[c] * d[c];
        du += d[c] * (v_j[c] - v_i[c]);
    }
    if (box_rate) du += stretching(*box_rate, d);
    return {(dd - a * a) / (a * a), du};
}

// Of each bond, [n_bonds] in the caller's order: (d.d - a^2) / a^2 and d.(v_j - v_i + L d), 0 without v; either may be
// nullptr. Throws Error once all molecules that give numbers are done.
void residuals(const Chains &chains, const AtomArray &r, const AtomArray &v, double *length, double *rate);

}  // namespace holonomic
