// Acceleration and velocity level of a block of chains: load, eliminate, substitute, store.
#include "core/kernels/eliminate/forward.hpp"
#include "core/kernels/eliminate/join.hpp"
#include "core/kernels/eliminate/listed.hpp"
#include "core/kernels/eliminate/segment_substitute.hpp"
#include "core/kernels/eliminate/substitute.hpp"
#include "core/kernels/memory/open.hpp"
#include "core/kernels/memory/values.hpp"
#include "core/kernels/memory/virial.hpp"
#include "core/kernels/verbs/forces_small.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

// Lists of atoms in packed arrays. True if the block is done; on false nothing was written.
static inline bool listed_forces(const Block &block, const Lane *lane, const ForcesCall &call, Arena arena) {
    if (!call.r.packed || (call.g.x && !call.g.packed) || call.tension || call.virial || !listed(block, lane))
        return false;
    const AtomLists at(lane);
    const System s(block.n, arena);
    const mask good = choose_terms(
        [&](auto terms) { return forward_listed<terms>(block, call.box, at, call.r, call.v, call.f, s, nullptr); },
        call.v.x, call.f.x);
    if (any(~good)) return false;
    choose(
        [&](auto add) {
            substitute_and_scatter<add ? add_ : write_>(block, s, at, base_of(call.g), call.lambda, splat(0.5));
        },
        call.add);
    return true;
}

template <bool careful>
static inline mask forward_forces(const Block &block, const ForcesCall &call, const Packed &r, const Packed &v,
                                  const Packed &f, const System &s, mask &calm) {
    return choose_terms([&](auto terms) { return forward_any<terms, careful>(block, call.box, r, v, f, s, calm); },
                        call.v.x, call.f.x);
}

// What a call wants of the lanes in `which`, from u.
static void finish_forces(const Block &block, const ForcesCall &call, const System &s, mask which, const Packed &g,
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
    const System s(block.n, arena);
    mask calm, good = forward_forces<false>(block, call, r, v, f, s, calm);
    const bool plain = block.lanes == W && !any(~(good & calm));
    if (__builtin_expect(plain && !call.tension && !call.virial, 1)) {
        choose([&](auto add) { substitute_and_store<add ? add_ : write_>(block, s, g, call.lambda, splat(0.5)); },
               update == add_);
    } else {
        backward(0, block.n, s.t, s.L);
        good = good & finite(s.t[0]) & block.in_use();
        finish_forces(block, call, s, good, g, update, arena, tally);
    }
    mask rest = block.in_use() & ~good;
    if (__builtin_expect(any(rest), 0)) {
        // The lanes that plain arithmetic can't answer for, once more with compensated products.
        forward_forces<true>(block, call, r, v, f, s, calm);
        backward(0, block.n, s.t, s.L);
        const mask mended = finite(s.t[0]) & rest;
        finish_forces(block, call, s, mended, g, update, arena, tally);
        good = good | mended;
        rest = rest & ~mended;
        if (any(rest)) note_bad(block, rest, tally);
    }
    if (call.g.x) close(call.g, block, lane, good, g, call.add);
}

void forces(const ForcesCall &call, const Unit &unit, double *scratch, Tally &tally) {
    for_each_block(call, unit, scratch, tally, forces_block, small_forces);
}

void long_forces_eliminate(const ForcesCall &call, const Lane &lane, int64_t j, bool careful, double *store,
                           double *scratch) {
    const Arena arena(scratch, longest_piece);
    choose_terms(
        [&](auto terms) { eliminate_block<terms>(call, lane, j, call.r, call.v, call.f, careful, store, arena); },
        call.v.x, call.f.x);
}

void long_forces_finish(const ForcesCall &call, const Lane &lane, int64_t j, double *store, double *scratch,
                        Tally &tally) {
    const SegmentOutputs out = {{}, false, call.lambda, call.tension, splat(0.5), 1.0, call.virial};
    finish_block<false>(call.box, call.r, call.g, call.add, out, lane, j, store, Arena(scratch, longest_piece), tally);
}

}  // namespace holonomic::HOL_ISA
