// Kept factors of molecules by sparse LDL^T: bonds, the factor and its pivots stay where a solve looks for them.
#pragma once

#include "core/kernels/kept/flagged.hpp"
#include "core/kernels/molecules/sparse_ldl/outputs.hpp"

namespace holonomic::HOL_ISA::graph {

// In front of the arrays: the lanes that are kept, those whose pivots do without refinement among them, bit by bit.
template <class V>
struct KeptLdl {
    const LdlPlan &s;
    double *const block;

    static int64_t doubles(const LdlPlan &s) {
        return most_lanes + Width<V>::lanes * (4 * static_cast<int64_t>(s.n_rows) + in_fours(s.n_entries) +
                                               in_fours(s.n_columns) + in_fours(s.n_bonds) + in_fours(s.n_sites));
    }
    // Makes this the memory of what is kept; all else is that of the thread.
    void lend(LdlLinear<V> &x) const {
        Memory<V> memory = {block + most_lanes};
        x.d = {memory.values(4 * static_cast<int64_t>(s.n_rows))};
        x.lower = memory.values(in_fours(s.n_entries));
        x.per_pivot = memory.values(in_fours(s.n_columns));
        x.size = memory.values(in_fours(s.n_bonds));
        x.w = memory.values(in_fours(s.n_sites));
    }
    void keep_lanes(const LdlLinear<V> &x) const {
        block[0] = static_cast<double>(x.in_all_subtrees(x.firm));
        block[1] = static_cast<double>(x.in_all_subtrees(x.left));
    }
    void take_lanes(const LdlLinear<V> &x) const {
        for (int32_t b = 0; b <= s.n_subtrees; ++b) {
            x.firm[b] = static_cast<unsigned>(block[0]);
            x.left[b] = static_cast<unsigned>(block[1]);
        }
    }
};

struct KeepByLdl {
    const KeepCall &call;
    const MoleculeUnit &unit;

    template <class V>
    void block(const MoleculeLane *lane, int used, bool, double *scratch) const {
        const LdlPlan &s = *unit.elimination->ldl;
        double *const room = call.kept->room(call.kept->owner, lane[0].molecule, KeptLdl<V>::doubles(s));
        if (!room) return leave(lane, (1u << used) - 1, call.left);
        Memory<V> memory = {scratch};
        const LdlBlock<V> block = {*unit.elimination, lane, used, true, false, unit.team, memory};
        const Inputs none = {};
        LdlLinear<V> x = block.linear(call.box, call.r, none, 0);
        const KeptLdl<V> kept = {s, room};
        kept.lend(x);
        factorize(x);
        kept.keep_lanes(x);
        leave(lane, bits(x.in_use()) & ~x.in_all_subtrees(x.firm), call.left);
    }
};

struct SolveByLdl {
    const KeptCall &call;
    const MoleculeUnit &unit;
    Tally &tally;

    template <class V>
    void block(const MoleculeLane *lane, int used, bool, double *scratch) const {
        double *const from = const_cast<double *>(call.kept->block[lane[0].molecule]);
        if (!from) return;
        Memory<V> memory = {scratch};
        const LdlBlock<V> block = {*unit.elimination, lane, used, true, true, unit.team, memory};
        const Inputs in = {call.v.x ? &call.v : nullptr, call.f.x ? &call.f : nullptr, call.rhs, false};
        const int terms = call.rhs ? given : (call.v.x ? squares : 0) | (call.f.x ? pulls : 0);
        LdlLinear<V> x = block.linear(*call.kept->box, call.kept->r, in, terms);
        const Rows<V> bonds = x.d;
        const KeptLdl<V> kept = {x.s, from};
        kept.lend(x);
        kept.take_lanes(x);
        const unsigned of_kept = x.in_all_subtrees(x.firm);
        const unsigned rest = of_kept & write_by_ldl(call, x, solve_again_and_refine(x, bonds), tally);
        if (rest) solve_extended(call, *unit.elimination, lane, rest, memory.next, tally);
    }
};

}  // namespace holonomic::HOL_ISA::graph
