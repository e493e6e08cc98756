#include "core/molecules/planned/ldl_plan.hpp"

#include <algorithm>

#include "core/molecules/planned/elimination_order.hpp"
#include "core/molecules/planned/ldl_order.hpp"

namespace holonomic {

namespace {

using Rows = std::vector<Numbers>;
using Tile = LdlPlan::Tile;

template <class T>
std::int32_t size_of(const std::vector<T> &list) {
    return static_cast<std::int32_t>(list.size());
}
void pad(Numbers &list, std::int32_t inert) {
    list.resize(static_cast<std::size_t>(in_fours(static_cast<std::int64_t>(list.size()))), inert);
}

class LdlPlanMaker {
public:
    LdlPlanMaker(const EliminationPlan &s, LdlArrays &a) : s_(s), a_(a) {}

    void make() {
        const Numbers order = bonds_from_the_leaves(s_);
        a_.bond_of = order;
        const Fill leaves_first = fill_of(neighbours_of(bonds_of_atoms(), s_.n_bonds));
        const ListOrder made = order_of_list(leaves_first);
        for (std::int32_t p = 0; p < s_.n_bonds; ++p) a_.bond_of[at(p)] = order[at(made.column[at(p)])];
        Fill fill = in_order(leaves_first, made.column);
        start_ = std::move(fill.column_start);
        row_ = std::move(fill.row);
        bonds_ = bonds_of_atoms();
        open_subtrees(made.subtree_end);
        for (Tile &t : a_.tile) list_bonds(t);
        list_homes();
        for (Tile &t : a_.tile) list_entries(t);
        side_of_.assign(at(a_.list.n_entries), -1);
        for (Tile &t : a_.tile) list_updates(t);
        list_sides();
        close();
    }

private:
    Lists bonds_of_atoms() const {
        return invert(s_.n_atoms, s_.n_bonds, [&](std::int32_t p, int end) { return end_of(p, end); });
    }
    // An atom of column p.
    std::int32_t end_of(std::int32_t p, int end) const {
        const std::int32_t k = a_.bond_of[at(p)];
        return (end ? s_.atom_j : s_.atom_i)[k];
    }
    // Where an entry is.
    std::int32_t entry(std::int32_t row, std::int32_t column) const {
        const auto begin = row_.begin();
        const std::int32_t e = static_cast<std::int32_t>(
            std::lower_bound(begin + start_[at(column)], begin + start_[at(column) + 1], row) - begin);
        const Tile &t = a_.tile[at(tile_of_[at(column)])];
        return t.first_entry + e - start_[at(t.first)];
    }

    // Subtrees and the separator behind them, and their tiles.
    void open_subtrees(const Numbers &subtree_end) {
        std::int32_t first = 0;
        for (const std::int32_t end : subtree_end) first = open_tiles(first, end);
        open_tiles(first, s_.n_bonds);
        a_.list.n_columns = static_cast<std::int32_t>(in_fours(s_.n_bonds));
        a_.place_of.assign(at(s_.n_atoms), -1);
        number_.assign(at(s_.n_atoms), -1);
        side_of_.assign(at(s_.n_bonds), -1);
        row_of_.assign(at(s_.n_bonds), -1);
    }

    std::int32_t open_tiles(std::int32_t first, std::int32_t end) {
        const std::int32_t n = (end - first + LdlPlan::columns_of_tile - 1) / LdlPlan::columns_of_tile,
                           begin = size_of(a_.tile);
        for (std::int32_t i = 0; i < n; ++i) {
            Tile t = {};
            t.first = first;
            t.end = first = i + 1 < n ? first + static_cast<std::int32_t>(in_fours((end - first) / (n - i))) : end;
            t.first_entry = a_.list.n_entries;
            t.end_entry = t.first_entry + start_[at(t.end)] - start_[at(t.first)];
            a_.list.n_entries = static_cast<std::int32_t>(in_fours(t.end_entry));
            tile_of_.insert(tile_of_.end(), at(t.end - t.first), size_of(a_.tile));
            a_.tile.push_back(t);
        }
        a_.subtree.push_back({begin, size_of(a_.tile)});
        return end;
    }

