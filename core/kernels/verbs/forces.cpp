// Acceleration level of a block of chains: load and eliminate in one go, up the chains; substitute and store, down.
#include "core/kernels/eliminate/chain.hpp"
#include "core/kernels/eliminate/listed.hpp"
#include "core/kernels/eliminate/substitute.hpp"
#include "core/kernels/memory/load.hpp"
#include "core/kernels/memory/open.hpp"
#include "core/kernels/memory/outputs.hpp"
#include "core/kernels/memory/parts.hpp"
#include "core/kernels/memory/prefetch.hpp"
#include "core/kernels/memory/small.hpp"
#include "core/kernels/memory/small_pulls.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

static mask forward_forces(const Block &block, const Reader &in, const ChainSystem &s, mask &calm) {
    return block.uniform_w ? forward<true, false>(block, in, s, nullptr, calm)
                           : forward<false, false>(block, in, s, nullptr, calm);
}

// With compensated products of unrounded bond vectors, which are good in all lanes.
static mask forward_extended(const Block &block, const Reader &in, const ChainSystem &s) {
    in.load(0, block.n, s.D, s.D_low, s.t);
    block.uniform_w ? forward_extended<true>(block, s) : forward_extended<false>(block, s);
    return ~none();
}

// Lists of atoms in packed arrays. True if the block is done; on false nothing was written.
static inline bool listed_forces(const Block &block, const Lane *lane, const ForcesCall &call, Arena arena) {
    if (!call.r.packed || !call.f.x || (call.g.x && !call.g.packed) || call.tension || call.virial ||
        !listed(block, lane))
        return false;
    const AtomLists at(lane);
    const ChainSystem s(block.n, arena);
    const Reader in(block, call.box, terms_of(call.v.x, call.f.x), at, call.r, call.v, call.f);
    mask calm;
    const mask good = forward_forces(block, in, s, calm);
    if (any(~(good & calm))) return false;
    s.L[block.n] = vec{};
    choose(
        [&](auto add) {
            substitute_and_scatter<add ? add_ : write_>(block, s, at, base_of(call.g), call.lambda, splat(0.5));
        },
        call.add);
    return true;
}

// Writes the outputs of the lanes in `which`, from t.
static void finish_forces(const Block &block, const ForcesCall &call, const ChainSystem &s, mask which, const Packed &g,
                          Update update, Arena arena, Tally &tally) {
    if (call.lambda) store_bonds(block, s.t, splat(0.5), which, call.lambda);
    if (call.tension) {
        vec *value = arena.vecs(block.n);
        for (long k = 0; k < block.n; ++k) value[k] = s.t[k] * sqrt(dot(s.D[k], s.D[k]));
        store_bonds(block, value, splat(1.0), which, call.tension);
    }
    if (call.g.x) store_pulls(block, s.D, s.t, which, update, g);
    if (call.virial) add_virial(block.n, s.D, s.t, which, splat(1.0), tally);
}

static void forces_block(const Block &block, const Lane *lane, const ForcesCall &call, Arena arena, Tally &tally) {
    if (block.staged && listed_forces(block, lane, call, arena)) return;
    const Packed r = open(call.r, block, lane, arena, true), v = open(call.v, block, lane, arena, true);
    const Packed f = open(call.f, block, lane, arena, true), g = open(call.g, block, lane, arena, false);
    const Update update = call.add && in_place(call.g, block) ? add_ : write_;  // else unstage() adds
    const ChainSystem s(block.n, arena);
    const int terms = terms_of(call.v.x, call.f.x);
    mask calm, good = forward_forces(block, Reader(block, call.box, terms, r, v, f), s, calm);
    const bool plain = block.lanes == W && !any(~(good & calm));
    if (__builtin_expect(plain && !call.tension && !call.virial, 1)) {
        s.L[block.n] = vec{};
        choose([&](auto add) { substitute_and_store<add ? add_ : write_>(block, s, g, call.lambda, splat(0.5)); },
               update == add_);
        if (call.g.x) close(call.g, block, lane, good, g, call.add);
        return;
    }
    // Lanes that plain arithmetic can't answer for: once more, with compensated products, but where it is their units
    // that are in the way.
    mask rest = block.in_use();
    const mask tried = ~good & (calm | all_if(call.rescaled));
    for (int extended = 0; extended < 2 && any(rest); ++extended) {
        if (extended) good = forward_extended(block, Reader(block, call.box, terms, r, v, f, true), s) & tried;
        backward(0, block.n, s.t, s.L);
        good = good & finite(s.t[0]) & rest;
        finish_forces(block, call, s, good, g, update, arena, tally);
        rest = rest & ~good;
    }
    if (any(rest)) note_bad(block, rest, tally);
    if (call.g.x) close(call.g, block, lane, ~rest, g, call.add);
}

