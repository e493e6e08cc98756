// The position level of molecules that are no chains, once over all ways: read, iterate (theory (15)-(17)), reject what
// moves too far, write, count. A way gives what differs, for one molecule or those in the lanes of a block:
//   newton                    the system of iterate.hpp that it is
//   Extent load()             reads bonds, and tau where there is a guess
//   V largest_pull(exact)     the largest w |tau| of an atom; unless exact, perhaps more
//   note_worst(which, error)  the worst bond of the lanes in `which`
//   write_multipliers(which), add_virial(which), write_moves(which, right)   `right`: lanes that stay
// and, where PositionWay does not do, far() and rejected().
#pragma once

#include "core/kernels/molecules/iterate.hpp"
#include "core/kernels/molecules/store.hpp"

namespace holonomic::HOL_ISA::graph {

// Of a molecule: its largest coordinate, its shortest and its longest bond.
template <class V>
struct Extent {
    V coordinate, a_min, a_max;
};

template <class V>
struct PositionWay {
    typedef V Value;
    const PositionsCall &call;
    const MoleculeLane *const lane;  // of all lanes; those without a molecule repeat the first one
    Tally &tally;

    double per_dt2() const { return 1 / (call.dt * call.dt); }
    double lambda_of_tau() const { return 0.5 / (call.dt * call.dt); }
    double tau_of_lambda() const { return 2 * call.dt * call.dt; }
    // The error from which nothing is tried.
    double far() const { return call.far_trial; }
    // Of lanes that have converged, those that are rejected all the same.
    MaskOf<V> rejected(MaskOf<V>) const { return Width<V>::none(); }

    // The guess of bonds k = first .. end - 1, into tau_of(k). bond_of: as the caller numbers them.
    template <class TauOf>
    HOL_FORCED void load_guess(const int32_t *bond_of, int32_t first, int32_t end, const TauOf &tau_of) const {
        const double factor = tau_of_lambda();
        for (int32_t k = first; k < end; ++k)
            for (int i = 0; i < Width<V>::lanes; ++i)
                Width<V>::set(tau_of(k), i, factor * call.lambda[lane[i].first_bond + bond_of[k]]);
    }
    // The multipliers of these bonds.
    template <class TauOf>
    HOL_FORCED void write_lambda(const int32_t *bond_of, int32_t first, int32_t end, unsigned which,
                                 const TauOf &tau_of) const {
        const V factor = Width<V>::all(lambda_of_tau());
        write_values<V>(bond_of, lane, call.lambda, which, first, end,
                        [&](int32_t k) HOL_FORCED { return mul_add(tau_of(k), factor, V{}); });
    }
};

// Finds multipliers, and writes nothing. Rejected, and so not converged, are lanes in which an atom's displacement is
// the difference of pulls so large that their rounding is more than the coordinates'.
template <class Way>
__attribute__((noinline)) Solved<typename Way::Value> find_multipliers(Way &x, MaskOf<typename Way::Value> in_use) {
    typedef typename Way::Value V;
    const Extent<V> extent = x.load();
    Limits<V> limits(x.call, extent.coordinate, extent.a_min);
    limits.far = x.far();
    Solved<V> out = iterate<V, false, true>(x.newton, limits, x.call, in_use);
    if (!any(out.converged)) return out;
    out.converged = out.converged & ~x.rejected(out.converged);
    const auto coarse = [&](bool exact) HOL_FORCED {
        return less(0.25 * (extent.coordinate + extent.a_min), x.largest_pull(exact) * extent.a_max);
    };
    if (any(out.converged & coarse(false))) out.converged = out.converged & ~coarse(true);
    return out;
}

// Returns the lanes that need extended arithmetic; nothing of them has been written. between(): what is done before
// anything is written.
template <class Way, class Between>
HOL_INLINE unsigned solve_positions(Way &x, MaskOf<typename Way::Value> in_use, const Between &between) {
    const auto out = find_multipliers(x, in_use);
    between();
    const unsigned moved = bits(out.converged), good = moved | bits(out.untouched);
    if (!good) return bits(in_use);
    if (x.call.report) x.note_worst(good, out.error);
    if (x.call.lambda) x.write_multipliers(good);
    if (moved) {
        if (x.call.virial) x.add_virial(moved);
        x.write_moves(moved, good & ~moved);
        count_moved(x.tally, __builtin_popcount(moved), out.solves);
    }
    return bits(in_use) & ~good;
}

}  // namespace holonomic::HOL_ISA::graph
