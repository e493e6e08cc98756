// The tiles of a list: columns in the order of elimination, the atoms at home in each tile, ghosts of those of others,
// and the bonds that a tile reads.
#include <algorithm>

#include "core/molecules/planned/elimination_order.hpp"
#include "core/molecules/planned/ldl_columns.hpp"
#include "core/molecules/planned/ldl_order.hpp"

namespace holonomic {

namespace {

using Tile = LdlPlan::Tile;

class TilesMaker {
public:
    TilesMaker(const EliminationPlan &s, Lists &&bonds, LdlArrays &a) : s_(s), a_(a), bonds_(std::move(bonds)) {}

    LdlColumns make(Numbers &&leaves_first) {
        put_in_order(std::move(leaves_first));
        open_tiles();
        for (Tile &t : a_.tile) list_bonds(t);
        list_homes();
        return std::move(c_);
    }

private:
    std::int32_t end_of(std::int32_t p, int end) const { return c_.end_of(p, end); }
    void list_ends() {
        c_.end.resize(at(2 * s_.n_bonds));
        for (std::int32_t p = 0; p < s_.n_bonds; ++p) {
            c_.end[at(2 * p)] = s_.atom_i[a_.bond_of[at(p)]];
            c_.end[at(2 * p + 1)] = s_.atom_j[a_.bond_of[at(p)]];
        }
    }
    void put_in_order(Numbers leaves_first) {
        a_.bond_of = leaves_first;
        list_ends();
        // The bonds of each atom in this order, ascending.
        Numbers next = bonds_.start;
        for (std::int32_t p = 0; p < s_.n_bonds; ++p)
            for (int end = 0; end < 2; ++end) bonds_.item[at(next[at(end_of(p, end))]++)] = p;
        const Fill filled =
            fill_of(bonds_, s_.n_bonds, s_.n_tree, [&](std::int32_t p, int end) { return end_of(p, end); });
        const ListOrder made = order_of_list(filled);
        column_of_.resize(made.column.size());
        for (std::size_t p = 0; p < made.column.size(); ++p) {
            column_of_[at(made.column[p])] = static_cast<std::int32_t>(p);
            a_.bond_of[p] = leaves_first[at(made.column[p])];
        }
        list_ends();
        Fill fill = in_order(filled, made.column, column_of_);
        c_.start = std::move(fill.column_start);
        c_.row = std::move(fill.row);
        subtree_end_ = made.subtree_end;
    }

    // Subtrees and the separator behind them, and their tiles.
    void open_tiles() {
        c_.tile_of.reserve(at(s_.n_bonds));
        std::int32_t first = 0;
        for (const std::int32_t end : subtree_end_) first = open_tiles(first, end);
        open_tiles(first, s_.n_bonds);
        a_.list.n_columns = static_cast<std::int32_t>(in_fours(s_.n_bonds));
        a_.site_of.resize(at(s_.n_atoms));
        number_ = minus_ones(s_.n_atoms);
        // An atom is at home in the first tile that has bonds of it.
        home_ = minus_ones(s_.n_atoms);
        last_tile_.resize(at(s_.n_atoms));
        for (std::int32_t p = 0; p < s_.n_bonds; ++p)
            for (int end = 0; end < 2; ++end) {
                std::int32_t &home = home_[at(end_of(p, end))];
                last_tile_[at(end_of(p, end))] = c_.tile_of[at(p)];
                home = home < 0 ? c_.tile_of[at(p)] : home;
            }
        group(
            size_of(a_.tile),
            [&](const auto &give) {
                for (std::int32_t i = 0; i < s_.n_atoms; ++i) give(home_[at(i)], i);
            },
            own_);
        c_.extra.resize(a_.tile.size());
        for (Numbers *const list : {&a_.from, &a_.to}) list->reserve(at(s_.n_bonds + 8 * size_of(a_.tile)));
        a_.atom_of.reserve(at(s_.n_atoms));
    }

    std::int32_t open_tiles(std::int32_t first, std::int32_t end) {
        const std::int32_t n = (end - first + LdlPlan::columns_of_tile - 1) / LdlPlan::columns_of_tile,
                           begin = size_of(a_.tile);
        for (std::int32_t i = 0; i < n; ++i) {
            Tile t = {};
            t.first = first;
            t.end = first = i + 1 < n ? first + static_cast<std::int32_t>(in_fours((end - first) / (n - i))) : end;
            t.first_entry = a_.list.n_entries;
            t.end_entry = t.first_entry + c_.start[at(t.end)] - c_.start[at(t.first)];
            a_.list.n_entries = static_cast<std::int32_t>(in_fours(t.end_entry));
            c_.tile_of.insert(c_.tile_of.end(), at(t.end - t.first), size_of(a_.tile));
            a_.tile.push_back(t);
        }
        a_.subtree.push_back({begin, size_of(a_.tile)});
        return end;
    }

