#include "core/molecules/planned/fronts.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include "core/molecules/planned/bisection.hpp"
#include "core/molecules/planned/hubs.hpp"
#include "core/molecules/planned/network.hpp"

namespace holonomic {

namespace {

// A part of so many unknowns is not halved: its matrix is dense enough.
constexpr std::int32_t most_of_leaf = 40;

class FrontMaker {
public:
    FrontMaker(const NetworkPlan &s, const unsigned char *fixed, FrontArrays &a)
        : s_(s), a_(a), cells_(cells_of(s, fixed)), n_hubs_(size_of(cells_.hub)), part_of_(at(cells_.size()), 0),
          in_part_(at(cells_.size()), -1), front_of_(at(s.n_unknowns + 3 * n_hubs_), -1) {}

    FrontPlan make(std::int64_t most_bytes) {
        Numbers cells(at(cells_.size()));
        for (std::int32_t i = 0; i < cells_.size(); ++i) cells[at(i)] = i;
        divide(cells_.graph, cells);
        list_spokes();
        number();
        list_rows();
        cut_subtrees();
        FrontPlan p = {};
        if (!count(most_bytes, p)) {
            a_ = {};
            return {};
        }
        list_elements();
        p.n_fronts = static_cast<std::int32_t>(a_.front.size());
        p.n_subtrees = static_cast<std::int32_t>(a_.subtree.size());
        p.front = a_.front.data();
        p.subtree = a_.subtree.data();
        p.row = a_.row.data();
        p.to_parent = a_.to_parent.data();
        p.node = a_.node.data();
        p.own_row = a_.own_row.data();
        p.foreign_row = a_.foreign_row.data();
        p.partner_row = a_.partner_row.data();
        p.n_hubs = n_hubs_;
        p.hub = a_.hub.data();
        p.hub_of = a_.hub_of.data();
        p.spoke = a_.spoke.data();
        return p;
    }

private:
    // Fronts of these cells, whose edges `g` has; returns the last one. Cells of the part: `cells` as g numbers them.
    std::int32_t divide(const WeightedGraph &g, const Numbers &cells) {
        std::int32_t unknowns = 0;
        for (const std::int32_t c : cells) unknowns += cells_.unknowns[at(c)];
        FrontPlan::Front front = {0, 0, 0, size_of(a_.node), size_of(a_.node), 0, 0, {-1, -1}, -1};
        std::vector<unsigned char> side;
        if (cells.size() > 1 && unknowns > most_of_leaf) side = bisect(g);
        const std::int32_t self_if_leaf = static_cast<std::int32_t>(a_.front.size());
        if (std::adjacent_find(side.begin(), side.end(), std::not_equal_to<>()) != side.end()) {
            for (unsigned char half = 0; half < 2; ++half) {
                WeightedGraph part;
                Numbers members;
                part_of(g, side, half, cells, part, members);
                front.half[half] = divide(part, members);
            }
        } else {
            for (const std::int32_t c : cells) {
                part_of_[at(c)] = self_if_leaf;
                if (cells_.node[at(c)] >= 0) a_.node.push_back(cells_.node[at(c)]);
            }
            front.end_node = size_of(a_.node);
        }
        a_.front.push_back(front);
        const std::int32_t self = static_cast<std::int32_t>(a_.front.size()) - 1;
        parent_.push_back(-1);
        for (const std::int32_t f : front.half)
            if (f >= 0) parent_[at(f)] = self;
        return self;
    }
    void part_of(const WeightedGraph &g, const std::vector<unsigned char> &side, unsigned char half,
                 const Numbers &cells, WeightedGraph &part, Numbers &members) {
        for (std::int32_t i = 0; i < g.size(); ++i)
            if (side[at(i)] == half) {
                in_part_[at(i)] = size_of(members);
                members.push_back(cells[at(i)]);
                part.weight.push_back(g.weight[at(i)]);
            }
        part.start.assign(1, 0);
        for (std::int32_t i = 0; i < g.size(); ++i) {
            if (side[at(i)] != half) continue;
            for (std::int32_t e = g.start[at(i)]; e < g.start[at(i) + 1]; ++e)
                if (side[at(g.edge[at(e)].to)] == half)
                    part.edge.push_back({in_part_[at(g.edge[at(e)].to)], g.edge[at(e)].weight});
            part.start.push_back(static_cast<std::int32_t>(part.edge.size()));
        }
    }

