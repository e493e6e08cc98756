// Velocity level of a block of chains: the same solve with d . (v_k - v_{k-1}) on the right; v_i += w_i G_i.

namespace holonomic {
namespace HOL_ISA {

template <bool careful>
static inline mask solve_velocities(const Block &block, const VelocitiesCall &call, const Packed &r, const Packed &v,
                                    const System &s) {
    return solve_any<rate, careful>(block, call.box, r, v, v, s);
}

// The recursion gives the multipliers to a few roundings of themselves. What that leaves of the rates goes with a second
// substitution, for the rates of the velocities as they are rounded now.
static void store_velocities(const Block &block, const Lane *lane, const VelocitiesCall &call, const System &s,
                             mask which, const Packed &v, Tally &tally) {
    if (!any(which)) return;
    if (call.lambda) store_bonds(block, s.t, 0.5, which, call.lambda);
    if (call.virial) add_virial(block.n, s.D, s.t, which, 1, tally);
    for (int pass = 0; pass < 2; ++pass) {
        if (block.uniform_w)
            store_pulls<true, true>(block, s.D, s.t, which, add_, v);
        else
            store_pulls<true, false>(block, s.D, s.t, which, add_, v);
        if (pass == 1 || call.v.is_float) break;
        load_rates(block, v, s.D, s.t);
        substitute(block.n, s.t, s.pivots, s.L);
    }
    close(call.v, block, lane, which, v, false);
}

static void velocities_block(const Block &block, const Lane *lane, const VelocitiesCall &call, Arena arena,
                             Tally &tally) {
    const Packed r = open(call.r, block, lane, arena, true), v = open(call.v, block, lane, arena, true);
    const System s(block.n, arena);
    mask good = solve_velocities<false>(block, call, r, v, s);
    store_velocities(block, lane, call, s, good, v, tally);
    mask rest = block.in_use() & ~good;
    if (__builtin_expect(!any(rest), 1)) return;
    good = solve_velocities<true>(block, call, r, v, s) & rest;
    store_velocities(block, lane, call, s, good, v, tally);
    rest = rest & ~good;
    if (any(rest)) note_bad(block, rest, tally);
}

static void velocities(const VelocitiesCall &call, const Unit &unit, double *scratch, Tally &tally) {
    for_each_block(call, unit, scratch, tally, velocities_block);
}

}  // namespace HOL_ISA
}  // namespace holonomic
