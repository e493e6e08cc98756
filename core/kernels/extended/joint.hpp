// One atom and the bonds that meet there, its arms. Some of them are eliminated together; this finds what they leave of
// the atom's inverse mass along another one. All bond vectors point away from the atom. Arm a offers the inverse mass
// E_a from its far side. With
//     S = diag(E) + w D^T B over the eliminated arms, where D = B except in Newton's method (theory (58)),
// each result is a sum over sets T of at most three of these arms. Its terms are products of Gram determinants, and
// nothing is subtracted (Cauchy and Binet). All sums are relative to the product of the E; so an arm of E = 0 must be
// in every set.
#pragma once

#include "core/kernels/extended/digits_lost.hpp"
#include "core/kernels/extended/plan.hpp"

namespace holonomic::HOL_ISA::extended {

// An atom of more bonds is done by its inertia alone, the sum of rho D B^T: O(n) instead of O(n^3) terms per arm. That
// has digits enough while it is no larger than `mild`; beyond, only atoms of still more bonds make do with it.
constexpr int few_arms = 16, most_arms = most_in_table;

// Among many arms, those that don't give way, three at most, take their directions out of all the others.
struct Rigid {
    int n, arm[3];
    Wide gram[9];  // inverse of D.B of these arms
};

struct Joint {
    int n;
    double w;
    bool mixed;
    Wide3 *D, *B;                 // [n], the same if not mixed
    Wide *rho;                    // [n] w / E; 1 where E = 0
    bool *rigid;                  // [n] E = 0
    Wide3 *XD, *XB;               // [n][n] cross products of arms a and b at [a n + b]
    double *sD, *sB, *sXD, *sXB;  // [n], [n][n] sizes of these vectors: sums of their components in absolute values
    int n_others, n_rigid;
    int *others;         // [n] the arms that are eliminated
    Wide det;            // of S over these arms, relative to the product of their E that are not 0
    bool by_inertia;     // how they are eliminated
    Wide inverse[9];     // if so: the inverse of 1 + sum rho D B^T over those that give way,
    Rigid rigid_arms;    // with the directions of the others taken out
    mutable Loss loss;   // of all sums so far
    Wide *behind, *row;  // [18 n], [n] of many arms: sums, and multipliers of one
};

// Finds the cross products and sizes of all arms, once their vectors are there.
HOL_NOINLINE void find_crosses(int n, const Wide3 *d, double *size, Wide3 *X, double *size_X) {
    for (int a = 0; a < n; ++a) size[a] = size_of(d[a]);
    for (int a = 0; a < n && n <= most_arms; ++a)
        for (int b = 0; b < a; ++b) {
            X[a * n + b] = cross(d[a], d[b]);
            X[b * n + a] = -X[a * n + b];
            size_X[a * n + b] = size_X[b * n + a] = size_of(X[a * n + b]);
        }
}

HOL_NOINLINE void prepare(Joint &x) {
    find_crosses(x.n, x.D, x.sD, x.XD, x.sXD);
    if (x.mixed) find_crosses(x.n, x.B, x.sB, x.XB, x.sXB);
}

// Arm a offers E from its far side.
HOL_NOINLINE void set_arm(Joint &x, int a, const Wide &E) {
    const Wide q = dot(x.D[a], x.B[a]);
    x.rigid[a] = !(abs(E.hi) > stiff * (x.w * abs(q.hi)));
    x.rho[a] = x.rigid[a] ? wide(1) : wide(x.w) / E;
}

// False if there is none.
HOL_NOINLINE bool invert(const Wide *m, Wide *inverse) {
    const Wide c0 = m[4] * m[8] - m[5] * m[7], c1 = m[5] * m[6] - m[3] * m[8], c2 = m[3] * m[7] - m[4] * m[6];
    const Wide det = m[0] * c0 + m[1] * c1 + m[2] * c2;
    if (!(abs(det.hi) > flat)) return false;
    const Wide r = wide(1) / det;
    const Wide adjugate[9] = {c0, m[2] * m[7] - m[1] * m[8], m[1] * m[5] - m[2] * m[4],
                              c1, m[0] * m[8] - m[2] * m[6], m[2] * m[3] - m[0] * m[5],
                              c2, m[1] * m[6] - m[0] * m[7], m[0] * m[4] - m[1] * m[3]};
    for (int i = 0; i < 9; ++i) inverse[i] = adjugate[i] * r;
    return true;
}

HOL_NOINLINE bool take_rigid(Joint &x, Rigid &rigid) {
    rigid.n = 0;
    if (x.n_rigid > 3) return false;
    for (int o = 0; o < x.n_others; ++o)
        if (x.rigid[x.others[o]]) rigid.arm[rigid.n++] = x.others[o];
    Wide m[9] = {};
    m[0] = m[4] = m[8] = wide(1);
    for (int p = 0; p < rigid.n; ++p)
        for (int q = 0; q < rigid.n; ++q) m[3 * p + q] = dot(x.D[rigid.arm[p]], x.B[rigid.arm[q]]);
    return invert(m, rigid.gram);
}

// Returns the multiplier of rigid arm p. With those of the others it takes a vector on the side of D, or of B, off the
// directions of the rigid arms.
HOL_INLINE Wide share(const Joint &x, const Rigid &rigid, const Wide3 &v, bool of_D, int p) {
    Wide sum = wide(0);
    for (int q = 0; q < rigid.n; ++q)
        sum += of_D ? dot(v, x.B[rigid.arm[q]]) * rigid.gram[3 * q + p]
                    : rigid.gram[3 * p + q] * dot(x.D[rigid.arm[q]], v);
    return sum;
}

HOL_NOINLINE Wide3 project(const Joint &x, const Rigid &rigid, const Wide3 &v, bool of_D) {
    Wide3 left = v;
    for (int p = 0; p < rigid.n; ++p) left = left - share(x, rigid, v, of_D, p) * (of_D ? x.D : x.B)[rigid.arm[p]];
    return left;
}

HOL_NOINLINE bool eliminate_by_inertia(Joint &x) {
    if (!take_rigid(x, x.rigid_arms)) return false;
    Wide m[9] = {};
    m[0] = m[4] = m[8] = wide(1);
    for (int o = 0; o < x.n_others; ++o) {
        const int a = x.others[o];
        if (x.rigid[a]) continue;
        const Wide3 D = x.rho[a] * project(x, x.rigid_arms, x.D[a], true), B = project(x, x.rigid_arms, x.B[a], false);
        const Wide d[3] = {D.x, D.y, D.z}, b[3] = {B.x, B.y, B.z};
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c) m[3 * r + c] += b[r] * d[c];
    }
    return invert(m, x.inverse);
}