    // The atoms and bonds of a tile: its own in the order of memory, then ghosts.
    void list_bonds(Tile &t) {
        Numbers bonds, own, ghosts;
        for (std::int32_t p = t.first; p < t.end; ++p) bonds.push_back(p);
        for (std::int32_t p = t.first; p < t.end; ++p)
            for (int end = 0; end < 2; ++end) {
                const std::int32_t i = end_of(p, end);
                if (number_[at(i)] >= 0) continue;
                number_[at(i)] = 0;
                (a_.place_of[at(i)] < 0 ? own : ghosts).push_back(i);
                for (const std::int32_t *q = bonds_.begin(i); q != bonds_.end(i); ++q)
                    if (*q >= t.end) bonds.push_back(*q);
            }
        const auto extra = bonds.begin() + (t.end - t.first);
        std::sort(extra, bonds.end());
        bonds.erase(std::unique(extra, bonds.end()), bonds.end());
        t.first_row = size_of(a_.from);
        const std::size_t visiting = ghosts.size();
        for (std::size_t b = at(t.end - t.first); b < bonds.size(); ++b)
            for (int end = 0; end < 2; ++end) {
                const std::int32_t i = end_of(bonds[b], end);
                if (number_[at(i)] >= 0) continue;
                number_[at(i)] = 0;
                ghosts.push_back(i);
            }
        std::sort(own.begin(), own.end());
        std::sort(ghosts.begin(), ghosts.begin() + static_cast<std::ptrdiff_t>(visiting));
        t.first_site = size_of(a_.atom_of);
        t.own_end = t.first_site + size_of(own);
        for (const std::int32_t i : own) a_.place_of[at(i)] = add_site(t, i);
        for (const std::int32_t i : ghosts) add_site(t, i);
        t.end_site = size_of(a_.atom_of);
        visiting_.push_back(size_of(own) + static_cast<std::int32_t>(visiting));
        for (std::size_t b = 0; b < bonds.size(); ++b) {
            if (b == at(t.end - t.first)) pad(a_.from, 0), pad(a_.to, 0);
            a_.from.push_back(4 * number_[at(end_of(bonds[b], 0))]);
            a_.to.push_back(4 * number_[at(end_of(bonds[b], 1))]);
        }
        pad(a_.from, 0), pad(a_.to, 0);
        t.end_row = size_of(a_.from);
        extra_.emplace_back(extra, bonds.end());
        for (std::int32_t site = t.first_site; site < t.end_site; ++site) number_[at(a_.atom_of[at(site)])] = -1;
        a_.list.most_sites = std::max(a_.list.most_sites, t.end_site - t.first_site);
        a_.list.most_rows = std::max(a_.list.most_rows, t.end_row - t.first_row);
        a_.list.most_columns = std::max(a_.list.most_columns, t.end - t.first);
    }
    std::int32_t add_site(const Tile &t, std::int32_t atom) {
        const std::int32_t site = size_of(a_.atom_of);
        number_[at(atom)] = site - t.first_site;
        a_.atom_of.push_back(atom);
        return site;
    }

    void list_homes() {
        for (const std::int32_t i : a_.atom_of) a_.home.push_back(a_.place_of[at(i)]);
        std::vector<std::vector<LdlPlan::Visit>> visits(a_.tile.size());
        for (std::size_t n = 0; n < a_.tile.size(); ++n)
            for (std::int32_t site = a_.tile[n].own_end; site < a_.tile[n].first_site + visiting_[n]; ++site) {
                std::size_t host = n;  // a tile before
                while (a_.home[at(site)] < a_.tile[host].first_site) --host;
                visits[host].push_back({a_.home[at(site)], site});
            }
        for (std::size_t n = 0; n < a_.tile.size(); ++n) {
            a_.tile[n].first_visit = size_of(a_.visit);
            a_.visit.insert(a_.visit.end(), visits[n].begin(), visits[n].end());
            a_.tile[n].end_visit = size_of(a_.visit);
        }
    }

    // Where a tile with these sides from `first` on gives to a column or an entry of a later one.
    static std::int32_t side_of(std::int32_t number, std::int32_t first, std::int32_t &n, Numbers &sides,
                                std::vector<LdlPlan::Late> &late) {
        std::int32_t &side = sides[at(number)];
        if (side < first) late.push_back({number, side = n++});
        return side;
    }

    void list_entries(Tile &t) {
        const std::vector<std::int32_t> &extra = extra_[at(tile_of_[at(t.first)])];
        const std::int32_t own_rows = static_cast<std::int32_t>(in_fours(t.end - t.first)),
                           none = 2 * (t.end_site - t.first_site);
        for (std::size_t b = 0; b < extra.size(); ++b) row_of_[at(extra[b])] = own_rows + static_cast<std::int32_t>(b);
        const auto row_of = [&](std::int32_t p) { return p < t.end ? p - t.first : row_of_[at(p)]; };
        const std::int32_t first_side = a_.list.n_columns;
        t.first_run = size_of(a_.run);
        for (std::int32_t p = t.first; p < t.end; ++p) {
            const std::int32_t n = start_[at(p) + 1] - start_[at(p)];
            if (size_of(a_.run) == t.first_run || a_.run.back().entries != n) a_.run.push_back({0, n});
            ++a_.run.back().columns;
            for (std::int32_t e = start_[at(p)]; e < start_[at(p) + 1]; ++e) {
                const std::int32_t q = row_[at(e)], shared = shared_atom(p, q);
                a_.row.push_back(q < t.end ? q : side_of(q, first_side, a_.list.n_columns, side_of_, a_.late));
                a_.row_4.push_back(shared < 0 ? 0 : 4 * row_of(q));
                a_.column_4.push_back(4 * (p - t.first));
                a_.mass.push_back(shared < 0 ? none
                                             : 2 * number_in(t, p, shared) +
                                                   ((end_of(p, 1) == shared) == (end_of(q, 1) == shared) ? 1 : 0));
            }
        }
        t.end_run = size_of(a_.run);
        for (Numbers *list : {&a_.row, &a_.row_4, &a_.column_4}) pad(*list, 0);
        pad(a_.mass, none);
        for (const std::int32_t q : extra) row_of_[at(q)] = -1;
    }
    std::int32_t shared_atom(std::int32_t p, std::int32_t q) const {
        for (int a = 0; a < 2; ++a)
            for (int b = 0; b < 2; ++b)
                if (end_of(p, a) == end_of(q, b)) return end_of(p, a);
        return -1;
    }
    // The number in a tile of an atom of its column p.
    std::int32_t number_in(const Tile &t, std::int32_t p, std::int32_t atom) const {
        const std::size_t row = at(t.first_row + p - t.first);
        return (end_of(p, 0) == atom ? a_.from : a_.to)[row] / 4;
    }

