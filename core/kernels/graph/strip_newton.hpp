// Newton's method for the positions of strips of triangles (theory (58)): LU of the band along the strip. In one sweep
// the bonds are moved and measured, what that leaves of their lengths is substituted forward, and new factors are
// found.
#ifndef HOLONOMIC_KERNELS_GRAPH_STRIP_NEWTON_HPP
#define HOLONOMIC_KERNELS_GRAPH_STRIP_NEWTON_HPP

#include "core/kernels/graph/newton_joint.hpp"
#include "core/kernels/graph/strip.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

template <class V>
struct StripNewton {
    typedef V Value;
    static constexpr bool by_length = false;
    struct Row {
        Vector3<V> D, b, new_D;  // new_D: D as moved, for new factors
        V tau, t;                // as in NewtonRow; t: u = y / P
        V a2, per_a2;
    };
    struct System {
        const Schedule &s;
        V *w;  // [n_atoms]
        Row *row;
    };
    // Of the bonds that end at an atom: 1 / 2 P; what the bonds ahead get of their y, and they of the corrections of
    // those.
    struct Factors {
        V r[2];
        StripColumns<V> up, down;
    };
    System x;
    Factors *factors;   // [n_atoms]
    Vector3<V> *moves;  // [n_atoms] displacements
    V *lengths;         // least and largest

    static constexpr int64_t row_values = static_cast<int64_t>(sizeof(Row) / sizeof(V)),
                             factor_values = static_cast<int64_t>(sizeof(Factors) / sizeof(V));
    static int64_t values(const Schedule &s) {
        return 2 + (4 + factor_values) * s.n_atoms + row_values * (s.n_bonds + more_strip_rows);
    }
    StripNewton(const Schedule &s, Memory<V> &memory)
        : x{s, nullptr, nullptr}, factors(), moves(), lengths(memory.values(2)) {
        x.w = memory.values(s.n_atoms);
        Row *const rows = reinterpret_cast<Row *>(memory.values(row_values * (s.n_bonds + more_strip_rows)));
        x.row = rows + strip_rows_before;
        factors = reinterpret_cast<Factors *>(memory.values(factor_values * s.n_atoms));
        moves = memory.vectors(s.n_atoms);
        for (int32_t k = 0; k < strip_rows_before; ++k) rows[k] = Row{};
        for (int32_t k = 0; k < strip_rows_behind; ++k) x.row[s.n_bonds + k] = Row{};
    }

    HOL_FORCED Vector3<V> pull_of(int32_t place) const { return x.row[place].tau * x.row[place].b; }
    // The displacement of an atom.
    HOL_FORCED Vector3<V> displacement(int32_t atom) const {
        const int32_t first = first_place_at(atom);
        return x.w[atom] * ((pull_of(first + begin_short) + pull_of(first + begin_long)) -
                            (pull_of(first) + pull_of(first + end_short)));
    }

    // The same of all atoms, one after the other.
    struct Displacements {
        StripSums<V> sums;
        HOL_FORCED Vector3<V> next(const StripNewton &z, int32_t atom) {
            const int32_t place = first_place_at(atom) + begin_short;
            return z.x.w[atom] * sums.next(z.pull_of(place), z.pull_of(place + 1));
        }
    };
    // In a sweep of their own: with the bonds they would need twice the registers.
    __attribute__((noinline)) void find_moves() {
        Displacements displacements = {};
        for (int32_t i = 0; i < x.s.n_atoms; ++i) moves[i] = displacements.next(*this, i);
    }

    // |D.D - a^2| / a^2 of the bonds that have been measured; max() may lose a NaN, y of the last bond keeps it.
    struct Errors {
        V worst;
        V largest(V y) const { return mul_add(y, V{}, worst); }
    };
    HOL_FORCED static V length_error(const Row &row, const Vector3<V> &D, Errors &errors) {
        const V sigma = excess(D, row.a2);
        errors.worst = max(abs(sigma) * row.per_a2, errors.worst);
        return sigma;
    }

    // The relative error of one bond, as the sweeps find it.
    V left_of(int32_t k) const {
        Errors errors = {};
        const Vector3<V> to = displacement(x.s.to[k]), from = displacement(x.s.from[k]);
        length_error(x.row[k], x.row[k].D + (to - from), errors);
        return errors.worst;
    }

    // What is left of the matrix for the bonds end_long, end_short, passing when those before are eliminated.
    typedef V Left[3][3];