// Sets the arms that are eliminated, others[0 .. n_others). Returns false if their S is singular.
HOL_NOINLINE bool eliminate_arms(Joint &x) {
    x.n_rigid = 0;
    double inertia = 0;
    for (int o = 0; o < x.n_others; ++o) {
        const int a = x.others[o];
        x.n_rigid += x.rigid[a];
        if (!x.rigid[a]) inertia += abs((x.rho[a] * dot(x.D[a], x.B[a])).hi);
    }
    x.by_inertia = x.n > most_arms || (x.n > few_arms && x.n_rigid == 0 && inertia < mild);
    if (x.w == 0) return true;
    if (x.by_inertia) {
        if (x.n_rigid > 0 || inertia >= mild) x.loss.note(1, wide(0));
        return eliminate_by_inertia(x);
    }
    Wide sum = x.n_rigid == 0 ? wide(1) : wide(0);
    double size = 0;
    for (int o = 0; o < x.n_others; ++o) {
        const int a = x.others[o];
        const Wide q = dot(x.D[a], x.B[a]), t = x.rho[a] * q;
        if (x.rigid[a] == x.n_rigid) sum += t;
        for (int p = 0; p < o; ++p) {
            const int b = x.others[p], rigid = x.rigid[a] + x.rigid[b];
            const Wide both = x.rho[a] * x.rho[b];
            const int ab = a * x.n + b;
            if (rigid == x.n_rigid) {
                sum += both * dot(x.XD[ab], x.XB[ab]);
                size += abs(both.hi) * (x.sD[a] * x.sD[b] * x.sXB[ab] + x.sXD[ab] * x.sB[a] * x.sB[b]);
            }
            for (int s = 0; s < p; ++s) {
                const int c = x.others[s];
                if (rigid + x.rigid[c] != x.n_rigid) continue;
                const Wide of_D = dot(x.D[c], x.XD[ab]), of_B = x.mixed ? dot(x.B[c], x.XB[ab]) : of_D;
                sum += both * x.rho[c] * (of_D * of_B);
                size += abs(both.hi * x.rho[c].hi) *
                        (x.sD[a] * x.sD[b] * x.sD[c] * abs(of_B.hi) + abs(of_D.hi) * x.sB[a] * x.sB[b] * x.sB[c]);
            }
        }
    }
    x.loss.note(size, sum);
    x.det = sum;
    return x.n_rigid <= 3 && abs(sum.hi) > coplanar;
}

