// The joints of trees at the position level (theory (58)). Rows belong to the new bond vectors D and columns to the
// reference bonds b. So S = diag(E) + w D^T b is not symmetric, and the ways up and down have multipliers of their own:
//
//     y_e = y_e + w (b_c . D_e) S^-1 y,   E_e = w (D_e . b_e) - w^2 (D_e . b) S^-1 (D . b_e),   t_c = u_c + (S^-1 w D .
//     b_e)_c t_e
//
// Newton's residuals are exact whatever the factors are, so nothing here needs a test of doubt.
#pragma once

#include "core/kernels/molecules/tree/joint.hpp"
#include "core/kernels/molecules/tree/many.hpp"

namespace holonomic::HOL_ISA::graph {

template <class V>
struct NewtonRow {
    // What the way down touches comes first.
    Vector3<V> b;
    V tau;   // the multiplier so far, 2 dt^2 lambda
    V t;     // what is left of the length, and y; then u, then the correction
    V down;  // of the correction of the bond above, what this one gets
    V up;    // of y, what the bond above gets
    V r;     // 1 / pivot; while factors are made first E, as in BondRow
    V a2, per_a2;
    V stretch;  // |D_0| / 2 a of the bond that the factors were made of
    Vector3<V> D;

    // What is left of the length, e = D.D / a^2 - 1. Not (D.D - a^2) / 2: a change of |D|, which is D/|D| . dD, is
    // nearly what it was when the factors were made, as bonds are stretched more than they turn; that of D.D grows with
    // |D|. So with the factors of D_0, of which row k is D_0 . dD, it is |D_0| (|D| - a), to second order in e
    // unless the bond is far too long.
    HOL_FORCED V left(V sigma, V e) const {
        return (stretch * sigma) * max(mul_add(Width<V>::all(-0.25), e, Width<V>::all(1)), Width<V>::all(0.5));
    }
    // Where the factors will be those of this D; to third order.
    HOL_FORCED V first_left(V sigma, V excess) {
        const V one = Width<V>::all(1), eighth = Width<V>::all(0.125), quarter = Width<V>::all(0.25);
        const V e = max(min(excess, Width<V>::all(0.5)), Width<V>::all(-0.5));
        stretch = 0.5 * mul_add(mul_add(-eighth, e, Width<V>::all(0.5)), e, one);
        return (0.5 * sigma) * mul_add(mul_add(-eighth, e, quarter), e, one);
    }
};

template <class V>
struct PulledAtom {
    Vector3<V> pull;  // the sum of tau b over the bonds that point away from it, less that over those that point to it
    V w;              // as in NewtonSystem
};

template <class V>
struct NewtonSystem {
    const EliminationPlan &s;
    V *w;  // [n_atoms] by index
    NewtonRow<V> *row;
    V *lower, *upper;            // [n_pairs] each
    PulledAtom<V> *atom;         // [n_atoms] by index
    Vector3<V> *r_ref, *r;       // [n_atoms] coordinates, until the bonds are made
    Vector3<V> *new_D;           // [n_bonds] bonds as moved, for new factors
    V *core_lower, *core_upper;  // [n_core] each, of a ring: what its last bond gets of each, and each of the last one
    V *reach_up, *reach_down;    // [2 n_tree] each, of a ring: as Ring
    Memory<V> working;           // of a joint of many bonds
};

// LU of S, which has k k values: r = 1 / P, lower l_aj = S_aj / P_j, upper n_ja = S_ja / P_j, both at pair_of(a, j),
// a > j.
template <class V>
HOL_INLINE void decompose(int k, V *S, V *r, V *lower, V *upper) {
    HOL_UNROLL_FEW
    for (int j = 0; j < k; ++j) {
        r[j] = Width<V>::all(1) / S[j * k + j];
        HOL_UNROLL_FEW
        for (int a = j + 1; a < k; ++a) {
            lower[pair_of(a, j)] = S[a * k + j] * r[j];
            upper[pair_of(a, j)] = S[j * k + a] * r[j];
        }
        HOL_UNROLL_FEW
        for (int a = j + 1; a < k; ++a) {
            HOL_UNROLL_FEW
            for (int b = j + 1; b < k; ++b) S[a * k + b] = mul_add(-lower[pair_of(a, j)], S[j * k + b], S[a * k + b]);
        }
    }
}

template <class V, int known>
struct NewtonMemory {
    V S[known * known], r[known], lower[known * (known - 1) / 2 + 1], upper[known * (known - 1) / 2 + 1], y[known],
        z[known], h[known], u[known];
    HOL_STATIC NewtonMemory make(Memory<V>, int) { return {}; }
};
template <class V>
struct NewtonMemory<V, 0> {
    V *S, *r, *lower, *upper, *y, *z, *h, *u;
    HOL_STATIC NewtonMemory make(Memory<V> a, int k) {
        return {a.values(k * k),
                a.values(k),
                a.values(k * (k - 1) / 2),
                a.values(k * (k - 1) / 2),
                a.values(k),
                a.values(k),
                a.values(k),
                a.values(k)};
    }
    static constexpr int64_t values(int64_t k) { return k * k + k * (k - 1) + 5 * k; }
};

// An atom at the position level: its bonds at their indices, those to its children, and the one above. known: how many
// children it has, where the compiler knows it. In lanes their indices follow each other; one molecule may be larger.
// tree_batch/newton.hpp has the same for atoms of W different trees.
template <class V, int known = 0>
struct NewtonAtom {
    const NewtonSystem<V> &x;
    const int32_t index, first, *const child;

