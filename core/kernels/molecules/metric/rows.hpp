// Metric determinant and Fixman force of a block of molecules in plain doubles (theory (60)-(62)): what all shapes
// share. Products of two bonds are found from unrounded coordinates, as those of chains: neither the determinant nor
// its force has a scale that would forgive their rounding. A pivot is P = A - F, where F is a sum of squares, so that
// ln(P / A) keeps its digits where F is small.
#pragma once

#include "core/kernels/arithmetic/log_sum.hpp"
#include "core/kernels/arithmetic/thresholds.hpp"
#include "core/kernels/molecules/atoms/vectors.hpp"
#include "core/kernels/molecules/blocks.hpp"
#include "core/kernels/molecules/molecules.hpp"
#include "core/kernels/molecules/scratch.hpp"

namespace holonomic::HOL_ISA::graph {

// The force on a bond may be wrong by so many times its scale, in roundings, if all that it may be wrong by adds up.
// That many count as right.
HOL_INLINE double most_uncertain(int32_t n_bonds) { return 2 * (16 + __builtin_sqrt(n_bonds)); }

// Of a bond at its index.
template <class V>
struct MetricRow {
    Vector3<V> d, low;  // low: what rounding leaves off d
    V q;                // d.d
    V E, F;             // what the bonds eliminated before leave of w q of that side, and what they take of A
    V rounded;          // what rounding may take of E, in roundings
    V r, l, H;          // 1 / P; multiplier: what it gets of the next bond; its element of A^-1
    Vector3<V> normal;  // sum of w H_kl d_k x d_l, then phi
    V scale, error;     // of that, in absolute values; what it may be wrong by, in roundings
    V off;              // the same of H
};

template <class V>
struct Metric {
    const EliminationPlan &s;
    const MetricCall &call;
    const MoleculeLane *const lane;
    const int used;
    const Atoms<V> at;
    MetricRow<V> *const row;  // [n_bonds] by bond index
    V *const w, *const pair;  // [n_atoms] by index; [n_pairs] multipliers among the children of an atom
    Vector3<V> *const r;      // [n_atoms] by index: positions, then forces
    const bool logs;
    const double per_uncertain;
    V least = Width<V>::all(1);  // negative where plain arithmetic may not do
    LogSum<V> det;
    LogSumWide<V> diagonal;  // of Z_kk

    static constexpr int64_t row_values = sizeof(MetricRow<V>) / sizeof(V);
    static int64_t values(const EliminationPlan &s) {
        return row_values * s.n_bonds + 4 * static_cast<int64_t>(s.n_atoms) + s.n_pairs;
    }
    Metric(const MetricCall &c, const EliminationPlan &elimination, const MoleculeLane *of, int n, Memory<V> memory)
        : s(elimination), call(c), lane(of), used(n), at(of, n, c.r.packed && (!c.force.x || c.force.packed)),
          row(reinterpret_cast<MetricRow<V> *>(memory.values(row_values * s.n_bonds))), w(memory.values(s.n_atoms)),
          pair(memory.values(s.n_pairs)), r(memory.vectors(s.n_atoms)), logs(c.log_det || c.sum || c.log_det_z),
          per_uncertain(1 / most_uncertain(elimination.n_bonds)) {}

    void read_atoms() {
        masses_by_index(s, lane, w);
        read_vectors(call.r, at, s.index_of, s.n_atoms, ByIndex<V>(r));
    }
    // Between two indices; E is that of the second atom alone. Far from where squares and their products over- or
    // underflow.
    HOL_FORCED void make(MetricRow<V> &x, int32_t from, int32_t to) {
        unrounded_bond(call.box, r[from], r[to], x.d, x.low);
        x.q = dot(x.d, x.d);
        x.E = w[to] * x.q;
        x.F = V{};
        x.rounded = x.E;
        const V A = x.E + w[from] * x.q;
        least = min(min(min(x.q, A) - Width<V>::all(0x1p-300), Width<V>::all(0x1p300) - max(x.q, A)), least);
    }

    // Counts P = A - F of a bond, A = weight q.
    HOL_FORCED void count(const MetricRow<V> &x, V weight, V P, V F) {
        const V A = weight * x.q, per_A = Width<V>::all(1) / A;
        det.multiply(P * per_A, F * per_A);
        if (call.log_det_z) diagonal.multiply(Width<V>::all(4) * A, Width<V>::all(1));
    }

    static inline V product(const MetricRow<V> &a, const MetricRow<V> &b) {
        return dot_compensated(a.d, a.low, b.d, b.low);
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
    HOL_STATIC void clear(MetricRow<V> &x) {
        x.normal = Vector3<V>{};
        x.scale = x.error = V{};
    }

    // kT phi = kT d x normal / q: the force on the second atom, and minus that on the first one. Returns something that
    // is finite if it is.
    HOL_FORCED V turn(MetricRow<V> &x) {
        least = min(mul_add(Width<V>::all(-per_uncertain), x.error, x.scale), least);
        x.normal = (Width<V>::all(call.kT) / x.q) * cross(x.d, x.normal);
        return abs(x.normal.x) + abs(x.normal.y) + abs(x.normal.z);
    }

    // Returns the lanes that plain arithmetic answers for. sum: of what turn() has returned.
    MaskOf<V> finish(V sum) {
        if (logs) det.flush();
        if (call.log_det_z) diagonal.total();
        return finite(sum + (det.sum + diagonal.sum)) & less_equal(V{}, least);
    }

    // Of the lanes in `which`. The forces on atoms are where these were.
    void write(unsigned which, Tally &tally) const {
        for (int i = 0; i < used; ++i) {
            if (!(which >> i & 1)) continue;
            const double value = Width<V>::get(det.sum, i);
            if (call.log_det) call.log_det[lane[i].molecule] = value;
            if (call.log_det_z) call.log_det_z[lane[i].molecule] = value + Width<V>::get(diagonal.sum, i);
            tally.log_det += value;
        }
        const Vector3<V> *const force = r;
        if (call.force.x && which)
            write_vectors(call.force, at, s.index_of, s.n_atoms, force, Written<V>{which, nullptr, lane, call.add});
    }
};

}  // namespace holonomic::HOL_ISA::graph