// The arms of a joint as they stand on the two sides of <x^T, y^T>.
struct ArmSides {
    const Wide3 *D, *B, *XD, *XB;
    const double *sD, *sB, *sXD, *sXB;
    HOL_STATIC ArmSides of(const Joint &j, bool swapped) {
        if (swapped) return {j.B, j.D, j.XB, j.XD, j.sB, j.sD, j.sXB, j.sXD};
        return {j.D, j.B, j.XD, j.XB, j.sD, j.sB, j.sXD, j.sXB};
    }
};

// Returns the sizes of what gram_sum() adds up, component by component: 0 for zeros of vectors along the axes.
HOL_NOINLINE double gram_size(const Joint &j, int x, int y, int skip, bool swapped) {
    const ArmSides s = ArmSides::of(j, swapped);
    const int n = j.n, wanted = j.n_rigid - (skip >= 0 && j.rigid[skip] ? 1 : 0);
    double size = wanted == 0 ? size_of_dot(s.D[x], s.B[y]) : 0;
    for (int o = 0; o < j.n_others; ++o) {
        const int a = j.others[o];
        if (a == skip) continue;
        const double rho = abs(j.rho[a].hi);
        if (j.rigid[a] == wanted)
            size += rho * size_of_crosses(s.D[x], s.D[a], s.XD[x * n + a], s.B[y], s.B[a], s.XB[y * n + a]);
        for (int p = 0; p < o; ++p) {
            const int b = j.others[p];
            if (b == skip || j.rigid[a] + j.rigid[b] != wanted) continue;
            size += rho * abs(j.rho[b].hi) *
                    (abs(dot(s.D[x], s.XD[a * n + b]).hi) * size_of_volume(s.B[y], s.B[a], s.B[b]) +
                     size_of_volume(s.D[x], s.D[a], s.D[b]) * abs(dot(s.B[y], s.XB[a * n + b]).hi));
        }
    }
    return size;
}

