#include "core/rigid/molecule_kind.hpp"

#include <algorithm>
#include <cmath>

#include "core/index.hpp"
#include "core/molecules/planned/elimination_order.hpp"

namespace holonomic::rigid {

namespace {

struct EquationRow {
    std::vector<Entry> entries;
    std::int32_t bond;
    DoublePair target;
    double scale, reach;
};

class Completion {
public:
    Completion(MoleculeKind &kind, const std::vector<Body> &bodies) : s_(kind), bodies_(bodies) {}

    void run() {
        place_nodes();
        make_rows();
        find_way();
        eliminate();
    }

private:
    const Body &body_of(const Part &part) const { return bodies_[at(part.body)]; }

    void place_nodes() {
        s_.part_of.assign(at(s_.n_held), -1);
        s_.node_of.assign(at(s_.n_atoms), -1);
        for (std::size_t p = 0; p < s_.parts.size(); ++p) {
            Part &part = s_.parts[p];
            const Body &body = body_of(part);
            part.first_node = s_.n_nodes;
            s_.n_nodes += 1 + body.rank;
            s_.w.insert(s_.w.end(), at(1 + body.rank), body.inverse_mass);
            for (std::int32_t a = 0; a < body.n_atoms; ++a)
                s_.part_of[at(part.first_atom + a)] = static_cast<std::int32_t>(p);
        }
        for (std::int32_t a = s_.n_held; a < s_.n_atoms; ++a) {
            s_.node_of[at(a)] = s_.n_nodes++;
            s_.w.push_back(a < s_.n_movable ? 1 / s_.mass[at(a)] : 0);
        }
    }

    // The entries of an atom at the end of a bond; sign +1 at its second atom.
    void add_end(std::int32_t atom, double sign, std::vector<Entry> &to) const {
        if (atom >= s_.n_held) return to.push_back({s_.node_of[at(atom)], -1, as_pair(sign)});
        const Part &part = s_.parts[at(s_.part_of[at(atom)])];
        const Body &body = body_of(part);
        const std::int32_t a = atom - part.first_atom;
        to.push_back({part.first_node, -1, body.first.empty() ? as_pair(sign) : sign * body.first[at(a)]});
        for (std::int32_t p = 0; p < body.rank; ++p)
            to.push_back({part.first_node + 1 + p, -1, sign * body.y[at(a * body.rank + p)]});
        for (std::size_t j = 0; j < part.fixed.size(); ++j)
            to.push_back({s_.node_of[at(part.fixed[j])], -1, sign * body.of_fixed[at(a) * part.fixed.size() + j]});
    }

    void check_within(const Bond &bond, std::int32_t number) const {
        if (s_.by_lengths) return;  // fit.hpp has done it
        const Part &part = s_.parts[at(s_.part_of[at(bond.i)])];
        const Body &body = body_of(part);
        double square = 0;
        for (int c = 0; c < 3; ++c) {
            const double d = body.coordinates[at(3 * (bond.j - part.first_atom) + c)] -
                             body.coordinates[at(3 * (bond.i - part.first_atom) + c)];
            square += d * d;
        }
        if (!(std::fabs(std::sqrt(square) - bond.length) <= same_length * bond.length))
            throw Unsolvable{Unsolvable::length_in_body, number};
    }

    bool are_of_one_part(const Bond &bond) const {
        return bond.i < s_.n_held && bond.j < s_.n_held && s_.part_of[at(bond.i)] == s_.part_of[at(bond.j)];
    }
    bool is_within_body(const Bond &bond) const {
        return are_of_one_part(bond) && body_of(s_.parts[at(s_.part_of[at(bond.i)])]).is_rigid;
    }

    bool is_off_plane(std::int32_t atom) const {
        if (atom >= s_.n_held) return false;
        const Part &part = s_.parts[at(s_.part_of[at(atom)])];
        const Body &body = body_of(part);
        return !body.z.empty() && body.z[at(atom - part.first_atom)].hi != 0;
    }

