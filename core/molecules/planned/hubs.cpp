#include "core/molecules/planned/hubs.hpp"

#include "core/molecules/planned/network.hpp"

namespace holonomic {

namespace {

class CellMaker {
public:
    CellMaker(const NetworkPlan &s, const unsigned char *fixed) : s_(s), fixed_(fixed) {}

    Cells make() {
        find_hubs();
        c_.cell_of.assign(at(s_.n_nodes), -1);
        for (std::int32_t n = 0; n < s_.n_nodes; ++n)
            if (!is_hub(n)) {
                c_.cell_of[at(n)] = c_.size();
                c_.node.push_back(n);
            }
        list_edges();
        place_unknowns();
        for (const std::int32_t n : c_.hub)
            if (!is_fixed(n)) delay_three(n);
        return std::move(c_);
    }

private:
    bool is_hub(std::int32_t n) const { return c_.hub_of[at(n)] >= 0; }
    bool is_fixed(std::int32_t n) const { return fixed_[s_.atom_of[s_.first_node + n]] != 0; }
    bool is_single(std::int32_t u) const { return s_.other_node[u] >= 0; }
    // The node at the other end of an unknown's strand.
    std::int32_t beyond(std::int32_t u) const { return is_single(u) ? s_.other_node[u] : s_.node_of[s_.partner[u]]; }

    void find_hubs() {
        c_.hub_of.assign(at(s_.n_nodes), -1);
        for (std::int32_t n = 0; n < s_.n_nodes; ++n) {
            const std::int32_t ends = s_.nodes[s_.nodes_of[n]].n_own + s_.foreign_start[n + 1] - s_.foreign_start[n];
            if (ends <= most_at_node) continue;
            c_.hub_of[at(n)] = static_cast<std::int32_t>(c_.hub.size());
            c_.hub.push_back(n);
        }
    }
    void list_edges() {
        const Lists strands =
            invert(s_.n_nodes, s_.n_strands, [&](std::int32_t i, int end) { return s_.strand_node[2 * i + end]; });
        WeightedGraph &g = c_.graph;
        g.start.assign(1, 0);
        for (const std::int32_t n : c_.node) {
            for (const std::int32_t *i = strands.begin(n); i != strands.end(n); ++i) {
                const std::int32_t other = s_.strand_node[2 * *i] + s_.strand_node[2 * *i + 1] - n;
                if (other != n && !is_hub(other)) g.edge.push_back({c_.cell_of[at(other)], 1});
            }
            g.start.push_back(static_cast<std::int32_t>(g.edge.size()));
            g.weight.push_back(1);
        }
    }
    void place_unknowns() {
        c_.of_unknown.resize(at(s_.n_unknowns));
        c_.late.assign(at(s_.n_unknowns), 0);
        Numbers beside(c_.hub.size(), 0);  // of a hub, a cell of its bonds
        for (std::int32_t u = 0; u < s_.n_unknowns; ++u) {
            const std::int32_t from = s_.node_of[u], to = beyond(u);
            Cells::Places &p = c_.of_unknown[at(u)];
            p = {c_.cell_of[at(from)], c_.cell_of[at(to)]};
            const bool any_hub = p.own < 0 || p.other < 0;
            if (any_hub && is_single(u))
                c_.late[at(u)] = (p.own < 0 || is_fixed(from)) && (p.other < 0 || is_fixed(to));
            if (p.own < 0 && p.other < 0 && !is_single(u)) {
                const std::int32_t v = s_.partner[u];
                p.own = v < u ? c_.of_unknown[at(v)].own : add_strand();
            }
            if (p.own < 0) p.own = p.other;
            if (p.other < 0) p.other = p.own;
            for (const std::int32_t n : {from, to})
                if (is_hub(n) && p.own >= 0) beside[at(c_.hub_of[at(n)])] = p.own;
        }
        if (c_.size() == 0) add_strand();
        c_.unknowns.assign(at(c_.size()), 0);
        for (std::int32_t u = 0; u < s_.n_unknowns; ++u) {
            Cells::Places &p = c_.of_unknown[at(u)];
            if (p.own < 0) p.own = p.other = beside[at(c_.hub_of[at(s_.node_of[u])])];
            ++c_.unknowns[at(p.own)];
            if (is_single(u) && p.other != p.own) ++c_.unknowns[at(p.other)];
        }
    }
    // Some that are far apart in its list.
    void delay_three(std::int32_t n) {
        Numbers ends(s_.foreign + s_.foreign_start[n], s_.foreign + s_.foreign_start[n + 1]);
        for_own(s_, n, [&](std::int32_t u) { ends.push_back(u); });
        for (std::int32_t i = 0; i < 3; ++i) c_.late[at(ends[ends.size() * at(i) / 3])] = 1;
    }
    // A cell without edges.
    std::int32_t add_strand() {
        c_.node.push_back(-1);
        c_.graph.start.push_back(c_.graph.start.back());
        c_.graph.weight.push_back(1);
        return c_.size() - 1;
    }

    const NetworkPlan &s_;
    const unsigned char *fixed_;
    Cells c_;
};

}  // namespace

Cells cells_of(const NetworkPlan &s, const unsigned char *fixed) { return CellMaker(s, fixed).make(); }

}  // namespace holonomic
