// Kept factors of molecules by sparse LDL^T: made in twice the precision (ldl_factor.hpp), and solves with them
// (ldl_solve.hpp).
#pragma once

#include "core/kernels/kept/flagged.hpp"
#include "core/kernels/kept/ldl_solve.hpp"
#include "core/kernels/molecules/sparse_ldl/outputs.hpp"

namespace holonomic::HOL_ISA::graph {

// In front of the arrays: the lanes that are kept, those whose pivots are far from nothing among them, bit by bit.
template <class V>
struct KeptLdl {
    const LdlPlan &s;
    double *const block;
    Rows<V> d;
    Pairs<V> lower, pivot;
    V *size, *w;

    static int64_t doubles(const LdlPlan &s) {
        return most_lanes + Width<V>::lanes * (4 * static_cast<int64_t>(s.n_rows) + 2 * in_fours(s.n_entries) +
                                               2 * in_fours(s.n_columns) + in_fours(s.n_bonds) + in_fours(s.n_sites));
    }
    KeptLdl(const LdlPlan &plan, double *at) : s(plan), block(at) {
        Memory<V> memory = {block + most_lanes};
        d = {memory.values(4 * static_cast<int64_t>(s.n_rows))};
        lower = {memory.values(in_fours(s.n_entries)), memory.values(in_fours(s.n_entries))};
        pivot = {memory.values(in_fours(s.n_columns)), memory.values(in_fours(s.n_columns))};
        size = memory.values(in_fours(s.n_bonds));
        w = memory.values(in_fours(s.n_sites));
    }
    // Makes this the memory of what is kept; all else is that of the thread.
    void lend_to(LdlLinear<V> &x) const {
        x.d = d;
        x.lower = lower.hi;
        x.per_pivot = pivot.hi;
        x.size = size;
        x.w = w;
    }
    unsigned lanes() const { return static_cast<unsigned>(block[0]); }
    double least_part(unsigned of) const {
        return of & ~static_cast<unsigned>(block[1]) ? least_pivot : least_proven_pivot;
    }
    void keep_lanes(const LdlLinear<V> &x) const {
        block[0] = static_cast<double>(x.in_all_subtrees(x.firm));
        block[1] = static_cast<double>(x.in_all_subtrees(x.left));
    }
    template <class S>
    LdlKeptSolve<V, S> solve(const Pairs<S> &t) const {
        return {s, lower, pivot, size, w, t};
    }
};

struct KeepByLdl {
    const KeepCall &call;
    const MoleculeUnit &unit;
    const LdlPlan &s;

    template <class V>
    void block(const MoleculeLane *lane, int used, bool, double *scratch) const {
        double *const room = call.kept->room(call.kept->owner, lane[0].molecule, KeptLdl<V>::doubles(s));
        if (!room) return leave(lane, (1u << used) - 1, call.left);
        Memory<V> memory = {scratch};
        const Inputs none = {};
        LdlLinear<V> x(s, lane, used, true, false, unit.team, call.box, call.r, none, 0, memory);
        const Rows<V> low_bonds = x.d;
        const KeptLdl<V> kept(s, room);
        kept.lend_to(x);
        LdlKeptFactor<V>::make(x, low_bonds, kept.lower.lo, kept.pivot.lo);
        kept.keep_lanes(x);
        leave(lane, bits(x.in_use()) & ~kept.lanes(), call.left);
    }
};

struct SolveByLdl {
    const KeptCall *const calls;
    const int n_calls;
    const MoleculeUnit &unit;
    const LdlPlan &s;
    Tally &tally;

