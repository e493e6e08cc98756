// Positions of stars: a centre with bonds to N other atoms, as in CH3, NH3, CH4. Bond k points from the centre to atom
// k of the others. They ascend, so it is also bond k of the molecule. For newton/multipliers.hpp, bond k becomes D_k
// + P_k,
//     P_k = - w_k tau_k b_k - w_c sum of tau_l b_l.
#pragma once

#include "core/kernels/molecules/image.hpp"
#include "core/kernels/molecules/small/worst_bond.hpp"
#include "core/kernels/molecules/star/atoms.hpp"
#include "core/kernels/molecules/star/four_bonds.hpp"
#include "core/kernels/molecules/tree/newton_joint.hpp"
#include "core/kernels/newton/multipliers.hpp"

namespace holonomic::HOL_ISA::graph {

// Masses and lengths.
template <int N, class V>
struct StarKind : StarMasses<N, V> {
    V a2[N], per_a2[N], a_min, a_max, per_a_min;
    unsigned light;    // lanes whose centre is light to Newton's method
    unsigned unequal;  // such lanes whose other masses are too far apart for four_bonds.hpp
    void set(const MoleculeLane *lane, int used, int centre) {
        StarMasses<N, V>::set(lane, used, centre);
        a_min = Width<V>::all(1e300);
        a_max = V{};
        for (int k = 0; k < N; ++k) {
            V a = Width<V>::all(0);  // not {}: gcc 12 then warns of a value that is not set
            for (int i = 0; i < Width<V>::lanes; ++i) Width<V>::set(a, i, lane[i < used ? i : 0].length[k]);
            a_min = min(a, a_min);
            a_max = max(a, a_max);
            a2[k] = a * a;
            per_a2[k] = Width<V>::all(1) / a2[k];
        }
        per_a_min = Width<V>::all(1) / a_min;
        light = unequal = 0;
        for (int i = 0; N == 4 && i < used; ++i) {
            double least = Width<V>::get(this->w[1], i), most = least;
            for (int k = 2; k <= N; ++k) {
                const double w_k = Width<V>::get(this->w[k], i);
                least = min(w_k, least);
                most = max(w_k, most);
            }
            if (!(Width<V>::get(this->w[0], i) > least_light_to_move * least)) continue;
            (most > most_unequal * least ? unequal : light) |= 1u << i;
        }
    }
};

// Solves with a matrix of N rows.
template <int N, class V>
struct SmallInverse {
    V r[N], lower[N * (N - 1) / 2], upper[N * (N - 1) / 2];
    HOL_STATIC SmallInverse of(V m[N][N]) {
        SmallInverse f;
        decompose(N, &m[0][0], f.r, f.lower, f.upper);
        return f;
    }
    HOL_STATIC void solve(const SmallInverse &f, const V *y, V *t) {
        V z[N];
        solve_joint(N, f.r, f.lower, f.upper, y, z, t);
    }
};
// In closed form, with one division.
template <class V>
struct SmallInverse<3, V> {
    V adj[3][3], r;
    HOL_STATIC SmallInverse of(const V m[3][3]) {
        SmallInverse f;
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) {
            HOL_UNROLL
            for (int l = 0; l < 3; ++l) {
                const int a = (l + 1) % 3, b = (l + 2) % 3, c = (k + 1) % 3, d = (k + 2) % 3;
                f.adj[k][l] = mul_add(m[a][c], m[b][d], -(m[a][d] * m[b][c]));
            }
        }
        f.r = Width<V>::all(1) / mul_add(m[0][2], f.adj[2][0], mul_add(m[0][1], f.adj[1][0], m[0][0] * f.adj[0][0]));
        return f;
    }
    HOL_STATIC void solve(const SmallInverse &f, const V *y, V *t) {
        HOL_UNROLL
        for (int k = 0; k < 3; ++k)
            t[k] = f.r * mul_add(f.adj[k][2], y[2], mul_add(f.adj[k][1], y[1], f.adj[k][0] * y[0]));
    }
};

template <int N, class V>
struct StarModel {
    static constexpr int unknowns = N;
    const StarKind<N, V> &m;
    const V *per_a2;
    V B[N][N];  // b_k . b_l
    V g[N][N];  // D_k . b_l
    const V *sigma;

    inline HOL_FORCED StarModel(const StarKind<N, V> &kind, const Vector3<V> *b, const Vector3<V> *D, const V *left)
        : m(kind), per_a2(kind.per_a2), sigma(left) {
        HOL_UNROLL
        for (int k = 0; k < N; ++k) {
            HOL_UNROLL
            for (int l = 0; l < N; ++l) {
                g[k][l] = dot(D[k], b[l]);
                B[k][l] = l < k ? B[l][k] : dot(b[k], b[l]);
            }
        }
    }

    // P_k . b_l and |P_k|^2.
    struct Change {
        V d[N][N], q[N];
    };
    inline HOL_FORCED Change change(const V *tau) const {
        Change p;
        V own[N], h[N], all = {};  // h_l = w_c (sum of tau_k b_k) . b_l
        HOL_UNROLL
        for (int l = 0; l < N; ++l) {
            own[l] = m.w[l + 1] * tau[l];
            V sum = tau[0] * B[0][l];
            HOL_UNROLL
            for (int k = 1; k < N; ++k) sum = mul_add(tau[k], B[k][l], sum);
            h[l] = m.w[0] * sum;
        }
        HOL_UNROLL
        for (int l = 0; l < N; ++l) all = mul_add(tau[l], h[l], all);
        all = m.w[0] * all;
        HOL_UNROLL
        for (int k = 0; k < N; ++k) {
            p.q[k] = mul_add(own[k], mul_add(own[k], B[k][k], h[k] + h[k]), all);
            HOL_UNROLL
            for (int l = 0; l < N; ++l) p.d[k][l] = -mul_add(own[k], B[k][l], h[l]);
        }
        return p;
    }

