// Velocities of small molecules of one kind.
#ifndef HOLONOMIC_KERNELS_VERBS_VELOCITIES_SMALL_HPP
#define HOLONOMIC_KERNELS_VERBS_VELOCITIES_SMALL_HPP

#include "core/kernels/eliminate/projection.hpp"
#include "core/kernels/memory/loose.hpp"
#include "core/kernels/verbs/small.hpp"

namespace holonomic {
namespace HOL_ISA {

// From molecule `first` on; returns the first one that is not done. `given`: what is set of a regular unit.
template <int N, bool uniform, bool boxed, template <int> class PlaceOf, bool strained = false>
static int64_t velocities_of_molecules(const VelocitiesCall &call, const Unit &unit, const Block &given,
                                       int64_t first) {
    typedef PlaceOf<N> Place;
    const double *const r = base_of(call.r);
    double *const v = base_of(call.v);
    BlockMasses<N, Place::loose> masses(given);
    const Block &block = masses.block;
    const int64_t end = Place::end(unit, first);
    for (int64_t n; (n = Place::next(first, end)) > 0; first += n) {
        vec3 D[N];
        vec t[N], left[N + 1], L[N + 1], pivots[N], elements[vectors_of<N>];
        const Place place(unit, first, n);
        masses.take(place);
        if (fetches_next<Place>(unit, first)) {
            place.fetch_next(r);
            place.fetch_next(v);
        }
        load_molecules<N, none_, uniform, boxed>(block, call.box, place, r, nullptr, nullptr, D, t);
        place.load(v, elements);
        const Packed from = place.first_atoms(r);
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
        if (call.lambda) place.store_multipliers(t, 0.5 * block.mass, call.lambda);
        place.template store<write_>(elements, v);
    }
    return first;
}

template <int N, bool uniform, bool boxed, template <int> class PlaceOf>
struct VelocitiesOfMolecules {
    static int64_t run(const VelocitiesCall &call, const Unit &unit, const Block &block, int64_t first, Tally &) {
        return velocities_of_molecules<N, uniform, boxed, PlaceOf>(call, unit, block, first);
    }
};

// In a box that changes: without one of the library's and one behind the other, as programs have them then.
template <int N, bool uniform, bool boxed, template <int> class PlaceOf>
struct StrainedMolecules {
    static int64_t run(const VelocitiesCall &call, const Unit &unit, const Block &block, int64_t first, Tally &) {
        if constexpr (boxed)
            return first;
        else
            return velocities_of_molecules<N, uniform, false, PlaceOf, true>(call, unit, block, first);
    }
};

static inline int64_t small_velocities(const VelocitiesCall &call, const Unit &unit, const Block &block, int64_t first,
                                       Tally &tally) {
    const bool plain = call.r.packed && call.v.packed && !call.virial;
    const bool boxed = call.box.shape != Box::none;
    if (plain && call.strain) return any_molecules<StrainedMolecules>(call, unit, block, first, boxed, tally);
    return plain ? any_molecules<VelocitiesOfMolecules>(call, unit, block, first, boxed, tally) : first;
}

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
