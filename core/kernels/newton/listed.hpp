// Positions of a block of chains that have lists of atoms: the arithmetic of attempts.hpp, on atoms read where the
// lists say. If a lane needs more than the first attempt, or no move at all, the block is left as it came, to the
// general path.
#ifndef HOLONOMIC_KERNELS_NEWTON_LISTED_HPP
#define HOLONOMIC_KERNELS_NEWTON_LISTED_HPP

#include "core/kernels/arithmetic/image.hpp"
#include "core/kernels/memory/listed.hpp"
#include "core/kernels/newton/iterate.hpp"
#include "core/kernels/newton/outputs.hpp"

namespace holonomic::HOL_ISA {

template <bool boxed>
HOL_INLINE void gather_bonds(const Block &block, const PositionsCall &call, const AtomLists &at, const Newton &x) {
    const double *const r_ref = base_of(call.r_ref), *const r = base_of(call.r), *const v = base_of(call.v);
    vec3 b0 = gather(r_ref, at, 0), r0 = gather(r, at, 0), unused = {};
    for (long k = 0; k < block.n; ++k) {
        if (block.list_ahead)
            for (int i = 0; i < W; ++i) {
                const int64_t next = 3 * at.atoms[i][k + block.list_ahead];
                __builtin_prefetch(r_ref + next, 0, 2);
                __builtin_prefetch(r + next, 0, 2);
                if (v) __builtin_prefetch(v + next, 0, 2);
            }
        const vec3 b1 = gather(r_ref, at, k + 1), r1 = gather(r, at, k + 1);
        vec3 b = b1 - b0, d = r1 - r0;
        if (boxed) {
            wrap<false>(call.box_ref, b, unused);
            wrap<false>(call.box, d, unused);
        }
        x.b[k] = b;
        x.D[k] = d;
        b0 = b1;
        r0 = r1;
    }
}

// As store_pulls() with a MoveSink, of all lanes.
template <bool uniform_w, bool to_v>
static inline void scatter_moves(const Block &block, const Newton &x, const AtomLists &at, double *r, double *v,
                                 vec rate) {
    vec3 before = {};
    for (long k = 0; k <= block.n; ++k) {
        const vec3 after = x.tau[k] * x.b[k], m = times_w<uniform_w>(x, k, after - before);
        before = after;
        scatter<add_>(r, at, k, m);
        if (!to_v) continue;
        const vec3 q = gather(v, at, k);
        scatter<write_>(v, at, k, {mul_add(m.x, rate, q.x), mul_add(m.y, rate, q.y), mul_add(m.z, rate, q.z)});
    }
}

// True if the block is done; on false nothing was written.
template <bool uniform_w, bool uniform_a>
HOL_NOINLINE bool listed_positions(const Block &block, const Lane *lane, const PositionsCall &call,
                                   const BondLengths &a, Arena arena, Tally &tally) {
    if (!call.r_ref.packed || !call.r.packed || (call.v.x && !call.v.packed) || !listed(block, lane)) return false;
    const AtomLists at(lane);
    Newton x(block, a, arena);
    if (call.box.shape == Box::none && call.box_ref.shape == Box::none)
        gather_bonds<false>(block, call, at, x);
    else
        gather_bonds<true>(block, call, at, x);
    if (call.guess) load_guess(block, call, x);
    Packed first;
    for (int i = 0; i < W; ++i) first.lane[i] = base_of(call.r) + 3 * lane[i].atoms[0];
    Carried carried(block, x, call, first, at.atoms);
    const Outcome out =
        solve_positions<uniform_w, uniform_a, false>(block, x, call, carried, block.in_use(), call.guess);
    if (any(~out.converged) || any(coarse_moves<uniform_w>(block, x, carried, out.converged))) return false;
    note_worst<uniform_w, uniform_a>(block, x, call, out.converged, out.error, tally);
    if (call.v.x)
        scatter_moves<uniform_w, true>(block, x, at, base_of(call.r), base_of(call.v), splat(1 / call.dt));
    else
        scatter_moves<uniform_w, false>(block, x, at, base_of(call.r), nullptr, vec{});
    if (call.virial) add_virial(block, x, out.converged, call.dt, tally);
    note_solved(block, x, call, out, tally);
    return true;
}

}  // namespace holonomic::HOL_ISA
#endif
