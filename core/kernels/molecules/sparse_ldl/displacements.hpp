// The bonds of molecules by sparse LDL^T at the position level (core/plan/sparse_ldl.hpp), what is left of their
// lengths, and what multipliers displace their atoms by. Of one molecule (V = double) bonds are found four at a time; W
// are in lanes.
#pragma once

#include "core/kernels/molecules/scratch.hpp"
#include "core/kernels/molecules/sparse_ldl/tiles.hpp"

namespace holonomic::HOL_ISA::graph {

// The largest error of bonds.
template <class V>
struct LdlErrors {
    Columns<V> worst, sum;  // max() may lose a NaN, the sum keeps it
    void add(const LdlErrors &other) {
        worst = larger(other.worst, worst);
        sum = sum + other.sum;
    }
    V largest() const { return largest_of<V>(worst) + V{} * sum_of_columns<V>(sum); }
};

// What is found of a tile: also the largest coordinate and inverse mass, the shortest and the longest bond, and the
// largest pull.
template <class V>
struct LdlFound {
    LdlErrors<V> errors;
    RowOf<V> coordinate;
    Columns<V> least, most;
    V w, pull;
};

template <class V>
struct LdlDisplacements {
    typedef RowOf<V> Row;
    typedef LdlErrors<V> Errors;
    static constexpr int step = at_once<V>;
    const LdlPlan &s;
    const LongTeam *const team;  // or nullptr
    double *const own;    // memory of this thread, for rows of one tile: coordinates, then bonds as moved; masses
    LdlFound<V> *found;   // [n_tiles]
    V *w;                 // inverse masses
    Rows<V> moves, D, b;  // of all tiles
    V *tau, *t;           // t: what is left of a length, then its correction
    V *a2, *per_a2;
    V *stretch;      // |D| / a of the bonds that the factors were made of
    V opening;       // the error of the bonds as they came
    bool displaced;  // `moves` are those of tau
    bool moved;      // the bonds are not D any more

    static constexpr int64_t found_values = sizeof(LdlFound<V>) / sizeof(V);
    static int64_t rows_of_tile(const LdlPlan &s) { return s.most_rows > s.most_sites ? s.most_rows : s.most_sites; }
    static int64_t tile_values(const LdlPlan &s) { return 4 * rows_of_tile(s) + most_masses(s); }
    // Where a thread has the masses of its tile.
    V *masses_beside(const Rows<V> &rows) const { return rows.start + 4 * rows_of_tile(s); }
    static int64_t values(const LdlPlan &s) {
        return in_fours(s.n_sites) + tile_values(s) + 4 * static_cast<int64_t>(s.n_sites) +
               8 * static_cast<int64_t>(s.n_rows) + found_values * static_cast<int64_t>(s.n_tiles) +
               4 * in_fours(s.n_bonds) + in_fours(s.n_columns);
    }
    LdlDisplacements(const LdlPlan &list, const LongTeam *threads, Memory<V> &memory)
        : s(list), team(list.n_subtrees > 0 ? threads : nullptr), own(memory.next), opening(), displaced(false),
          moved(false) {
        memory.values(tile_values(s));
        moves = {memory.values(4 * static_cast<int64_t>(s.n_sites))};
        D = {memory.values(4 * static_cast<int64_t>(s.n_rows))};
        b = {memory.values(4 * static_cast<int64_t>(s.n_rows))};
        found = reinterpret_cast<LdlFound<V> *>(memory.values(found_values * static_cast<int64_t>(s.n_tiles)));
        t = memory.values(in_fours(s.n_columns));
        tau = memory.values(in_fours(s.n_bonds));
        a2 = memory.values(in_fours(s.n_bonds));
        per_a2 = memory.values(in_fours(s.n_bonds));
        stretch = memory.values(in_fours(s.n_bonds));
        w = memory.values(in_fours(s.n_sites));
    }

    HOL_FORCED Columns<V> &some(V *values, int64_t k) const { return *reinterpret_cast<Columns<V> *>(values + k); }