    void add_distance(const Bond &bond, std::int32_t number) {
        if (is_off_plane(bond.i) || is_off_plane(bond.j)) throw Unsolvable{Unsolvable::off_plane, number};
        EquationRow row{
            {}, number, as_pair(bond.length) * as_pair(bond.length), bond.length * bond.length, bond.length};
        add_end(bond.j, 1, row.entries);
        add_end(bond.i, -1, row.entries);
        if (are_of_one_part(bond)) {  // of an affine one: each node once
            const std::size_t half = row.entries.size() / 2;
            for (std::size_t e = 0; e < half; ++e)
                row.entries[e].factor = row.entries[e].factor + row.entries[half + e].factor;
            row.entries.erase(row.entries.begin() + static_cast<std::ptrdiff_t>(half), row.entries.end());
            if (body_of(s_.parts[at(s_.part_of[at(bond.i)])]).first.empty())
                row.entries.erase(row.entries.begin());  // the centre
            if (row.entries.empty()) throw Unsolvable{Unsolvable::too_many, number};
        }
        rows_.push_back(std::move(row));
    }

    void make_rows() {
        for (std::size_t k = 0; k < s_.bonds.size(); ++k) {
            Bond &bond = s_.bonds[k];
            if (bond.row == held_elsewhere) continue;
            bond.row = -1;
            if (is_within_body(bond)) {
                check_within(bond, static_cast<std::int32_t>(k));
                continue;
            }
            add_distance(bond, static_cast<std::int32_t>(k));
            if (!s_.has_images) s_.longest = std::max(s_.longest, bond.length);
        }
        for (const Bond &bond : s_.hidden) add_distance(bond, -1);
        for (const Part &part : s_.parts) {
            const Body &body = body_of(part);
            if (!body.is_rigid) continue;
            const std::int32_t u = part.first_node + 1;
            for (std::int32_t p = 0; p < body.rank; ++p)
                for (std::int32_t q = p; q < body.rank; ++q) {
                    EquationRow row{{{u + p, u + q, as_pair(1)}},
                                    -1,
                                    p == q ? body.square[p] : as_pair(0),
                                    body.length[p] * body.length[q],
                                    body.length[p] + body.length[q]};
                    if (p != q) row.entries.push_back({u + q, u + p, as_pair(1)});
                    rows_.push_back(std::move(row));
                }
        }
        s_.n_rows = static_cast<std::int32_t>(rows_.size());
    }

    // From the first atom through bodies and along bonds, but not through fixed atoms.
    void find_way() {
        std::vector<std::vector<std::int32_t>> partners(at(s_.n_atoms));
        for (const Bond &bond : s_.bonds) {
            partners[at(bond.i)].push_back(bond.j);
            partners[at(bond.j)].push_back(bond.i);
        }
        std::vector<bool> seen(at(s_.n_atoms), false);
        std::vector<std::int32_t> found;
        const auto reach = [&](std::int32_t atom, std::int32_t before) {
            if (seen[at(atom)]) return;
            seen[at(atom)] = true;
            found.push_back(atom);
            if (before >= 0) s_.steps.push_back({atom, before});
            if (atom >= s_.n_held) return;
            const Part &part = s_.parts[at(s_.part_of[at(atom)])];
            const Body &body = body_of(part);
            if (!body.is_rigid) return;
            for (const NearestStep &step : nearest_steps(body, atom - part.first_atom)) {
                s_.steps.push_back({part.first_atom + step.atom, part.first_atom + step.before});
                seen[at(part.first_atom + step.atom)] = true;
                found.push_back(part.first_atom + step.atom);
                double square = 0;
                for (int c = 0; c < 3; ++c) {
                    const double d =
                        body.coordinates[at(3 * step.atom + c)] - body.coordinates[at(3 * step.before + c)];
                    square += d * d;
                }
                s_.longest = std::max(s_.longest, std::sqrt(square));
            }
        };
        reach(0, -1);
        std::size_t next = 0;
        const auto follow_bonds = [&] {
            for (; next < found.size(); ++next) {
                const std::int32_t atom = found[next];
                if (atom >= s_.n_movable) continue;
                for (const std::int32_t partner : partners[at(atom)]) reach(partner, atom);
            }
        };
        follow_bonds();
        for (std::size_t k = 0; k < s_.links.size(); ++k) {
            const NearestStep &link = s_.links[k];
            if (seen[at(link.atom)] == seen[at(link.before)]) continue;
            if (seen[at(link.atom)])
                reach(link.before, link.atom);
            else
                reach(link.atom, link.before);
            follow_bonds();
            k = static_cast<std::size_t>(-1);  // those before it may lead on
        }
        if (static_cast<std::int32_t>(found.size()) < s_.n_atoms) throw Unsolvable{Unsolvable::unconnected, -1};
    }

