// Chains that fit into lanes: their elimination kept, and solves with it. A right-hand side costs the two sweeps, and
// what it is read from.
#include "core/kernels/eliminate/chain.hpp"
#include "core/kernels/eliminate/listed.hpp"
#include "core/kernels/eliminate/substitute.hpp"
#include "core/kernels/kept/block.hpp"
#include "core/kernels/kept/small.hpp"
#include "core/kernels/memory/load.hpp"
#include "core/kernels/memory/open.hpp"
#include "core/kernels/memory/outputs.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

using namespace kept;

static void leave(const Block &block, mask which, unsigned char *left) {
    for (unsigned rest = bits(which & block.in_use()); rest; rest &= rest - 1)
        left[block.chain[__builtin_ctz(rest)]] = 1;
}

// Lanes that plain products can't answer for get those of compensated ones.
static mask keep_extended(const Block &block, const Reader &in, const ChainSystem &s, mask which, Arena arena) {
    const ChainSystem extended(block.n, arena);
    in.load(0, block.n, extended.D, extended.D_low, extended.t);
    block.uniform_w ? forward_extended<true>(block, extended) : forward_extended<false>(block, extended);
    for (long k = 0; k < block.n; ++k) {
        s.pivots[k] = select(which, extended.pivots[k], s.pivots[k]);
        if (k > 0) s.L[k] = select(which, extended.L[k], s.L[k]);
    }
    return which & finite(extended.t[0]);
}

// Where a chunk of W bonds of which the bonds k0 .. are wanted is read: at k0, or as much in front of it as lets it end
// with its lanes, which end together; -1: neither is possible.
HOL_INLINE long chunk_at(const Block &block, long k0) {
    if (__builtin_expect(k0 + W <= block.n_min, 1)) return k0;
    return block.n_min == block.n && block.n >= W ? block.n - W : -1;
}

// Bonds as they stand in memory: to transpose twice changes nothing.
static void keep_rows(const Block &block, const ChainSystem &s, double *to) {
    for (long k0 = 0; k0 < block.n; k0 += W) {
        const long from = chunk_at(block, k0);
        if (from < 0) continue;
        vec *const row = rows(to, block.n, k0 / W);
        for (int j = 0; j < 3; ++j) {
            for (int i = 0; i < W; ++i) row[j * W + i] = (&s.D[from].x)[j * W + i];
            transpose(row + j * W);
        }
    }
}

static void keep_block(const Block &block, const Lane *lane, const KeepCall &call, Arena arena, Tally &) {
    double *const to = call.kept->room(call.kept->owner, block.chain[0], doubles_with_rows(block.n));
    if (!to) return leave(block, ~none(), call.left);
    const Packed r = open(call.r, block, lane, arena, true);
    const ChainSystem s = kept::system(to, block.n, arena.vecs(block.n + W));
    const Reader in(block, call.box, none_, r, {}, {});
    mask calm, good = block.uniform_w ? forward<true, true>(block, in, s, nullptr, calm)
                                      : forward<false, true>(block, in, s, nullptr, calm);
    s.L[0] = s.L[block.n] = vec{};
    good = good & calm;
    if (any(block.in_use() & ~good))
        good = good | keep_extended(block, Reader(block, call.box, none_, r, {}, {}, true), s, ~good & calm, arena);
    keep_rows(block, s, to);
    set_head(to, false, good & block.in_use());
    leave(block, ~good, call.left);
}

void keep_chains(const KeepCall &call, const Unit &unit, double *scratch, Tally &tally) {
    for_each_block(call, unit, scratch, tally, keep_block, keep_small_ones);
}

// step(k, b) for the bonds k0 .. end - 1, of which bond k is number b in a chunk read from bond `from` on.
template <class Step>
HOL_INLINE void for_chunk(long k0, long end, long from, const Step &step) {
    if (__builtin_expect(from == k0 && end == k0 + W, 1)) {
        HOL_UNROLL
        for (long b = 0; b < W; ++b) step(k0 + b, b);
    } else {
        for (long k = k0; k < end; ++k) step(k, k - (from < 0 ? k0 : from));
    }
}

// Differences of a vector per atom along the bonds k0 .. k0 + W - 1, with inverse masses if there are `w`, where a lane
// may end: what is behind counts as zeros.
template <bool weigh>
HOL_INLINE void differences(const Block &block, const Packed &x, long k0, vec3 *out) {
    for (int i = 0; i < block.lanes; ++i)
        for (long k = k0; k < k0 + W && k < block.len[i]; ++k)
            for (int c = 0; c < 3; ++c) {
                const double *const p = x.lane[i] + 3 * k + c, *const w = weigh ? block.w3[i] + 3 * k + c : nullptr;
                (&out[k - k0].x)[c][i] = weigh ? w[3] * p[3] - w[0] * p[0] : p[3] - p[0];
            }
}

