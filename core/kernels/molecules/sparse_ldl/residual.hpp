// What the multipliers leave of the equation of a single bond of one molecule, in twice the precision. The bound of
// error_bound.hpp is for the worst case: of a million bonds some miss it by little, whose equations are solved all the
// same.
#pragma once

#include <cstddef>

#include "core/kernels/atom.hpp"
#include "core/kernels/molecules/sparse_ldl/linear.hpp"
#include "core/kernels/molecules/twice.hpp"

namespace holonomic::HOL_ISA::graph {

template <class V>
class LdlResidual {
public:
    explicit LdlResidual(const LdlLinear<V> &linear) : x(linear), s(linear.s) {}

    // Prepares for so many columns of a tile, column(i): lists the bonds of their atoms.
    template <class Column>
    void prepare(const Tile &tile, int32_t n, const Column &column) {
        listed = &tile;
        __builtin_memset(wanted(), 0, static_cast<size_t>(tile.end_site - tile.first_site));
        for (int32_t i = 0; i < n; ++i) {
            const int32_t row = tile.first_row + (column(i) - tile.first);
            wanted()[s.from[row] / 4] = wanted()[s.to[row] / 4] = 1;
        }
        list(tile);
    }
    // Of column k of a tile, once the multipliers of all bonds of its two atoms are known.
    __attribute__((noinline)) double of(const Tile &tile, int32_t k, int of_lane) {
        lane = of_lane;
        const int32_t row = tile.first_row + (k - tile.first),
                      site[2] = {tile.first_site + s.from[row] / 4, tile.first_site + s.to[row] / 4};
        Pair3<double> a[2];
        Vector3<double> v[2] = {};
        for (int e = 0; e < 2; ++e) {
            const int64_t number = x.at.number(lane, s.atom_of[site[e]]);
            Vector3<double> f = {};
            if (x.in.v && x.in.v->x) read_atom(*x.in.v, number, &v[e].x);
            if (x.in.f && x.in.f->x) read_atom(*x.in.f, number, &f.x);
            a[e] = pulls_at(tile, site[e], pairs_of(f, Vector3<double>{}));
            a[e] = scale_pairs(x.lane[lane].w[s.atom_of[site[e]]], a[e]);
            if (x.in.rates) a[e] = add_pairs(a[e], pairs_of(v[e], Vector3<double>{}));
        }
        Pair<double> sum = dot_pairs(bond(site[0], site[1]), subtract_pairs(a[1], a[0]));
        if (x.terms & squares) {
            const Pair3<double> dv = difference_of(v[0], v[1]);
            sum = add_pairs(sum, dot_pairs(dv, dv));
        }
        if (x.in.rhs || x.in.strain) sum = add_pairs(sum, Pair<double>{Width<V>::get(x.given_to(tile, k), lane), 0});
        return sum.hi + sum.lo;
    }

private:
    const LdlLinear<V> &x;
    const LdlPlan &s;
    int lane = 0;
    const Tile *listed = nullptr;  // bonds of whose wanted atoms are listed, in x.bonds_at

    Pair3<double> bond(int32_t from, int32_t to) const {
        Vector3<double> r[2] = {}, d = {}, low = {};
        read_atom(x.coordinates, x.at.number(lane, s.atom_of[from]), &r[0].x);
        read_atom(x.coordinates, x.at.number(lane, s.atom_of[to]), &r[1].x);
        unrounded_bond(x.box, r[0], r[1], d, low);
        return pairs_of(d, low);
    }
    // What the bond of a column pulls its first atom by, or its second one.
    Pair3<double> pull(const Tile &tile, int32_t k, bool second) const {
        const int32_t row = tile.first_row + (k - tile.first);
        const Pair3<double> d = bond(tile.first_site + s.from[row] / 4, tile.first_site + s.to[row] / 4);
        const double t = Width<V>::get(x.t[k], lane);
        return scale_pairs(second ? -t : t, d);
    }

    // Of a tile's atoms: which are wanted. The bonds of these: columns. Then by atoms: where each atom's begin, and
    // twice their columns, and one more at the second atom.
    unsigned char *wanted() const { return reinterpret_cast<unsigned char *>(x.bonds_at); }
    int32_t *columns() const { return x.bonds_at + in_fours(s.most_sites); }
    int32_t *starts() const { return columns() + in_fours(s.most_columns); }
    int32_t *items() const { return starts() + in_fours(s.most_sites + 2); }
    void list(const Tile &tile) {
        const int32_t *const from = s.from + (tile.first_row - tile.first), *const to = s.to + (from - s.from);
        int32_t *const start = starts(), *const item = items(), *const column = columns();
        const int32_t n = tile.end_site - tile.first_site;
        int32_t found = 0;
        for (int32_t k = tile.first; k < tile.end; ++k) {
            column[found] = k;
            found += wanted()[from[k] / 4] | wanted()[to[k] / 4];
        }
        for (int32_t i = 0; i < n + 2; ++i) start[i] = 0;
        const auto for_ends = [&](const auto &body) {
            for (int32_t i = 0; i < found; ++i) {
                body(from[column[i]] / 4, 2 * column[i]);
                body(to[column[i]] / 4, 2 * column[i] + 1);
            }
        };
        for_ends([&](int32_t site, int32_t) { ++start[site + 2]; });
        for (int32_t i = 2; i < n + 2; ++i) start[i] += start[i - 1];
        for_ends([&](int32_t site, int32_t end) { item[start[site + 1]++] = end; });
    }
    // Adds the pulls of a tile's bonds on one of its sites: in the order of these, listed or not.
    Pair3<double> add(const Tile &tile, int32_t site, Pair3<double> sum) {
        const int32_t i = site - tile.first_site, *const item = items();
        const auto add_end = [&](int32_t k, bool second) { sum = add_pairs(sum, pull(tile, k, second)); };
        if (listed == &tile && wanted()[i]) {
            for (int32_t e = starts()[i]; e < starts()[i + 1]; ++e) add_end(item[e] / 2, (item[e] & 1) != 0);
            return sum;
        }
        const int32_t *const from = s.from + (tile.first_row - tile.first), *const to = s.to + (from - s.from);
        for (int32_t k = tile.first; k < tile.end; ++k) {
            if (from[k] == 4 * i) add_end(k, false);
            if (to[k] == 4 * i) add_end(k, true);
        }
        return sum;
    }
    // Of all bonds of an atom, in whatever tiles these are.
    Pair3<double> pulls_at(const Tile &tile, int32_t site, Pair3<double> sum) {
        sum = add(tile, site, sum);
        const int32_t home = s.home[site];
        const Tile &own = *tile_of_site(home);
        if (home != site) sum = add(own, home, sum);
        for (int32_t i = own.first_visit; i < own.end_visit; ++i)
            if (s.visit[i].own == home && s.visit[i].ghost != site)
                sum = add(*tile_of_site(s.visit[i].ghost), s.visit[i].ghost, sum);
        return sum;
    }
    const Tile *tile_of_site(int32_t site) const {
        const Tile *tile = s.tile;
        while (site >= tile->end_site) ++tile;
        return tile;
    }
};

}  // namespace holonomic::HOL_ISA::graph
