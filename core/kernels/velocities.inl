// Velocity level of a block of chains: the same solve with d . (v_k - v_{k-1}) on the right; v_i += w_i G_i.

namespace holonomic {
namespace HOL_ISA {

template <bool careful>
static inline mask forward_velocities(const Block &block, const VelocitiesCall &call, const Packed &r, const Packed &v,
                                      const System &s, mask &calm) {
    return forward_any<rate, careful>(block, call.box, r, v, v, s, calm);
}

static inline void pull_velocities(const Block &block, const System &s, mask which, const Packed &v) {
    if (block.uniform_w)
        store_pulls<true, true>(block, s.D, s.t, which, add_, v);
    else
        store_pulls<true, false>(block, s.D, s.t, which, add_, v);
}

// The recursion gives the multipliers to a few roundings of themselves. What that leaves of the rates goes with a second
// substitution, for the rates of the velocities as they are rounded now.
static void finish_velocities(const Block &block, const Lane *lane, const VelocitiesCall &call, const System &s,
                              mask which, const Packed &v, Tally &tally) {
    if (!any(which)) return;
    if (call.lambda) store_bonds(block, s.t, 0.5 * block.mass, which, call.lambda);
    if (call.virial) add_virial(block.n, s.D, s.t, which, block.mass, tally);
    pull_velocities(block, s, which, v);
    if (!call.v.is_float) {
        load_rates(block, v, s.D, s.t);
        substitute(block.n, s);
        backward(0, block.n, s.t, s.L);
        pull_velocities(block, s, which, v);
    }
    close(call.v, block, lane, which, v, false);
}

static inline void substitute_velocities(const Block &block, const System &s, const Packed &v, double *lambda) {
    if (block.uniform_w)
        substitute_and_store<true, true, add_>(block, s, v, lambda, 0.5 * block.mass);
    else
        substitute_and_store<true, false, add_>(block, s, v, lambda, 0.5 * block.mass);
}

static void velocities_block(const Block &block, const Lane *lane, const VelocitiesCall &call, Arena arena,
                             Tally &tally) {
    if (block.staged && listed_velocities(block, lane, call, arena)) return;
    const Packed r = open(call.r, block, lane, arena, true), v = open(call.v, block, lane, arena, true);
    const System s(block.n, arena);
    mask calm, good = forward_velocities<false>(block, call, r, v, s, calm);
    const bool plain = block.lanes == W && !any(~(good & calm));
    if (__builtin_expect(plain && !call.virial && !call.v.is_float, 1)) {
        substitute_velocities(block, s, v, call.lambda);
        load_rates(block, v, s.D, s.t);
        substitute(block.n, s);
        substitute_velocities(block, s, v, nullptr);
        close(call.v, block, lane, good, v, false);
        return;
    }
    backward(0, block.n, s.t, s.L);
    good = good & finite(s.t[0]) & block.in_use();
    finish_velocities(block, lane, call, s, good, v, tally);
    mask rest = block.in_use() & ~good;
    if (__builtin_expect(!any(rest), 1)) return;
    forward_velocities<true>(block, call, r, v, s, calm);
    backward(0, block.n, s.t, s.L);
    good = finite(s.t[0]) & rest;
    finish_velocities(block, lane, call, s, good, v, tally);
    rest = rest & ~good;
    if (any(rest)) note_bad(block, rest, tally);
}

static void velocities(const VelocitiesCall &call, const Unit &unit, double *scratch, Tally &tally) {
    for_each_block(call, unit, scratch, tally, velocities_block);
}

}  // namespace HOL_ISA
}  // namespace holonomic
