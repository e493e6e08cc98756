#include "core/molecules/flat_list.hpp"

#include <algorithm>
#include <vector>

#include "core/molecules/elimination_order.hpp"
#include "core/molecules/flat_order.hpp"

namespace holonomic {

namespace {

using Rows = std::vector<Numbers>;

class FlatMaker {
public:
    FlatMaker(const Schedule &s, FlatArrays &a) : s_(s), a_(a) {}

    void make() {
        const Numbers order = bonds_from_the_leaves(s_);
        a_.bond_of = order;
        const Numbers rounds = in_rounds(fill_of(neighbours()));
        for (std::int32_t p = 0; p < s_.n_bonds; ++p) a_.bond_of[at(p)] = order[at(rounds[at(p)])];
        number_atoms();
        Fill fill = fill_of(neighbours());
        start_ = std::move(fill.column_start);
        a_.row = std::move(fill.row);
        list_entries();
        list_updates();
        list_runs();
        pad();
    }

private:
    Lists bonds_of_atoms() const {
        return invert(s_.n_atoms, s_.n_bonds, [&](std::int32_t p, int end) {
            const std::int32_t k = a_.bond_of[at(p)];
            return (end ? s_.atom_j : s_.atom_i)[k];
        });
    }
    // Calls each(p, q, atom) for all columns p > q that share an atom.
    template <class Each>
    void for_pairs(const Each &each) const {
        const Lists bonds = bonds_of_atoms();
        for (std::int32_t i = 0; i < s_.n_atoms; ++i)
            for (const std::int32_t *p = bonds.begin(i); p != bonds.end(i); ++p)
                for (const std::int32_t *q = bonds.begin(i); q != p; ++q) each(std::max(*p, *q), std::min(*p, *q), i);
    }
    Rows neighbours() const {
        Rows list(at(s_.n_bonds));
        for_pairs([&](std::int32_t p, std::int32_t q, std::int32_t) {
            list[at(p)].push_back(q);
            list[at(q)].push_back(p);
        });
        return list;
    }
    std::int32_t entry(std::int32_t row, std::int32_t column) const {
        const auto begin = a_.row.begin();
        return static_cast<std::int32_t>(
            std::lower_bound(begin + start_[at(column)], begin + start_[at(column) + 1], row) - begin);
    }
    // In the order in which the bonds come to them.
    void number_atoms() {
        a_.place_of.assign(at(s_.n_atoms), -1);
        for (const std::int32_t k : a_.bond_of)
            for (const std::int32_t i : {s_.atom_i[k], s_.atom_j[k]}) {
                if (a_.place_of[at(i)] >= 0) continue;
                a_.place_of[at(i)] = static_cast<std::int32_t>(a_.atom_of.size());
                a_.atom_of.push_back(i);
            }
    }
    bool points_to(std::int32_t p, std::int32_t atom) const { return s_.atom_j[a_.bond_of[at(p)]] == atom; }

    void list_entries() {
        for (std::int32_t p = 0; p < s_.n_bonds; ++p) {
            a_.from.push_back(4 * a_.place_of[at(s_.atom_i[a_.bond_of[at(p)]])]);
            a_.to.push_back(4 * a_.place_of[at(s_.atom_j[a_.bond_of[at(p)]])]);
            for (std::int32_t e = start_[at(p)]; e < start_[at(p) + 1]; ++e) {
                a_.row_4.push_back(4 * a_.row[at(e)]);
                a_.column_4.push_back(4 * p);
            }
        }
        a_.mass.assign(a_.row.size(), 2 * s_.n_atoms);
        for_pairs([&](std::int32_t p, std::int32_t q, std::int32_t i) {
            a_.mass[at(entry(p, q))] = 2 * a_.place_of[at(i)] + (points_to(p, i) == points_to(q, i) ? 1 : 0);
        });
    }

    void list_updates() {
        for (std::int32_t p = 0; p < s_.n_bonds; ++p) {
            const std::int32_t first = start_[at(p)], end = start_[at(p) + 1];
            for (std::int32_t i = first; i < end; ++i)
                for (std::int32_t j = first; j < i; ++j) a_.update.push_back(entry(a_.row[at(i)], a_.row[at(j)]));
        }
    }

    void list_runs() {
        for (std::int32_t p = 0; p < s_.n_bonds; ++p) {
            const std::int32_t entries = start_[at(p) + 1] - start_[at(p)];
            if (a_.run.empty() || a_.run.back().entries != entries) a_.run.push_back({0, entries});
            ++a_.run.back().columns;
        }
    }

    void pad() {
        FlatList &l = a_.list;
        l.n_atoms = s_.n_atoms;
        l.n_bonds = s_.n_bonds;
        l.n_entries = static_cast<std::int32_t>(a_.row.size());
        const std::size_t bonds = static_cast<std::size_t>(in_fours(l.n_bonds)),
                          entries = static_cast<std::size_t>(in_fours(l.n_entries));
        a_.bond_of.resize(bonds, 0);
        a_.from.resize(bonds, 0);
        a_.to.resize(bonds, 0);
        a_.row_4.resize(entries, 0);
        a_.column_4.resize(entries, 0);
        a_.mass.resize(entries, 2 * s_.n_atoms);
        l.atom_of = a_.atom_of.data();
        l.place_of = a_.place_of.data();
        l.bond_of = a_.bond_of.data();
        l.from = a_.from.data();
        l.to = a_.to.data();
        l.run = a_.run.data();
        l.n_runs = static_cast<std::int32_t>(a_.run.size());
        l.row = a_.row.data();
        l.row_4 = a_.row_4.data();
        l.column_4 = a_.column_4.data();
        l.mass = a_.mass.data();
        l.update = a_.update.data();
    }

    const Schedule &s_;
    FlatArrays &a_;
    Numbers start_;  // of the columns' entries
};

}  // namespace

std::size_t FlatArrays::bytes() const {
    std::size_t count = 0;
    for (const Numbers *numbers : {&atom_of, &place_of, &bond_of, &from, &to, &row, &row_4, &column_4, &mass, &update})
        count += numbers->capacity();
    return count * sizeof(std::int32_t) + run.capacity() * sizeof(FlatList::Run);
}

bool fits_flat_list(const Schedule &s) {
    constexpr std::int64_t most_updates = 16;  // for each bond
    Numbers bonds(at(s.n_atoms));
    for (std::int32_t k = 0; k < s.n_bonds; ++k)
        for (const std::int32_t i : {s.atom_i[k], s.atom_j[k]}) ++bonds[at(i)];
    std::int64_t updates = 0;
    for (const std::int64_t n : bonds) {
        if (n > 3000) return false;  // more than the most of the largest list
        updates += n * (n - 1) / 2 * (n - 2) / 3;
    }
    return s.n_bonds <= largest_in_list && updates <= most_updates * s.n_bonds;
}

void make_flat_list(const Schedule &s, FlatArrays &arrays) { FlatMaker(s, arrays).make(); }

}  // namespace holonomic
