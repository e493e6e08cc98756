// The atoms between the arms of a large tree, one by one: read, eliminated, and what is found of them.
#pragma once

#include "core/kernels/molecules/armed_tree/linear.hpp"

namespace holonomic::HOL_ISA::graph {

// Reads the atom and the bond above it. The parent is read again from the caller's arrays.
HOL_INLINE void load_index(const ArmedTree &z, int32_t index) {
    const Molecules<double> &x = z.x;
    const int32_t atom = x.s.atom_of[index], above = x.s.atom_of[x.s.parent[index]];
    const double w = x.lane[0].w[atom];
    Vector3<double> d = read(*x.r, x.at, atom) - read(*x.r, x.at, above), unused = {};
    take_image<false>(*x.box, d, unused);
    double b = 0;
    if (z.terms & (squares | rates)) {
        const Vector3<double> dv = read(*x.in.v, x.at, atom) - read(*x.in.v, x.at, above);
        b = z.terms & rates ? dot(d, dv) : dot(dv, dv);
        if (x.in.strain) b += stretching(x.in.strain, d);
    }
    if (z.terms & pulls)
        b = Loader<double>::with_pull(d, x.lane[0].w[above], read(*x.in.f, x.at, above), w, read(*x.in.f, x.at, atom),
                                      b);
    BondRow<double> &row = x.row[index];
    row.d = d;
    row.q = dot(d, d);
    row.E = w * row.q;  // of a leaf
    row.t = b;
    x.w[index] = w;
}

// In twice the precision. False: that doesn't do either.
HOL_NOINLINE bool up_extended(const Molecules<double> &x, int32_t index, int k) {
    const AtomRows<double> rows(x, index);
    FlaggedAtom atom = {};
    atom.k = k;
    atom.w = rows.w();
    for (int a = 0; a <= k; ++a) {
        atom.bond[a] = a < k ? rows.bond(a) : rows.above();
        exact_bond(x, 0, a < k ? rows.child[a] : index, atom.d[a], atom.low[a]);
    }
    if (!up_flagged(atom)) return false;
    for (int a = 0; a <= k; ++a) (a < k ? rows.bond(a) : rows.above()) = atom.bond[a];
    for (int p = 0; p < k * (k - 1) / 2; ++p) rows.multipliers()[p] = atom.pair[p];
    return true;
}

// Goes up at one atom, with extended arithmetic where plain arithmetic does not do.
HOL_NOINLINE void up_one(ArmedTree &z, int32_t index) {
    const Molecules<double> &x = z.x;
    Cancelling &cancelling = z.cancelling;
    double &margin = z.x.margin;
    const AtomRows<double> rows(x, index);
    const int k = x.s.child_start[index + 1] - x.s.child_start[index];
    if (__builtin_expect(cancelling.holds(index), 0)) {
        if (k > 3 || !up_extended(x, index, k)) margin = -1;
        return cancelling.note_extended(index);
    }
    if (k > 3) return up_joint<0, false>(rows, k, z.working, margin);
    double before[8], own = 1;
    for (int a = 0; a <= k; ++a) {
        const BondRow<double> &row = a < k ? rows.bond(a) : rows.above();
        before[2 * a] = row.E;
        before[2 * a + 1] = row.t;
    }
    choose_number<1, 3>(k, [&](auto known) { up_joint<known, false>(rows, k, z.working, own); });
    if (__builtin_expect(own >= 0, 1)) return;
    for (int a = 0; a <= k; ++a) {
        BondRow<double> &row = a < k ? rows.bond(a) : rows.above();
        row.E = before[2 * a];
        row.t = before[2 * a + 1];
    }
    if (!up_extended(x, index, k)) margin = -1;
    cancelling.note_extended(index);
}

// Deals with an atom with cancelling bonds. The first time it notes the atom, to be eliminated in extended precision
// the next time. Then products are right, and a result must not be a small difference of what comes up and what comes
// down.
HOL_NOINLINE void note_cancelling(ArmedTree &z, int32_t index, int k) {
    const Molecules<double> &x = z.x;
    Cancelling &cancelling = z.cancelling;
    double &margin = z.x.margin;
    double own = 1;
    flag_cancelling_bonds(x, index, k, 1, own);
    if (own >= 0) return;
    if (!cancelling.again) {
        if (!cancelling.note(index)) margin = -1;
        return;
    }
    if (!cancelling.holds(index)) margin = -1;
    const double above = x.row[index].t;
    for (int a = 0; a < k; ++a) {
        const int32_t bond_index = x.s.child[x.s.child_start[index] + a];
        const BondRow<double> &row = x.row[bond_index];
        const double down = row.l * above, A = (x.w[index] + x.w[bond_index]) * row.q;
        const double size = abs(row.t) + terms_of(x, row, bond_index, 0) / A;
        if (!(abs(row.t - down) + abs(down) <= sqrt(most_cancelled2(x.s.n_bonds)) * size)) margin = -1;
    }
}

HOL_INLINE void down_atom(ArmedTree &z, int32_t index, bool look) {
    const Molecules<double> &x = z.x;
    const int k = x.s.child_start[index + 1] - x.s.child_start[index];
    double own = 1;
    if (look && k > 1) {
        down_one<double>(x, index, true, false, nullptr, own);
        if (__builtin_expect(own < 0, 0)) note_cancelling(z, index, k);
    } else {
        down_one<double>(x, index, false, false, nullptr, own);
    }
}

}  // namespace holonomic::HOL_ISA::graph