    template <class V>
    void block(const MoleculeLane *lane, int used, bool, double *scratch) const {
        double *const from = const_cast<double *>(calls->kept->block[lane[0].molecule]);
        if (!from) return;
        const KeptLdl<V> kept(s, from);
        int done = 0;
        if constexpr (W > 1 && Width<V>::lanes == 1)
            for (; n_calls - done > 1 && go_together(); done += W)
                solve_together(kept, lane, calls + done, n_calls - done < W ? n_calls - done : W, scratch);
        for (; done < n_calls; ++done) solve(kept, calls[done], lane, used, scratch);
    }

private:
    template <class V>
    __attribute__((noinline)) void solve(const KeptLdl<V> &kept, const KeptCall &call, const MoleculeLane *lane,
                                         int used, double *scratch) const {
        Memory<V> memory = {scratch};
        const RightHandSides rhs = right_hand_sides_of(call);
        LdlLinear<V> x(s, lane, used, true, true, unit.team, *call.kept->box, call.kept->r, rhs.in, rhs.terms, memory);
        kept.lend_to(x);
        const LdlKeptSolve<V, V> pairs = kept.solve(Pairs<V>{x.t, x.back});
        pairs.start();
        x.up([&](const LdlLinear<V> &own, const Subtree &subtree) HOL_FORCED {
            for_tiles_up(own.s, subtree, [&](const Tile &tile) HOL_FORCED {
                load_rhs(own, tile);
                pairs.up(tile);
            });
        });
        x.down([&](const LdlLinear<V> &own, const Subtree &subtree) HOL_FORCED {
            for_tiles_down(own.s, subtree, [&](const Tile &tile) HOL_FORCED {
                pairs.down(tile);
                if (call.g.x) find_pulls(own, tile);
            });
        });
        const unsigned wanted = kept.lanes() & bits(x.in_use());
        double *const at_sites = reinterpret_cast<double *>(x.a_low.start);
        const unsigned good = pairs.good_lanes(wanted, kept.least_part(wanted), at_sites);
        write_by_ldl(call, x, good, tally);
        if (good != wanted) solve_extended(call, *unit.elimination, lane, wanted & ~good, memory.next, tally);
    }
    // Right-hand sides of a tile; their low words, in `back`, are none.
    template <class V>
    static __attribute__((noinline)) void load_rhs(const LdlLinear<V> &x, const Tile &tile) {
        if (x.terms & given) {
            for (int32_t k = tile.first; k < tile.end; ++k) {
                x.t[k] = x.given_to(tile, k);
                x.back[k] = V{};
            }
            return;
        }
        if (x.terms & squares) read_atoms(*x.in.v, x.at, x.s, tile, x.v);
        x.load_inputs(tile);
        for (int64_t k = tile.first; k < tile.end; k += x.step) {
            x.some(x.t, k) = x.right_hand_sides_of(tile, k, x.terms);
            x.some(x.back, k) = Columns<V>{};
        }
    }
    template <class V>
    static __attribute__((noinline)) void find_pulls(const LdlLinear<V> &x, const Tile &tile) {
        const Rows<V> of = x.pull.from(tile.first_site);
        sum_pulls(x.s, tile, x.t, x.d_of(tile), of);
        add_visits(x.s, tile, x.pull, x.pull);
    }

    // Several right-hand sides of one molecule in lanes: where nothing but multipliers is wanted of them, and the
    // memory for one of them does.
    bool go_together() const {
        bool all = W * 2 * in_fours(s.n_columns) + s.n_sites <= LdlLinear<double>::values(s);
        for (int i = 0; i < n_calls; ++i)
            all = all && calls[i].rhs && calls[i].lambda && !calls[i].tension && !calls[i].g.x && !calls[i].virial;
        return all;
    }
    __attribute__((noinline)) void solve_together(const KeptLdl<double> &kept, const MoleculeLane *lane,
                                                  const KeptCall *call, int n, double *scratch) const {
        if (!kept.lanes()) return;
        Memory<vec> memory = {scratch};
        vec *const high = memory.values(in_fours(s.n_columns));
        const Pairs<vec> t = {high, memory.values(in_fours(s.n_columns))};
        const LdlKeptSolve<double, vec> pairs = kept.solve(t);
        const LongTeam *const team = s.n_subtrees > 0 ? unit.team : nullptr;
        const double *rhs[W];
        int64_t out[W];
        for (int i = 0; i < W; ++i) {
            const KeptCall &one = call[i < n ? i : 0];
            rhs[i] = one.rhs + lane->first_bond;
            out[i] = one.lambda - call->lambda + lane->first_bond;
        }
        pairs.start();
        subtrees_up(s, team, scratch, [&](const Subtree &subtree, double *) {
            for_tiles_up(s, subtree, [&](const Tile &tile) HOL_FORCED {
                for (int32_t k = tile.first; k < tile.end; ++k) {
                    vec b = {};
                    HOL_UNROLL
                    for (int i = 0; i < W; ++i) Width<vec>::set(b, i, rhs[i][s.bond_of[k]]);
                    high[k] = 0.5 * b;
                    t.lo[k] = vec{};
                }
                pairs.up(tile);
            });
        });
        subtrees_down(s, team, scratch, [&](const Subtree &subtree, double *) {
            for_tiles_down(s, subtree, [&](const Tile &tile) HOL_FORCED { pairs.down(tile); });
        });
        const unsigned wanted = (1u << n) - 1, good = pairs.good_lanes(wanted, kept.least_part(1), memory.next);
        write_values<vec>(s.bond_of, out, call->lambda, good, 0, s.n_bonds,
                          [&](int32_t k) HOL_FORCED { return mul_add(high[k], splat(0.5), vec{}); });
        for (unsigned left = wanted & ~good; left; left &= left - 1)
            solve_extended(call[__builtin_ctz(left)], *unit.elimination, lane, 1, memory.next, tally);
    }
};

}  // namespace holonomic::HOL_ISA::graph
