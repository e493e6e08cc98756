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
        for (int32_t slot = stretch.first; slot < stretch.end; ++slot) {
            load_slot(z, slot);
            if (x.s.child_start[slot + 1] > x.s.child_start[slot]) up_one(z, slot);
        }
        if (stretch.arm >= 0) up_arm(z, stretch.arm);
    }
    up_joint<1, true>(AtomRows<double>(x, x.s.n_tree), 1, z.working, x.margin);
}

HOL_NOINLINE void down_armed(ArmedTree &z, bool look) {
    for (int32_t i = z.x.s.n_arms; i >= 0; --i) {
        const EliminationPlan::Stretch &stretch = z.x.s.stretch[i];
        if (stretch.arm >= 0) down_arm(z, stretch.arm, look);
        for (int32_t slot = stretch.end; slot-- > stretch.first;) down_atom(z, slot, look);
    }
}

bool ArmedTree::read_and_solve(bool look) {
    for (int32_t slot = x.s.n_tree; slot < x.s.n_atoms; ++slot) x.w[slot] = x.lane[0].w[x.s.atom_of[slot]];
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
        for (int32_t k = x.s.stretch[i].first_place; k < x.s.stretch[i].end_place; ++k) {
            sum += abs(x.row[k].t);
            most = max(x.row[k].r, most);
            least = min(x.row[k].r, least);
        }
    return (x.margin >= 0 || !look) && sum - sum == 0 && ordinary_squares(least, most, most_ordinary_pivot).set;
}

HOL_NOINLINE bool is_overcorrected(const Molecules<double> &x, int32_t slot) {
    double v[3];
    read_atom(*x.in.v, x.at.number(0, x.s.atom_of[slot]), v);
    Overcorrected overcorrected(x.row[slot]);
    for (int32_t c = x.s.child_start[slot]; c < x.s.child_start[slot + 1]; ++c)
        overcorrected.add_child(x.row[x.s.child[c]]);
    return overcorrected.is(x.w[slot], v);
}

bool ArmedTree::any_overcorrected() const {
    if (cancelling.n_extended <= Cancelling::most_extended) {
        for (int32_t i = 0; i < cancelling.n_extended; ++i)
            if (is_overcorrected(x, cancelling.extended[i])) return true;
        return false;
    }
    const auto any_in = [&](int32_t first, int32_t end) {
        for (int32_t slot = first; slot < end; ++slot)
            if (is_overcorrected(x, slot)) return true;
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
