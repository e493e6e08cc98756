// Forces of small molecules.
#ifndef HOLONOMIC_KERNELS_VERBS_FORCES_SMALL_HPP
#define HOLONOMIC_KERNELS_VERBS_FORCES_SMALL_HPP

#include "core/kernels/eliminate/chain.hpp"
#include "core/kernels/verbs/small.hpp"

namespace holonomic::HOL_ISA {

// Bonds D[k] of W molecules and their right-hand sides t[k], rounded as load_chunk() does.
template <int terms, bool uniform, bool boxed, class Place>
HOL_INLINE void load_sides(const Block &block, const Box &box, const Place &place, const double *r, const double *v,
                           const double *f, vec3 *D, vec *t) {
    constexpr int N = Place::bonds;
    const bool wait = boxed && box.shape == Box::triclinic;  // as in load_chunk_with()
    vec e[vectors_of<N>], p[3 * N] = {}, *const d = &D[0].x;
    vec3 other[boxed ? N : 1];
    load_bonds<boxed>(box, place, r, e, D);
    if (terms & velocity_squared) {
        load_molecules(place, v, e);
        HOL_UNROLL
        for (int c = 0; c < 3 * N; ++c) p[c] = square<terms>(block.mass, e[c + 3] - e[c]);
    }
    load_molecules(place, f, e);
    HOL_UNROLL
    for (int c = 0; c < 3 * N; ++c) {
        const vec df = uniform ? e[c + 3] - e[c] : block.w[c / 3 + 1] * e[c + 3] - block.w[c / 3] * e[c];
        if (wait)
            (&other->x)[c] = df;
        else
            p[c] = product<terms>(d[c], vec{}, df, p[c]);
    }
    HOL_UNROLL
    for (int k = 0; k < N; ++k) {
        t[k] = (p[3 * k] + p[3 * k + 1]) + p[3 * k + 2];
        if (wait) t[k] = terms & velocity_squared ? dot(D[k], other[k]) + t[k] : dot(D[k], other[k]);
    }
}

// G of the atoms of W molecules.
template <Update update, class Place>
HOL_INLINE void store_pulls(const vec3 *D, const vec *t, const Place &place, double *out) {
    constexpr int N = Place::bonds;
    vec value[vectors_of<N>] = {};
    vec3 before = {};
    HOL_UNROLL
    for (int k = 0; k <= N; ++k) {
        const vec3 after = k < N ? t[k] * D[k] : vec3{}, g = after - before;
        value[3 * k] = g.x;
        value[3 * k + 1] = g.y;
        value[3 * k + 2] = g.z;
        before = after;
    }
    store_molecules<update>(place, value, out);
}

// Does molecules from `first` on. Returns the first one that is not done. `given`: the block of a regular unit.
template <class Place, int terms, bool uniform, bool boxed>
static int64_t forces_of_molecules(const ForcesCall &call, const Unit &unit, const Block &given, int64_t first) {
    constexpr int N = Place::bonds;
    const double *const r = base_of(call.r), *const v = base_of(call.v), *const f = base_of(call.f);
    double *const g = base_of(call.g);
    BlockMasses<Place> masses(given);
    const Block &block = masses.block;
    const int64_t end = Place::end(unit, first);
    for (int64_t n; (n = Place::next(first, end)) > 0; first += n) {
        vec3 D[N];
        vec t[N], L[N + 1];
        const Place place(unit, first, n);
        masses.take(place);
        place.fetch_next(r);
        place.fetch_next(v);
        place.fetch_next(f);
        load_sides<terms, uniform, boxed>(block, call.box, place, r, v, f, D, t);
        const Packed from = first_atoms(place, r);
        const Source source = {&from, r, place.lists(), &call.box, nullptr, place.lanes()};
        Sweep<uniform, false> sweep{block, source, System(D, t, L, nullptr)};
        HOL_UNROLL
        for (int k = 0; k < N; ++k) sweep.step(k, t[k], k % 4 == 0, false);
        if (__builtin_expect(any(sweep.doubt() | ~sweep.calm()), 0)) break;
        backward(0, N, t, L);
        if (g) call.add ? store_pulls<add_>(D, t, place, g) : store_pulls<write_>(D, t, place, g);
        if (call.lambda) store_multipliers(place, t, splat(0.5), call.lambda);
    }
    return first;
}

static inline int64_t small_forces(const ForcesCall &call, const Unit &unit, Block &block, int64_t first, Tally &) {
    const bool plain = call.r.packed && (!call.v.x || call.v.packed) && call.f.packed && (!call.g.x || call.g.packed) &&
                       !call.tension && !call.virial;
    if (!plain || !call.f.x) return first;
    return any_molecules(
        unit, block, first, call.box.shape != Box::none, true, [&](auto place, auto uniform, auto boxed) {
            typedef typename decltype(place)::type Place;
            constexpr int both = velocity_squared | force_difference;
            return call.v.x ? forces_of_molecules<Place, both, uniform, boxed>(call, unit, block, first)
                            : forces_of_molecules<Place, force_difference, uniform, boxed>(call, unit, block, first);
        });
}

}  // namespace holonomic::HOL_ISA
#endif