// Returns the sum of <x^T, y^T> over sets T of eliminated arms, times what is left of the product of the E. A set holds
// all rigid arms but `in`, which is x or y or neither; no set holds `skip`. x is on the side of D and y on that of B,
// or the other way round.
HOL_NOINLINE Wide gram_sum(const Joint &j, int x, int y, int skip, bool swapped) {
    const ArmSides s = ArmSides::of(j, swapped);
    const int n = j.n, wanted = j.n_rigid - (skip >= 0 && j.rigid[skip] ? 1 : 0);
    Wide sum = wanted == 0 ? dot(s.D[x], s.B[y]) : wide(0);
    double size = wanted == 0 ? s.sD[x] * s.sB[y] : 0;
    for (int o = 0; o < j.n_others; ++o) {
        const int a = j.others[o], xa = x * n + a, ya = y * n + a;
        if (a == skip) continue;
        const double rho = abs(j.rho[a].hi);
        if (j.rigid[a] == wanted) {
            sum += j.rho[a] * dot(s.XD[xa], s.XB[ya]);
            size += rho * (s.sD[x] * s.sD[a] * s.sXB[ya] + s.sXD[xa] * s.sB[y] * s.sB[a]);
        }
        for (int p = 0; p < o; ++p) {
            const int b = j.others[p], ab = a * n + b;
            if (b == skip || j.rigid[a] + j.rigid[b] != wanted) continue;
            const Wide vx = dot(s.D[x], s.XD[ab]), vy = x == y && !j.mixed ? vx : dot(s.B[y], s.XB[ab]);
            sum += j.rho[a] * j.rho[b] * (vx * vy);
            size += rho * abs(j.rho[b].hi) *
                    (s.sD[x] * s.sD[a] * s.sD[b] * abs(vy.hi) + abs(vx.hi) * s.sB[y] * s.sB[a] * s.sB[b]);
        }
    }
    if (is_too_large(size, sum)) size = gram_size(j, x, y, skip, swapped);
    j.loss.note(size, sum);
    return sum;
}

HOL_NOINLINE Wide through_inverse(const Joint &x, const Wide3 &of_D, const Wide3 &of_B) {
    const Wide *const m = x.inverse;
    const Wide3 D = project(x, x.rigid_arms, of_D, true), B = project(x, x.rigid_arms, of_B, false);
    const Wide3 v = {m[0] * B.x + m[1] * B.y + m[2] * B.z, m[3] * B.x + m[4] * B.y + m[5] * B.z,
                     m[6] * B.x + m[7] * B.y + m[8] * B.z};
    return dot(D, v);
}

// First those of the arms that give way; the others share what these leave of the vector.
HOL_NOINLINE void multipliers_by_inertia(const Joint &x, int e, Wide *l) {
    Wide3 left = x.D[e];
    for (int o = 0; o < x.n_others; ++o) {
        const int a = x.others[o];
        if (x.rigid[a]) continue;
        l[a] = x.rho[a] * through_inverse(x, x.D[e], x.B[a]);
        left = left - l[a] * x.D[a];
    }
    for (int p = 0; p < x.rigid_arms.n; ++p) l[x.rigid_arms.arm[p]] = share(x, x.rigid_arms, left, true, p);
}

// Returns d_e . W d_f, the inverse mass between two arms e and f that are not eliminated.
HOL_NOINLINE Wide offered(const Joint &x, int e, int f) {
    if (x.w == 0) return wide(0);
    if (x.by_inertia) return x.w * through_inverse(x, x.D[e], x.B[f]);
    return x.w * (gram_sum(x, e, f, -1, false) / x.det);
}

// Finds the multipliers l of arm e: its row of S times the inverse of S over the eliminated arms; y_e -= sum l_a y_a.
HOL_NOINLINE void multipliers(const Joint &x, int e, Wide *l) {
    if (x.w != 0 && x.by_inertia) return multipliers_by_inertia(x, e, l);
    for (int o = 0; o < x.n_others; ++o) {
        const int a = x.others[o];
        l[a] = x.w == 0 ? wide(0) : x.rho[a] * (gram_sum(x, e, a, a, false) / x.det);
    }
}

// Returns what the eliminated arms have taken of w d_e . d_e, or of w d_e . d_f, from their multipliers.
HOL_NOINLINE Wide taken(const Joint &x, const Wide *l, int f) {
    Wide sum = wide(0);
    double size = 0;
    for (int o = 0; o < x.n_others; ++o) {
        const int a = x.others[o];
        sum += l[a] * dot(x.D[a], x.B[f]);
        size += abs(l[a].hi) * x.sD[a] * x.sB[f];
    }
    x.loss.note(size, sum);
    return x.w * sum;
}

}  // namespace holonomic::HOL_ISA::extended
