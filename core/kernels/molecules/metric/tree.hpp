// Metric determinant and Fixman force of trees (theory (52), (60)). Bond vectors point away from the root.
//
// Up: S = L P L^T of the bonds below each atom. Down: with H of the bond above, e,
//
//     H_ce = l_c H_ee,   H_cc' = (S^-1)_cc' + l_c l_c' H_ee
#pragma once

#include "core/kernels/molecules/metric/rows.hpp"
#include "core/kernels/molecules/tree/joint.hpp"

namespace holonomic::HOL_ISA::graph {

constexpr int pairs_to(int k) { return k * (k + 1) / 2; }  // with those of one and the same

template <class V>
struct TreeMetric : Metric<V> {
    typedef Metric<V> Base;
    using Base::Base, Base::s, Base::row, Base::w, Base::pair, Base::r, Base::least, Base::logs, Base::product,
        Base::normal, Base::couple;

    // Returns the lanes that plain arithmetic answers for.
    MaskOf<V> solve() {
        this->read_atoms();
        for (int32_t index = 0; index < s.n_tree; ++index) this->make(row[index], s.parent[index], index);
        for (int32_t index = 0; index < s.n_atoms; ++index) {
            const int k = children(index);
            if (index == s.n_tree)
                up<1, true>(index, k);
            else if (k > 0)
                choose_few<1>(k, [&](auto known) HOL_FORCED { up<known, false>(index, k); });
        }
        V sum = {};
        for (int32_t index = s.n_atoms; this->call.force.x && index-- > 0;) {
            const int k = children(index);
            if (index == s.n_tree)
                down<1, true>(index, k);
            else if (k > 0)
                choose_few<1>(k, [&](auto known) HOL_FORCED { down<known, false>(index, k); });
            r[index] = Vector3<V>{};
            if (index < s.n_tree) {
                sum = sum + this->turn(row[index]);
                r[index] = row[index].normal;
                r[s.parent[index]] = r[s.parent[index]] - row[index].normal;
            }
        }
        return this->finish(sum);
    }

private:
    int children(int32_t index) const { return s.child_start[index + 1] - s.child_start[index]; }
    const int32_t *children_of(int32_t index) const { return s.child + s.child_start[index]; }

    template <int known, bool top>
    HOL_FORCED void up(int32_t index, int count_of) {
        constexpr int most = known > 0 ? known : most_decomposed;
        const int k = known > 0 ? known : count_of;
        const int32_t *const child = children_of(index);
        const V w0 = w[index];
        V S[pairs_to(most)], F[most], z[most], l[most];
        V *const m = pair + s.pair_start[index];
        for (int a = 0; a < k; ++a) {
            const MetricRow<V> &x = row[child[a]];
            for (int b = 0; b < a; ++b) S[pair_of(a + 1, b)] = w0 * product(x, row[child[b]]);
            S[pair_of(a + 1, a)] = mul_add(w0, x.q, x.E);
            F[a] = x.F;
        }
        for (int j = 0; j < k; ++j) {
            MetricRow<V> &x = row[child[j]];
            const V P = S[pair_of(j + 1, j)];
            if (j > 0) least = min(mul_add(Width<V>::all(-least_kept), mul_add(w0, x.q, x.E), P), least);
            x.r = Width<V>::all(1) / P;
            if (logs) this->count(x, w0 + w[child[j]], P, F[j]);
            for (int a = j + 1; a < k; ++a) {
                const V part = S[pair_of(a + 1, j)] * x.r;
                m[pair_of(a, j)] = part;
                F[a] = mul_add(part, S[pair_of(a + 1, j)], F[a]);
                for (int b = j + 1; b <= a; ++b)
                    S[pair_of(a + 1, b)] = mul_add(-part, S[pair_of(b + 1, j)], S[pair_of(a + 1, b)]);
            }
        }
        if (top) {  // nothing is above
            row[child[0]].l = V{};
            return;
        }
        MetricRow<V> &e = row[index];
        V per_pivot[most], y[most], taken = {};
        for (int a = 0; a < k; ++a) {
            per_pivot[a] = row[child[a]].r;
            y[a] = w0 * product(row[child[a]], e);
        }
        solve_joint(k, per_pivot, m, y, z, l);
        for (int a = 0; a < k; ++a) {
            taken = mul_add(z[a] * per_pivot[a], z[a], taken);
            row[child[a]].l = l[a];
        }
        const V whole = w0 * e.q;
        e.F = taken;
        if (known == 1) {  // of one child E is (9), which subtracts nothing
            MetricRow<V> &x = row[child[0]];
            x.normal = normal(x, e);
            e.E = (w0 * x.r) * mul_add(e.q, x.E, w0 * dot(x.normal, x.normal));
            e.rounded = mul_add(x.l * x.l, x.rounded, e.E);
            return;
        }
        e.E = whole - taken;
        e.rounded = whole;
        for (int a = 0; a < k; ++a) e.rounded = mul_add(l[a] * l[a], row[child[a]].rounded, e.rounded);
        least = min(mul_add(Width<V>::all(-least_kept), whole, e.E), least);
    }

