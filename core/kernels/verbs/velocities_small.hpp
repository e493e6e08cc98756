// Velocities of small molecules of one kind.
#ifndef HOLONOMIC_KERNELS_VERBS_VELOCITIES_SMALL_HPP
#define HOLONOMIC_KERNELS_VERBS_VELOCITIES_SMALL_HPP

#include "core/kernels/eliminate/projection.hpp"
#include "core/kernels/memory/fixed.hpp"
#include "core/kernels/verbs/small.hpp"

namespace holonomic {
namespace HOL_ISA {

// From molecule `first` on; returns the first one that is not done.
template <int N, bool uniform>
static int64_t velocities_of_molecules(const VelocitiesCall &call, const Unit &unit, const Block &block,
                                       int64_t first) {
    const Lane &head = unit.lanes[0];
    const double *const r = reinterpret_cast<double *>(call.r.x) + 3 * head.first_atom;
    double *const v = reinterpret_cast<double *>(call.v.x) + 3 * head.first_atom;
    for (; molecules_left(unit, first); first += W) {
        vec3 D[N];
        vec t[N], left[N + 1], L[N + 1], pivots[N], elements[vectors_of<N>];
        const int64_t at = 3 * (N + 1) * first;
        load_molecules<N, none_, uniform>(block, r + at, nullptr, nullptr, D, t);
        load_molecules<N>(v + at, elements);
        Packed from;
        for (int i = 0; i < W; ++i) from.lane[i] = const_cast<double *>(r) + at + 3 * (N + 1) * i;
        const Source source = {&from, nullptr, nullptr, &call.box, nullptr};
        const Projection x({D, t, L, pivots}, reinterpret_cast<vec3 *>(elements), left);
        Sweep<uniform, true> sweep{block, source, x.s};
        HOL_UNROLL
        for (int k = 0; k < N; ++k) sweep.step(k, rate_of(D[k], x.v[k], x.v[k + 1]), k % 4 == 0, false);
        FirstPull<uniform> pull(block, x, N);
        HOL_UNROLL
        for (int k = N - 1; k >= 0; --k) pull.step(k);
        pull.finish();
        substitute(N, x.correction());
        if (__builtin_expect(any(sweep.doubt() | ~x.finite(N)), 0)) break;
        Pull<uniform> correction{block, x, left};
        HOL_UNROLL
        for (int k = N - 1; k >= 0; --k) x.v[k + 1] = correction.step(k);
        x.v[0] = correction.finish();
        if (call.lambda) store_multipliers<N>(t, 0.5 * block.mass, call.lambda + head.first_bond + N * first);
        store_elements<N, write_>(elements, v + at);
    }
    return first;
}

template <int N, bool uniform>
struct VelocitiesOfMolecules {
    static int64_t run(const VelocitiesCall &call, const Unit &unit, const Block &block, int64_t first) {
        return velocities_of_molecules<N, uniform>(call, unit, block, first);
    }
};

static inline int64_t small_velocities(const VelocitiesCall &call, const Unit &unit, const Block &block, int64_t first,
                                       Tally &) {
    const bool plain = call.r.packed && call.v.packed && !call.virial && call.box.shape == Box::none;
    return plain ? any_molecules<VelocitiesOfMolecules>(call, unit, block, first) : first;
}

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