    // Calls body(tile, rows of this thread) for all tiles, up or down the subtrees.
    template <class Body>
    HOL_FORCED void up(const Body &body) const {
        subtrees_up(
            s, team, own, [&](const Subtree &subtree, double *of_thread) __attribute__((noinline)) {
                const Rows<V> rows = {reinterpret_cast<V *>(of_thread)};
                for_tiles_up(s, subtree, [&](const Tile &tile) HOL_FORCED { body(tile, rows); });
            });
    }
    template <class Body>
    HOL_FORCED void down(const Body &body) const {
        subtrees_down(
            s, team, own, [&](const Subtree &subtree, double *) __attribute__((noinline)) {
                for_tiles_down(s, subtree, [&](const Tile &tile) HOL_FORCED { body(tile); });
            });
    }
    V largest_error() const {
        Errors all = {};
        for (int32_t i = 0; i < s.n_tiles; ++i) all.add(found[i].errors);
        return all.largest();
    }

    // D.D - a^2 of bonds k ..
    HOL_FORCED Columns<V> excess_of(int64_t k, const Row (&d)[step]) const {
        const Turned<V> at = turned(d);
        return multiply_add(at.z, at.z, multiply_add(at.y, at.y, multiply_add(at.x, at.x, -some(a2, k))));
    }
    // What is left of their lengths. Not of their squares: a change of |D|, which is D/|D| . dD, is nearly what it was
    // when the factors were made, as bonds are stretched more than they turn; that of D.D grows with |D|. So with the
    // factors of D_0, of which row k is D_0 . dD, |D_0| (|D| - a). `fresh`: the factors will be those of this D.
    template <bool fresh>
    HOL_FORCED void measure(int64_t k, const Row (&d)[step], Errors &errors) const {
        const auto all = [](double value) HOL_FORCED { return all_columns<V>(value); };
        const Columns<V> sigma = excess_of(k, d), excess = sigma * some(per_a2, k);
        errors.worst = larger(absolute(excess), errors.worst);
        errors.sum = errors.sum + sigma;
        if (fresh) {
            const Columns<V> root = root_of(all(1) + excess);
            some(stretch, k) = root;
            some(t, k) = sigma * (root / (all(1) + root));
        } else {  // 2 (sqrt(1 + e) - 1) / e
            const Columns<V> e = smaller(larger(excess, all(-0.5)), all(0.5));
            some(t, k) = (all(0.5) * some(stretch, k)) *
                         (sigma * multiply_add(e, multiply_add(all(0.125), e, all(-0.25)), all(1)));
        }
    }
    // What is left of a tile's bonds d.
    template <bool fresh>
    Errors measure_tile(const Tile &tile, const Rows<V> &d) const {
        Errors errors = {};
        for (int64_t k = tile.first; k < tile.end; k += step) {
            Row one[step];
            HOL_UNROLL
            for (int i = 0; i < step; ++i) one[i] = d[k - tile.first + i];
            measure<fresh>(k, one, errors);
        }
        return errors;
    }

    V open() const { return opening; }
    void forget(MaskOf<V> which) {
        if (!any(which)) return;
        for (int64_t k = 0; k < in_fours(s.n_bonds); ++k) tau[k] = select(which, V{}, tau[k]);
        displaced = false;
    }

    // Bond `row` of a tile as moved.
    HOL_FORCED Row moved_bond(const Tile &tile, int64_t row) const {
        const Rows<V> of = moves.from(tile.first_site);
        return D[row] + (of.at_four_times(s.to[row]) - of.at_four_times(s.from[row]));
    }
    // |D.D - a^2| / a^2 of a tile's bond as it is, in the digits of measure().
    V error_of(const Tile &tile, int64_t k) const {
        const int64_t row = tile.first_row + k - tile.first;
        const Vector3<V> d = vector_of(moved ? moved_bond(tile, row) : D[row]);
        return abs(mul_add(d.z, d.z, mul_add(d.y, d.y, mul_add(d.x, d.x, -a2[k]))) * per_a2[k]);
    }

