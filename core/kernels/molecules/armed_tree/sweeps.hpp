// The sweeps of tree/joint.hpp (theory (51)-(53)) over one large tree with arms, and what is written of it. Arms
// come as chains (arms.hpp), between their ends atoms come one by one (atoms.hpp). Compiled once.
#pragma once

#include "core/kernels/atom.hpp"
#include "core/kernels/molecules/armed_tree/arms.hpp"

namespace holonomic::HOL_ISA::graph {

// Goes up, reading on the way. An arm comes behind the stretch that ends at its lowest atom.
HOL_NOINLINE void up_armed(ArmedTree &z) {
    Molecules<double> &x = z.x;
    z.cancelling.n_extended = 0;
    x.margin = 1;
    for (int32_t i = 0; i <= x.s.n_arms; ++i) {
        const EliminationPlan::Stretch &stretch = x.s.stretch[i];
        for (int32_t index = stretch.first; index < stretch.end; ++index) {
            load_index(z, index);
            if (x.s.child_start[index + 1] > x.s.child_start[index]) up_one(z, index);
        }
        if (stretch.arm >= 0) up_arm(z, stretch.arm);
    }
    up_joint<1, true>(AtomRows<double>(x, x.s.n_tree), 1, z.working, x.margin);
}

HOL_NOINLINE void down_armed(ArmedTree &z, bool look) {
    for (int32_t i = z.x.s.n_arms; i >= 0; --i) {
        const EliminationPlan::Stretch &stretch = z.x.s.stretch[i];
        if (stretch.arm >= 0) down_arm(z, stretch.arm, look);
        for (int32_t index = stretch.end; index-- > stretch.first;) down_atom(z, index, look);
    }
}

bool ArmedTree::read_and_solve(bool look) {
    for (int32_t index = x.s.n_tree; index < x.s.n_atoms; ++index) x.w[index] = x.lane[0].w[x.s.atom_of[index]];
    eliminate_arms(*this);
    bool again;
    do {  // once more where cancelling bonds have been found
        up_armed(*this);
        down_armed(*this, look);
        again = cancelling.n > 0 && !cancelling.again && x.margin >= 0;
        cancelling.again = true;
    } while (again);
    double sum = 0, most = 0, least = 1;  // of reciprocal pivots
    for (int32_t i = 0; i <= x.s.n_arms; ++i)
        for (int32_t k = x.s.stretch[i].first_index; k < x.s.stretch[i].end_index; ++k) {
            sum += abs(x.row[k].t);
            most = max(x.row[k].r, most);
            least = min(x.row[k].r, least);
        }
    return (x.margin >= 0 || !look) && sum - sum == 0 && ordinary_squares(least, most, most_ordinary_pivot).set;
}

HOL_NOINLINE bool is_overcorrected(const Molecules<double> &x, int32_t index) {
    double v[3];
    read_atom(*x.in.v, x.at.number(0, x.s.atom_of[index]), v);
    Overcorrected overcorrected(x.row[index]);
    for (int32_t c = x.s.child_start[index]; c < x.s.child_start[index + 1]; ++c)
        overcorrected.add_child(x.row[x.s.child[c]]);
    return overcorrected.is(x.w[index], v);
}

bool ArmedTree::any_overcorrected() const {
    if (cancelling.n_extended <= Cancelling::most_extended) {
        for (int32_t i = 0; i < cancelling.n_extended; ++i)
            if (is_overcorrected(x, cancelling.extended[i])) return true;
        return false;
    }
    const auto any_in = [&](int32_t first, int32_t end) {
        for (int32_t index = first; index < end; ++index)
            if (is_overcorrected(x, index)) return true;
        return false;
    };
    for (int32_t i = 0; i <= x.s.n_arms; ++i)
        if (any_in(x.s.stretch[i].first, x.s.stretch[i].end)) return true;
    for (int32_t a = 0; a < x.s.n_arms; ++a)
        if (arms.alone[a] && any_in(x.s.arm[a].bottom + 1, x.s.arm[a].top() + 1)) return true;
    return false;
}

void ArmedTree::write_all(const LinearOutputs &out, bool weighted, Tally &tally) const {
    MoleculesVirial<double> virial;
    for (int32_t i = 0; i <= x.s.n_arms; ++i) write_range(x, weighted, x.s.stretch[i], out, virial);
    write_range(x, weighted, {x.s.n_tree, x.s.n_atoms, 0, 0, -1}, out, virial);
    if (out.virial) virial.count(1, 1, tally);
    write_arms(*this, weighted, out, tally);
}

}  // namespace holonomic::HOL_ISA::graph
