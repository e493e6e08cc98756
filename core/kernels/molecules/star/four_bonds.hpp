// The equations of four bonds at one atom, M t = y with
//     M = A + c D B^T,   A = diag(w_k D_k . b_k),   c the inverse mass of the centre, rows D_k and b_k,
// where D = b but in Newton's method. Four bonds in space depend on each other. So a light centre leaves of M's
// smallest eigenvalue a part of A / c, which elimination would have to find by subtraction. Here it is the three
// equations of the centre that are solved (theory (53d)), and they are even if the bonds point everywhere:
//     p = sum of b_k t_k = N sum of b_k y_k / a_k,   N = (1 + c G)^-1,   G = sum of b_k D_k^T / a_k,
//     t_k = (y_k - c D_k . p) / a_k.
// A force F on the centre itself puts - c D_k . F into y_k. It is added to p instead, which N makes small: with y of
// the others alone, F + p = N (F + sum of b_k y_k / a_k) takes the place of p in t_k.
#pragma once

#include "core/kernels/arithmetic/matrix3.hpp"
#include "core/kernels/molecules/molecules.hpp"

namespace holonomic::HOL_ISA::graph {

template <class V>
struct FourBonds {
    const V *w;           // [5] inverse masses, the centre first
    const Vector3<V> *b;  // [4]
    Vector3<V> D[4];
    V a[4], per_a[4], trace;  // the last of 1 + c G
    Matrix3<V> N;

    inline HOL_FORCED void set(const V *masses, const Vector3<V> *moved, const Vector3<V> *reference) {
        w = masses;
        b = reference;
        HOL_UNROLL
        for (int k = 0; k < 4; ++k) D[k] = moved[k];
        HOL_UNROLL
        for (int k = 0; k < 4; ++k) a[k] = w[k + 1] * dot(D[k], b[k]);
        HOL_UNROLL
        for (int k = 0; k < 4; k += 2) {  // two quotients by one division
            const V r = Width<V>::all(1) / (a[k] * a[k + 1]);
            per_a[k] = r * a[k + 1];
            per_a[k + 1] = r * a[k];
        }
        Matrix3<V> M = Matrix3<V>::one();
        HOL_UNROLL
        for (int k = 0; k < 4; ++k) M.add((w[0] * per_a[k]) * b[k], D[k]);
        N = divided_by(M, Width<V>::all(1));
        trace = M.trace();
    }

    // The lanes in which N is so even that it loses few digits: the bonds point everywhere. An N that has lost all may
    // have any trace.
    inline HOL_FORCED MaskOf<V> is_even() const {
        const V uneven = trace * N.trace();
        return less(uneven, Width<V>::all(most_uneven_light)) & less(Width<V>::all(least_uneven - 1), uneven);
    }

    // Finds t, and F + p.
    inline HOL_FORCED void solve(const V *y, const Vector3<V> &force, V *t, Vector3<V> &total) const {
        Vector3<V> z = force;
        HOL_UNROLL
        for (int k = 0; k < 4; ++k) z = add_times(z, per_a[k] * y[k], b[k]);
        total = N * z;
        const Vector3<V> moved = w[0] * total;
        HOL_UNROLL
        for (int k = 0; k < 4; ++k) t[k] = per_a[k] * (y[k] - dot(D[k], moved));
    }

    // Of symmetric equations, H = M^-1: the lanes in which what a multiplier is made of, taken by its size, is no more
    // than most_parts times its scale, the sum of |H_kl y_l|; and N is even.
    inline HOL_FORCED MaskOf<V> keeps_digits(const V *q, const V *y) const {
        Vector3<V> u[4];
        V length[4], size[4];
        HOL_UNROLL
        for (int l = 0; l < 4; ++l) {
            u[l] = (w[0] * per_a[l]) * (N * b[l]);
            length[l] = sqrt(q[l]);
            size[l] = sqrt(dot(u[l], u[l]));
        }
        V margin = Width<V>::all(1);
        HOL_UNROLL
        for (int k = 0; k < 4; ++k) {
            V parts = {}, scale = {};
            HOL_UNROLL
            for (int l = 0; l < 4; ++l) {
                const V of_centre = dot(b[k], u[l]), own = Width<V>::all(k == l);
                parts = mul_add(mul_add(length[k], size[l], own), abs(y[l]), parts);
                scale = mul_add(abs(own - of_centre), abs(y[l]), scale);
            }
            margin = min(mul_add(Width<V>::all(most_parts), scale, -parts), margin);
        }
        return ~less(margin, V{}) & is_even();
    }
};

}  // namespace holonomic::HOL_ISA::graph