    // The atoms and bonds of a tile: its own in the order of memory, then ghosts.
    void list_bonds(Tile &t) {
        const std::int32_t tile = c_.tile_of[at(t.first)], n = t.end - t.first;
        Numbers &extra = c_.extra[at(tile)], ghosts;
        const auto add_later_bonds = [&](std::int32_t i) {
            for (const std::int32_t *q = bonds_.begin(i); last_tile_[at(i)] > tile && q != bonds_.end(i); ++q)
                if (column_of_[at(*q)] >= t.end) extra.push_back(column_of_[at(*q)]);
        };
        t.first_site = size_of(a_.atom_of);
        for (const std::int32_t *i = own_.begin(tile); i != own_.end(tile); ++i) {
            a_.site_of[at(*i)] = add_site(t, *i);
            add_later_bonds(*i);
        }
        t.own_end = size_of(a_.atom_of);
        const auto add_ghost = [&](std::int32_t i) {
            if (number_[at(i)] >= 0) return false;
            number_[at(i)] = 0;
            ghosts.push_back(i);
            return true;
        };
        for (std::int32_t p = t.first; p < t.end; ++p)
            for (int end = 0; end < 2; ++end)
                if (add_ghost(end_of(p, end))) add_later_bonds(end_of(p, end));
        std::sort(ghosts.begin(), ghosts.end());
        c_.visiting.push_back(t.own_end - t.first_site + size_of(ghosts));
        std::sort(extra.begin(), extra.end());
        extra.erase(std::unique(extra.begin(), extra.end()), extra.end());
        for (const std::int32_t q : extra)
            for (int end = 0; end < 2; ++end) add_ghost(end_of(q, end));
        for (const std::int32_t i : ghosts) add_site(t, i);
        t.end_site = size_of(a_.atom_of);
        t.first_row = size_of(a_.from);
        t.end_row = t.first_row + static_cast<std::int32_t>(in_fours(n) + in_fours(size_of(extra)));
        for (int end = 0; end < 2; ++end) {
            Numbers &to = end ? a_.to : a_.from;
            to.resize(at(t.end_row));
            std::int32_t *const own = to.data() + t.first_row, *const behind = own + in_fours(n);
            for (std::int32_t p = 0; p < n; ++p) own[p] = 4 * number_[at(end_of(t.first + p, end))];
            for (std::size_t b = 0; b < extra.size(); ++b) behind[b] = 4 * number_[at(end_of(extra[b], end))];
        }
        for (std::int32_t site = t.first_site; site < t.end_site; ++site) number_[at(a_.atom_of[at(site)])] = -1;
        a_.list.most_sites = std::max(a_.list.most_sites, t.end_site - t.first_site);
        a_.list.most_rows = std::max(a_.list.most_rows, t.end_row - t.first_row);
        a_.list.most_columns = std::max(a_.list.most_columns, n);
    }
    std::int32_t add_site(const Tile &t, std::int32_t atom) {
        const std::int32_t site = size_of(a_.atom_of);
        number_[at(atom)] = site - t.first_site;
        a_.atom_of.push_back(atom);
        return site;
    }

    void list_homes() {
        a_.home.resize(a_.atom_of.size());
        for (std::size_t site = 0; site < a_.home.size(); ++site) a_.home[site] = a_.site_of[at(a_.atom_of[site])];
        std::vector<std::vector<LdlPlan::Visit>> visits(a_.tile.size());
        for (std::size_t n = 0; n < a_.tile.size(); ++n)
            for (std::int32_t site = a_.tile[n].own_end; site < a_.tile[n].first_site + c_.visiting[n]; ++site)
                visits[at(home_[at(a_.atom_of[at(site)])])].push_back({a_.home[at(site)], site});
        for (std::size_t n = 0; n < a_.tile.size(); ++n) {
            a_.tile[n].first_visit = size_of(a_.visit);
            a_.visit.insert(a_.visit.end(), visits[n].begin(), visits[n].end());
            a_.tile[n].end_visit = size_of(a_.visit);
        }
    }

    const EliminationPlan &s_;
    LdlArrays &a_;
    LdlColumns c_;
    Lists bonds_;               // of an atom, as the leaves come first
    Numbers column_of_;         // of a bond in that order
    Numbers subtree_end_;       // columns
    Lists own_;                 // by tile, the atoms that are at home there
    Numbers number_;            // of an atom in the tile that is listed
    Numbers home_, last_tile_;  // of an atom; the last one that has bonds of it
};

}  // namespace

// What the bonds and atoms of tiles were found with goes before the longest lists are made.
LdlColumns make_ldl_tiles(const EliminationPlan &s, Lists bonds, Numbers leaves_first, LdlArrays &arrays) {
    return TilesMaker(s, std::move(bonds), arrays).make(std::move(leaves_first));
}

}  // namespace holonomic