    // Rows that meet at a node are coupled.
    void eliminate() {
        std::vector<std::vector<std::int32_t>> rows_of(at(s_.n_nodes)), neighbours(rows_.size());
        for (std::size_t k = 0; k < rows_.size(); ++k)
            for (const Entry &entry : rows_[k].entries)
                if (s_.w[at(entry.node)] > 0) rows_of[at(entry.node)].push_back(static_cast<std::int32_t>(k));
        for (const auto &rows : rows_of)
            for (const std::int32_t a : rows)
                for (const std::int32_t b : rows)
                    if (a != b) neighbours[at(a)].push_back(b);
        Lists lists{{0}, {}};
        for (auto &list : neighbours) {
            std::sort(list.begin(), list.end());
            list.erase(std::unique(list.begin(), list.end()), list.end());
            lists.item.insert(lists.item.end(), list.begin(), list.end());
            lists.start.push_back(static_cast<std::int32_t>(lists.item.size()));
        }
        const std::vector<std::int32_t> order = minimum_degree(std::move(lists));
        std::vector<std::int32_t> number(order.size());
        for (std::size_t k = 0; k < order.size(); ++k) number[at(order[k])] = static_cast<std::int32_t>(k);
        FillMaker maker(static_cast<std::int32_t>(order.size()));
        for (std::size_t k = 0; k < order.size(); ++k) {
            for (const std::int32_t other : neighbours[at(order[k])])
                maker.add(static_cast<std::int32_t>(k), number[at(other)]);
            maker.end_column(static_cast<std::int32_t>(k));
        }
        const Fill fill = sorted(maker.made());
        s_.column_start = fill.column_start;
        s_.row = fill.row;
        write_rows(order);
        find_products();
    }

    void write_rows(const std::vector<std::int32_t> &order) {
        s_.entry_start.push_back(0);
        for (std::size_t k = 0; k < order.size(); ++k) {
            const EquationRow &row = rows_[at(order[k])];
            s_.entries.insert(s_.entries.end(), row.entries.begin(), row.entries.end());
            s_.entry_start.push_back(static_cast<std::int32_t>(s_.entries.size()));
            s_.bond_of_row.push_back(row.bond);
            s_.target.push_back(row.target);
            s_.scale.push_back(row.scale);
            s_.reach.push_back(row.reach);
            if (row.bond >= 0) s_.bonds[at(row.bond)].row = static_cast<std::int32_t>(k);
        }
    }