    void list_updates(Tile &t) {
        const std::int32_t first_side = a_.list.n_entries;
        t.first_update = static_cast<std::int64_t>(a_.update.size());
        for (std::int32_t p = t.first; p < t.end; ++p) {
            const std::int32_t first = start_[at(p)], end = start_[at(p) + 1];
            for (std::int32_t i = first; i < end; ++i)
                for (std::int32_t j = first; j < i; ++j) {
                    const std::int32_t e = entry(row_[at(i)], row_[at(j)]);
                    a_.update.push_back(
                        row_[at(j)] < t.end ? e : side_of(e, first_side, a_.list.n_entries, side_of_, a_.late_entry));
                }
        }
    }
    // Late columns and entries of all tiles, in their order, and columns of which not all is known in their tile.
    void list_sides() {
        const auto before = [](const LdlPlan::Late &a, const LdlPlan::Late &b) { return a.number < b.number; };
        std::stable_sort(a_.late.begin(), a_.late.end(), before);
        std::stable_sort(a_.late_entry.begin(), a_.late_entry.end(), before);
        std::int32_t late = 0, entry = 0;
        for (Tile &t : a_.tile) {
            t.first_late = late;
            t.first_late_entry = entry;
            t.first_outer = size_of(a_.outer);
            for (std::int32_t p = t.first; p < t.end; ++p) {
                const std::int32_t first = late;
                while (late < size_of(a_.late) && a_.late[at(late)].number == p) ++late;
                bool outer = late > first;
                for (int end = 0; end < 2; ++end) outer = outer || a_.place_of[at(end_of(p, end))] < t.first_site;
                if (outer) a_.outer.push_back(p);
            }
            while (entry < size_of(a_.late_entry) && a_.late_entry[at(entry)].number < t.end_entry) ++entry;
            t.end_late = late;
            t.end_late_entry = entry;
            t.end_outer = size_of(a_.outer);
        }
    }

    void close() {
        LdlPlan &l = a_.list;
        l.n_atoms = s_.n_atoms;
        l.n_bonds = s_.n_bonds;
        l.n_sites = size_of(a_.atom_of);
        l.n_rows = size_of(a_.from);
        l.n_tiles = size_of(a_.tile);
        l.n_subtrees = size_of(a_.subtree) - 1;
        pad(a_.bond_of, 0);
        l.tile = a_.tile.data();
        l.subtree = a_.subtree.data();
        l.atom_of = a_.atom_of.data();
        l.home = a_.home.data();
        l.place_of = a_.place_of.data();
        l.bond_of = a_.bond_of.data();
        l.from = a_.from.data();
        l.to = a_.to.data();
        l.run = a_.run.data();
        l.row = a_.row.data();
        l.row_4 = a_.row_4.data();
        l.column_4 = a_.column_4.data();
        l.mass = a_.mass.data();
        l.update = a_.update.data();
        l.late = a_.late.data();
        l.late_entry = a_.late_entry.data();
        l.visit = a_.visit.data();
        l.outer = a_.outer.data();
    }

    const EliminationPlan &s_;
    LdlArrays &a_;
    Numbers start_, row_;  // of the factor's columns
    Lists bonds_;          // columns of an atom
    Rows extra_;           // columns that are a tile's extra bonds
    Numbers number_;       // of an atom in the tile that is listed
    Numbers visiting_;     // by tile, its atoms that its own bonds have
    Numbers tile_of_;      // of a column
    Numbers side_of_;      // the last one of a column, then of an entry
    Numbers row_of_;       // of a column among a tile's extra bonds
};

}  // namespace

void make_ldl_plan(const EliminationPlan &s, LdlArrays &arrays) { LdlPlanMaker(s, arrays).make(); }

}  // namespace holonomic
