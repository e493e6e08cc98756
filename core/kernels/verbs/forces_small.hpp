// Forces of small molecules of one kind.
#ifndef HOLONOMIC_KERNELS_VERBS_FORCES_SMALL_HPP
#define HOLONOMIC_KERNELS_VERBS_FORCES_SMALL_HPP

#include "core/kernels/eliminate/chain.hpp"
#include "core/kernels/memory/loose.hpp"
#include "core/kernels/verbs/small.hpp"

namespace holonomic {
namespace HOL_ISA {

// From molecule `first` on; returns the first one that is not done. `given`: what is set of a regular unit.
template <int N, int terms, bool uniform, bool boxed, template <int> class PlaceOf>
static int64_t forces_of_molecules(const ForcesCall &call, const Unit &unit, const Block &given, int64_t first) {
    typedef PlaceOf<N> Place;
    const double *const r = base_of(call.r), *const v = base_of(call.v), *const f = base_of(call.f);
    double *const g = base_of(call.g);
    BlockMasses<N, Place::loose> masses(given);
    const Block &block = masses.block;
    const int64_t end = Place::end(unit, first);
    for (int64_t n; (n = Place::next(first, end)) > 0; first += n) {
        vec3 D[N];
        vec t[N], L[N + 1];
        const Place place(unit, first, n);
        masses.take(place);
        if (fetches_next<Place>(unit, first)) {
            place.fetch_next(r);
            place.fetch_next(v);
            place.fetch_next(f);
        }
        load_molecules<N, terms, uniform, boxed>(block, call.box, place, r, v, f, D, t);
        const Packed from = place.first_atoms(r);
        const Source source = {&from, r, place.lists(), &call.box, nullptr, place.lanes()};
        Sweep<uniform, false> sweep{block, source, System(D, t, L, nullptr)};
        HOL_UNROLL
        for (int k = 0; k < N; ++k) sweep.step(k, t[k], k % 4 == 0, false);
        if (__builtin_expect(any(sweep.doubt() | ~sweep.calm()), 0)) break;
        backward(0, N, t, L);
        if (g) {
            if (call.add)
                store_pulls<N, add_>(D, t, place, g);
            else
                store_pulls<N, write_>(D, t, place, g);
        }
        if (call.lambda) place.store_multipliers(t, splat(0.5), call.lambda);
    }
    return first;
}

template <int N, bool uniform, bool boxed, template <int> class PlaceOf>
struct ForcesOfMolecules {
    static int64_t run(const ForcesCall &call, const Unit &unit, const Block &block, int64_t first, Tally &) {
        constexpr int both = velocity_squared | force_difference;
        if (call.v.x && call.f.x)
            return forces_of_molecules<N, both, uniform, boxed, PlaceOf>(call, unit, block, first);
        if (call.f.x)
            return forces_of_molecules<N, force_difference, uniform, boxed, PlaceOf>(call, unit, block, first);
        return first;
    }
};

static inline int64_t small_forces(const ForcesCall &call, const Unit &unit, const Block &block, int64_t first,
                                   Tally &tally) {
    const bool plain = call.r.packed && (!call.v.x || call.v.packed) && (!call.f.x || call.f.packed) &&
                       (!call.g.x || call.g.packed) && !call.tension && !call.virial;
    const bool boxed = call.box.shape != Box::none;
    return plain ? any_molecules<ForcesOfMolecules>(call, unit, block, first, boxed, tally) : first;
}

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
