// Metric determinant and Fixman force of trees in plain doubles (theory (52), (60)-(62)). Bond vectors point away from
// the root. Products of two of them are found from unrounded coordinates, as those of chains: neither the determinant
// nor its force has a scale that would forgive their rounding.
//
// Up: S = L P L^T of the bonds below each atom. A pivot is P = A - F, where F is a sum of squares, so that ln(P / A)
// keeps its digits where F is small. Down: with H of the bond above, e,
//
//     H_ce = l_c H_ee,   H_cc' = (S^-1)_cc' + l_c l_c' H_ee
//
// What doubt costs is asked of the molecule: `least` is negative where plain arithmetic may not do.
#ifndef HOLONOMIC_KERNELS_MOLECULES_TREE_METRIC_HPP
#define HOLONOMIC_KERNELS_MOLECULES_TREE_METRIC_HPP

#include "core/kernels/arithmetic/log_sum.hpp"
#include "core/kernels/molecules/load.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

// The force on a bond may be wrong by so many times its scale, in roundings, if all of what uncertain() counts adds up.
// It never does: random trees with masses over ten decades stay below a quarter of that. 32 count as right.
constexpr double most_uncertain = 64;

constexpr int pairs_to(int k) { return k * (k + 1) / 2; }  // with those of one and the same

// Of a bond at its place.
template <class V>
struct MetricRow {
    Vector3<V> d, low;  // low: what rounding leaves off d
    V q;                // d.d
    V E, F;             // what the bonds below leave of w q, and what they take
    V rounded;          // what rounding may take of E, in roundings
    V r, l, H;          // 1 / P; what it gets of the bond above; its element of A^-1
    Vector3<V> normal;  // sum of w H_kl d_k x d_l, then phi
    V scale, error;     // of that, in absolute values; what it may be wrong by, in roundings
};

template <class V>
struct TreeMetric {
    const Schedule &s;
    const MetricCall &call;
    const MoleculeLane *const lane;
    const int used;
    const Atoms<V> at;
    MetricRow<V> *const row;  // [n_bonds]
    V *const w, *const pair;  // [n_atoms] by slot; [n_pairs] multipliers among the children of an atom
    Vector3<V> *const r;      // [n_atoms] by slot
    V least = Width<V>::all(1);
    LogSum<V> det;
    LogSumWide<V> diagonal;  // of Z_kk

    static constexpr int64_t row_values = sizeof(MetricRow<V>) / sizeof(V);
    static int64_t values(const Schedule &s) {
        return row_values * s.n_bonds + 4 * static_cast<int64_t>(s.n_atoms) + s.n_pairs;
    }
    TreeMetric(const MetricCall &c, const Schedule &schedule, const MoleculeLane *of, int n, Memory<V> memory)
        : s(schedule), call(c), lane(of), used(n), at(of, n, c.r.packed && (!c.force.x || c.force.packed)),
          row(reinterpret_cast<MetricRow<V> *>(memory.values(row_values * s.n_bonds))), w(memory.values(s.n_atoms)),
          pair(memory.values(s.n_pairs)), r(memory.vectors(s.n_atoms)) {}

    // Returns the lanes that plain arithmetic answers for. phi, times kT, is in `normal` if there is a force.
    MaskOf<V> solve() {
        load();
        const bool logs = call.log_det || call.sum || call.log_det_z;
        for (int32_t slot = 0; slot < s.n_atoms; ++slot) {
            const int k = children(slot);
            if (slot == s.n_tree)
                up<1, true>(slot, k, logs);
            else if (k > 0)
                choose_few<1>(k, [&](auto known) HOL_FORCED { up<known, false>(slot, k, logs); });
        }
        V sum = {};
        if (call.force.x) {
            for (int32_t slot = s.n_atoms; slot-- > 0;) {
                const int k = children(slot);
                if (slot == s.n_tree)
                    down<1, true>(slot, k);
                else if (k > 0)
                    choose_few<1>(k, [&](auto known) HOL_FORCED { down<known, false>(slot, k); });
                if (slot < s.n_tree) sum = sum + turn(row[slot]);
            }
        }
        if (logs) det.flush();
        if (call.log_det_z) diagonal.total();
        return finite(sum + (det.sum + diagonal.sum)) & less_equal(V{}, least);
    }

