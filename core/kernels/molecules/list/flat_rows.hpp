// Vectors in space of one molecule as rows of four doubles, x y z and one more, whatever the lanes are: x, y and z are
// done at once, and four rows are turned into lanes of four where a number of each is wanted.
#pragma once

#include "core/kernels/isa/choose.hpp"
#include "core/kernels/molecules/atoms/atoms.hpp"
#include "core/kernels/molecules/image.hpp"
#include "core/kernels/molecules/list/flat_list.hpp"

namespace holonomic::HOL_ISA::graph {

typedef double Row __attribute__((vector_size(32)));
typedef long long RowBits __attribute__((vector_size(32)));

struct Rows {
    double *start;  // [n][4], aligned to 32
    HOL_FORCED Row &operator[](int64_t k) const { return *reinterpret_cast<Row *>(start + 4 * k); }
    HOL_FORCED Row &at_four_times(int32_t k) const { return *reinterpret_cast<Row *>(start + k); }
};

HOL_INLINE Row in_row(double a) { return Row{a, a, a, a}; }
HOL_INLINE Row row_of(const Vector3<double> &a) { return Row{a.x, a.y, a.z, 0}; }
HOL_INLINE Vector3<double> vector_of(const Row &a) { return {a[0], a[1], a[2]}; }
HOL_INLINE Row absolute(const Row &a) {
    return reinterpret_cast<Row>(reinterpret_cast<RowBits>(a) & (RowBits{} + 0x7fffffffffffffffLL));
}

// a b + c, in one rounding or two as mul_add().
HOL_INLINE Row multiply_add(const Row &a, const Row &b, const Row &c) {
#if defined(__AVX2__) && HOL_HAS_FMA
    return _mm256_fmadd_pd(a, b, c);
#else
    return Row{mul_add(a[0], b[0], c[0]), mul_add(a[1], b[1], c[1]), mul_add(a[2], b[2], c[2]),
               mul_add(a[3], b[3], c[3])};
#endif
}
HOL_INLINE Row larger(const Row &a, const Row &b) {
#if defined(__AVX2__)
    return _mm256_max_pd(a, b);
#else
    return Row{max(a[0], b[0]), max(a[1], b[1]), max(a[2], b[2]), max(a[3], b[3])};
#endif
}
HOL_INLINE Row smaller(const Row &a, const Row &b) {
#if defined(__AVX2__)
    return _mm256_min_pd(a, b);
#else
    return Row{min(a[0], b[0]), min(a[1], b[1]), min(a[2], b[2]), min(a[3], b[3])};
#endif
}
HOL_INLINE Row root_of(const Row &a) {
#if defined(__AVX2__)
    return _mm256_sqrt_pd(a);
#else
    return Row{__builtin_sqrt(a[0]), __builtin_sqrt(a[1]), __builtin_sqrt(a[2]), __builtin_sqrt(a[3])};
#endif
}
HOL_INLINE double largest_of(const Row &a) { return max(max(a[0], a[1]), max(a[2], a[3])); }
HOL_INLINE double smallest_of(const Row &a) { return min(min(a[0], a[1]), min(a[2], a[3])); }

// The sums of the elements of four rows.
HOL_INLINE Row sums_of(const Row &a, const Row &b, const Row &c, const Row &d) {
#if defined(__AVX2__)
    const __m256d ab = _mm256_hadd_pd(a, b), cd = _mm256_hadd_pd(c, d);
    return _mm256_permute2f128_pd(ab, cd, 0x20) + _mm256_permute2f128_pd(ab, cd, 0x31);
#else
    return Row{(a[0] + a[1]) + (a[2] + a[3]), (b[0] + b[1]) + (b[2] + b[3]), (c[0] + c[1]) + (c[2] + c[3]),
               (d[0] + d[1]) + (d[2] + d[3])};
#endif
}

// Four rows turned into x, y, z of all of them.
struct Lanes3 {
    Row x, y, z;
};
HOL_INLINE Lanes3 turned(const Row &a, const Row &b, const Row &c, const Row &d) {
#if defined(__AVX2__)
    const __m256d xz = _mm256_unpacklo_pd(a, b), yw = _mm256_unpackhi_pd(a, b), xz2 = _mm256_unpacklo_pd(c, d),
                  yw2 = _mm256_unpackhi_pd(c, d);
    return {_mm256_permute2f128_pd(xz, xz2, 0x20), _mm256_permute2f128_pd(yw, yw2, 0x20),
            _mm256_permute2f128_pd(xz, xz2, 0x31)};
#else
    return {Row{a[0], b[0], c[0], d[0]}, Row{a[1], b[1], c[1], d[1]}, Row{a[2], b[2], c[2], d[2]}};
#endif
}
HOL_INLINE Row dots_of(const Lanes3 &a, const Lanes3 &b) {
    return multiply_add(a.z, b.z, multiply_add(a.y, b.y, a.x * b.x));
}

// Most columns have few entries: up to three are known to the compiler.
constexpr int32_t known_entries = 3;

typedef FlatList::Tile Tile;

// Calls body(k, first, n) for all columns of a tile, up or down; first is that of their entries, n is a constant where
// it is small.
template <class Body>
HOL_INLINE void for_columns_up(const FlatList &s, const Tile &tile, const Body &body) {
    int32_t k = tile.first, first = tile.first_entry;
    for (int32_t r = tile.first_run; r < tile.end_run; ++r) {
        const int32_t end = k + s.run[r].columns, entries = s.run[r].entries;
        choose_few<known_entries>(entries, [&](auto known) HOL_FORCED {
            const int32_t n = known > 0 ? known : entries;
            for (; k < end; ++k, first += n) body(k, first, n);
        });
    }
}
template <class Body>
HOL_INLINE void for_columns_down(const FlatList &s, const Tile &tile, const Body &body) {
    int32_t k = tile.end, first = tile.end_entry;
    for (int32_t r = tile.end_run; r-- > tile.first_run;) {
        const int32_t start = k - s.run[r].columns, entries = s.run[r].entries;
        choose_few<known_entries>(entries, [&](auto known) HOL_FORCED {
            const int32_t n = known > 0 ? known : entries;
            while (k > start) body(--k, first -= n, n);
        });
    }
}

// What tiles have given to columns of later ones: none so far; added to the columns of a tile; as the columns of a tile
// are now, for the tiles before.
HOL_INLINE void clear_sides(const FlatList &s, double *t) {
    for (int64_t k = in_fours(s.n_bonds); k < s.n_columns; ++k) t[k] = 0;
}
HOL_INLINE void add_sides(const FlatList &s, const Tile &tile, double *t) {
    for (int32_t i = tile.first_late; i < tile.end_late; ++i) t[s.late[i].number] += t[s.late[i].side];
}
HOL_INLINE void give_sides(const FlatList &s, const Tile &tile, double *t) {
    for (int32_t i = tile.first_late; i < tile.end_late; ++i) t[s.late[i].side] = t[s.late[i].number];
}
// The same of entries.
HOL_INLINE void clear_entries(const FlatList &s, double *lower) {
    const Tile &last = s.tile[s.n_tiles - 1];
    for (int64_t e = in_fours(last.end_entry); e < s.n_entries; ++e) lower[e] = 0;
}
HOL_INLINE void add_entries(const FlatList &s, const Tile &tile, double *lower) {
    for (int32_t i = tile.first_late_entry; i < tile.end_late_entry; ++i)
        lower[s.late_entry[i].number] += lower[s.late_entry[i].side];
}

// Another right-hand side, in t: up along the columns of a factor with a diagonal of ones, and down with the pivots and
// the factor above the diagonal, which is the same one where the matrix is symmetric.
HOL_INLINE void solve_up(const FlatList &s, const Tile &tile, const double *lower, double *t) {
    add_sides(s, tile, t);
    for_columns_up(s, tile, [&](int32_t k, int32_t first, int32_t n) HOL_FORCED {
        const int32_t *const row = s.row + first;
        const double *const l = lower + first, y = t[k];
        HOL_UNROLL_FEW
        for (int32_t e = 0; e < n; ++e) t[row[e]] = mul_add(-l[e], y, t[row[e]]);
    });
}
template <class Each>
HOL_INLINE void solve_down(const FlatList &s, const Tile &tile, const double *upper, const double *r, double *t,
                           const Each &each) {
    for_columns_down(s, tile, [&](int32_t k, int32_t first, int32_t n) HOL_FORCED {
        const int32_t *const row = s.row + first;
        const double *const u = upper + first;
        double x = t[k] * r[k];
        HOL_UNROLL_FEW
        for (int32_t e = n - 1; e >= 0; --e) x = mul_add(-u[e], t[row[e]], x);
        t[k] = x;
        each(k, x);
    });
    give_sides(s, tile, t);
}

// Of an atom of a tile, and of a guest the pull on it added to that on its atom.
HOL_INLINE void add_visits(const FlatList &s, const Tile &tile, const Rows &pull) {
    for (int32_t i = tile.first_visit; i < tile.end_visit; ++i)
        pull[s.visit[i].own] = pull[s.visit[i].own] + pull[s.visit[i].guest];
}
// Guests are as their atoms are.
HOL_INLINE void copy_guests(const FlatList &s, const Tile &tile, const Rows &x) {
    for (int32_t site = tile.own_end; site < tile.end_site; ++site) x[site] = x[s.home[site]];
}

HOL_INLINE Rows rows_from(const Rows &rows, int64_t first) { return {rows.start + 4 * first}; }

// A local atom's row.
HOL_INLINE Row read_row_of(const AtomArray &array, const Atoms<double> &at, int32_t i) {
#if defined(__AVX2__)
    if (at.layout != elements) {
        const double *const p = reinterpret_cast<const double *>(array.x) + 3 * at.number(0, i);
        return _mm256_maskload_pd(p, _mm256_set_epi64x(0, -1, -1, -1));
    }
#endif
    return row_of(read(array, at, i));
}
// The rows of a tile's atoms.
HOL_INLINE void read_atoms(const AtomArray &array, const Atoms<double> &at, const FlatList &s, const Tile &tile,
                           const Rows &to) {
    for (int32_t i = tile.first_site; i < tile.end_site; ++i) {
        if (at.layout != elements && i + rows_ahead < tile.end_site)
            fetch_row(array, 3 * at.number(0, s.atom_of[i + rows_ahead]));
        to[i - tile.first_site] = read_row_of(array, at, s.atom_of[i]);
    }
}
// Their masses, -w_0, w_0, -w_1, .. , 0.
HOL_INLINE void read_masses(const double *w, const FlatList &s, const Tile &tile, double *mass) {
    double *to = mass + tile.first_mass;
    for (int32_t i = tile.first_site; i < tile.end_site; ++i, to += 2) {
        if (i + rows_ahead < tile.end_site) __builtin_prefetch(w + s.atom_of[i + rows_ahead], 0, 2);
        const double one = w[s.atom_of[i]];
        to[0] = -one;
        to[1] = one;
    }
    *to = 0;
}
HOL_INLINE int64_t mass_values(const FlatList &s) { return in_fours(2 * static_cast<int64_t>(s.n_sites) + s.n_tiles); }

// A tile's bonds as they come, from the coordinates of their ends: four at a time, the inert ones too.
HOL_INLINE void find_bonds(const FlatList &s, const Tile &tile, const Box &box, const Rows &r, const Rows &d) {
    for (int64_t k = tile.first_row; k < tile.end_row; ++k)
        d[k] = r.at_four_times(s.to[k]) - r.at_four_times(s.from[k]);
    if (box.shape == Box::none) return;
    for (int64_t k = tile.first_row; k < tile.end_row; ++k) {
        Vector3<double> bond = vector_of(d[k]), unused = {};
        wrap<false>(box, bond, unused);
        d[k] = row_of(bond);
    }
}

}  // namespace holonomic::HOL_ISA::graph
