// Linear equations of strips of triangles (theory (55), in the order along the strip): LDL^T of the band and its
// substitutions, with what is needed of it in registers.
#ifndef HOLONOMIC_KERNELS_GRAPH_STRIP_LINEAR_HPP
#define HOLONOMIC_KERNELS_GRAPH_STRIP_LINEAR_HPP

#include "core/kernels/graph/core_matrix.hpp"
#include "core/kernels/graph/residual.hpp"
#include "core/kernels/graph/strip.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

// Right-hand sides from atom to atom, which the columns take forward to u in t of the rows. The bonds that end at atom
// i + 2 have to be given before atom i is done.
template <class V>
struct StripForward {
    V y[strip_bonds], next;

    HOL_FORCED explicit StripForward(const V &first) : y{V{}, V{}, V{}, first, V{}}, next() {}
    HOL_FORCED void take(const V &to_long, const V &to_short) {
        y[begin_long] = to_long;
        next = to_short;
    }
    // row: of the atom's first bond.
    HOL_FORCED void atom(BondRow<V> *row, const StripColumns<V> &columns) {
        columns.forward(y);
        row[end_long].t = y[end_long] * row[end_long].r;
        row[end_short].t = y[end_short] * row[end_short].r;
        to_next_atom(y, next);
    }
};

// The part of the matrix that is at work: of the first three bonds of an atom what is left of it when those before are
// eliminated; below the diagonal.
template <class V>
struct StripMatrix {
    V m[strip_bonds][strip_bonds];

    // Takes an atom's part into it.
    HOL_FORCED void add_atom(const V &w, const BondRow<V> *row) {
        HOL_UNROLL
        for (int r = 0; r < strip_bonds; ++r) {
            HOL_UNROLL
            for (int c = 0; c <= r; ++c) {
                if (r == passing || c == passing) {
                    if (r > passing) m[r][c] = V{};
                    continue;
                }
                const V g = w * (r == c ? row[r].q : dot(row[r].d, row[c].d));
                if (r < passing)
                    m[r][c] = m[r][c] + g;
                else
                    m[r][c] = c < passing ? -g : g;
            }
        }
    }
    // Eliminates bond p; l: its multipliers for those behind. Returns 1 / pivot.
    template <int p>
    HOL_FORCED V eliminate(V *l) {
        const V minus = Width<V>::all(-1) / m[p][p];
        HOL_UNROLL
        for (int e = p + 1; e < strip_bonds; ++e) {
            const V factor = l[e - p - 1] = m[e][p] * minus;
            HOL_UNROLL
            for (int c = p + 1; c <= e; ++c) m[e][c] = mul_add(factor, m[c][p], m[e][c]);
        }
        return -minus;
    }
    HOL_FORCED void next_atom() {
        HOL_UNROLL
        for (int r = 0; r <= passing; ++r) {
            HOL_UNROLL
            for (int c = 0; c <= r; ++c) m[r][c] = m[r + passing][c + passing];
        }
    }
};

// Rows of bonds of no length before the first bond and behind the last one.
template <class V>
HOL_INLINE void open_strip(const Molecules<V> &x) {
    for (int32_t k = -strip_rows_before; k < 0; ++k) x.row[k] = BondRow<V>{};
    for (int32_t k = 0; k < strip_rows_behind; ++k) x.row[x.s.n_bonds + k] = BondRow<V>{};
}