// Right-hand sides of the W bonds that are chunk number c, from bond `from` on: products of what stands in memory are
// transposed alone, as load_chunks() does.
template <bool weigh, bool has_v, bool has_f>
HOL_INLINE void rhs_of_chunk(const Block &block, const vec *d, const RowsOfLanes &of_v, const RowsOfLanes &of_f,
                             long from, vec *B) {
    constexpr int terms = (has_v ? velocity_squared : 0) | (has_f ? force_difference : 0);
    vec p[3 * W];
    HOL_UNROLL
    for (int j = 0; j < 3; ++j) {
        const long at = 3 * from + W * j;
        HOL_UNROLL
        for (int i = 0; i < W; ++i) {
            vec dv = {}, df = {}, vv = {};
            if (has_v) {
                const double *const v = of_v.first + at + of_v.lane[i];
                dv = load(v + 3) - load(v);
                vv = square(terms, splat(block.mass[i]), dv);
            }
            if (has_f) {
                const double *const f = of_f.first + at + of_f.lane[i], *const w = weigh ? block.w3[i] + at : nullptr;
                df = weigh ? load(w + 3) * load(f + 3) - load(w) * load(f) : load(f + 3) - load(f);
            }
            p[j * W + i] = product(terms, d[j * W + i], dv, df, vv);
        }
        transpose(p + j * W);
    }
    HOL_UNROLL
    for (int b = 0; b < W; ++b) B[b] = (p[3 * b] + p[3 * b + 1]) + p[3 * b + 2];
}

// Right-hand sides of all bonds into t, and the sweep up on the way. Returns the lanes in which nothing can overflow on
// the way down, as Sweep::calm().
template <bool weigh, bool has_v, bool has_f>
HOL_NOINLINE mask substitute_rhs(const Block &block, const ChainSystem &s, const double *kept, const Packed &v,
                                 const Packed &f) {
    constexpr int terms = (has_v ? velocity_squared : 0) | (has_f ? force_difference : 0);
    const RowsOfLanes of_v(has_v ? v : f), of_f(has_f ? f : v);
    vec y = {}, size = {};
    for (long k0 = 0; k0 < block.n; k0 += W) {
        vec B[W];
        const long from = chunk_at(block, k0), end = k0 + W < block.n ? k0 + W : block.n;
        if (__builtin_expect(from >= 0, 1)) {
            rhs_of_chunk<weigh, has_v, has_f>(block, rows(kept, block.n, k0 / W), of_v, of_f, from, B);
        } else {
            vec3 dv[W] = {}, df[W] = {};
            if (has_v) differences<false>(block, v, k0, dv);
            if (has_f) differences<weigh>(block, f, k0, df);
            for (long b = 0; b < end - k0; ++b) B[b] = right_hand_side(terms, block.mass, s.D[k0 + b], dv[b], df[b]);
        }
        for_chunk(k0, end, from, [&](long k, long b) HOL_FORCED {
            y = mul_add(s.L[k], y, B[b]);
            const vec u = y * s.pivots[k];
            s.t[k] = u;
            size = size + abs(u);
        });
    }
    return less(size, splat(largest_calm));
}

// The same of lists of atoms.
template <bool has_v, bool has_f>
HOL_NOINLINE mask substitute_listed(const Block &block, const ChainSystem &s, const AtomLists &at, const double *v,
                                    const double *f) {
    constexpr int terms = (has_v ? velocity_squared : 0) | (has_f ? force_difference : 0);
    const vec *const w = block.uniform_w ? nullptr : block.w;
    vec y = {}, size = {};
    vec3 v0 = {}, f0 = {}, dv = {}, df = {};
    if (has_v) v0 = gather(v, at, 0);
    if (has_f) f0 = gather(f, at, 0);
    for (long k = 0; k < block.n; ++k) {
        if (has_v) {
            const vec3 v1 = gather(v, at, k + 1);
            dv = v1 - v0;
            v0 = v1;
        }
        if (has_f) {
            const vec3 f1 = gather(f, at, k + 1);
            df = w ? w[k + 1] * f1 - w[k] * f0 : f1 - f0;
            f0 = f1;
        }
        y = mul_add(s.L[k], y, right_hand_side(terms, block.mass, s.D[k], dv, df));
        const vec u = y * s.pivots[k];
        s.t[k] = u;
        size = size + abs(u);
    }
    return less(size, splat(largest_calm));
}

