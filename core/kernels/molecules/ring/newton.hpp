// Newton's method for the positions of rings without side atoms. Bonds 0 .. N-2 are a chain, eliminated as in
// newton/sweeps.hpp; the last one, n = N-1, closes it. With J the matrix of theory (58), each row gives the last one
//     l_k = - J_nk / P_k of its y,   takes c_k = - J_kn / P_k of the last one's correction,   and J_nn loses l_k P_k
//     c_k
// where J_nk and J_kn are what the rows before have left: J_n,k+1 = J_nk up_k, J_k+1,n = down_k J_kn.
#pragma once

#include "core/kernels/molecules/atoms/vectors.hpp"
#include "core/kernels/molecules/tree/newton_joint.hpp"

namespace holonomic::HOL_ISA::graph {

// Puts a value into `to` in the lanes of `which`, or in all.
template <bool all, class V>
HOL_INLINE void put_where(MaskOf<V> which, V &to, V value) {
    to = all ? value : select(which, value, to);
}

template <class V>
struct RingNewton {
    typedef V Value;
    // What is shared with the last bond.
    struct Closure {
        V l, c;
    };
    struct RingSystem {
        const EliminationPlan &s;
        V *w;               // [N]
        NewtonRow<V> *row;  // t: u = y / P; up: of y, what the row before gives; down: of the correction behind
    };
    RingSystem x;
    Closure *closure;  // [N - 1]
    V *lengths;        // least and largest

    static constexpr int64_t row_values = static_cast<int64_t>(sizeof(NewtonRow<V>) / sizeof(V));
    static int64_t values(const EliminationPlan &s) { return 2 + (3 + row_values) * s.n_bonds; }
    RingNewton(const EliminationPlan &s, Memory<V> &memory)
        : x{s, nullptr, nullptr}, closure(), lengths(memory.values(2)) {
        x.w = memory.values(s.n_atoms);
        x.row = reinterpret_cast<NewtonRow<V> *>(memory.values(row_values * s.n_bonds));
        closure = reinterpret_cast<Closure *>(memory.values(2 * static_cast<int64_t>(s.n_bonds)));
    }

    void set_masses(const MoleculeLane *lane) { masses_by_index(x.s, lane, x.w); }

    // The displacement of an atom between the bonds that pull it with tau b.
    HOL_FORCED Vector3<V> pull_of(int32_t bond) const { return x.row[bond].tau * x.row[bond].b; }
    HOL_FORCED Vector3<V> displacement(int32_t atom) const {
        return x.w[atom] * (pull_of(atom) - pull_of(atom > 0 ? atom - 1 : x.s.n_bonds - 1));
    }

    // Of all atoms; the bonds as they came are done with.
    Displacements<V> displacements() const {
        NewtonRow<V> *const row = x.row;
        Vector3<V> before = pull_of(x.s.n_bonds - 1);
        for (int32_t k = 0; k < x.s.n_atoms; ++k) {
            const Vector3<V> next = pull_of(k);
            put(row[k].D, next - before);
            put(before, next);
        }
        return {ByIndex<V>(row, &row->D.x), x.w};
    }

    // The bond vectors as tau moves them, one after the other, the last one first.
    struct RingMover {
        Vector3<V> pull, left, first;  // of the bond before, and the displacement of the atom behind it; of atom 0
        HOL_FORCED Vector3<V> last(const RingNewton &z) {
            const int32_t n = z.x.s.n_bonds - 1;
            pull = z.pull_of(0);
            first = left = z.x.w[0] * (pull - z.pull_of(n));
            return z.x.row[n].D + (first - z.displacement(n));
        }
        HOL_FORCED Vector3<V> bond(const RingNewton &z, int32_t k) {
            const Vector3<V> p = z.pull_of(k + 1), right = z.x.w[k + 1] * (p - pull);
            const Vector3<V> d = z.x.row[k].D + (right - left);
            pull = p;
            left = right;
            return d;
        }
    };

    // What is left of a bond's length, for D as given; its largest error relative to a^2. first: for the factors that
    // are made of it, in the lanes of `which`.
    template <bool first, bool all>
    HOL_FORCED static V length_left(NewtonRow<V> &row, const Vector3<V> &D, V &worst, MaskOf<V> which) {
        const V sigma = excess(D, row.a2), e = sigma * row.per_a2;
        worst = max(abs(e), worst);
        if (!first) return row.left(sigma, e);
        if (all) return row.first_left(sigma, e);
        const V left = row.left(sigma, e), stretch = row.stretch, anew = row.first_left(sigma, e);
        row.stretch = select(which, row.stretch, stretch);
        return select(which, anew, left);
    }
    template <bool first, bool all>
    HOL_FORCED static V length_left(NewtonRow<V> &row, const Vector3<V> &D, V &worst) {
        return length_left<first, all>(row, D, worst, Width<V>::none());
    }
    // max() may lose a NaN, y of the last bond keeps it.
    HOL_FORCED static V largest(V worst, V y) { return mul_add(y, V{}, worst); }

    // The relative error of one bond, as the sweeps find it.
    V left_of(int32_t k) const {
        const int32_t n = x.s.n_bonds - 1;
        const Vector3<V> right = displacement(k < n ? k + 1 : 0);
        return abs(excess(x.row[k].D + (right - displacement(k)), x.row[k].a2)) * x.row[k].per_a2;
    }

    // E as a fraction A / F, as in eliminate/effective_mass.hpp.
    struct RingFraction {
        V A, F;
    };