// New columns, by which the right-hand sides in t of the rows become u.
template <class V>
HOL_NOINLINE void factorize_strip(Molecules<V> &x, StripColumns<V> *columns) {
    open_strip(x);
    const V one = Width<V>::all(1), least = Width<V>::all(-least_pivot);
    V slack = x.slack, w1 = {}, w2 = {};  // of the last atom, and of the one before
    // Atom 0 has no bonds that end there or pass by: their pivots are 1, and they are coupled to nothing.
    StripMatrix<V> a = {{{one}, {V{}, one}, {V{}, V{}, one}}};
    StripForward<V> forward(x.row[0].t);
    for (int32_t i = 0; i < x.s.n_atoms; ++i) {
        BondRow<V> *const row = x.row + first_place_at(i);
        const V w = x.w[i];
        a.add_atom(w, row);
        slack = min(mul_add(least, (w + w2) * row[end_long].q, a.m[end_long][end_long]), slack);
        row[end_long].r = a.template eliminate<end_long>(columns[i].first);
        slack = min(mul_add(least, (w + w1) * row[end_short].q, a.m[end_short][end_short]), slack);
        row[end_short].r = a.template eliminate<end_short>(columns[i].second);
        forward.take(row[begin_long].t, row[begin_long + 1].t);
        forward.atom(row, columns[i]);
        a.next_atom();
        w2 = w1;
        w1 = w;
    }
    x.slack = slack;
}

// Right-hand sides in t of the rows to u.
template <class V>
HOL_NOINLINE void substitute_strip(const Molecules<V> &x, const StripColumns<V> *columns) {
    StripForward<V> forward(x.row[0].t);
    for (int32_t i = 0; i < x.s.n_atoms; ++i) {
        BondRow<V> *const row = x.row + first_place_at(i);
        forward.take(row[begin_long].t, row[begin_long + 1].t);
        forward.atom(row, columns[i]);
    }
}

// u in t of the rows to the solution.
template <class V>
HOL_NOINLINE void down_strip(const Molecules<V> &x, const StripColumns<V> *columns) {
    V t[strip_bonds] = {};
    for (int32_t i = x.s.n_atoms - 1; i >= 0; --i) {
        BondRow<V> *const row = x.row + first_place_at(i);
        t[end_long] = row[end_long].t;
        t[end_short] = row[end_short].t;
        columns[i].back(t);
        row[end_long].t = t[end_long];
        row[end_short].t = t[end_short];
        to_atom_before(t);
    }
}

// What find_residuals() finds, and u of it in t of the rows. Accelerations first, in a sweep of their own: with the
// rest they would need more registers than there are.
template <class V>
HOL_NOINLINE void find_accelerations(const Molecules<V> &x, const Equations<V> &e, const V *t) {
    const int32_t n = x.s.n_atoms;
    const Vector3<V> zero = {};
    const auto pull = [&](int32_t place) HOL_FORCED { return scale_pairs(t[place], e.d[place]); };
    for (int32_t i = 0; i < n; ++i) {
        const int32_t first = first_place_at(i);
        Pair3<V> sum = pairs_of(e.force ? e.force[i] : zero, zero);
        if (i + 1 < n) sum = add_pairs(sum, pull(first + begin_short));
        if (i + 2 < n) sum = add_pairs(sum, pull(first + begin_long));
        if (i > 0) sum = subtract_pairs(sum, pull(first + end_short));
        if (i > 1) sum = subtract_pairs(sum, pull(first + end_long));
        e.a[i] = scale_pairs(x.w[i], sum);
        if (e.start) e.a[i] = add_pairs(e.a[i], pairs_of(e.start[i], zero));
    }
}

template <class V>
HOL_NOINLINE void substitute_residuals(const Molecules<V> &x, const Equations<V> &e, const V *t,
                                       const StripColumns<V> *columns) {
    find_accelerations(x, e, t);
    const auto residual = [&](int32_t place, int32_t from, int32_t to)
                              HOL_FORCED { return residual_of(x, e, place, from, to, e.a[from], e.a[to]); };
    const int32_t n = x.s.n_atoms;
    StripForward<V> forward(residual(0, 0, 1));
    for (int32_t i = 0; i < n; ++i) {
        const int32_t first = first_place_at(i);
        forward.take(V{}, V{});
        if (__builtin_expect(i + 2 < n, 1))
            forward.take(residual(first + begin_long, i, i + 2), residual(first + begin_long + 1, i + 1, i + 2));
        forward.atom(x.row + first, columns[i]);
    }
}

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