// The same of values per bond that are given.
HOL_NOINLINE mask substitute_given(const Block &block, const ChainSystem &s, const double *rhs) {
    const vec half = 0.5 * block.mass;
    vec y = {}, size = {};
    for (long k = 0; W == 1 && k < block.n; ++k) {
        y = mul_add(s.L[k], y, half * rhs[block.first_bond[0] + k]);
        const vec u = y * s.pivots[k];
        s.t[k] = u;
        size = size + abs(u);
    }
    for (long k0 = W == 1 ? block.n : 0; k0 < block.n; k0 += W) {
        vec b[W];
        const long end = k0 + W < block.n ? k0 + W : block.n;
        const long from = chunk_at(block, k0);
        for (int i = block.lanes; i < W; ++i) b[i] = vec{};
        if (__builtin_expect(from >= 0, 1)) {
            for (int i = 0; i < block.lanes; ++i) b[i] = load(rhs + block.first_bond[i] + from);
            transpose(b);
        } else {
            for (int i = 0; i < W; ++i) b[i] = vec{};
            for (int i = 0; i < block.lanes; ++i)
                for (long k = k0; k < end && k < block.len[i]; ++k) b[k - k0][i] = rhs[block.first_bond[i] + k];
        }
        for_chunk(k0, end, from, [&](long k, long i) HOL_FORCED {
            y = mul_add(s.L[k], y, half * b[i]);
            const vec u = y * s.pivots[k];
            s.t[k] = u;
            size = size + abs(u);
        });
    }
    return less(size, splat(largest_calm));
}

// Writes at once what the sweep down finds. Returns whether it is done; if not, nothing has been written.
template <class Substitute, class Store>
HOL_INLINE bool solve_at_once(const Block &block, const ChainSystem &s, const KeptCall &call, const double *from,
                              const Substitute &substitute, const Store &store) {
    if ((call.rhs ? !call.g.x : !call.v.x && !call.f.x) || call.tension || call.virial || block.lanes < W ||
        any(~kept_lanes(from)))
        return false;
    mask calm = none();
    if (call.rhs)
        calm = substitute_given(block, s, call.rhs);
    else
        choose([&](auto has_v, auto has_f) { calm = substitute(has_v, has_f); }, call.v.x != nullptr,
               call.f.x != nullptr);
    if (any(~calm)) return false;
    choose([&](auto add) { store(add); }, call.add);
    return true;
}

// Of no forces and no velocities.
HOL_INLINE void substitute_nothing(const Block &block, const ChainSystem &s) {
    for (long k = 0; k < block.n; ++k) s.t[k] = vec{};
}

static void solve_block(const Block &block, const Lane *lane, const KeptCall &call, Arena arena, Tally &tally) {
    const double *const from = call.kept->block[block.chain[0]];
    if (!from) return;
    const ChainSystem s = kept::system(from, block.n, arena.vecs(block.n + W));
    const vec half = splat(0.5);
    if (block.staged && listed(block, lane)) {
        const AtomLists at(lane);
        if (solve_at_once(
                block, s, call, from,
                [&](auto has_v, auto has_f) {
                    return substitute_listed<has_v, has_f>(block, s, at, base_of(call.v), base_of(call.f));
                },
                [&](auto add) {
                    substitute_and_scatter<add ? add_ : write_>(block, s, at, base_of(call.g), call.lambda, half);
                }))
            return;
    }
    const Packed v = open(call.v, block, lane, arena, true), f = open(call.f, block, lane, arena, true);
    const Packed g = open(call.g, block, lane, arena, false);
    const Update update = call.add && in_place(call.g, block) ? add_ : write_;  // else unstage() adds
    if (!block.staged &&
        solve_at_once(
            block, s, call, from,
            [&](auto has_v, auto has_f) {
                return block.uniform_w ? substitute_rhs<false, has_v, has_f>(block, s, from, v, f)
                                       : substitute_rhs<true, has_v, has_f>(block, s, from, v, f);
            },
            [&](auto add) { substitute_and_store<add ? add_ : write_>(block, s, g, call.lambda, half); }))
        return;
    if (call.rhs)
        substitute_given(block, s, call.rhs);
    else if (!call.v.x && !call.f.x)
        substitute_nothing(block, s);
    else
        choose(
            [&](auto has_v, auto has_f) {
                block.uniform_w ? substitute_rhs<false, has_v, has_f>(block, s, from, v, f)
                                : substitute_rhs<true, has_v, has_f>(block, s, from, v, f);
            },
            call.v.x != nullptr, call.f.x != nullptr);
    backward(0, block.n, s.t, s.L);
    const mask good = finite(s.t[0]) & kept_lanes(from);
    leave(block, ~good, call.left);
    if (call.lambda) store_bonds(block, s.t, splat(0.5), good, call.lambda);
    if (call.tension) {
        vec *const value = arena.vecs(block.n);
        for (long k = 0; k < block.n; ++k) value[k] = s.t[k] * sqrt(dot(s.D[k], s.D[k]));
        store_bonds(block, value, splat(1.0), good, call.tension);
    }
    if (call.virial) add_virial(block.n, s.D, s.t, good, splat(1.0), tally);
    if (call.g.x) {
        store_pulls(block, s.D, s.t, good, update, g);
        close(call.g, block, lane, good, g, call.add);
    }
}

void solve_kept_chains(const KeptCall &call, const Unit &unit, double *scratch, Tally &tally) {
    for_each_block(call, unit, scratch, tally, solve_block, solve_small_ones);
}

}  // namespace holonomic::HOL_ISA
