#include "core/molecules/planned/ldl_plan.hpp"

#include <algorithm>

#include "core/molecules/planned/elimination_order.hpp"
#include "core/molecules/planned/ldl_order.hpp"

namespace holonomic {

namespace {

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
    LdlPlanMaker(const EliminationPlan &s, Lists &&bonds, LdlArrays &a) : s_(s), a_(a), bonds_(std::move(bonds)) {}

    void make(Numbers &&leaves_first) {
        put_in_order(std::move(leaves_first));
        open_tiles();
        for (Tile &t : a_.tile) list_bonds(t);
        list_homes();
        give_back();
        list_entries();
        list_updates();
        list_contributions();
        close();
    }

private:
    // An atom of column p.
    std::int32_t end_of(std::int32_t p, int end) const { return end_[at(2 * p + end)]; }
    void list_ends() {
        end_.resize(at(2 * s_.n_bonds));
        for (std::int32_t p = 0; p < s_.n_bonds; ++p) {
            end_[at(2 * p)] = s_.atom_i[a_.bond_of[at(p)]];
            end_[at(2 * p + 1)] = s_.atom_j[a_.bond_of[at(p)]];
        }
    }
    void put_in_order(Numbers leaves_first) {
        a_.bond_of = leaves_first;
        list_ends();
        // The bonds of each atom in this order, ascending.
        Numbers next = bonds_.start;
        for (std::int32_t p = 0; p < s_.n_bonds; ++p)
            for (int end = 0; end < 2; ++end) bonds_.item[at(next[at(end_of(p, end))]++)] = p;
        const Fill filled = fill_of(bonds_, s_.n_bonds, [&](std::int32_t p, int end) { return end_of(p, end); });
        const ListOrder made = order_of_list(filled);
        column_of_.resize(made.column.size());
        for (std::size_t p = 0; p < made.column.size(); ++p) {
            column_of_[at(made.column[p])] = static_cast<std::int32_t>(p);
            a_.bond_of[p] = leaves_first[at(made.column[p])];
        }
        list_ends();
        Fill fill = in_order(filled, made.column, column_of_);
        start_ = std::move(fill.column_start);
        row_ = std::move(fill.row);
        subtree_end_ = made.subtree_end;
    }

    // Subtrees and the separator behind them, and their tiles.
    void open_tiles() {
        tile_of_.reserve(at(s_.n_bonds));
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
                last_tile_[at(end_of(p, end))] = tile_of_[at(p)];
                home = home < 0 ? tile_of_[at(p)] : home;
            }
        group(
            size_of(a_.tile),
            [&](const auto &give) {
                for (std::int32_t i = 0; i < s_.n_atoms; ++i) give(home_[at(i)], i);
            },
            own_);
        extra_.resize(a_.tile.size());
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
        const std::int32_t tile = tile_of_[at(t.first)], n = t.end - t.first;
        Numbers &extra = extra_[at(tile)], ghosts;
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
        visiting_.push_back(t.own_end - t.first_site + size_of(ghosts));
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
            for (std::int32_t site = a_.tile[n].own_end; site < a_.tile[n].first_site + visiting_[n]; ++site)
                visits[at(home_[at(a_.atom_of[at(site)])])].push_back({a_.home[at(site)], site});
        for (std::size_t n = 0; n < a_.tile.size(); ++n) {
            a_.tile[n].first_visit = size_of(a_.visit);
            a_.visit.insert(a_.visit.end(), visits[n].begin(), visits[n].end());
            a_.tile[n].end_visit = size_of(a_.visit);
        }
    }

    // What the bonds and atoms of tiles were found with, before the longest lists are made.
    void give_back() {
        for (Numbers *const list :
             {&bonds_.start, &bonds_.item, &own_.start, &own_.item, &number_, &home_, &last_tile_, &column_of_})
            Numbers().swap(*list);
    }

