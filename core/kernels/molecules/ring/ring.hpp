// A ring without side atoms (theory (57)): on unit bonds every row of the matrix is diagonally dominant, whatever the
// signs, and Gaussian elimination that carries what the diagonal has beyond its neighbours, v, subtracts nothing that
// matters (Q. Ye, Math. Comp. 77, 2195 (2008)). Each row is coupled to the next one (n) and, by fill, to the last (z).
#ifndef HOLONOMIC_KERNELS_MOLECULES_RING_RING_HPP
#define HOLONOMIC_KERNELS_MOLECULES_RING_RING_HPP

#include "core/kernels/molecules/molecules.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

template <class V>
struct RingRow {
    V o;       // the coupling to the bond before, at the atom between them: - w c
    V left;    // w (1 - |c|) of that atom
    V per_d;   // 1 / |d|
    V l_last;  // what the last row gets of this one; l of the bond's row is what the next one gets
};

// Plain products do while every v keeps this part of the diagonal: it is a sum of 1 - |c|, of which each is right to
// 2 / sin roundings where it comes from a cross product, eleven where it is a 64th. Of random rings of fifty bonds with
// equal masses one in a thousand has a smaller one.
constexpr double least_deficit = 1.0 / 64;

template <class V>
static inline void factorize_ring(Molecules<V> &x, RingRow<V> *ring) {
    const int32_t N = x.s.n_bonds;
    BondRow<V> *const row = x.row;
    const V one = Width<V>::all(1), half = Width<V>::all(0.5);
    for (int32_t k = 0; k < N; ++k) ring[k].per_d = one / sqrt(row[k].q);
    for (int32_t k = 0; k < N; ++k) {
        const int32_t before = k > 0 ? k - 1 : N - 1;
        const V per = ring[before].per_d * ring[k].per_d, c = product_of(x, before, k) * per, size = abs(c);
        const Vector3<V> normal = cross(row[before].d, row[k].d);
        const V sine2 = dot(normal, normal) * (per * per);
        ring[k].o = -(x.w[k] * c);
        ring[k].left = x.w[k] * select(less(size, half), one - size, sine2 / (one + size));
    }
    for (int32_t k = 0; k < N; ++k) row[k].E = ring[k].left + ring[k + 1 < N ? k + 1 : 0].left;  // v
    V z = ring[0].o;
    for (int32_t k = 0; k + 2 < N; ++k) {
        const V n = ring[k + 1].o, old = k + 3 == N ? ring[N - 1].o : V{}, v = row[k].E;
        const V r = one / (v + (abs(n) + abs(z))), fill = -(n * z) * r;
        x.slack = min(mul_add(Width<V>::all(-least_deficit), x.w[k] + x.w[k + 1], v), x.slack);
        row[k].r = r;
        row[k].l = -(n * r);
        ring[k].l_last = -(z * r);
        const V twice = keep(less(old * fill, V{}), 2.0 * min(abs(old), abs(fill)));
        row[k + 1].E = row[k + 1].E + mul_add(abs(n) * v, r, twice);
        row[N - 1].E = row[N - 1].E + mul_add(abs(z) * v, r, twice);
        z = old + fill;
    }
    BondRow<V> &next = row[N - 2], &last = row[N - 1];
    x.slack = min(mul_add(Width<V>::all(-least_deficit), x.w[N - 2] + x.w[N - 1], next.E), x.slack);
    next.r = one / (next.E + abs(z));
    next.l = V{};
    ring[N - 2].l_last = -(z * next.r);
    const V left = mul_add(abs(z) * next.E, next.r, last.E);
    x.slack = min(mul_add(Width<V>::all(-least_deficit), x.w[N - 1] + x.w[0], left), x.slack);
    last.r = one / left;
}

// From right-hand sides to the solution, both in t of the rows.
template <class V>
static inline void solve_ring(const Molecules<V> &x, const RingRow<V> *ring) {
    const int32_t N = x.s.n_bonds;
    BondRow<V> *const row = x.row;
    V y = row[0].t * ring[0].per_d, y_last = row[N - 1].t * ring[N - 1].per_d;
    for (int32_t k = 0; k + 1 < N; ++k) {
        row[k].t = y * row[k].r;
        y_last = mul_add(ring[k].l_last, y, y_last);
        y = mul_add(row[k].l, y, row[k + 1].t * ring[k + 1].per_d);
    }
    const V t_last = y_last * row[N - 1].r;
    V t = t_last;
    row[N - 1].t = t_last * ring[N - 1].per_d;
    for (int32_t k = N - 2; k >= 0; --k) {
        t = mul_add(row[k].l, t, mul_add(ring[k].l_last, t_last, row[k].t));
        row[k].t = t * ring[k].per_d;
    }
}

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
