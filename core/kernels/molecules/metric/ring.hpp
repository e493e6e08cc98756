// Metric determinant and Fixman force of a ring without side atoms: a chain that its last bond closes (theory (57a)).
// Bond k leads from atom k to atom k + 1. What bonds before leave of bond k is found without a subtraction, as in a
// chain; what they leave of the last one, by fill, is subtracted from it.
#pragma once

#include "core/kernels/molecules/metric/rows.hpp"
#include "core/kernels/molecules/tree/joint.hpp"

namespace holonomic::HOL_ISA::graph {

template <class V>
struct RingMetric : Metric<V> {
    typedef Metric<V> Base;
    using Base::Base, Base::s, Base::row, Base::w, Base::r, Base::least, Base::product, Base::normal, Base::couple;

    // Returns the lanes that plain arithmetic answers for.
    MaskOf<V> solve() {
        const int32_t n = s.n_bonds;
        this->read_atoms();
        for (int32_t k = 0; k < n; ++k) this->make(row[k], k, k + 1 < n ? k + 1 : 0);
        up();
        if (!this->call.force.x) return this->finish(V{});
        down();
        V sum = {};
        for (int32_t k = 0; k < n; ++k) sum = sum + this->turn(row[k]);
        for (int32_t k = 0; k < n; ++k) r[k] = row[k > 0 ? k - 1 : n - 1].normal - row[k].normal;
        return this->finish(sum);
    }

private:
    // What a bond gets of the last one.
    V &to_last(int32_t k) const { return row[k].rounded; }

    void up() {
        const int32_t last = s.n_bonds - 1;
        row[0].E = w[0] * row[0].q;
        V z = -(w[0] * product(row[last], row[0])), taken = {};  // coupling to the last bond; what fill takes of it
        for (int32_t k = 0; k < last; ++k) {
            MetricRow<V> &x = row[k], &y = row[k + 1];
            const V w1 = w[k + 1], P = mul_add(w1, x.q, x.E), g = product(x, y), one = Width<V>::all(1);
            x.r = one / P;
            if (this->logs) this->count(x, w[k] + w1, P, x.F);
            x.l = (w1 * g) * x.r;
            const V passed = x.l * (w1 * g);
            x.normal = normal(x, y);
            y.E = (w1 * x.r) * mul_add(y.q, x.E, w1 * dot(x.normal, x.normal));
            y.F = passed;
            if (k + 1 < last) {
                to_last(k) = -(z * x.r);
                taken = mul_add(z * x.r, z, taken);
                z = z * x.l;
            } else {  // (z - w g)^2 / P, of which the chain has w g
                const V both = z - w1 * g;
                x.off = (abs(z) + abs(w1 * g)) * x.r;
                to_last(k) = -(both * x.r);
                taken = mul_add(z * x.r, both - w1 * g, taken);
            }
        }
        close(taken);
    }

    // The last bond: P = w q + E - taken.
    void close(V taken) {
        const int32_t last = s.n_bonds - 1;
        MetricRow<V> &x = row[last];
        const V whole = mul_add(w[0], x.q, x.E), P = whole - taken;
        least = min(mul_add(Width<V>::all(-least_kept), max(whole, abs(taken)), P), least);
        x.r = Width<V>::all(1) / P;
        x.rounded = max(whole, abs(taken)) * x.r;
        V F = {};
        for (int32_t k = 0; k < last; ++k) F = mul_add(to_last(k) * to_last(k), Width<V>::all(1) / row[k].r, F);
        if (this->logs) this->count(x, w[last] + w[0], P, F);
    }

    // Rows of the inverse from the last one back: elements with the last bond, with the next, and their own. off: what
    // these may be wrong by, in roundings.
    void down() {
        const int32_t last = s.n_bonds - 1;
        const V corner = row[last].r, off_corner = row[last].rounded * corner;
        V own = corner, off_own = off_corner, beside = corner, off_beside = off_corner;
        this->clear(row[last]);
        for (int32_t k = last; k-- > 0;) {
            MetricRow<V> &x = row[k], &y = row[k + 1];
            const V l = x.l, l1 = to_last(k), size = abs(l), size1 = abs(l1);
            V h = l1 * corner, off = size1 * (off_corner + corner), h_last = h, off_last = off;
            if (k + 1 == last) {  // it couples to the next bond as the last one alone
                off_last = off = mul_add(x.off, corner, size1 * off_corner);
                own = mul_add(l1, h, x.r);
                off_own = mul_add(size1, off, x.r);
            } else {
                h_last = mul_add(l, beside, h);
                off_last = mul_add(size, off_beside + abs(beside), off);
                h = mul_add(l, own, l1 * beside);
                off = mul_add(size, off_own + own, size1 * (off_beside + abs(beside)));
                own = mul_add(l, h, mul_add(l1, h_last, x.r));
                off_own = mul_add(size, off, mul_add(size1, off_last, x.r));
            }
            const Vector3<V> n = x.normal;
            this->clear(x);
            couple(x, y, n, -(w[k + 1] * h), w[k + 1] * off);
            beside = h_last;
            off_beside = off_last;
        }
        couple(row[last], row[0], normal(row[last], row[0]), -(w[0] * beside), w[0] * off_beside);
    }
};

}  // namespace holonomic::HOL_ISA::graph