    // Eliminates with the bonds as they came or as tau moves them, and substitutes forward; returns the largest error.
    template <bool moved, bool all>
    __attribute__((noinline)) V eliminate(MaskOf<V> which) {
        NewtonRow<V> *const row = x.row;
        const int32_t n = x.s.n_bonds - 1;
        RingMover mover;
        const Vector3<V> D_n = moved ? mover.last(*this) : row[n].D;
        Vector3<V> d = moved ? mover.bond(*this, 0) : row[0].D;
        V worst = {}, y = {}, down = {}, q = dot(d, row[0].b), y_n = length_left<true, all>(row[n], D_n, worst, which);
        V to_last = x.w[0] * dot(D_n, row[0].b), from_last = x.w[0] * dot(d, row[n].b);
        V P_n = (x.w[n] + x.w[0]) * dot(D_n, row[n].b);
        RingFraction e = {x.w[0] * q, Width<V>::all(1)};
        for (int32_t k = 0; k < n; ++k) {
            NewtonRow<V> &here = row[k];
            const V w = x.w[k + 1];
            const Vector3<V> d1 = k + 1 == n ? D_n : moved ? mover.bond(*this, k + 1) : row[k + 1].D;
            const V q1 = dot(d1, row[k + 1].b), lower = dot(d1, here.b), upper = dot(row[k + 1].b, d);
            const V F1 = mul_add(w * q, e.F, e.A), rF = Width<V>::all(1) / F1, rP = e.F * rF;
            const V left = length_left<true, all>(here, d, worst, which);
            if (k + 1 == n) {
                to_last = mul_add(w, lower, to_last);
                from_last = mul_add(w, upper, from_last);
            }
            const V l = to_last * rP, c = from_last * rP;
            P_n = mul_add(-l, from_last, P_n);
            put_where<all>(which, here.r, rP);
            put_where<all>(which, here.up, down);
            y = mul_add(here.up, y, left);
            here.t = y * here.r;
            const V wP = w * rP, up = wP * upper;
            down = wP * lower;
            put_where<all>(which, here.down, up);
            put_where<all>(which, closure[k].l, l);
            put_where<all>(which, closure[k].c, c);
            y_n = mul_add(closure[k].l, y, y_n);
            to_last = to_last * up;
            from_last = down * from_last;
            e.A = mul_add((w * w) * mul_add(q, q1, -(lower * upper)), e.F, (w * q1) * e.A);
            e.F = F1;
            if ((k & 3) == 3) e = {e.A * rF, Width<V>::all(1)};
            q = q1;
            d = d1;
        }
        put_where<all>(which, row[n].r, Width<V>::all(1) / P_n);
        row[n].t = y_n * row[n].r;
        return largest(worst, y_n);
    }

    V open() { return eliminate<false, true>(Width<V>::none()); }
    void first_factors() {}  // they are there already

    // New factors for the bonds as moved, in the lanes of `which`.
    void factorize(MaskOf<V> which) {
        if (bits(which) == (1u << Width<V>::lanes) - 1)
            eliminate<true, true>(which);
        else
            eliminate<true, false>(which);
    }

    // The bonds as tau moves them, what that leaves of their lengths substituted forward, and the largest error.
    __attribute__((noinline)) V move() {
        NewtonRow<V> *const row = x.row;
        const int32_t n = x.s.n_bonds - 1;
        RingMover mover;
        V worst = {}, y = {}, y_n = length_left<false, true>(row[n], mover.last(*this), worst);
#pragma GCC unroll 2
        for (int32_t k = 0; k < n; ++k) {
            y = mul_add(row[k].up, y, length_left<false, true>(row[k], mover.bond(*this, k), worst));
            y_n = mul_add(closure[k].l, y, y_n);
            row[k].t = y * row[k].r;
        }
        row[n].t = y_n * row[n].r;
        return largest(worst, y_n);
    }

    // Corrections from u, added to tau in the lanes of `active`.
    void solve(MaskOf<V> active) {
        if (bits(active) == (1u << Width<V>::lanes) - 1)
            down<true>(active);
        else
            down<false>(active);
    }
    template <bool all>
    __attribute__((noinline)) void down(MaskOf<V> active) {
        NewtonRow<V> *const row = x.row;
        const auto add = [&](int32_t bond, V change)
                             HOL_FORCED { row[bond].tau = row[bond].tau + (all ? change : keep(active, change)); };
        int32_t k = x.s.n_bonds - 1;
        const V last = row[k].t;
        V t = last;
        add(k--, t);
        const auto u_of = [&](int32_t bond) HOL_FORCED { return mul_add(closure[bond].c, last, row[bond].t); };
        // The bond next to the last one has the joint between them in c, too.
        t = u_of(k);
        add(k--, t);
        // Two bonds depend on the one behind them at once, by the product of their factors.
#pragma GCC unroll 2
        for (; k > 0; k -= 2) {
            const V u = u_of(k), up = row[k].down, next = row[k - 1].down;
            const V both = next * up, sum = mul_add(next, u, u_of(k - 1));
            add(k, mul_add(up, t, u));
            t = mul_add(both, t, sum);
            add(k - 1, t);
        }
        if (k == 0) add(0, mul_add(row[0].down, t, u_of(0)));
    }

    // tau = 0 in the lanes of `which`.
    void forget(MaskOf<V> which) {
        for (int32_t k = 0; k < x.s.n_bonds; ++k) x.row[k].tau = select(which, V{}, x.row[k].tau);
    }
};

}  // namespace holonomic::HOL_ISA::graph
