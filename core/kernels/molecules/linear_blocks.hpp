// Blocks of molecules of one shape at the linear levels (linear_level.hpp): of trees and rings in lanes, by sparse
// LDL^T, or one large tree with arms.
#pragma once

#include "core/kernels/molecules/armed_tree/linear.hpp"
#include "core/kernels/molecules/blocks.hpp"
#include "core/kernels/molecules/flagged.hpp"
#include "core/kernels/molecules/solve.hpp"
#include "core/kernels/molecules/sparse_ldl/outputs.hpp"

namespace holonomic::HOL_ISA::graph {

// v + w G of the atom at an index.
template <class V>
struct ProjectedVelocities {
    const Vector3<V> *v, *pull;
    const V *w;
    HOL_FORCED Vector3<V> operator[](int32_t index) const { return add_times(v[index], w[index], pull[index]); }
};

// Trees and rings in lanes.
template <class V>
struct LinearBlock {
    TreeLinear<V> &z;
    const int terms;
    const bool masses_known;

    unsigned in_use() const { return bits(z.x.in_use()); }
    unsigned solve() const { return load_and_solve(z, terms, masses_known); }
    template <bool with_length>
    HOL_FORCED void write_bonds(double factor, double *out, unsigned which) const {
        graph::write_bonds<with_length>(z.x, factor, out, which);
    }
    HOL_FORCED void write_pulls(const AtomArray &g, bool add, unsigned which) const {
        write_vectors(g, z.x.at, z.x.s.index_of, z.x.s.n_atoms, ByIndex<V>(z.pulls()),
                      Written<V>{which, nullptr, z.x.lane, add});
    }
    HOL_FORCED void write(const LinearOutputs &out, unsigned which, Tally &tally) const {
        if (out.virial) add_pulls_to_virial(z.x, which, tally);
        write_bonds_and_pulls(*this, out, which);
    }
    HOL_FORCED void project(const LinearOutputs &out, bool twice, unsigned which, Tally &tally) const {
        write_all_but_atoms(*this, out, which, tally);
        const ProjectedVelocities<V> projected = {z.v, z.pulls(), z.x.w};
        if (twice) {
            for (int32_t index = 0; index < z.x.s.n_atoms; ++index) put(z.v[index], projected[index]);
            solve_for_rates(z);
        }
        write_vectors(*out.g, z.x.at, z.x.s.index_of, z.x.s.n_atoms, projected, Written<V>{which, nullptr, z.x.lane});
    }
};

// Call: of forces, of velocities, or for given right-hand sides.
template <class Call>
struct LinearOfBlocks {
    const Call &call;
    const EliminationPlan &elimination;
    const Way way;
    const bool packed;
    Tally &tally;
    const LongTeam *team;
    NextMolecules &ahead;

    template <class V>
    void block(const MoleculeLane *lane, int used, bool masses_known, double *scratch) const {
        if (way == Way::sparse_ldl) return block_by_ldl<V>(lane, used, masses_known, scratch);
        if (way == Way::armed_tree) {
            if (solve_armed(lane, scratch)) return;
            if (elimination.ldl) return block_by_ldl<V>(lane, used, false, scratch);
        }
        Memory<V> memory = {scratch};
        TreeLinear<V> z(elimination, lane, used, packed, call.box, call.r, memory);
        const RightHandSides rhs = right_hand_sides_of(call);
        z.x.in = rhs.in;
        const LinearBlock<V> x = {z, rhs.terms, masses_known};
        const unsigned rest = solve_linear(call, x, tally, [&] { ahead.fetch(); });
        if (__builtin_expect(rest != 0, 0)) solve_flagged(call, elimination, lane, rest, memory.next, tally);
    }

private:
    template <class V>
    __attribute__((noinline)) void block_by_ldl(const MoleculeLane *lane, int used, bool masses_known,
                                                double *scratch) const {
        Memory<V> memory = {scratch};
        const LdlBlock<V> block = {elimination, lane, used, packed, masses_known, team, memory};
        const RightHandSides rhs = right_hand_sides_of(call);
        const LdlLinear<V> list = block.linear(call.box, call.r, rhs.in, rhs.terms);
        const LdlWay<V> x = {list};
        if (const unsigned rest = solve_linear(call, x, tally, [] {}))
            solve_flagged(call, elimination, lane, rest, memory.next, tally);
    }
    // Given right-hand sides have no use for arms.
    bool solve_armed(const MoleculeLane *lane, double *scratch) const {
        const RightHandSides rhs = right_hand_sides_of(call);
        if (rhs.terms == given) return false;
        ArmedTree z(elimination, *lane, packed, call.box, call.r, rhs.in, rhs.terms, team, scratch);
        return solve_linear(call, z, tally, [] {}) == 0;
    }
};

}  // namespace holonomic::HOL_ISA::graph