    // H of the bonds below an atom, and what they and the one above pull at each other.
    template <int known, bool top>
    HOL_FORCED void down(int32_t index, int count_of) {
        constexpr int most = known > 0 ? known : most_decomposed;
        const int k = known > 0 ? known : count_of;
        const int32_t *const child = children_of(index);
        const V w0 = w[index], above = top ? V{} : row[index].H;
        V H[pairs_to(most)], off[pairs_to(most)], beside[most], off_beside[most];  // and of H_ce
        inverse<most>(k, child, pair + s.pair_start[index], H);
        if (known == 1) {
            MetricRow<V> &x = row[child[0]];
            const V off_r = x.r * x.rounded, of_above = top ? V{} : mul_add(above, off_r, row[index].off);
            off_beside[0] = abs(x.l) * of_above;
            x.off = mul_add(x.l * x.l, of_above + above * off_r, x.r * off_r);
        } else {
            uncertain<most>(index, k, H, off, off_beside);
        }
        for (int a = 0; a < k; ++a) {
            MetricRow<V> &x = row[child[a]];
            beside[a] = top ? V{} : x.l * above;
            for (int b = 0; b <= a && !top; ++b)
                H[pair_of(a + 1, b)] = mul_add(beside[a], row[child[b]].l, H[pair_of(a + 1, b)]);
            x.H = H[pair_of(a + 1, a)];
            x.scale = x.error = V{};
            if (known != 1 || top) x.normal = Vector3<V>{};  // else the cross product that was made on the way up
        }
        if (known == 1) {
            if (!top) {
                MetricRow<V> &x = row[child[0]];
                const Vector3<V> n = x.normal;
                x.normal = Vector3<V>{};
                couple(x, row[index], n, -(w0 * beside[0]), w0 * off_beside[0]);
            }
            return;
        }
        for (int a = 0; a < k; ++a) {
            MetricRow<V> &x = row[child[a]];
            for (int b = 0; b < a; ++b)
                couple(x, row[child[b]], normal(x, row[child[b]]), w0 * H[pair_of(a + 1, b)],
                       w0 * off[pair_of(a + 1, b)]);
            // The bond above points to the atom.
            couple(x, row[index], normal(x, row[index]), -(w0 * beside[a]), w0 * off_beside[a]);
        }
    }

    // S^-1 from its factors.
    template <int most>
    HOL_FORCED void inverse(int k, const int32_t *child, const V *m, V *H) const {
        V below[pairs_to(most)];  // of the inverse of L, pair_of(a, b) for a > b
        for (int b = 0; b < k; ++b) {
            for (int a = b + 1; a < k; ++a) {
                V sum = m[pair_of(a, b)];
                for (int j = b + 1; j < a; ++j) sum = mul_add(m[pair_of(a, j)], below[pair_of(j, b)], sum);
                below[pair_of(a, b)] = -sum;
            }
        }
        for (int b = 0; b < k; ++b) {
            for (int c = 0; c <= b; ++c) {
                const V r0 = row[child[b]].r;
                V sum = c == b ? r0 : r0 * below[pair_of(b, c)];
                for (int a = b + 1; a < k; ++a)
                    sum = mul_add(row[child[a]].r * below[pair_of(a, b)], below[pair_of(a, c)], sum);
                H[pair_of(b + 1, c)] = sum;
            }
        }
    }

    // What a rounding of each term of |L| P |L|^T = T, and of what E was made of, may do to H between different bonds:
    // |S^-1| T |S^-1| and what comes of l by H_ee. Products d.d' are right to a rounding of themselves.
    template <int most>
    __attribute__((noinline)) void uncertain(int32_t index, int k, const V *inverse, V *off, V *off_beside) const {
        const int32_t *const child = children_of(index);
        const V *const m = pair + s.pair_start[index], above = row[index].H, off_above = row[index].off;
        const auto of_inverse = [&](int a, int b)
                                    HOL_FORCED { return abs(inverse[a > b ? pair_of(a + 1, b) : pair_of(b + 1, a)]); };
        V T[most][most], B[most][most], of_l[most];  // |S^-1| T, and B |l|
        for (int a = 0; a < k; ++a)
            for (int b = 0; b <= a; ++b) {
                const V P = Width<V>::all(1) / row[child[b]].r;
                V sum = a == b ? P + row[child[a]].rounded : abs(m[pair_of(a, b)]) * P;
                for (int j = 0; j < b; ++j)
                    sum = mul_add(abs(m[pair_of(a, j)] * m[pair_of(b, j)]), Width<V>::all(1) / row[child[j]].r, sum);
                T[a][b] = T[b][a] = sum;
            }
        for (int a = 0; a < k; ++a) {
            of_l[a] = V{};
            for (int b = 0; b < k; ++b) {
                V sum = {};
                for (int j = 0; j < k; ++j) sum = mul_add(of_inverse(a, j), T[j][b], sum);
                B[a][b] = sum;
                of_l[a] = mul_add(sum, abs(row[child[b]].l), of_l[a]);
            }
            off_beside[a] = mul_add(above, of_l[a], off_above * abs(row[child[a]].l));
        }
        for (int a = 0; a < k; ++a)
            for (int b = 0; b <= a; ++b) {
                const V la = abs(row[child[a]].l), lb = abs(row[child[b]].l);
                V sum = mul_add(off_above * la, lb, above * mul_add(of_l[a], lb, of_l[b] * la));
                for (int j = 0; j < k; ++j) sum = mul_add(B[a][j], of_inverse(j, b), sum);
                if (a == b)
                    row[child[a]].off = sum;
                else
                    off[pair_of(a + 1, b)] = sum;
            }
    }
};

}  // namespace holonomic::HOL_ISA::graph
