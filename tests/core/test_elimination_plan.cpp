// The order of elimination of chains, trees, rings and other graphs.
#include <algorithm>
#include <random>

#include "plan_checks.hpp"

using namespace plan_checks;

namespace
{

Bonds random_tree(int n_atoms, int valence, std::mt19937 &random)
{
    Bonds bonds;
    std::vector<int> degree(static_cast<std::size_t>(n_atoms)), name(static_cast<std::size_t>(n_atoms));
    for (int i = 0; i < n_atoms; ++i) name[static_cast<std::size_t>(i)] = i;
    std::shuffle(name.begin(), name.end(), random);
    for (int i = 1; i < n_atoms; ++i) {
        int j;
        do j = static_cast<int>(random() % static_cast<unsigned>(i));
        while (degree[static_cast<std::size_t>(j)] >= valence);
        ++degree[static_cast<std::size_t>(j)];
        ++degree[static_cast<std::size_t>(i)];
        bonds.push_back({name[static_cast<std::size_t>(i)], name[static_cast<std::size_t>(j)]});
    }
    return bonds;
}

Bonds ring(int n)
{
    Bonds bonds;
    for (int i = 0; i < n; ++i) bonds.push_back({i, (i + 1) % n});
    return bonds;
}

void small_shapes()
{
    check("one bond", {{0, 1}}, 2, EliminationPlan::tree);
    check("methane", {{0, 1}, {0, 2}, {0, 3}, {0, 4}}, 5, EliminationPlan::tree);
    check("triangle", {{0, 1}, {0, 2}, {1, 2}}, 3, EliminationPlan::triangle);
    check("ring of four", ring(4), 4, EliminationPlan::ring);
    check("ring of 50", ring(50), 50, EliminationPlan::ring);
    const auto lariat = check("lariat", {{0, 1}, {1, 2}, {2, 0}, {2, 3}, {3, 4}, {3, 5}}, 6, EliminationPlan::ring);
    require(lariat->n_tree == 3 && lariat->n_core == 3, "the tail is not a tree");
    Bonds hairy = ring(6);
    for (int i = 0; i < 6; ++i)
        for (int k = 0; k < 2; ++k) hairy.push_back({i, 6 + 2 * i + k});
    check("cyclohexane", hairy, 18, EliminationPlan::ring);
    hairy.push_back({0, 18});
    check("a ring with three children at an atom", hairy, 19, EliminationPlan::graph);
    Bonds lasso = ring(200);
    for (int i = 200; i <= holonomic::largest_graph_in_lanes; ++i) lasso.push_back({i - 1, i});
    check("a large lasso", lasso, holonomic::largest_graph_in_lanes + 1, EliminationPlan::graph);
    lasso.pop_back();
    check("a smaller lasso", lasso, holonomic::largest_graph_in_lanes, EliminationPlan::ring);
    check("tetrahedron", {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}, 4, EliminationPlan::graph);
    check("two rings and what joins them", {{0, 1}, {1, 2}, {2, 0}, {2, 3}, {3, 4}, {4, 5}, {5, 6}, {6, 4}}, 7,
          EliminationPlan::graph);
    Bonds strip;
    for (int i = 0; i + 1 < 40; ++i) {
        strip.push_back({i, i + 1});
        if (i + 2 < 40) strip.push_back({i, i + 2});
    }
    const auto s = check("triangle strip", strip, 40, EliminationPlan::graph);
    require(s->ldl->n_entries < 4 * s->n_core, "a strip fills");
}

void random_shapes()
{
    std::mt19937 random(7);
    for (int n = 2; n < 200; ++n) {
        Bonds bonds = random_tree(n, 2 + n % 5, random);
        check("random tree", bonds, n, EliminationPlan::tree);
        if (n < 5) continue;
        for (int extra = 0; extra < 1 + n / 20; ++extra) {
            const int i = static_cast<int>(random() % static_cast<unsigned>(n)),
                      j = static_cast<int>(random() % static_cast<unsigned>(n));
            bool there = i == j;
            for (const auto &b : bonds)
                there = there || (b.first == i && b.second == j) || (b.first == j && b.second == i);
            if (!there) bonds.push_back({i, j});
        }
        const auto s = plan_of_bonds(bonds, n);
        check("random graph", bonds, n, s->type);
    }
}

void large_shapes()
{
    std::mt19937 random(3);
    check("large random tree", random_tree(300000, 4, random), 300000, EliminationPlan::tree);
    check("large ring", ring(300000), 300000, EliminationPlan::ring);
    Bonds strip = ring(300000);
    for (int i = 0; i + 2 < 300000; ++i) strip.push_back({i, i + 2});
    const auto s = check("large strip", strip, 300000, EliminationPlan::graph);
    require(s->ldl->n_entries < 8 * s->n_core, "a large strip fills");
}

// Two halves of what is long, more of what forks, and none of what is small.
void subtrees()
{
    const auto strip_of = [](int n) {
        Bonds strip;
        for (int i = 0; i + 1 < n; ++i)
            for (int k = i + 1; k < i + 3 && k < n; ++k) strip.push_back({i, k});
        return plan_of_bonds(strip, n);
    };
    branches_need_nothing_of_others(*strip_of(30000)->ldl, 2, 0.51);
    branches_need_nothing_of_others(*strip_of(5001)->ldl, 2, 0.51);
    require(strip_of(2000)->ldl->n_subtrees == 0, "a small strip has branches");
    std::mt19937 random(5);
    const int n = 100000;
    Bonds bonds = random_tree(n, 4, random);
    branches_need_nothing_of_others(*plan_of_bonds(bonds, n)->ldl, 10, 0.07);
    for (int i = 0; i + 40 < n; i += 40) bonds.push_back({i, i + 39});
    std::sort(bonds.begin(), bonds.end());
    bonds.erase(std::unique(bonds.begin(), bonds.end()), bonds.end());
    const auto graph = plan_of_bonds(bonds, n);
    if (graph->ldl) branches_need_nothing_of_others(*graph->ldl, 2, 0.67);
}

}  // namespace

int main()
{
    small_shapes();
    random_shapes();
    large_shapes();
    subtrees();
    return 0;
}
