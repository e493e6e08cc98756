#include "core/molecules/given/count.hpp"
#include "core/index.hpp"

#include <algorithm>
#include <utility>

namespace holonomic {

namespace {

constexpr const char *too_many =
    "is one too many: the atoms that it and the bonds around it join have fewer freedoms than bonds; "
    "hol_chains_add_rigid holds such a part by coordinates";

// Whether an atom has four others beside it that have four bonds or are fixed: where none has, nothing would be left by
// BondGraph::strip().
bool may_be_left(const Draft &draft) {
    std::vector<unsigned char> degree(draft.atoms.size(), 0), strong(draft.atoms.size(), 0);  // up to four
    const auto count = [](unsigned char &n) { n = static_cast<unsigned char>(n + (n < 4)); };
    for (const std::int32_t i : draft.pairs) count(degree[at(i)]);
    for (std::size_t i = 0; i < degree.size(); ++i)
        if (draft.fixed[i]) degree[i] = 4;
    for (std::size_t k = 0; k < draft.bonds.size(); ++k) {
        const std::size_t i = at(draft.pairs[2 * k]), j = at(draft.pairs[2 * k + 1]);
        if (degree[i] < 4 || degree[j] < 4) continue;
        if (count(strong[i]); strong[i] == 4 && !draft.fixed[i]) return true;
        if (count(strong[j]); strong[j] == 4 && !draft.fixed[j]) return true;
    }
    return false;
}

// The molecule as a graph in which a fixed atom is one atom, however many bonds it ends.
class BondGraph {
public:
    BondGraph(const Draft &draft, std::int64_t bonds_round)
        : draft_(draft), bonds_round_(bonds_round), vertex_(draft.atoms.size()) {
        std::int32_t n = -1;
        for (std::size_t i = 0; i < vertex_.size(); ++i) {
            if (i == 0 || draft.atoms[i] != draft.atoms[i - 1]) ++n;
            vertex_[i] = n;
        }
        const std::size_t n_vertices = at(n) + 1;
        start_.assign(n_vertices + 1, 0);
        fixed_.resize(n_vertices);
        for (std::size_t i = 0; i < vertex_.size(); ++i) fixed_[at(vertex_[i])] = draft.fixed[i];
        for (const std::int32_t i : draft.pairs) ++start_[at(vertex_[at(i)]) + 1];
        for (std::size_t v = 0; v < n_vertices; ++v) start_[v + 1] += start_[v];
        bond_.resize(draft.pairs.size());
        std::vector<std::int32_t> next(start_);
        for (std::size_t e = 0; e < draft.pairs.size(); ++e)
            bond_[at(next[end(e)]++)] = static_cast<std::int32_t>(e / 2);
    }

    // Takes away movable atoms with at most three bonds until there are none; false if nothing is left.
    bool strip() {
        const std::size_t n = fixed_.size();
        degree_.resize(n);
        gone_.assign(n, 0);
        std::vector<std::size_t> stack;
        for (std::size_t v = 0; v < n; ++v) {
            degree_[v] = start_[v + 1] - start_[v];
            if (!fixed_[v] && degree_[v] <= 3) stack.push_back(v);
        }
        std::size_t left = static_cast<std::size_t>(std::count(fixed_.begin(), fixed_.end(), 0));
        while (!stack.empty()) {
            const std::size_t v = stack.back();
            stack.pop_back();
            if (gone_[v]) continue;
            gone_[v] = 1;
            --left;
            for (std::int32_t b = start_[v]; b < start_[v + 1]; ++b) {
                const std::size_t u = other(bond_[at(b)], v);
                if (!fixed_[u] && !gone_[u] && --degree_[u] <= 3) stack.push_back(u);
            }
        }
        return left > 0;
    }

    // The last bond of a part that has more bonds than freedoms, or -1.
    std::int64_t overfull() const {
        std::vector<unsigned char> seen(fixed_.size(), 0);
        for (std::size_t v = 0; v < fixed_.size(); ++v) {
            if (fixed_[v] || gone_[v] || seen[v]) continue;
            const std::int64_t bond = overfull_part(v, seen);
            if (bond >= 0) return bond;
        }
        return -1;
    }