    // Takes the atom's part into the matrix, eliminates the bonds that end there, and leaves what the next one starts
    // from. row: of its first bond.
    template <bool moved, bool all>
    HOL_FORCED static void eliminate_atom(const V &w, const Row *row, Left &left, Factors &f, MaskOf<V> which) {
        V m[strip_bonds][strip_bonds];
        const V signed_w[2] = {w, -w};
        HOL_UNROLL
        for (int r = 0; r < strip_bonds; ++r) {
            HOL_UNROLL
            for (int c = 0; c < strip_bonds; ++c) {
                if (r == passing || c == passing)
                    m[r][c] = r <= passing && c <= passing ? left[r][c] : V{};
                else
                    m[r][c] = signed_w[(r < passing) != (c < passing)] * dot(moved ? row[r].new_D : row[r].D, row[c].b);
                if (r < passing && c < passing) m[r][c] = m[r][c] + left[r][c];
            }
        }
        HOL_UNROLL
        for (int p = 0; p < 2; ++p) {
            const V minus = Width<V>::all(-1) / m[p][p];
            V *const up = p == 0 ? f.up.first : f.up.second, *const down = p == 0 ? f.down.first : f.down.second;
            put_where<all>(which, f.r[p], -0.5 * minus);
            HOL_UNROLL
            for (int e = p + 1; e < strip_bonds; ++e) {
                const V l = m[e][p] * minus;
                put_where<all>(which, up[e - p - 1], l);
                put_where<all>(which, down[e - p - 1], m[p][e] * minus);
                HOL_UNROLL
                for (int c = p + 1; c < strip_bonds; ++c) m[e][c] = mul_add(l, m[p][c], m[e][c]);
            }
        }
        HOL_UNROLL
        for (int r = 0; r <= passing; ++r) {
            HOL_UNROLL
            for (int c = 0; c <= passing; ++c) left[r][c] = m[r + passing][c + passing];
        }
    }

    // What is left of the length of a bond as it came, or as its atoms have been moved.
    template <bool moved, bool find>
    HOL_FORCED V measure(Row &row, int32_t from, int32_t to, Errors &errors) const {
        Vector3<V> d = row.D;
        if (moved) d = d + (moves[to] - moves[from]);
        if (moved && find) row.new_D = d;
        return length_error(row, d, errors);
    }

    // From atom to atom: the bonds, what is left of their lengths and, with `find`, new factors, by which that is
    // substituted forward. Returns the largest error.
    template <bool moved, bool find, bool all>
    __attribute__((noinline)) V sweep(MaskOf<V> which) {
        if (moved) find_moves();
        const int32_t n = x.s.n_atoms;
        const V one = Width<V>::all(1);
        Errors errors = {};
        // Atom 0 has no bonds that end there or pass by: their pivots are 1, and they are coupled to nothing.
        Left left = {{one}, {V{}, one}, {V{}, V{}, one}};
        V y[strip_bonds] = {}, next_y = {};
        y[begin_short] = measure<moved, find>(x.row[0], 0, 1, errors);
        for (int32_t i = 0; i < n; ++i) {
            Row *const row = x.row + first_place_at(i);
            y[begin_long] = next_y = V{};
            if (__builtin_expect(i + 2 < n, 1)) {
                y[begin_long] = measure<moved, find>(row[begin_long], i, i + 2, errors);
                next_y = measure<moved, find>(row[begin_long + 1], i + 1, i + 2, errors);
            }
            Factors &f = factors[i];
            if (find) eliminate_atom<moved, all>(x.w[i], row, left, f, which);
            f.up.forward(y);
            row[end_long].t = y[end_long] * f.r[0];
            row[end_short].t = y[end_short] * f.r[1];
            to_next_atom(y, next_y);
        }
        return errors.largest(y[end_short]);
    }

    V open() { return sweep<false, true, true>(Width<V>::none()); }
    void first_factors() {}  // they are there already
    V move() { return sweep<true, false, true>(Width<V>::none()); }

    // New factors for the bonds as moved, in the lanes of `which`.
    void factorize(MaskOf<V> which) {
        if (bits(which) == (1u << Width<V>::lanes) - 1)
            sweep<true, true, true>(which);
        else
            sweep<true, true, false>(which);
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
        V t[strip_bonds] = {};
        for (int32_t i = x.s.n_atoms - 1; i >= 0; --i) {
            Row *const row = x.row + first_place_at(i);
            t[end_long] = row[end_long].t;
            t[end_short] = row[end_short].t;
            factors[i].down.back(t);
            HOL_UNROLL
            for (int e = 0; e < passing; ++e) row[e].tau = row[e].tau + (all ? t[e] : keep(active, t[e]));
            to_atom_before(t);
        }
    }

    // tau = 0 in the lanes of `which`.
    void forget(MaskOf<V> which) {
        for (int32_t k = 0; k < x.s.n_bonds; ++k) x.row[k].tau = select(which, V{}, x.row[k].tau);
    }
};

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