    // Of 2 M, M_kl = w_c D_k . b_l + (w_k D_k . b_k if k = l).
    inline HOL_FORCED SmallInverse<N, V> inverse() const { return invert(g); }
    inline HOL_FORCED SmallInverse<N, V> inverse(const Change &p) const {
        V h[N][N];
        HOL_UNROLL
        for (int k = 0; k < N; ++k) {
            HOL_UNROLL
            for (int l = 0; l < N; ++l) h[k][l] = g[k][l] + p.d[k][l];
        }
        return invert(h);
    }
    inline HOL_FORCED SmallInverse<N, V> invert(const V h[N][N]) const {
        V M[N][N];
        HOL_UNROLL
        for (int k = 0; k < N; ++k) {
            HOL_UNROLL
            for (int l = 0; l < N; ++l) M[k][l] = 2.0 * (k == l ? (m.w[0] + m.w[k + 1]) * h[k][l] : m.w[0] * h[k][l]);
        }
        return SmallInverse<N, V>::of(M);
    }
    HOL_STATIC void solve(const SmallInverse<N, V> &f, const V *y, V *tau) { SmallInverse<N, V>::solve(f, y, tau); }

    // The sum of tau_k b_k, and the largest move that a bond makes.
    HOL_STATIC Vector3<V> pull(const V *tau, const Vector3<V> *b) {
        Vector3<V> sum = tau[0] * b[0];
        HOL_UNROLL
        for (int k = 1; k < N; ++k) sum = add_times(sum, tau[k], b[k]);
        return sum;
    }
    HOL_STATIC MaskOf<V> is_even() { return ~Width<V>::none(); }
    HOL_STATIC V largest_move(const StarKind<N, V> &m, const V *tau) {
        V largest = {};
        HOL_UNROLL
        for (int k = 0; k < N; ++k) largest = max(max(m.w[0], m.w[k + 1]) * abs(tau[k]), largest);
        return largest * m.a_max;
    }
};

// Four bonds at a light centre, by four_bonds.hpp. The sum p of tau_k b_k is an unknown, too: it is small, its terms
// are not.
template <class V>
struct LightStarModel {
    static constexpr int N = 4, unknowns = N + 3;
    const StarKind<N, V> &m;
    const V *per_a2;
    const Vector3<V> *const b, *const D;
    const V *sigma;

    inline HOL_FORCED LightStarModel(const StarKind<N, V> &kind, const Vector3<V> *reference, const Vector3<V> *now,
                                     const V *left)
        : m(kind), per_a2(kind.per_a2), b(reference), D(now), sigma(left) {}

    // P_k and |P_k|^2.
    struct Change {
        Vector3<V> P[N];
        V q[N];
    };
    inline HOL_FORCED Change change(const V *tau) const {
        Change c;
        const Vector3<V> of_centre = m.w[0] * pull(tau, b);
        HOL_UNROLL
        for (int k = 0; k < N; ++k) {
            const Vector3<V> less = add_times(of_centre, m.w[k + 1] * tau[k], b[k]);
            c.P[k] = {-less.x, -less.y, -less.z};
            c.q[k] = dot(less, less);
        }
        return c;
    }

    // Of M.
    inline HOL_FORCED FourBonds<V> inverse() const {
        FourBonds<V> f;
        f.set(m.w, D, b);
        return f;
    }
    inline HOL_FORCED FourBonds<V> inverse(const Change &c) const {
        Vector3<V> now[N];
        HOL_UNROLL
        for (int k = 0; k < N; ++k) now[k] = D[k] + c.P[k];
        FourBonds<V> f;
        f.set(m.w, now, b);
        return f;
    }
    HOL_STATIC void solve(const FourBonds<V> &f, const V *y, V *tau) {
        V half[N];
        Vector3<V> p;
        HOL_UNROLL
        for (int k = 0; k < N; ++k) half[k] = 0.5 * y[k];
        f.solve(half, Vector3<V>{}, tau, p);
        tau[4] = p.x;
        tau[5] = p.y;
        tau[6] = p.z;
    }

    inline HOL_FORCED MaskOf<V> is_even() const { return inverse().is_even(); }
    HOL_STATIC Vector3<V> pull(const V *tau, const Vector3<V> *) { return {tau[4], tau[5], tau[6]}; }
    HOL_STATIC V largest_move(const StarKind<N, V> &m, const V *tau) {
        V of_bonds = {};
        HOL_UNROLL
        for (int k = 0; k < N; ++k) of_bonds = max(m.w[k + 1] * abs(tau[k]), of_bonds);
        const V of_centre = max(max(abs(tau[4]), abs(tau[5])), abs(tau[6]));
        return max(m.w[0] * of_centre, of_bonds * m.a_max);
    }
};

}  // namespace holonomic::HOL_ISA::graph