// Bonds D[k] of W molecules and their right-hand sides t[k].
template <bool uniform, bool boxed, class View, class Array>
HOL_INLINE void load_rhs(const Block &block, const Box &box, const View &view, const Array &r, const Array &v,
                         const Array &f, vec3 *D, vec *t) {
    constexpr int N = View::bonds;
    vec e[vectors_of<N>];
    vec3 dv[N] = {}, *const x = reinterpret_cast<vec3 *>(e);
    load_bonds<boxed, false>(box, view, r, e, D);
    if (v) {
        load_molecules(view, v, e);
        HOL_UNROLL
        for (int k = 0; k < N; ++k) dv[k] = x[k + 1] - x[k];
    }
    load_molecules(view, f, e);
    vec3 df[N];
    HOL_UNROLL
    for (int k = 0; k < N; ++k) df[k] = uniform ? x[k + 1] - x[k] : block.w[k + 1] * x[k + 1] - block.w[k] * x[k];
    if (v) {
        HOL_UNROLL
        for (int k = 0; k < N; ++k)
            t[k] = right_hand_side(velocity_squared | force_difference, block.mass, D[k], dv[k], df[k]);
    } else {
        HOL_UNROLL
        for (int k = 0; k < N; ++k) t[k] = right_hand_side(force_difference, block.mass, D[k], dv[k], df[k]);
    }
}

// Does molecules from `first` on. Returns the first one that is not done. `given`: the block of a regular unit.
template <class View, bool uniform, bool boxed, bool virial>
static int64_t forces_of_molecules(const ForcesCall &call, const Unit &unit, const Block &given, int64_t first,
                                   Tally &tally) {
    constexpr int N = View::bonds;
    const auto r = View::array(call.r), v = View::array(call.v), f = View::array(call.f), g = View::array(call.g);
    BlockMasses<View> masses(given);
    const Block &block = masses.block;
    const int64_t end = View::end(unit, first);
    for (int64_t n; (n = View::next(first, end)) > 0; first += n) {
        vec3 D[N];
        vec t[N], L[N + 1];
        const View view(unit, first, n);
        masses.take(view);
        view.fetch_next(r);
        view.fetch_next(v);
        view.fetch_next(f);
        load_rhs<uniform, boxed>(block, call.box, view, r, v, f, D, t);
        const auto source = view.source(r, call.box);
        Sweep<uniform, false, decltype(view.source(r, call.box))> sweep{block, source, ChainSystem(D, t, L, nullptr)};
        HOL_UNROLL
        for (int k = 0; k < N; ++k)
            sweep.step(
                k, [&]() HOL_FORCED { return t[k]; }, k % 4 == 0, false);
        if (__builtin_expect(any(sweep.flag() | ~sweep.calm()), 0)) break;
        backward(0, N, t, L);
        if (virial || (N >= fewest_with_virial && __builtin_expect(call.virial, 0)))
            count_virial<N>(D, t, n, splat(1.0), tally);
        if (g) store_pulls(D, t, view, g, call.add);
        if (call.lambda) store_multipliers(view, t, splat(0.5), call.lambda);
    }
    return first;
}

static int64_t small_forces(const ForcesCall &call, const Unit &unit, Block &block, int64_t first, Tally &tally) {
    if (!call.f.x || call.tension) return first;
    const bool packed = call.r.packed && (!call.v.x || call.v.packed) && call.f.packed && (!call.g.x || call.g.packed);
    const bool boxed = call.box.lattice != Box::none;
    const auto kernel = [&](auto view, auto uniform, auto in_box) {
        typedef typename decltype(view)::type View;
        return with_virial_or_not<View, in_box>(call.virial, [&](auto virial, auto box) {
            return forces_of_molecules<View, uniform, box, virial>(call, unit, block, first, tally);
        });
    };
    if (packed) return any_molecules(unit, block, first, boxed, true, kernel);
    return reads_columns(call) ? molecules_in_columns(unit, block, first, boxed, true, kernel) : first;
}

// Arrays that are not packed. False if nothing has been done.
static bool forces_in_parts(const ForcesCall &call, const Unit &unit, double *scratch, Tally &tally) {
    if (call.f.x && !call.tension && reads_columns(call) && fit_columns(unit, call.box.lattice != Box::none))
        return false;
    return in_packed_parts(call, unit, tally, [=](const ForcesCall &c, const Unit &u, Tally &own) {
        for_each_block(c, u, scratch, own, forces_block, small_forces);
    });
}

void forces(const ForcesCall &call, const Unit &unit, double *scratch, Tally &tally) {
    if (!call.r.packed && forces_in_parts(call, unit, scratch, tally)) return;
    for_each_block(call, unit, scratch, tally, forces_block, small_forces);
}

}  // namespace holonomic::HOL_ISA