    // The bonds of hubs, by the leaf that has their terms.
    void list_spokes() {
        a_.hub = cells_.hub;
        a_.hub_of = cells_.hub_of;
        for (std::int32_t u = 0; u < s_.n_unknowns && n_hubs_ > 0; ++u) {
            add_spoke(u, s_.node_of[u], 1);
            if (s_.other_node[u] >= 0) add_spoke(u, s_.other_node[u], -1);
        }
        std::stable_sort(a_.spoke.begin(), a_.spoke.end(),
                         [this](const FrontPlan::Spoke &x, const FrontPlan::Spoke &y) {
                             return leaf_of(x.unknown) < leaf_of(y.unknown);
                         });
        std::vector<unsigned char> begun(at(n_hubs_), 0);
        std::int32_t i = 0;
        for (std::size_t f = 0; f < a_.front.size(); ++f) {
            a_.front[f].first_spoke = i;
            for (; at(i) < a_.spoke.size() && at(leaf_of(a_.spoke[at(i)].unknown)) == f; ++i) {
                FrontPlan::Spoke &spoke = a_.spoke[at(i)];
                spoke.is_first = !begun[at(spoke.hub)];
                begun[at(spoke.hub)] = 1;
            }
            a_.front[f].end_spoke = i;
        }
    }
    void add_spoke(std::int32_t u, std::int32_t node, std::int32_t sign) {
        if (cells_.hub_of[at(node)] >= 0) a_.spoke.push_back({u, cells_.hub_of[at(node)], 0, 0, -1, sign, false});
    }
    std::int32_t leaf_of(std::int32_t u) const { return part_of_[at(cells_.of_unknown[at(u)].own)]; }
    std::int32_t of_hub(std::int32_t hub, std::int32_t c) const { return s_.n_unknowns + 3 * hub + c; }

    // The front that has both: fronts of halves have lower numbers than those of the whole.
    std::int32_t common(std::int32_t a, std::int32_t b) const {
        if (a < 0 || b < 0) return std::max(a, b);
        while (a != b) (a < b ? a : b) = parent_[at(a < b ? a : b)];
        return a;
    }
    // Where each unknown is eliminated, and when: in a front, hubs after most, late bonds after these.
    void number() {
        for (std::int32_t u = 0; u < s_.n_unknowns; ++u) {
            const Cells::Places &p = cells_.of_unknown[at(u)];
            front_of_[at(u)] = common(part_of_[at(p.own)], part_of_[at(p.other)]);
        }
        for (const FrontPlan::Spoke &spoke : a_.spoke)
            for (std::int32_t c = 0; c < 3; ++c) {
                std::int32_t &front = front_of_[at(of_hub(spoke.hub, c))];
                front = common(front,
                               cells_.late[at(spoke.unknown)] ? leaf_of(spoke.unknown) : front_of_[at(spoke.unknown)]);
            }
        for (const FrontPlan::Spoke &spoke : a_.spoke)
            if (cells_.late[at(spoke.unknown)])
                front_of_[at(spoke.unknown)] =
                    common(front_of_[at(spoke.unknown)], front_of_[at(of_hub(spoke.hub, 0))]);
        for (const std::int32_t f : front_of_) ++a_.front[at(f)].n_own;
        std::int32_t first = 0;
        Numbers next;
        for (const FrontPlan::Front &f : a_.front) {
            next.push_back(first);
            first += f.n_own;
        }
        const std::int32_t n = size_of(front_of_);
        turn_.resize(at(n));
        unknown_.resize(at(n));
        const auto turn = [&](std::int32_t u) {
            turn_[at(u)] = next[at(front_of_[at(u)])]++;
            unknown_[at(turn_[at(u)])] = u;
        };
        for (std::int32_t u = 0; u < n; ++u)
            if (u >= s_.n_unknowns || !cells_.late[at(u)]) turn(u);
        for (std::int32_t u = 0; u < s_.n_unknowns; ++u)
            if (cells_.late[at(u)]) turn(u);
    }