    // Where a tile with these contributions from `first` on gives to a column or an entry of a later one.
    static std::int32_t contribution_of(std::int32_t number, std::int32_t first, std::int32_t &n,
                                        Numbers &contributions, std::vector<LdlPlan::Late> &late) {
        std::int32_t &contribution = contributions[at(number)];
        if (contribution < first) late.push_back({number, contribution = n++});
        return contribution;
    }

    void list_entries() {
        for (Numbers *const list : {&a_.row, &a_.row_4, &a_.column_4, &a_.mass}) list->resize(at(a_.list.n_entries));
        contribution_of_ = minus_ones(s_.n_bonds);
        row_of_ = minus_ones(s_.n_bonds);
        for (Tile &t : a_.tile) list_entries(t);
    }
    void list_entries(Tile &t) {
        const Numbers &extra = extra_[at(tile_of_[at(t.first)])];
        const std::int32_t own_rows = static_cast<std::int32_t>(in_fours(t.end - t.first)),
                           none = 2 * (t.end_site - t.first_site);
        for (std::size_t b = 0; b < extra.size(); ++b) row_of_[at(extra[b])] = own_rows + static_cast<std::int32_t>(b);
        const std::int32_t *const from = a_.from.data() + t.first_row, *const to_atom = a_.to.data() + t.first_row;
        const std::int32_t first_contribution = a_.list.n_columns;
        t.first_run = size_of(a_.run);
        std::size_t to = at(t.first_entry);
        const auto add = [&](std::int32_t column, std::int32_t q, std::int32_t row) {
            a_.row[to] = q;
            a_.column_4[to] = 4 * column;
            // Both point to or from the atom that they share; or one to it, one from it; or none is shared.
            const std::int32_t i = from[column], j = to_atom[column], k = row < 0 ? -1 : from[row],
                               l = row < 0 ? -1 : to_atom[row];
            const bool same = (i == k) | (j == l), shares = same | (i == l) | (j == k);
            a_.row_4[to] = shares ? 4 * row : 0;
            a_.mass[to++] = shares ? ((((i == k) | (i == l)) ? i : j) >> 1) + same : none;
        };
        for (std::int32_t p = t.first; p < t.end; ++p) {
            std::int32_t e = start_[at(p)];
            const std::int32_t end = start_[at(p) + 1];
            if (size_of(a_.run) == t.first_run || a_.run.back().entries != end - e) a_.run.push_back({0, end - e});
            ++a_.run.back().columns;
            for (; e < end && row_[at(e)] < t.end; ++e) add(p - t.first, row_[at(e)], row_[at(e)] - t.first);
            for (; e < end; ++e)
                add(p - t.first,
                    contribution_of(row_[at(e)], first_contribution, a_.list.n_columns, contribution_of_, a_.late),
                    row_of_[at(row_[at(e)])]);
        }
        t.end_run = size_of(a_.run);
        for (; at(in_fours(t.end_entry)) > to; ++to) a_.mass[to] = none;
        for (const std::int32_t q : extra) row_of_[at(q)] = -1;
    }
    void list_updates() {
        std::int64_t n_updates = 0;
        for (std::int32_t p = 0; p < s_.n_bonds; ++p) {
            const std::int64_t n = start_[at(p) + 1] - start_[at(p)];
            n_updates += n * (n - 1) / 2;
        }
        a_.update.resize(at(n_updates));
        contribution_of_ = minus_ones(a_.list.n_entries);
        for (const Tile &t : a_.tile) entries_before_.push_back(t.first_entry - start_[at(t.first)]);
        std::int32_t *to = a_.update.data();
        for (Tile &t : a_.tile) to = list_updates(t, to);
    }
    std::int32_t *list_updates(Tile &t, std::int32_t *to) {
        const std::int32_t first_contribution = a_.list.n_entries;
        t.first_update = to - a_.update.data();
        for (std::int32_t p = t.first; p < t.end; ++p) {
            const std::int32_t n = start_[at(p) + 1] - start_[at(p)], *const row = row_.data() + start_[at(p)];
            // The rows below row[j] are in its column, too.
            for (std::int32_t j = 0; j + 1 < n; ++j) {
                const std::int32_t column = row[j], before = entries_before_[at(tile_of_[at(column)])];
                const std::int32_t *e = row_.data() + start_[at(column)], *const end =
                                                                              row_.data() + start_[at(column) + 1];
                for (std::int32_t i = j + 1; i < n; ++i) {
                    e = find(e, end, row[i]);
                    to[at(i) * at(i - 1) / 2 + at(j)] = before + static_cast<std::int32_t>(e - row_.data());
                }
            }
            const bool gives = n > 1 && row[n - 2] >= t.end;  // to entries of later tiles
            for (std::int32_t i = 1; gives && i < n; ++i)
                for (std::int32_t j = 0; j < i; ++j)
                    if (std::int32_t &e = to[at(i) * at(i - 1) / 2 + at(j)]; row[j] >= t.end)
                        e = contribution_of(e, first_contribution, a_.list.n_entries, contribution_of_, a_.late_entry);
            to += static_cast<std::ptrdiff_t>(n) * (n - 1) / 2;
        }
        return to;
    }
    // A number that is there, among those that ascend; mostly it is near.
    static const std::int32_t *find(const std::int32_t *e, const std::int32_t *end, std::int32_t number) {
        for (int near = 0; near < 8; ++near, ++e)
            if (*e == number) return e;
        return std::lower_bound(e, end, number);
    }

