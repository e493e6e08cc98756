// A ring without side atoms; triangles are rings, too (theory (57)). Elimination on unit bonds carries the
// off-diagonals and the deficits of diagonal dominance. It subtracts nothing that matters, whatever the signs are (Q.
// Ye, Math. Comp. 77, 2195 (2008)). Rows are the bonds round the ring; joint k lies between rows k - 1 and k.
#pragma once

#include "core/kernels/extended/molecule.hpp"

namespace holonomic::HOL_ISA::extended {

struct Ring {
    int32_t n;
    Wide *length;          // [n] of row k's bond, in the bond's unit
    bool *backwards;       // [n] the bond points from row k's second atom to its first
    Wide *o, *v;           // [n] off-diagonal between rows k - 1 and k, deficit of row k
    Wide *P, *l, *l_last;  // [n] pivots; multipliers of the next row and of the last
    Wide *removed;         // [n] what the rows before have taken of the diagonal
    Wide *y;               // [n]
};

HOL_NOINLINE Ring take_ring(const ExtendedPlan &plan, ByteArena &memory) {
    Ring x;
    x.n = plan.n_bonds;
    x.backwards = memory.take<bool>(x.n);
    x.length = memory.take<Wide>(x.n);
    x.o = memory.take<Wide>(x.n);
    x.v = memory.take<Wide>(x.n);
    x.P = memory.take<Wide>(x.n);
    x.l = memory.take<Wide>(x.n);
    x.l_last = memory.take<Wide>(x.n);
    x.removed = memory.take<Wide>(x.n);
    x.y = memory.take<Wide>(x.n);
    return x;
}

// The atom between rows k - 1 and k.
HOL_INLINE int32_t joint_atom(const ScaledMolecule &m, const Ring &x, int32_t k) {
    const int32_t bond = m.plan.ring[k];
    return x.backwards[k] ? m.plan.atom_j[bond] : m.plan.atom_i[bond];
}

HOL_NOINLINE bool measure(const ScaledMolecule &m, const Ring &x) {
    const ExtendedPlan &plan = m.plan;
    int32_t atom = plan.atom_i[plan.ring[0]];  // ring begins with bond 0, which leaves it at its atom_j
    double bent = 0;
    for (int32_t k = 0; k < x.n; ++k) {
        const int32_t bond = plan.ring[k];
        x.backwards[k] = plan.atom_i[bond] != atom;
        atom = m.other(bond, atom);
        x.length[k] = square_root(dot(m.d[bond], m.d[bond]));
        x.v[k] = wide(0);
    }
    for (int32_t k = 0; k < x.n; ++k) {
        const int32_t before = k == 0 ? x.n - 1 : k - 1;
        const Wide3 &a = m.d[plan.ring[before]], &b = m.d[plan.ring[k]];
        const Wide lengths = x.length[before] * x.length[k];
        Wide cosine = dot(a, b) / lengths;
        if (x.backwards[before] != x.backwards[k]) cosine = -cosine;
        const Wide3 normal = cross(a, b);
        const Wide sine2 = dot(normal, normal) / (lengths * lengths);
        bent = sine2.hi > bent ? sine2.hi : bent;
        const double w = m.w[joint_atom(m, x, k)];
        const Wide complement = w * (sine2 / (wide(1) + abs(cosine)));
        x.o[k] = -(w * cosine);
        x.v[before] += complement;
        x.v[k] += complement;
    }
    return bent > straight;
}

HOL_NOINLINE bool factorize(const ScaledMolecule &m, const Ring &x, int32_t &bad) {
    const int32_t last = x.n - 1;
    bad = m.plan.ring[last];
    if (!measure(m, x)) return false;
    for (int32_t k = 0; k < x.n; ++k) x.removed[k] = wide(0);
    Wide z = x.o[0];
    for (int32_t k = 0; k + 2 < x.n; ++k) {
        const Wide next = x.o[k + 1];
        x.P[k] = x.v[k] + abs(next) + abs(z);
        bad = m.plan.ring[k];
        if (!(x.P[k].hi > 0)) return false;
        x.l[k] = -(next / x.P[k]);
        x.l_last[k] = -(z / x.P[k]);
        const Wide fill = x.l[k] * z, old = k + 3 == x.n ? x.o[last] : wide(0);
        const bool opposite = (old.hi > 0 && fill.hi < 0) || (old.hi < 0 && fill.hi > 0);
        const Wide smaller = less(abs(old), abs(fill)) ? abs(old) : abs(fill);
        const Wide lost = opposite ? 2.0 * smaller : wide(0);
        const Wide share = x.v[k] / x.P[k];
        x.v[k + 1] += abs(next) * share + lost;
        x.v[last] += abs(z) * share + lost;
        x.removed[k + 1] += next * next / x.P[k];
        x.removed[last] += z * z / x.P[k];
        z = old + fill;
    }
    const int32_t k = last - 1;
    x.P[k] = x.v[k] + abs(z);
    bad = m.plan.ring[k];
    if (!(x.P[k].hi > 0)) return false;
    x.l[k] = -(z / x.P[k]);
    x.l_last[k] = wide(0);
    x.P[last] = x.v[last] + abs(z) * (x.v[k] / x.P[k]);
    x.removed[last] += z * z / x.P[k];
    bad = m.plan.ring[last];
    return x.P[last].hi > 0;
}

HOL_NOINLINE void solve(const ScaledMolecule &m, const Ring &x, const Wide *b, Wide *t) {
    const int32_t last = x.n - 1;
    for (int32_t k = 0; k < x.n; ++k) x.y[k] = b[m.plan.ring[k]] / x.length[k];
    for (int32_t k = 0; k < last; ++k) {
        x.y[k + 1] += x.l[k] * x.y[k];
        if (k + 1 < last) x.y[last] += x.l_last[k] * x.y[k];
    }
    x.y[last] = x.y[last] / x.P[last];
    for (int32_t k = last; k-- > 0;) {
        x.y[k] = x.y[k] / x.P[k] + x.l[k] * x.y[k + 1];
        if (k + 1 < last) x.y[k] += x.l_last[k] * x.y[last];
    }
    for (int32_t k = 0; k < x.n; ++k) t[m.plan.ring[k]] = x.y[k] / x.length[k];
}

}  // namespace holonomic::HOL_ISA::extended