    // Calls each(unknown) for those that a leaf's terms hold; some more than once.
    template <class Each>
    void for_unknowns(const FrontPlan::Front &f, const Each &each) const {
        for (std::int32_t i = f.first_node; i < f.end_node; ++i) {
            const std::int32_t n = a_.node[at(i)];
            for_own(s_, n, [&](std::int32_t u) {
                each(u);
                if (s_.sign[u] < 0) each(s_.partner[u]);
            });
            for (std::int32_t k = s_.foreign_start[n]; k < s_.foreign_start[n + 1]; ++k) each(s_.foreign[k]);
        }
        for (std::int32_t i = f.first_spoke; i < f.end_spoke; ++i) {
            const FrontPlan::Spoke &spoke = a_.spoke[at(i)];
            each(spoke.unknown);
            if (couples(spoke)) each(s_.partner[spoke.unknown]);
            for (std::int32_t c = 0; c < 3; ++c) each(of_hub(spoke.hub, c));
        }
    }
    // Whether the terms that couple a strand's ends are with its end at the hub.
    bool couples(const FrontPlan::Spoke &spoke) const {
        return s_.other_node[spoke.unknown] < 0 && s_.sign[spoke.unknown] < 0;
    }
    void list_rows() {
        const std::int32_t n_fronts = static_cast<std::int32_t>(a_.front.size());
        std::vector<Numbers> left(a_.front.size());  // turns that the halves of a front leave, then its own rows
        Numbers turns;
        for (std::int32_t f = 0; f < n_fronts; ++f) {
            FrontPlan::Front &front = a_.front[at(f)];
            turns = std::move(left[at(f)]);
            if (front.half[0] < 0) for_unknowns(front, [&](std::int32_t u) { turns.push_back(turn_[at(u)]); });
            std::sort(turns.begin(), turns.end());
            turns.erase(std::unique(turns.begin(), turns.end()), turns.end());
            front.first_row = size_of(a_.row);
            front.n_rows = size_of(turns);
            a_.row.insert(a_.row.end(), turns.begin(), turns.end());
            if (parent_[at(f)] < 0) continue;
            Numbers &to = left[at(parent_[at(f)])];
            to.insert(to.end(), turns.begin() + front.n_own, turns.end());
        }
        a_.to_parent.assign(a_.row.size(), -1);
        for (std::int32_t f = 0; f < n_fronts; ++f) {
            if (parent_[at(f)] < 0) continue;
            const FrontPlan::Front &front = a_.front[at(f)], &whole = a_.front[at(parent_[at(f)])];
            std::int32_t k = whole.first_row;
            for (std::int32_t i = front.first_row + front.n_own; i < front.first_row + front.n_rows; ++i) {
                while (a_.row[at(k)] != a_.row[at(i)]) ++k;
                a_.to_parent[at(i)] = k - whole.first_row;
            }
        }
    }
    std::int32_t row_of(std::int32_t f, std::int32_t u) const {
        const auto begin = a_.row.begin() + a_.front[at(f)].first_row;
        return static_cast<std::int32_t>(std::lower_bound(begin, begin + a_.front[at(f)].n_rows, turn_[at(u)]) - begin);
    }
    void list_elements() {
        a_.own_row.resize(at(s_.n_unknowns));
        a_.partner_row.assign(at(s_.n_unknowns), -1);
        a_.foreign_row.resize(at(s_.foreign_start[s_.n_nodes]));
        for (std::int32_t n = 0; n < s_.n_nodes; ++n) {
            if (cells_.cell_of[at(n)] < 0) continue;
            const std::int32_t f = part_of_[at(cells_.cell_of[at(n)])];
            for_own(s_, n, [&](std::int32_t u) {
                a_.own_row[at(u)] = row_of(f, u);
                if (s_.sign[u] < 0) a_.partner_row[at(u)] = row_of(f, s_.partner[u]);
            });
            for (std::int32_t k = s_.foreign_start[n]; k < s_.foreign_start[n + 1]; ++k)
                a_.foreign_row[at(k)] = row_of(f, s_.foreign[k]);
        }
        for (FrontPlan::Spoke &spoke : a_.spoke) {
            const std::int32_t f = leaf_of(spoke.unknown);
            spoke.row = row_of(f, spoke.unknown);
            spoke.hub_row = row_of(f, of_hub(spoke.hub, 0));
            if (couples(spoke)) spoke.partner_row = row_of(f, s_.partner[spoke.unknown]);
        }
        for (std::int32_t &turn : a_.row) turn = unknown_[at(turn)];
    }
    // ns, measured on Zen 4; and numbers, in vectors of four.
    static double time_of(const FrontPlan::Front &f) {
        double operations = 0;
        for (std::int32_t k = 0; k < f.n_own; ++k) {
            const double rows = f.n_rows - k;
            operations += 0.5 * rows * rows;
        }
        return 0.05 * operations + 1.5 * entries_of(f) + 30 * f.n_rows;
    }
    static double entries_of(const FrontPlan::Front &f) { return (f.n_own + 4.0) * (f.n_rows + 8.0); }
    static double left_by(const FrontPlan::Front &f) { return (f.n_rows - f.n_own + 4.0) * (f.n_rows - f.n_own + 4.0); }
    // Subtrees that take no more than a sixteenth of all, so that any few threads have as much to do.
    void cut_subtrees() {
        const std::size_t n = a_.front.size();
        std::vector<double> time(n);
        Numbers first(n);  // of what a front is made of
        for (std::size_t f = 0; f < n; ++f) {
            time[f] = time_of(a_.front[f]);
            first[f] = static_cast<std::int32_t>(f);
            for (const std::int32_t half : a_.front[f].half) {
                if (half < 0) continue;
                time[f] += time[at(half)];
                first[f] = std::min(first[f], first[at(half)]);
            }
        }
        constexpr double worth_threads = 1e5;
        const double most = time.back() < worth_threads ? time.back() : time.back() / 16;
        for (std::size_t f = 0; f < n; ++f) {
            const std::int32_t parent = parent_[f];
            const auto is_small = [&](std::size_t i) { return time[i] <= most || a_.front[i].half[0] < 0; };
            if (!is_small(f) || (parent >= 0 && is_small(at(parent)))) continue;
            const FrontPlan::Subtree subtree = {first[f], static_cast<std::int32_t>(f) + 1};
            for (std::int32_t i = subtree.first; i < subtree.end; ++i)
                a_.front[at(i)].subtree = static_cast<std::int32_t>(a_.subtree.size());
            a_.subtree.push_back(subtree);
        }
    }
    // Of the fronts among these that are of one subtree, or of the separator.
    double most_waiting(const FrontPlan::Subtree &among, std::int32_t subtree) const {
        double waits = 0, most = 0;
        for (std::int32_t f = among.first; f < among.end; ++f) {
            const FrontPlan::Front &front = a_.front[at(f)];
            if (front.subtree != subtree) continue;
            most = std::max(most, waits += left_by(front));
            for (const std::int32_t half : front.half)
                if (half >= 0 && a_.front[at(half)].subtree == subtree) waits -= left_by(a_.front[at(half)]);
        }
        return most;
    }
    // What they take: memory, and time beside that of the iteration; strands of that many coiled bonds need some sixty
    // rounds divided by it.
    bool count(std::int64_t most_bytes, FrontPlan &p) const {
        double entries = 0, time = 0;
        for (const FrontPlan::Front &f : a_.front) {
            entries += entries_of(f);
            time += time_of(f);
        }
        const std::int32_t n_fronts = static_cast<std::int32_t>(a_.front.size());
        double waiting = most_waiting({0, n_fronts}, -1), stack = 0;
        for (std::size_t b = 0; b < a_.subtree.size(); ++b) {
            stack = std::max(stack, most_waiting(a_.subtree[b], static_cast<std::int32_t>(b)));
            waiting += left_by(a_.front[at(a_.subtree[b].end - 1)]);
        }
        const double bonds = s_.n_bonds - s_.n_tree,
                     of_round = (s_.has_foreign ? 30.0 : 15.0) * s_.n_unknowns;  // ns
        p.rounds = time / of_round;
        p.at_once = p.rounds * bonds < 60.0 * s_.n_strands;
        return sizeof(double) * (2 * entries + waiting + stack) <= static_cast<double>(most_bytes);
    }

    const NetworkPlan &s_;
    FrontArrays &a_;
    const Cells cells_;
    const std::int32_t n_hubs_;
    Numbers part_of_;         // the leaf of a cell
    Numbers in_part_;         // of a graph's vertices
    Numbers parent_;          // of a front, or -1
    Numbers front_of_;        // of an unknown, then of those of hubs, three each
    Numbers turn_, unknown_;  // of an unknown, when it is eliminated; and the other way round
};

}  // namespace

FrontPlan make_fronts(const NetworkPlan &s, const unsigned char *fixed, std::int64_t most_bytes, FrontArrays &arrays) {
    return FrontMaker(s, fixed, arrays).make(most_bytes);
}

std::size_t bytes_of(const FrontArrays &a) {
    std::size_t bytes = a.front.capacity() * sizeof(a.front[0]) + a.subtree.capacity() * sizeof(a.subtree[0]) +
                        a.spoke.capacity() * sizeof(a.spoke[0]);
    for (const Numbers *list :
         {&a.row, &a.to_parent, &a.node, &a.own_row, &a.foreign_row, &a.partner_row, &a.hub, &a.hub_of})
        bytes += list->capacity() * sizeof(std::int32_t);
    return bytes;
}

}  // namespace holonomic