    HOL_FORCED NewtonAtom(const NewtonSystem<V> &system, int32_t s)
        : x(system), index(s), first(system.s.child_start[s]), child(system.s.child + first) {}
    HOL_FORCED V w() const { return x.w[index]; }
    HOL_FORCED int32_t bond_index(int a) const { return known > 0 && Width<V>::lanes > 1 ? first + a : child[a]; }
    HOL_FORCED NewtonRow<V> &bond(int a) const { return x.row[bond_index(a)]; }
    HOL_FORCED const Vector3<V> &D(int a) const { return x.new_D[bond_index(a)]; }
    HOL_FORCED NewtonRow<V> &above() const { return x.row[index]; }
    HOL_FORCED const Vector3<V> &D_above() const { return x.new_D[index]; }
    HOL_FORCED V *lower() const { return x.lower + x.s.pair_start[index]; }
    HOL_FORCED V *upper() const { return x.upper + x.s.pair_start[index]; }
    HOL_FORCED Memory<V> working() const { return x.working; }
};

// Finds the factors of the k children of an atom. Puts them into f and where they are kept.
template <class V, class Rows, class Joint>
HOL_INLINE void factorize_children(const Rows &x, int k, Joint &f) {
    const V w = x.w();
    HOL_UNROLL_FEW
    for (int a = 0; a < k; ++a) {
        HOL_UNROLL_FEW
        for (int b = 0; b < k; ++b) {
            const V g = w * dot(x.D(a), x.bond(b).b);
            f.S[a * k + b] = a == b ? g + x.bond(a).r : g;
        }
    }
    decompose(k, f.S, f.r, f.lower, f.upper);
    V *const lower = x.lower(), *const upper = x.upper();
    HOL_UNROLL_FEW
    for (int a = 0; a < k; ++a) {
        x.bond(a).r = f.r[a];
        HOL_UNROLL_FEW
        for (int b = 0; b < a; ++b) {
            lower[pair_of(a, b)] = f.lower[pair_of(a, b)];
            upper[pair_of(a, b)] = f.upper[pair_of(a, b)];
        }
    }
}

// Returns what the children leave of the inverse mass along another bond b of the atom, D as moved. Finds its
// multipliers for each of them, `up` and `down`.
template <class V, class Rows, class Joint>
HOL_INLINE V couple(const Rows &x, int k, const Vector3<V> &D, const Vector3<V> &b, Joint &f, V *z, V *h, V *up,
                    V *down) {
    const V w = x.w();
    HOL_UNROLL_FEW
    for (int a = 0; a < k; ++a) f.y[a] = w * dot(x.D(a), b);
    solve_joint(k, f.r, f.lower, f.upper, f.y, z, down);
    HOL_UNROLL_FEW
    for (int a = 0; a < k; ++a) f.y[a] = w * dot(D, x.bond(a).b);
    solve_joint(k, f.r, f.upper, f.lower, f.y, h, up);
    V E = w * dot(D, b);
    HOL_UNROLL_FEW
    for (int a = 0; a < k; ++a) E = mul_add(-(h[a] * f.r[a]), z[a], E);
    return E;
}

// An atom with many children, as in many.hpp:
//
//     M = 1 + w sum_c b_c D_c^T / E_c,   N = M^-1,   E_e = w D_e^T N b_e,   t_c = (y_c - D_c.a) / E_c,   a = w N sum_c
//     b_c y_c / E_c
//
// Keeps w N and the D_c / E_c: bonds turn before there are new factors.
template <class V, class Rows>
HOL_INLINE void factorize_many(const Rows &x, int k) {
    const V w = x.w();
    Matrix3<V> M = Matrix3<V>::one();
    Vector3<V> *const D = reinterpret_cast<Vector3<V> *>(x.lower() + 9);
    for (int a = 0; a < k; ++a) {
        NewtonRow<V> &row = x.bond(a);
        row.r = Width<V>::all(1) / row.r;
        D[a] = row.r * x.D(a);
        M.add(w * row.b, D[a]);
    }
    const Matrix3<V> B = divided_by(M, w);
    *reinterpret_cast<Matrix3<V> *>(x.lower()) = B;
    const Vector3<V> D_e = x.D_above(), down = B * x.above().b,
                     up = add_times(add_times(D_e.x * B.x, D_e.y, B.y), D_e.z, B.z);
    x.above().r = dot(D_e, down);
    for (int a = 0; a < k; ++a) {
        NewtonRow<V> &row = x.bond(a);
        row.up = row.r * dot(up, row.b);
        row.down = dot(D[a], down);
    }
}

template <class V, class Rows>
HOL_INLINE void substitute_many_moved(const Rows &x, int k) {
    const Vector3<V> *const D = reinterpret_cast<const Vector3<V> *>(x.lower() + 9);
    Vector3<V> sum = {};
    V above = x.above().t;
    for (int a = 0; a < k; ++a) {
        NewtonRow<V> &row = x.bond(a);
        above = mul_add(row.up, row.t, above);
        row.t = row.t * row.r;
        sum = add_times(sum, row.t, row.b);
    }
    sum = *reinterpret_cast<const Matrix3<V> *>(x.lower()) * sum;
    for (int a = 0; a < k; ++a) x.bond(a).t = x.bond(a).t - dot(D[a], sum);
    x.above().t = above;
}

template <int known, bool top, class V, class Rows>
HOL_INLINE void factorize_joint(const Rows &x, int count) {
    const int k = known > 0 ? known : count;
    if (!top && k > most_decomposed) return factorize_many<V>(x, k);
    auto f = NewtonMemory<V, known>::make(x.working(), k);
    factorize_children<V>(x, k, f);
    if (top) return;
    V *const up = f.S, *const down = f.u;  // S is done with
    x.above().r = couple<V>(x, k, x.D_above(), x.above().b, f, f.z, f.h, up, down);
    HOL_UNROLL_FEW
    for (int a = 0; a < k; ++a) {
        x.bond(a).up = up[a];
        x.bond(a).down = down[a];
    }
}

// Substitutes up: finds u of the children, and y of the bond above.
template <int known, bool top, class V, class Rows>
HOL_INLINE void substitute_newton_joint(const Rows &x, int count) {
    const int k = known > 0 ? known : count;
    if (!top && k > most_decomposed) return substitute_many_moved<V>(x, k);
    if (known == 1) {
        NewtonRow<V> &row = x.bond(0);
        const V y = row.t;
        row.t = y * row.r;
        if (!top) x.above().t = mul_add(row.up, y, x.above().t);
        return;
    }
    auto f = NewtonMemory<V, known>::make(x.working(), k);
    V above = top ? V{} : x.above().t;
    HOL_UNROLL_FEW
    for (int a = 0; a < k; ++a) {
        const NewtonRow<V> &row = x.bond(a);
        f.y[a] = row.t;
        f.r[a] = row.r;
        if (!top) above = mul_add(row.up, row.t, above);
    }
    solve_joint(k, f.r, x.lower(), x.upper(), f.y, f.z, f.u);
    HOL_UNROLL_FEW
    for (int a = 0; a < k; ++a) x.bond(a).t = f.u[a];
    if (!top) x.above().t = above;
}

}  // namespace holonomic::HOL_ISA::graph