    // Late columns and entries of all tiles, in their order, and columns of which not all is known in their tile.
    void list_contributions() {
        const auto before = [](const LdlPlan::Late &a, const LdlPlan::Late &b) { return a.number < b.number; };
        std::stable_sort(a_.late.begin(), a_.late.end(), before);
        std::stable_sort(a_.late_entry.begin(), a_.late_entry.end(), before);
        std::int32_t late = 0, entry = 0;
        for (Tile &t : a_.tile) {
            t.first_late = late;
            t.first_late_entry = entry;
            t.first_outer = size_of(a_.outer);
            const bool all_own = visiting_[at(&t - a_.tile.data())] == t.own_end - t.first_site,
                       none_late = late == size_of(a_.late) || a_.late[at(late)].number >= t.end;
            for (std::int32_t p = all_own && none_late ? t.end : t.first; p < t.end; ++p) {
                const std::int32_t first = late;
                while (late < size_of(a_.late) && a_.late[at(late)].number == p) ++late;
                bool outer = late > first;
                for (int end = 0; end < 2; ++end) outer = outer || a_.site_of[at(end_of(p, end))] < t.first_site;
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
        l.site_of = a_.site_of.data();
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
    Lists bonds_;                 // of an atom, as the leaves come first
    Numbers column_of_;           // of a bond in that order
    Numbers end_;                 // [][2] atoms of a column
    Numbers start_, row_;         // of the factor's columns
    Numbers subtree_end_;         // columns
    Lists own_;                   // by tile, the atoms that are at home there
    std::vector<Numbers> extra_;  // by tile, columns that are its extra bonds
    Numbers number_;              // of an atom in the tile that is listed
    Numbers entries_before_;      // by tile, inert ones
    Numbers visiting_;            // by tile, its atoms that its own bonds have
    Numbers tile_of_;             // of a column
    Numbers home_, last_tile_;    // of an atom; the last one that has bonds of it
    Numbers contribution_of_;     // the last one of a column, then of an entry
    Numbers row_of_;              // of a column among a tile's extra bonds
};

}  // namespace

void make_ldl_plan(const EliminationPlan &s, Lists bonds, Numbers leaves_first, LdlArrays &arrays) {
    LdlPlanMaker(s, std::move(bonds), arrays).make(std::move(leaves_first));
}

void make_ldl_plan(const EliminationPlan &s, Lists bonds, LdlArrays &arrays) {
    Numbers leaves_first = bonds_from_the_leaves(s, bonds);
    make_ldl_plan(s, std::move(bonds), std::move(leaves_first), arrays);
}

}  // namespace holonomic
