// Forces of small molecules of one kind.
#ifndef HOLONOMIC_KERNELS_VERBS_FORCES_SMALL_HPP
#define HOLONOMIC_KERNELS_VERBS_FORCES_SMALL_HPP

#include "core/kernels/eliminate/chain.hpp"
#include "core/kernels/memory/fixed.hpp"
#include "core/kernels/verbs/small.hpp"

namespace holonomic {
namespace HOL_ISA {

// From molecule `first` on; returns the first one that is not done.
template <int N, int terms, bool uniform>
static int64_t forces_of_molecules(const ForcesCall &call, const Unit &unit, const Block &block, int64_t first) {
    const Lane &head = unit.lanes[0];
    const auto atoms = [&](const AtomArray &a) {
        return a.x ? reinterpret_cast<double *>(a.x) + 3 * head.first_atom : nullptr;
    };
    const double *const r = atoms(call.r), *const v = atoms(call.v), *const f = atoms(call.f);
    double *const g = atoms(call.g);
    for (; molecules_left(unit, first); first += W) {
        vec3 D[N];
        vec t[N], L[N + 1];
        const int64_t at = 3 * (N + 1) * first;
        load_molecules<N, terms, uniform>(block, r + at, v ? v + at : v, f ? f + at : f, D, t);
        Packed from;
        for (int i = 0; i < W; ++i) from.lane[i] = const_cast<double *>(r) + at + 3 * (N + 1) * i;
        const Source source = {&from, nullptr, nullptr, &call.box, nullptr};
        Sweep<uniform, false> sweep{block, source, System(D, t, L, nullptr)};
        HOL_UNROLL
        for (int k = 0; k < N; ++k) sweep.step(k, t[k], k % 4 == 0, false);
        if (__builtin_expect(any(sweep.doubt() | ~sweep.calm()), 0)) break;
        backward(0, N, t, L);
        if (g) {
            if (call.add)
                store_pulls<N, add_>(D, t, g + at);
            else
                store_pulls<N, write_>(D, t, g + at);
        }
        if (call.lambda) store_multipliers<N>(t, splat(0.5), call.lambda + head.first_bond + N * first);
    }
    return first;
}

template <int N, bool uniform>
struct ForcesOfMolecules {
    static int64_t run(const ForcesCall &call, const Unit &unit, const Block &block, int64_t first) {
        if (call.v.x && call.f.x)
            return forces_of_molecules<N, velocity_squared | force_difference, uniform>(call, unit, block, first);
        if (call.f.x) return forces_of_molecules<N, force_difference, uniform>(call, unit, block, first);
        return first;
    }
};

static inline int64_t small_forces(const ForcesCall &call, const Unit &unit, const Block &block, int64_t first,
                                   Tally &) {
    const bool plain = call.r.packed && (!call.v.x || call.v.packed) && (!call.f.x || call.f.packed) &&
                       (!call.g.x || call.g.packed) && !call.tension && !call.virial && call.box.shape == Box::none;
    return plain ? any_molecules<ForcesOfMolecules>(call, unit, block, first) : first;
}

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
