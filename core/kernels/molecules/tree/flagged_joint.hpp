// Eliminates an atom of a tree at which plain products have lost too much, in twice the precision, by sums in which
// nothing is subtracted (theory (54)). What comes up to it is right, so what it hands up is right, too. Nothing else of
// a large molecule needs to be done again.
#pragma once

#include "core/kernels/extended/joint.hpp"
#include "core/kernels/molecules/tree/flagged_atom.hpp"
#include "core/kernels/molecules/tree/joint.hpp"

namespace holonomic::HOL_ISA::graph {

// An atom with at most three children, which are arms 0 .. k - 1; the bond above is arm k. Vectors are divided by a
// power of two each, masses by one, so that no product overflows.
struct FlaggedJoint {
    static constexpr int most = FlaggedAtom::most;
    Wide3 D[most], X[most * most];
    Wide rho[most];
    bool rigid[most];
    int others[most];
    double size[most], size_X[most * most];
    double unit[most], mass_unit;
    extended::Joint joint;

    static double power_of(double a) {
        int e;
        (void)__builtin_frexp(a, &e);
        return __builtin_ldexp(1.0, e - 1);
    }

    bool open(const FlaggedAtom &x) {
        const int k = x.k;
        mass_unit = power_of(x.w);
        joint = {};
        joint.n = k + 1;
        joint.w = x.w / mass_unit;
        joint.D = joint.B = D;
        joint.rho = rho;
        joint.rigid = rigid;
        joint.XD = joint.XB = X;
        joint.others = others;
        joint.sD = joint.sB = size;
        joint.sXD = joint.sXB = size_X;
        for (int a = 0; a <= k; ++a) {
            const Vector3<double> &d = x.d[a], &lo = x.low[a];
            unit[a] = power_of(__builtin_sqrt(x.bond[a].q));
            if (!(unit[a] > 0x1p-480 && unit[a] < 0x1p480)) return false;
            const double r = 1 / unit[a];
            D[a] = {{r * d.x, r * lo.x}, {r * d.y, r * lo.y}, {r * d.z, r * lo.z}};
        }
        prepare(joint);
        for (int a = 0; a < k; ++a) set_arm(joint, a, wide(x.bond[a].E / unit[a] / unit[a] / mass_unit));
        return true;
    }

    // Of the first n arms all but one.
    bool eliminate(int n, int but) {
        joint.n_others = 0;
        for (int a = 0; a < n; ++a)
            if (a != but) others[joint.n_others++] = a;
        return eliminate_arms(joint);
    }
    // An atom that gives way to the bond above by less than this is held: its bonds may depend on each other, which the
    // extended-precision solver has to say.
    bool gives_way(const Wide &E) const { return E.hi > 1e-40 * (joint.w * dot(D[joint.n - 1], D[joint.n - 1]).hi); }
    // Of an arm, with what it offers from its far side.
    Wide pivot(int a, double E) const { return wide(E / unit[a] / unit[a] / mass_unit) + offered(joint, a, a); }
};

bool up_flagged(FlaggedAtom &x) {
    const int k = x.k;
    FlaggedJoint f;
    if (!f.open(x)) return false;
    double r[3], m[3] = {}, u[3], y[3], l[3];
    Wide L[FlaggedJoint::most];
    for (int j = 0; j < k; ++j) {
        y[j] = x.bond[j].t;
        if (!f.eliminate(j, -1)) return false;
        const Wide P = f.pivot(j, x.bond[j].E);
        r[j] = 1 / rounded(P) / f.unit[j] / f.unit[j] / f.mass_unit;
        for (int a = j + 1; a < k; ++a)
            m[pair_of(a, j)] = rounded(offered(f.joint, a, j) / P) * (f.unit[a] / f.unit[j]);
    }
    for (int a = 0; a < k; ++a) {
        if (!f.eliminate(k, a)) return false;
        extended::multipliers(f.joint, a, L);
        Wide sum = wide(y[a]);
        for (int b = 0; b < k; ++b)
            if (b != a) sum -= L[b] * wide(y[b] * (f.unit[a] / f.unit[b]));
        u[a] = rounded(sum / f.pivot(a, x.bond[a].E)) / f.unit[a] / f.unit[a] / f.mass_unit;
    }
    if (!f.eliminate(k, -1)) return false;
    const Wide left = offered(f.joint, k, k);
    if (!f.gives_way(left)) return false;
    extended::multipliers(f.joint, k, L);
    Wide above = wide(x.bond[k].t);
    for (int a = 0; a < k; ++a) {
        above += L[a] * wide(y[a] * (f.unit[k] / f.unit[a]));
        l[a] = rounded(L[a]) * (f.unit[k] / f.unit[a]);
    }
    x.bond[k].E = rounded(left) * f.unit[k] * f.unit[k] * f.mass_unit;
    x.bond[k].t = rounded(above);
    for (int a = 0; a < k; ++a) {
        BondRow<double> &row = x.bond[a];
        row.E = y[a] * r[a];
        row.t = u[a];
        row.l = l[a];
        row.r = r[a];
    }
    for (int i = 0; i < k * (k - 1) / 2; ++i) x.pair[i] = m[i];
    return true;
}

}  // namespace holonomic::HOL_ISA::graph
