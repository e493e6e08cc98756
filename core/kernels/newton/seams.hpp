// Chains at the position level that are solved in parts which know nothing of each other: what is asked of a part, and
// whether two of them fit together where they meet.
#pragma once

#include "core/kernels/arithmetic/image.hpp"
#include "core/kernels/memory/stage.hpp"
#include "core/kernels/newton/criterion.hpp"
#include "core/kernels/tally.hpp"

namespace holonomic::HOL_ISA {

enum WindowResult { window_failed, window_untouched, window_solved };

// The lengths at the ends of a part must be within the tolerance with the multipliers of its neighbour, too. A guess
// does not help: it knows of the pulls beyond the ends of a part, which are not there.
HOL_INLINE PositionsCall call_for_parts(const PositionsCall &call) {
    PositionsCall strict = call;
    strict.tolerance = call.tolerance / 8;
    strict.v = AtomArray{};
    strict.guess = false;
    return strict;
}
HOL_INLINE double enough_at_seams(const PositionsCall &call) {
    return call.tolerance > floor_error ? call.tolerance : floor_error;
}

// Returns the largest |D.D - a^2| / a^2 of the bonds on either side of atom `seam`, moved by tau; notes it if it is the
// largest so far.
static inline double seam_error(const PositionsCall &call, const Lane &lane, int64_t seam, const double *tau,
                                Arena arena, Tally &tally) {
    const int64_t from = seam - 2 > 0 ? seam - 2 : 0, end = seam + 2 < lane.n_bonds ? seam + 2 : lane.n_bonds;
    const long n = static_cast<long>(end - from);
    Packed r_ref = {}, r = {};
    open_lane(call.r_ref, lane, from, n, n, r_ref, 0, arena.doubles(staged_size(n)), true);
    open_lane(call.r, lane, from, n, n, r, 0, arena.doubles(staged_size(n)), true);
    Vector3<double> pull[6] = {}, move[5];  // pull[k + 1]: of bond from + k
    const auto bond = [](const Box &box, const double *p) { return bond_vector(box, p, p + 3); };
    for (long k = 0; k < n; ++k) pull[k + 1] = tau[from + k] * bond(call.box_ref, r_ref.lane[0] + 3 * k);
    for (long k = 0; k <= n; ++k) move[k] = relative_w(lane, from + k) * (pull[k + 1] - pull[k]);
    double worst = 0;
    for (int64_t k = seam - 1; k <= seam; ++k) {
        const long i = static_cast<long>(k - from);
        const double a = lane.length ? lane.length[k] : lane.length_uniform;
        const Vector3<double> d = bond(call.box, r.lane[0] + 3 * i) + (move[i + 1] - move[i]);
        const double error = abs(excess(d, a * a)) / (a * a);
        if (!(error <= worst)) worst = error;
        if (!(error > tally.worst)) continue;
        tally.worst = error;
        tally.worst_bond = k;
    }
    return worst;
}

// A largest number that threads share.
struct SharedLargest {
    double value = 0;
    double seen() const {
        double a;
        __atomic_load(&value, &a, __ATOMIC_RELAXED);
        return a;
    }
    void raise(double to) {
        double a = seen();
        while (to > a && !__atomic_compare_exchange(&value, &a, &to, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
        }
    }
    // Lets solve() note a larger error in `part`; of equal ones several may be noted, and the first part's counts.
    template <class Solve>
    auto look(int64_t chain, Tally &part, const Solve &solve) {
        const double most = seen(), known = most > 0 ? most * (1 - epsilon) : -4.9e-324;
        part.worst = known;
        part.worst_chain = chain;
        const auto result = solve();
        if (part.worst == known)
            part.worst_chain = -1;
        else
            raise(part.worst);
        return result;
    }
};

}  // namespace holonomic::HOL_ISA
