// A linear chain for the extended-precision solver, which needs a plan as of any tree. Few need one: it is made on the
// spot.
#pragma once

#include "core/kernels/extended/molecule.hpp"
#include "core/kernels/extended/scratch.hpp"
#include "core/kernels/extended/verbs.hpp"
#include "core/kernels/tally.hpp"

namespace holonomic::HOL_ISA::extended {

// Bond k joins atoms k and k + 1. The last atom is the root.
struct ChainPlan {
    static constexpr int64_t most = longest_lane;  // bonds
    ExtendedPlan plan;
    MoleculeLane lane;
    int64_t table_start[most + 2];
    double w[most + 1], length[most];
    int32_t atom_i[most], atom_j[most], arm_start[most + 2], arms[2 * most], parent[most + 1], hanging[most],
        column_of[most], column_start[1];

    void set(const Lane &chain) {
        const int32_t n = static_cast<int32_t>(chain.n_bonds);
        arm_start[0] = column_start[0] = 0;
        table_start[0] = 0;
        for (int32_t i = 0; i <= n; ++i) {
            int32_t &end = arm_start[i + 1];
            end = arm_start[i];
            if (i > 0) arms[end++] = i - 1;
            if (i < n) arms[end++] = i;
            const int64_t valence = end - arm_start[i];
            table_start[i + 1] = table_start[i] + valence * valence;
            parent[i] = i < n ? i : -1;
            w[i] = chain.w ? chain.w[i] : chain.w_uniform;
        }
        for (int32_t k = 0; k < n; ++k) {
            atom_i[k] = hanging[k] = k;
            atom_j[k] = k + 1;
            column_of[k] = -1;
            length[k] = chain.length ? chain.length[k] : chain.length_uniform;
        }
        plan = {n + 1, n,       atom_i, atom_j,  arm_start, arms,         table_start, n > 1 ? 2 : 1, parent,
                n,     hanging, 0,      nullptr, column_of, column_start, nullptr,     nullptr};
        lane = {chain.first_atom, chain.atoms, nullptr, w, length, chain.first_bond, chain.chain};
    }
};

constexpr int64_t chain_scratch_bytes(int64_t n_bonds) {
    const int64_t n = n_bonds < ChainPlan::most ? n_bonds : ChainPlan::most;
    return static_cast<int64_t>((sizeof(ChainPlan) + 63) / 64 * 64) + extended_scratch_bytes(n + 1, n, 2, 4 * n, 0, 0);
}

// Returns false, with nothing written, if the chain has too many bonds or no solution is found. `scratch` has
// chain_scratch_bytes(), aligned to 64.
HOL_NOINLINE bool chain_positions(const PositionsCall &call, const Lane &chain, double *scratch, Tally &tally) {
    if (chain.n_bonds > ChainPlan::most) return false;
    ByteArena memory = {reinterpret_cast<char *>(scratch)};
    ChainPlan &of = *memory.take<ChainPlan>(1);
    of.set(chain);
    Tally own = empty_tally();
    PositionsCall of_chain = call;
    of_chain.far_trial = call.worst_trial;
    HOL_EXTENDED::extended::positions(of_chain, of.plan, of.lane, reinterpret_cast<double *>(memory.next), own);
    if (own.n_bad > 0) return false;
    add(tally, own);
    return true;
}

}  // namespace holonomic::HOL_ISA::extended