    // Of the lanes in `which`.
    void write(unsigned which, Tally &tally) const {
        for (int i = 0; i < used; ++i) {
            if (!(which >> i & 1)) continue;
            const double value = Width<V>::get(det.sum, i);
            if (call.log_det) call.log_det[lane[i].molecule] = value;
            if (call.log_det_z) call.log_det_z[lane[i].molecule] = value + Width<V>::get(diagonal.sum, i);
            tally.log_det += value;
        }
        if (call.force.x && which)
            write_vectors(call.force, at, s.slot_of, s.n_atoms, Force{*this},
                          Written<V>{which, nullptr, lane, call.add});
    }

private:
    int children(int32_t slot) const { return s.child_start[slot + 1] - s.child_start[slot]; }
    const int32_t *children_of(int32_t slot) const { return s.child + s.child_start[slot]; }

    struct Force {
        const TreeMetric &x;
        HOL_FORCED Vector3<V> operator[](int32_t slot) const {
            Vector3<V> f = {};
            if (slot < x.s.n_tree) f = x.row[slot].normal;
            for (int32_t c = x.s.child_start[slot]; c < x.s.child_start[slot + 1]; ++c)
                f = f - x.row[x.s.child[c]].normal;
            return f;
        }
    };

    static inline V product(const MetricRow<V> &a, const MetricRow<V> &b) {
        return dot_compensated(a.d, a.low, b.d, b.low);
    }

    // Far from where squares and their products over- or underflow.
    void load() {
        for (int32_t i = 0; i < s.n_atoms; ++i)
            for (int l = 0; l < Width<V>::lanes; ++l) Width<V>::set(w[i], l, lane[l].w[s.atom_of[i]]);
        read_vectors(call.r, at, s.slot_of, s.n_atoms, Slots<V>(r));
        const V small = Width<V>::all(0x1p-300), large = Width<V>::all(0x1p300);
        for (int32_t slot = 0; slot < s.n_tree; ++slot) {
            MetricRow<V> &x = row[slot];
            const int32_t parent = s.parent[slot];
            unrounded_bond(call.box, r[parent], r[slot], x.d, x.low);
            x.q = dot(x.d, x.d);
            x.E = w[slot] * x.q;
            x.F = V{};
            x.rounded = x.E;
            const V A = x.E + w[parent] * x.q;
            least = min(min(min(x.q, A) - small, large - max(x.q, A)), least);
        }
    }

    // Counts P = A - F of a bond.
    HOL_FORCED void count(const MetricRow<V> &x, V weight, V P, V F) {
        const V A = weight * x.q, per_A = Width<V>::all(1) / A;
        det.multiply(P * per_A, F * per_A);
        if (call.log_det_z) diagonal.multiply(Width<V>::all(4) * A, Width<V>::all(1));
    }

    template <int known, bool top>
    HOL_FORCED void up(int32_t slot, int count_of, bool logs) {
        constexpr int most = known > 0 ? known : most_decomposed;
        const int k = known > 0 ? known : count_of;
        const int32_t *const child = children_of(slot);
        const V w0 = w[slot];
        V S[pairs_to(most)], F[most], z[most], l[most];
        V *const m = pair + s.pair_start[slot];
        for (int a = 0; a < k; ++a) {
            const MetricRow<V> &x = row[child[a]];
            for (int b = 0; b < a; ++b) S[pair_of(a + 1, b)] = w0 * product(x, row[child[b]]);
            S[pair_of(a + 1, a)] = mul_add(w0, x.q, x.E);
            F[a] = x.F;
        }
        for (int j = 0; j < k; ++j) {
            MetricRow<V> &x = row[child[j]];
            const V P = S[pair_of(j + 1, j)];
            if (j > 0) least = min(mul_add(Width<V>::all(-least_part), mul_add(w0, x.q, x.E), P), least);
            x.r = Width<V>::all(1) / P;
            if (logs) count(x, w0 + w[child[j]], P, F[j]);
            for (int a = j + 1; a < k; ++a) {
                const V part = S[pair_of(a + 1, j)] * x.r;
                m[pair_of(a, j)] = part;
                F[a] = mul_add(part, S[pair_of(a + 1, j)], F[a]);
                for (int b = j + 1; b <= a; ++b)
                    S[pair_of(a + 1, b)] = mul_add(-part, S[pair_of(b + 1, j)], S[pair_of(a + 1, b)]);
            }
        }
        if (top) return;
        MetricRow<V> &e = row[slot];
        V taken = {};
        for (int a = 0; a < k; ++a) {
            const MetricRow<V> &x = row[child[a]];
            V sum = w0 * product(x, e);
            for (int j = 0; j < a; ++j) sum = mul_add(-m[pair_of(a, j)], z[j], sum);
            z[a] = sum;
            l[a] = sum * x.r;
            taken = mul_add(l[a], sum, taken);
        }
        for (int a = k - 1; a >= 0; --a) {
            for (int j = a + 1; j < k; ++j) l[a] = mul_add(-m[pair_of(j, a)], l[j], l[a]);
            row[child[a]].l = l[a];
        }
        const V whole = w0 * e.q;
        e.F = taken;
        if (known == 1) {  // of one child E is (9), which subtracts nothing
            MetricRow<V> &x = row[child[0]];
            x.normal = normal(x, e);
            e.E = (w0 * x.r) * mul_add(e.q, x.E, w0 * dot(x.normal, x.normal));
            e.rounded = e.E;
            return;
        }
        e.E = whole - taken;
        e.rounded = whole;
        least = min(mul_add(Width<V>::all(-least_part), whole, e.E), least);
    }