    void find_products() {
        struct Occurrence {
            std::int32_t entry, row;
        };
        std::vector<std::vector<Occurrence>> of_node(at(s_.n_nodes));
        for (std::int32_t k = 0; k < s_.n_rows; ++k)
            for (std::int32_t e = s_.entry_start[at(k)]; e < s_.entry_start[at(k + 1)]; ++e)
                if (s_.w[at(s_.entries[at(e)].node)] > 0) of_node[at(s_.entries[at(e)].node)].push_back({e, k});
        for (const auto &occurrences : of_node)
            for (std::size_t a = 0; a < occurrences.size(); ++a)
                for (std::size_t b = a; b < occurrences.size(); ++b) {
                    const Occurrence first = occurrences[a], second = occurrences[b];  // rows ascend
                    if (first.row == second.row) {
                        s_.products.push_back({first.entry, second.entry, first.row, a == b ? 1 : 2});
                        continue;
                    }
                    const auto begin = s_.row.begin() + s_.column_start[at(first.row)],
                               end = s_.row.begin() + s_.column_start[at(first.row + 1)];
                    const auto found = std::lower_bound(begin, end, second.row);
                    s_.products.push_back(
                        {first.entry, second.entry, static_cast<std::int32_t>(found - s_.row.begin()), 0});
                }
    }

    MoleculeKind &s_;
    const std::vector<Body> &bodies_;
    std::vector<EquationRow> rows_;
};

}  // namespace

namespace {

// Axes of a body take its lengths to the twelfth power, elimination squares of lengths^2 / mass.
constexpr double most_length = 0x1p80, most_mass = 0x1p150;

bool is_between(double a, double most) { return a > 1 / most && a < most; }

bool is_in_range(const MoleculeKind &kind, const std::vector<Body> &bodies) {
    bool good = true;
    for (const Part &part : kind.parts) {
        const Body &body = bodies[static_cast<std::size_t>(part.body)];
        good = good && is_between(body.mass, most_mass) && is_between(body.extent, most_length);
    }
    for (const double mass : kind.mass) good = good && (mass == 0 || is_between(mass, most_mass));
    for (const Bond &bond : kind.bonds) good = good && is_between(bond.length, most_length);
    return good;
}

}  // namespace

void complete(MoleculeKind &kind, const std::vector<Body> &bodies) {
    Completion(kind, bodies).run();
    kind.is_ordinary = is_in_range(kind, bodies);
    kind.is_lone_body =
        kind.is_ordinary && kind.parts.size() == 1 && kind.n_atoms == kind.n_held &&
        std::all_of(kind.bonds.begin(), kind.bonds.end(), [](const Bond &bond) { return bond.row < 0; }) &&
        bodies[static_cast<std::size_t>(kind.parts[0].body)].is_thick;
    // A rigid whole has three or six motions left unless a fixed atom holds it, one that goes round the box three: more
    // equations than freedoms depend.
    std::int64_t freedoms = 3 * (kind.n_movable - kind.n_held), rows = 0;
    for (const Part &part : kind.parts) {
        const Body &body = bodies[static_cast<std::size_t>(part.body)];
        freedoms += !body.is_rigid ? 3 * (1 + body.rank) : body.rank == 1 ? 5 : 6;
    }
    for (const Bond &bond : kind.bonds) rows += bond.row >= 0;
    rows += static_cast<std::int64_t>(kind.hidden.size());
    const bool free = kind.n_atoms == kind.n_movable;
    if (rows > 0 && rows > freedoms - (!free ? 0 : kind.has_images ? 3 : 5)) throw Unsolvable{Unsolvable::too_many, -1};
}

std::int64_t MoleculeKind::bytes() const {
    return static_cast<std::int64_t>(
        signature.capacity() * sizeof(double) + entries.capacity() * sizeof(Entry) +
        products.capacity() * sizeof(Product) + bonds.capacity() * sizeof(Bond) +
        steps.capacity() * sizeof(NearestStep) +
        (row.capacity() + column_start.capacity() + part_of.capacity() + node_of.capacity()) * sizeof(std::int32_t) +
        (w.capacity() + mass.capacity() + scale.capacity() + reach.capacity()) * sizeof(double) +
        target.capacity() * sizeof(DoublePair) + sizeof *this);
}

}  // namespace holonomic::rigid
