#include "graph.hpp"

#include <algorithm>
#include <climits>

namespace holonomic_subdomain {

Graph::Graph(std::vector<double> inverse_masses, std::vector<Bond> given)
    : w(std::move(inverse_masses)), bonds(std::move(given)), first_(w.size() + 1, 0), at_(2 * bonds.size()) {
    for (const Bond &bond : bonds) ++first_[bond.from + 1], ++first_[bond.to + 1];
    for (std::size_t i = 0; i < w.size(); ++i) first_[i + 1] += first_[i];
    std::vector<int> next(first_.begin(), first_.end() - 1);
    for (int k = 0; k < n_bonds(); ++k) {
        at_[next[bonds[k].from]++] = {k, -1.0};
        at_[next[bonds[k].to]++] = {k, 1.0};
    }
}

namespace {

/** Walks along bonds over atoms that can move, from all of some atoms at once. */
struct Walk {
    const Graph &graph;
    std::vector<int> root, steps, reached;  // root, steps: by atom; root -1: not reached

    explicit Walk(const Graph &g) : graph(g), root(g.w.size(), -1), steps(g.w.size(), 0) {}

    void start(int atom, int name) {
        if (graph.w[atom] == 0 || root[atom] >= 0) return;
        root[atom] = name, steps[atom] = 0;
        reached.push_back(atom);
    }

    void go(int most_steps) {
        for (std::size_t k = 0; k < reached.size(); ++k) {
            const int atom = reached[k];
            if (steps[atom] == most_steps) continue;
            for (const Graph::At *at = graph.begin(atom); at != graph.end(atom); ++at) {
                const int other = graph.bonds[at->bond].from + graph.bonds[at->bond].to - atom;
                if (graph.w[other] == 0 || root[other] >= 0) continue;
                root[other] = root[atom], steps[other] = steps[atom] + 1;
                reached.push_back(other);
            }
        }
    }

    void clear() {
        for (int atom : reached) root[atom] = -1;
        reached.clear();
    }
};

}  // namespace

Reach::Reach(const Graph &graph, const std::vector<End> &ends) {
    choose_colours(graph, ends);
    find_pullers(graph, ends);
    first_coupling.assign(1, 0);
    for (int q = 0; q < n_colours; ++q) {
        for (int from : of_colour[q])
            for (int to : near_[from]) couplings.push_back({from, to});
        first_coupling.push_back(static_cast<int>(couplings.size()));
    }
}

void Reach::choose_colours(const Graph &graph, const std::vector<End> &ends) {
    const int n = static_cast<int>(ends.size());
    std::vector<std::vector<int>> at_atom(graph.w.size());
    for (int e = 0; e < n; ++e) at_atom[ends[e].atom].push_back(e);
    // Parts, by the first of their ends
    std::vector<std::vector<int>> parts;
    Walk whole(graph);
    for (int e = 0; e < n; ++e) {
        if (graph.w[ends[e].atom] == 0) continue;
        if (whole.root[ends[e].atom] < 0) {
            whole.start(ends[e].atom, static_cast<int>(parts.size()));
            whole.go(INT_MAX);
            parts.emplace_back();
        }
        parts[whole.root[ends[e].atom]].push_back(e);
    }
    near_.resize(n);
    colour_.assign(n, -1);
    Walk ball(graph);
    for (const std::vector<int> &part : parts) {
        const bool few = static_cast<int>(part.size()) <= few_ends;
        exact = exact && few;
        for (int e : part) {
            if (few) {
                near_[e] = part;
            } else {
                ball.start(ends[e].atom, e);
                ball.go(far);
                for (int atom : ball.reached)
                    near_[e].insert(near_[e].end(), at_atom[atom].begin(), at_atom[atom].end());
                ball.clear();
            }
            std::vector<char> taken(near_[e].size() + 1, 0);
            for (int other : near_[e])
                if (colour_[other] >= 0 && colour_[other] < static_cast<int>(taken.size())) taken[colour_[other]] = 1;
            colour_[e] = static_cast<int>(std::find(taken.begin(), taken.end(), 0) - taken.begin());
            n_colours = std::max(n_colours, colour_[e] + 1);
        }
    }
    of_colour.resize(n_colours);
    for (int e = 0; e < n; ++e)
        if (colour_[e] >= 0) of_colour[colour_[e]].push_back(e);
}

/** Each bond is pulled at by the nearest end of a colour. */
void Reach::find_pullers(const Graph &graph, const std::vector<End> &ends) {
    puller.assign(n_colours, std::vector<int>(graph.bonds.size(), -1));
    for (int q = 0; q < n_colours; ++q) {
        Walk walk(graph);
        for (int e : of_colour[q]) walk.start(ends[e].atom, e);
        walk.go(INT_MAX);
        for (int k = 0; k < graph.n_bonds(); ++k) {
            const int a = graph.bonds[k].from, b = graph.bonds[k].to;
            const int near = walk.root[a] < 0 || (walk.root[b] >= 0 && walk.steps[b] < walk.steps[a]) ? b : a;
            puller[q][k] = walk.root[near];
        }
    }
}

}  // namespace holonomic_subdomain
