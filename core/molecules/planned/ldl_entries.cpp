// The entries of a list: rows of the factor's columns with the masses that make them, which entries each column
// changes, and what tiles give to columns and entries of later ones.
#include <algorithm>

#include "core/molecules/planned/ldl_columns.hpp"

namespace holonomic {

namespace {

using Tile = LdlPlan::Tile;

class EntriesMaker {
public:
    EntriesMaker(const LdlColumns &c, LdlArrays &a)
        : c_(c), a_(a), n_bonds_(static_cast<std::int32_t>(c.start.size()) - 1) {}

    void make() {
        list_entries();
        list_updates();
        list_contributions();
    }

private:
    // Where a tile with these contributions from `first` on gives to a column or an entry of a later one.
    static std::int32_t contribution_of(std::int32_t number, std::int32_t first, std::int32_t &n,
                                        Numbers &contributions, std::vector<LdlPlan::Late> &late) {
        std::int32_t &contribution = contributions[at(number)];
        if (contribution < first) late.push_back({number, contribution = n++});
        return contribution;
    }

    void list_entries() {
        for (Numbers *const list : {&a_.row, &a_.row_4, &a_.column_4, &a_.mass}) list->resize(at(a_.list.n_entries));
        contribution_of_ = minus_ones(n_bonds_);
        row_of_ = minus_ones(n_bonds_);
        for (Tile &t : a_.tile) list_entries(t);
    }
    void list_entries(Tile &t) {
        const Numbers &extra = c_.extra[at(c_.tile_of[at(t.first)])];
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
            std::int32_t e = c_.start[at(p)];
            const std::int32_t end = c_.start[at(p) + 1];
            if (size_of(a_.run) == t.first_run || a_.run.back().entries != end - e) a_.run.push_back({0, end - e});
            ++a_.run.back().columns;
            for (; e < end && c_.row[at(e)] < t.end; ++e) add(p - t.first, c_.row[at(e)], c_.row[at(e)] - t.first);
            for (; e < end; ++e)
                add(p - t.first,
                    contribution_of(c_.row[at(e)], first_contribution, a_.list.n_columns, contribution_of_, a_.late),
                    row_of_[at(c_.row[at(e)])]);
        }
        t.end_run = size_of(a_.run);
        for (; at(in_fours(t.end_entry)) > to; ++to) a_.mass[to] = none;
        for (const std::int32_t q : extra) row_of_[at(q)] = -1;
    }
    void list_updates() {
        std::int64_t n_updates = 0;
        for (std::int32_t p = 0; p < n_bonds_; ++p) {
            const std::int64_t n = c_.start[at(p) + 1] - c_.start[at(p)];
            n_updates += n * (n - 1) / 2;
        }
        a_.update.resize(at(n_updates));
        contribution_of_ = minus_ones(a_.list.n_entries);
        for (const Tile &t : a_.tile) entries_before_.push_back(t.first_entry - c_.start[at(t.first)]);
        std::int32_t *to = a_.update.data();
        for (Tile &t : a_.tile) to = list_updates(t, to);
    }
    std::int32_t *list_updates(Tile &t, std::int32_t *to) {
        const std::int32_t first_contribution = a_.list.n_entries;
        t.first_update = to - a_.update.data();
        for (std::int32_t p = t.first; p < t.end; ++p) {
            const std::int32_t n = c_.start[at(p) + 1] - c_.start[at(p)], *const row = c_.row.data() + c_.start[at(p)];
            // The rows below row[j] are in its column, too.
            for (std::int32_t j = 0; j + 1 < n; ++j) {
                const std::int32_t column = row[j], before = entries_before_[at(c_.tile_of[at(column)])];
                const std::int32_t *e = c_.row.data() + c_.start[at(column)], *const end = c_.row.data() +
                                                                                           c_.start[at(column) + 1];
                for (std::int32_t i = j + 1; i < n; ++i) {
                    e = find(e, end, row[i]);
                    to[at(i) * at(i - 1) / 2 + at(j)] = before + static_cast<std::int32_t>(e - c_.row.data());
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
            const bool all_own = c_.visiting[at(&t - a_.tile.data())] == t.own_end - t.first_site,
                       none_late = late == size_of(a_.late) || a_.late[at(late)].number >= t.end;
            for (std::int32_t p = all_own && none_late ? t.end : t.first; p < t.end; ++p) {
                const std::int32_t first = late;
                while (late < size_of(a_.late) && a_.late[at(late)].number == p) ++late;
                bool outer = late > first;
                for (int end = 0; end < 2; ++end) outer = outer || a_.site_of[at(c_.end_of(p, end))] < t.first_site;
                if (outer) a_.outer.push_back(p);
            }
            while (entry < size_of(a_.late_entry) && a_.late_entry[at(entry)].number < t.end_entry) ++entry;
            t.end_late = late;
            t.end_late_entry = entry;
            t.end_outer = size_of(a_.outer);
        }
    }

    const LdlColumns &c_;
    LdlArrays &a_;
    const std::int32_t n_bonds_;
    Numbers entries_before_;   // by tile, inert ones
    Numbers contribution_of_;  // the last one of a column, then of an entry
    Numbers row_of_;           // of a column among a tile's extra bonds
};

}  // namespace

void list_ldl_entries(const LdlColumns &columns, LdlArrays &arrays) { EntriesMaker(columns, arrays).make(); }

}  // namespace holonomic
