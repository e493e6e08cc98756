// Velocity level of a block of chains: the solve of the forces with d . (v_k - v_{k-1}) on the right; v_i += w_i G_i.
// Velocities are read once, stay in lanes until they are right, and are written once.
#include "core/kernels/eliminate/listed.hpp"
#include "core/kernels/eliminate/projection.hpp"
#include "core/kernels/memory/open.hpp"
#include "core/kernels/memory/outputs.hpp"
#include "core/kernels/memory/packed.hpp"
#include "core/kernels/memory/small.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

// Loads all velocities, and finds the rates of bonds that have been loaded.
HOL_NOINLINE void load_rates(const Block &block, const Packed &v, const Projection &x) {
    x.v[0] = load_atom(v);
    for (long k0 = 0; k0 < block.n; k0 += W) load_ragged_atoms(block, v, k0, x.v);
    for (long k = 0; k < block.n; ++k) {
        vec b = rate_of(x.s.D[k], x.v[k], x.v[k + 1]);
        if (x.strain) b = b + stretching(x.strain, x.s.D[k]);
        x.s.t[k] = keep(joint(block, k), b);
    }
}

// The same in a box that changes; or with compensated products of unrounded bond vectors, which all lanes can rely on.
template <bool uniform, bool boxed, bool careful>
HOL_NOINLINE mask forward_loaded(const Block &block, const Box &box, const Packed &r, const Packed &v,
                                 const Projection &x) {
    load_bonds<careful ? none_ : bonds_alone, uniform, boxed, careful>(block, box, r, r, r, x.s.D, x.s.D_low, x.s.t);
    load_rates(block, v, x);
    if constexpr (careful) {
        forward_careful<uniform>(block, x.s);
        return ~none();
    } else {
        const Source source = {&box, &r};
        Sweep<uniform, true> sweep{block, source, x.s};
        for (long k = 0; k < block.n; ++k) sweep.step(k, x.s.t[k], k % 4 == 0, k >= block.n_min);
        return ~sweep.doubt();
    }
}

static inline mask forward_velocities(const Block &block, const Box &box, const Packed &r, const Packed &v,
                                      const Projection &x, bool careful) {
    return choose(
        [&](auto uniform, auto boxed) {
            if (careful) return forward_loaded<uniform, boxed, true>(block, box, r, v, x);
            if (x.strain) return forward_loaded<uniform, boxed, false>(block, box, r, v, x);
            mask calm;
            return forward<rate, uniform, boxed>(block, box, r, v, v, x.s, x.v, calm);
        },
        block.uniform_w, box.shape != Box::none);
}

// Makes the second substitution and writes the velocities of the lanes in `which` to `out`.
template <bool uniform>
HOL_NOINLINE void correct_and_store(const Block &block, const Projection &x, mask which, const Packed &out) {
    Pull<uniform> pull{block, x, x.left};
    const Packed to = out;  // by value: its pointers stay in registers
    const AtomSink<write_> sink = {to};
    const unsigned chosen = bits(which);
    const long full = block.n / W * W, fast = chosen == all_lanes ? block.n_min : 0;
    if (full < block.n) {
        vec3 value[W] = {};
        for (long k = block.n - 1; k >= full; --k) value[k - full] = pull.step(k);
        store_ragged(block, full + 1, &value->x, chosen, sink);
    }
    for (long k0 = full - W; k0 >= 0; k0 -= W) {
        vec value[3 * W];
        HOL_UNROLL
        for (long b = W - 1; b >= 0; --b) {
            const vec3 v = pull.step(k0 + b);
            value[3 * b] = v.x;
            value[3 * b + 1] = v.y;
            value[3 * b + 2] = v.z;
        }
        if (__builtin_expect(k0 + W <= fast, 1))
            store_chunk(k0 + 1, value, sink);
        else
            store_ragged(block, k0 + 1, value, chosen, sink);
    }
    store_first(pull.finish(), chosen, sink);
}

template <bool uniform>
HOL_NOINLINE void correct_and_scatter(const Block &block, const Projection &x, const AtomLists &at, double *out) {
    Pull<uniform> pull{block, x, x.left};
    for (long k = block.n - 1; k >= 0; --k) scatter<write_>(out, at, k + 1, pull.step(k));
    scatter<write_>(out, at, 0, pull.finish());
}

// Lists of atoms in packed arrays. True if the block is done; on false nothing was written.
static inline bool listed_velocities(const Block &block, const Lane *lane, const VelocitiesCall &call, Arena arena) {
    if (!call.r.packed || call.virial || call.strain || !listed(block, lane)) return false;
    const AtomLists at(lane);
    const Projection x(block.n, arena, nullptr);
    mask good = forward_listed<rate>(block, call.box, at, call.r, call.v, call.v, x.s, x.v);
    good = good & pull_back(block, x, true);
    if (any(~good)) return false;
    if (call.lambda) store_bonds(block, x.s.t, 0.5 * block.mass, good, call.lambda);
    choose([&](auto uniform) { correct_and_scatter<uniform>(block, x, at, base_of(call.v)); }, block.uniform_w);
    return true;
}

static void velocities_block(const Block &block, const Lane *lane, const VelocitiesCall &call, Arena arena,
                             Tally &tally) {
    if (block.staged && listed_velocities(block, lane, call, arena)) return;
    const Packed r = open(call.r, block, lane, arena, true), v = open(call.v, block, lane, arena, true);
    const Projection x(block.n, arena, call.strain);
    mask rest = block.in_use();
    for (int careful = 0; careful < 2 && any(rest); ++careful) {
        mask good = forward_velocities(block, call.box, r, v, x, careful);
        good = good & pull_back(block, x, !call.v.is_float) & rest;
        rest = rest & ~good;
        if (!any(good)) continue;
        if (call.lambda) store_bonds(block, x.s.t, 0.5 * block.mass, good, call.lambda);
        if (call.virial) add_virial(block.n, x.s.D, x.s.t, good, block.mass, tally);
        choose([&](auto uniform) { correct_and_store<uniform>(block, x, good, v); }, block.uniform_w);
        close(call.v, block, lane, good, v, false);
    }
    if (any(rest)) note_bad(block, rest, tally);
}

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
        const Source source = place.source(r, call.box);
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

void velocities(const VelocitiesCall &call, const Unit &unit, double *scratch, Tally &tally) {
    for_each_block(call, unit, scratch, tally, velocities_block, small_velocities);
}

}  // namespace holonomic::HOL_ISA