    // The last bond of five atoms that are all bonded to each other, or -1.
    std::int64_t five_bonded() {
        if (may_go_round(5)) return -1;
        list_partners();
        for (std::size_t k = 0; k < draft_.bonds.size(); ++k) {
            std::size_t u = end(2 * k), v = end(2 * k + 1);
            if (gone_[u] || gone_[v] || fixed_[u] || fixed_[v]) continue;
            if (n_bonds(v) < n_bonds(u)) std::swap(u, v);  // which may be a hub
            std::vector<std::size_t> both;
            for (std::int32_t b = start_[u]; b < start_[u + 1]; ++b) {
                const std::size_t x = other(bond_[at(b)], u);
                if (x != v && bond_between(x, v) >= 0) both.push_back(x);
            }
            for (std::size_t a = 2; a < both.size(); ++a)
                for (std::size_t b = 1; b < a; ++b)
                    for (std::size_t c = 0; c < b; ++c)
                        if (bond_between(both[a], both[b]) >= 0 && bond_between(both[b], both[c]) >= 0 &&
                            bond_between(both[a], both[c]) >= 0)
                            return last_among({u, v, both[a], both[b], both[c]});
        }
        return -1;
    }

private:
    // Whether cycles of so many bonds are long enough for it.
    bool may_go_round(std::int64_t n) const { return bonds_round_ > 0 && n >= bonds_round_; }
    std::size_t end(std::size_t e) const { return at(vertex_[at(draft_.pairs[e])]); }
    std::size_t other(std::int32_t bond, std::size_t v) const {
        const std::size_t first = end(2 * at(bond));
        return first == v ? end(2 * at(bond) + 1) : first;
    }
    std::int32_t n_bonds(std::size_t v) const { return start_[v + 1] - start_[v]; }
    std::int64_t bond_between(std::size_t u, std::size_t v) const {
        if (n_bonds(v) < n_bonds(u)) std::swap(u, v);
        const auto begin = partner_.begin() + start_[u], end = partner_.begin() + start_[u + 1];
        const Partner wanted = {static_cast<std::int32_t>(v), 0};
        const auto found = std::lower_bound(begin, end, wanted);
        return found == end || found->first != wanted.first ? -1 : draft_.bonds[at(found->second)];
    }
    std::int64_t last_among(const std::vector<std::size_t> &atoms) const {
        std::int64_t last = -1;
        for (std::size_t u : atoms)
            for (std::size_t v : atoms) last = std::max(last, u < v ? bond_between(u, v) : -1);
        return last;
    }

    void list_partners() {
        for (std::size_t v = 0; v + 1 < start_.size(); ++v) {
            for (std::int32_t b = start_[v]; b < start_[v + 1]; ++b)
                partner_.emplace_back(static_cast<std::int32_t>(other(bond_[at(b)], v)), bond_[at(b)]);
            std::sort(partner_.begin() + start_[v], partner_.end());
        }
    }

    std::int64_t overfull_part(std::size_t from, std::vector<unsigned char> &seen) const {
        std::vector<std::size_t> stack{from}, fixed;
        std::int64_t n = 0, ends = 0, ends_at_fixed = 0, last = -1;
        seen[from] = 1;
        while (!stack.empty()) {
            const std::size_t v = stack.back();
            stack.pop_back();
            ++n;
            for (std::int32_t b = start_[v]; b < start_[v + 1]; ++b) {
                const std::size_t u = other(bond_[at(b)], v);
                if (gone_[u]) continue;
                last = std::max(last, draft_.bonds[at(bond_[at(b)])]);
                ++ends;
                if (fixed_[u]) {
                    ++ends_at_fixed;
                    fixed.push_back(u);
                } else if (!seen[u]) {
                    seen[u] = 1;
                    stack.push_back(u);
                }
            }
        }
        std::sort(fixed.begin(), fixed.end());
        const std::int64_t n_fixed = std::unique(fixed.begin(), fixed.end()) - fixed.begin();
        const std::int64_t turns = may_go_round(n + n_fixed) ? 0 : n_fixed <= 1 ? 3 : n_fixed == 2 ? 1 : 0;
        const std::int64_t rigid = n_fixed == 0 ? 3 + turns : turns;  // motions as a whole
        return (ends + ends_at_fixed) / 2 > 3 * n - rigid ? last : -1;
    }

    const Draft &draft_;
    const std::int64_t bonds_round_;
    std::vector<std::int32_t> vertex_;  // of each place in the draft
    std::vector<unsigned char> fixed_, gone_;
    std::vector<std::int32_t> start_, bond_, degree_;  // the bonds of each vertex
    typedef std::pair<std::int32_t, std::int32_t> Partner;
    std::vector<Partner> partner_;  // of each vertex, ascending, and the bond to it
};

}  // namespace

void check_count(const BondList &list, const Draft &draft) {
    const std::int64_t n_bonds = static_cast<std::int64_t>(draft.bonds.size());
    const std::int64_t n_atoms = static_cast<std::int64_t>(draft.atoms.size());
    const std::int64_t n_fixed = std::count(draft.fixed.begin(), draft.fixed.end(), 1);
    // Five atoms with ten bonds have six independent cycles; no part with fewer is overfull, unless atoms are fixed.
    if (n_bonds - n_atoms < 5 && n_fixed < 4) return;
    if (!may_be_left(draft)) return;
    BondGraph graph(draft, list.bonds_round);
    if (!graph.strip()) return;
    std::int64_t bond = graph.overfull();
    if (bond < 0) bond = graph.five_bonded();
    if (bond >= 0) throw bond_error(list, Status::degenerate, bond, too_many);
}

}  // namespace holonomic
