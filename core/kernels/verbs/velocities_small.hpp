// Velocities of small molecules.
#ifndef HOLONOMIC_KERNELS_VERBS_VELOCITIES_SMALL_HPP
#define HOLONOMIC_KERNELS_VERBS_VELOCITIES_SMALL_HPP

#include "core/kernels/eliminate/projection.hpp"
#include "core/kernels/verbs/small.hpp"

namespace holonomic::HOL_ISA {

// Does molecules from `first` on. Returns the first one that is not done. `given`: the block of a regular unit.
template <class Place, bool uniform, bool boxed, bool strained>
static int64_t velocities_of_molecules(const VelocitiesCall &call, const Unit &unit, const Block &given,
                                       int64_t first) {
    constexpr int N = Place::bonds;
    const double *const r = base_of(call.r);
    double *const v = base_of(call.v);
    BlockMasses<Place> masses(given);
    const Block &block = masses.block;
    const int64_t end = Place::end(unit, first);
    for (int64_t n; (n = Place::next(first, end)) > 0; first += n) {
        vec3 D[N];
        vec t[N], left[N + 1], L[N + 1], pivots[N], elements[vectors_of<N>];
        const Place place(unit, first, n);
        masses.take(place);
        place.fetch_next(r);
        place.fetch_next(v);
        load_bonds<boxed>(call.box, place, r, elements, D);
        load_molecules(place, v, elements);
        const Packed from = first_atoms(place, r);
        const Source source = {&from, r, place.lists(), &call.box, nullptr, place.lanes()};
        const Projection x({D, t, L, pivots}, reinterpret_cast<vec3 *>(elements), left);
        Sweep<uniform, true> sweep{block, source, x.s};
        HOL_UNROLL
        for (int k = 0; k < N; ++k) {
            vec b = rate_of(D[k], x.v[k], x.v[k + 1]);
            if constexpr (strained) b = b + stretching(call.strain, D[k]);
            sweep.step(k, b, k % 4 == 0, false);
        }
        FirstPull<uniform> pull(block, x, N);
        HOL_UNROLL
        for (int k = N - 1; k >= 0; --k) pull.step(k);
        pull.finish();
        for (int k = 0; strained && k < N; ++k) left[k] = left[k] + stretching(call.strain, D[k]);
        substitute(N, x.correction());
        if (__builtin_expect(any(sweep.doubt() | ~x.finite(N)), 0)) break;
        Pull<uniform> correction{block, x, left};
        HOL_UNROLL
        for (int k = N - 1; k >= 0; --k) x.v[k + 1] = correction.step(k);
        x.v[0] = correction.finish();
        if (call.lambda) store_multipliers(place, t, 0.5 * block.mass, call.lambda);
        store_molecules<write_>(place, elements, v);
    }
    return first;
}

// With a rate of the box, only molecules in a row and without images have a kernel: those are what programs have then.
static inline int64_t small_velocities(const VelocitiesCall &call, const Unit &unit, Block &block, int64_t first,
                                       Tally &) {
    if (!call.r.packed || !call.v.packed || call.virial) return first;
    return any_molecules(unit, block, first, call.box.shape != Box::none, true,
                         [&](auto place, auto uniform, auto boxed) {
                             typedef typename decltype(place)::type Place;
                             if (!call.strain)
                                 return velocities_of_molecules<Place, uniform, boxed, false>(call, unit, block, first);
                             if constexpr (boxed)
                                 return first;
                             else
                                 return velocities_of_molecules<Place, uniform, false, true>(call, unit, block, first);
                         });
}

}  // namespace holonomic::HOL_ISA
#endif
