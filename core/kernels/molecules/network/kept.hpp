// Factors of a network that are kept: what strands, trees and nodes leave of each other, and fronts where a solve needs
// them. Each solve is looked at as that of a single call.
#pragma once

#include "core/kernels/molecules/network/linear.hpp"

namespace holonomic::HOL_ISA::graph {

// In front of the arrays: whether they are good for anything; whether fronts stand. Without a block nothing is kept.
struct KeptNetwork {
    double *const block;

    static int64_t doubles(const NetworkPlan &s) { return most_lanes + NetLinear::values_of_factor(s); }
    Memory<double> memory() const { return {block + most_lanes}; }
    bool is_good() const { return block && block[0] != 0; }

    void keep(const NetLinear &x) const {
        block[0] = x.make();
        if (is_good()) x.factor.unknowns.prepare_for_many(NetProof::any_part, x.size_of_rhs);
        block[1] = x.factor.unknowns.direct;
    }
    void lend_to(NetLinear &x) const {
        x.is_kept = x.factor.unknowns.tried = true;
        x.factor.unknowns.direct = block[1] != 0;
    }
};

}  // namespace holonomic::HOL_ISA::graph