    // H of the bonds below an atom, and what they and the one above pull at each other.
    template <int known, bool top>
    HOL_FORCED void down(int32_t slot, int count_of) {
        constexpr int most = known > 0 ? known : most_decomposed;
        const int k = known > 0 ? known : count_of;
        const int32_t *const child = children_of(slot);
        const V w0 = w[slot], above = top ? V{} : row[slot].H;
        V H[pairs_to(most)], off[pairs_to(most)] = {}, beside[most], off_beside[most] = {};  // and of H_ce
        inverse<most>(k, child, pair + s.pair_start[slot], H);
        if (known == 1) {
            const MetricRow<V> &x = row[child[0]];
            off_beside[0] = above * (abs(x.l) * (x.rounded * x.r));
        } else {
            uncertain<most>(slot, k, H, off, off_beside);
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
                couple(x, row[slot], n, -(w0 * beside[0]), w0 * off_beside[0]);
            }
            return;
        }
        for (int a = 0; a < k; ++a) {
            MetricRow<V> &x = row[child[a]];
            for (int b = 0; b < a; ++b)
                couple(x, row[child[b]], normal(x, row[child[b]]), w0 * H[pair_of(a + 1, b)],
                       w0 * off[pair_of(a + 1, b)]);
            // The bond above points to the atom.
            couple(x, row[slot], normal(x, row[slot]), -(w0 * beside[a]), w0 * off_beside[a]);
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
    __attribute__((noinline)) void uncertain(int32_t slot, int k, const V *inverse, V *off, V *off_beside) const {
        const int32_t *const child = children_of(slot);
        const V *const m = pair + s.pair_start[slot], above = slot < s.n_tree ? row[slot].H : V{};
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
            off_beside[a] = above * of_l[a];
        }
        for (int a = 0; a < k; ++a)
            for (int b = 0; b < a; ++b) {
                V sum = above * mul_add(of_l[a], abs(row[child[b]].l), of_l[b] * abs(row[child[a]].l));
                for (int j = 0; j < k; ++j) sum = mul_add(B[a][j], of_inverse(j, b), sum);
                off[pair_of(a + 1, b)] = sum;
            }
    }

    HOL_NOINLINE Vector3<V> normal(const MetricRow<V> &a, const MetricRow<V> &b) {
        return cross_compensated(a.d, a.low, b.d, b.low);
    }
    // h n, n = d_a x d_b, is added to the normal of a, and taken from that of b. off: what h may be wrong by.
    HOL_STATIC void couple(MetricRow<V> &a, MetricRow<V> &b, const Vector3<V> &n, V h, V off) {
        const V size = sqrt(dot(n, n)), scale = abs(h) * size, error = off * size;
        a.normal = add_times(a.normal, h, n);
        b.normal = add_times(b.normal, -h, n);
        a.scale = a.scale + scale;
        b.scale = b.scale + scale;
        a.error = a.error + error;
        b.error = b.error + error;
    }

    // kT phi = kT d x normal / q. Returns something that is finite if it is.
    HOL_FORCED V turn(MetricRow<V> &x) {
        least = min(mul_add(Width<V>::all(-1 / most_uncertain), x.error, x.scale), least);
        x.normal = (Width<V>::all(call.kT) / x.q) * cross(x.d, x.normal);
        return abs(x.normal.x) + abs(x.normal.y) + abs(x.normal.z);
    }
};

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