    // The lanes in which no bond has turned from the reference by a larger angle than one that is moved straight across
    // until |D.D - a^2| / a^2 is `far`.
    __attribute__((noinline)) MaskOf<V> turned_little(double far) const {
        up([&](const Tile &tile, const Rows<V> &) HOL_FORCED {
            Columns<V> least = all_columns<V>(0);
            for (int64_t k = tile.first; k < tile.end; k += step) {
                const int64_t row = tile.first_row + k - tile.first;
                Row d[step], ref[step];
                HOL_UNROLL
                for (int i = 0; i < step; ++i) {
                    d[i] = moved_bond(tile, row + i);
                    ref[i] = b[row + i];
                }
                const Turned<V> now = turned(d), before = turned(ref);
                const auto dot = [](const Turned<V> &x, const Turned<V> &y)
                                     HOL_FORCED { return multiply_add(x.z, y.z, multiply_add(x.y, y.y, x.x * y.x)); };
                const Columns<V> along = dot(now, before), whole = some(a2, k) * dot(before, before);
                least = smaller(all_columns<V>(1 + far) * (along * absolute(along)) - whole, least);
            }
            found[&tile - s.tile].pull = smallest_of<V>(least);
        });
        V least = {};
        for (int32_t i = 0; i < s.n_tiles; ++i) least = min(found[i].pull, least);
        return less_equal(V{}, least);
    }

    // Displacements by the bonds of a tile, and of its atoms by all: times w only in the end.
    HOL_FORCED void pull(const Tile &tile) const {
        sum_pulls(s, tile, tau, b.from(tile.first_row), moves.from(tile.first_site));
    }
    HOL_FORCED void weigh(const Tile &tile) const {
        const Rows<V> of = moves.from(tile.first_site);
        const V *const of_site = w + tile.first_site;
        add_visits(s, tile, moves, moves);
        for (int64_t i = 0; i < tile.own_end - tile.first_site; ++i) of[i] = in_row(of_site[i]) * of[i];
    }
    __attribute__((noinline)) void displace() {
        if (displaced) return;
        displaced = true;
        down([&](const Tile &tile) {
            pull(tile);
            weigh(tile);
        });
    }
    // Bonds as moved, and what is left of them.
    __attribute__((noinline)) V move() {
        displace();
        up([&](const Tile &tile, const Rows<V> &) HOL_FORCED { measure_inner(tile); });
        return finish_move();
    }
    // Of the bonds of a tile's own atoms, in groups of `step`; the others, once all atoms have been moved.
    __attribute__((noinline)) void measure_inner(const Tile &tile) const {
        Errors errors = {};
        int64_t k = tile.first;
        for (int32_t i = tile.first_outer; i < tile.end_outer; ++i) {
            const int64_t group = s.outer[i] / step * step;
            for (; k < group; k += step) measure_moved(tile, k, errors);
            if (k == group) k += step;
        }
        for (; k < tile.end; k += step) measure_moved(tile, k, errors);
        found[&tile - s.tile].errors = errors;
    }
    V finish_move() {
        moved = true;
        if (s.n_tiles > 1) up([&](const Tile &tile, const Rows<V> &) HOL_FORCED { measure_outer(tile); });
        return largest_error();
    }
    void measure_outer(const Tile &tile) const {
        copy_ghosts(s, tile, moves);
        Errors &errors = found[&tile - s.tile].errors;
        int64_t next = tile.first;
        for (int32_t i = tile.first_outer; i < tile.end_outer; ++i) {
            const int64_t group = s.outer[i] / step * step;
            if (group >= next) measure_moved(tile, group, errors);
            next = group + step;
        }
    }
    HOL_FORCED void measure_moved(const Tile &tile, int64_t k, Errors &errors) const {
        Row d[step];
        HOL_UNROLL
        for (int i = 0; i < step; ++i) d[i] = moved_bond(tile, k + (tile.first_row - tile.first) + i);
        measure<false>(k, d, errors);
    }
};

}  // namespace holonomic::HOL_ISA::graph
