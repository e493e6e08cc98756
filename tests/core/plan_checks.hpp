// What holds of the order of elimination of any molecule: numbers are permutations, parents come behind their children,
// and what a list says solves a system as dense elimination does.
#ifndef HOLONOMIC_TESTS_PLAN_CHECKS_HPP
#define HOLONOMIC_TESTS_PLAN_CHECKS_HPP

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "core/molecules/planned/elimination_plan.hpp"
#include "core/plan/sparse_ldl.hpp"

namespace plan_checks
{

using holonomic::EliminationPlan;
using holonomic::make_elimination_plan;
using Bonds = std::vector<std::pair<int, int>>;

inline const char *current = "";

inline void require(bool condition, const char *what)
{
    if (condition) return;
    std::printf("%s: %s\n", current, what);
    std::exit(1);
}

inline std::unique_ptr<const EliminationPlan> plan_of_bonds(const Bonds &bonds, int n_atoms)
{
    std::vector<std::int32_t> pairs;
    for (const auto &b : bonds) {
        pairs.push_back(b.first);
        pairs.push_back(b.second);
    }
    return make_elimination_plan(n_atoms, static_cast<std::int32_t>(bonds.size()), pairs.data(), nullptr);
}

inline void numbers_are_permutations(const EliminationPlan &s)
{
    for (int i = 0; i < s.n_atoms; ++i)
        require(s.index_of[s.atom_of[i]] == i && s.atom_of[s.index_of[i]] == i, "indices are no permutation");
    std::vector<int> placed(static_cast<std::size_t>(s.n_bonds));
    for (int p = 0; p < s.n_bonds; ++p)
        require(placed[static_cast<std::size_t>(s.bond_of[p])]++ == 0, "places are no permutation");
    require(s.n_tree + s.n_core == s.n_bonds, "bonds are missing");
}

inline void joins(const EliminationPlan &s, int bond_index, int index, int other, const char *what)
{
    const int i = s.atom_i[s.bond_of[bond_index]], j = s.atom_j[s.bond_of[bond_index]], a = s.atom_of[index],
              b = s.atom_of[other];
    require((i == a && j == b) || (i == b && j == a), what);
}

inline void trees_are_in_order(const EliminationPlan &s)
{
    int children = 0;
    for (int k = 0; k < s.n_tree; ++k) {
        require(s.parent[k] > k, "a parent before its child");
        joins(s, k, k, s.parent[k], "the bond of a bond_index joins other atoms");
    }
    for (int i = 0; i < s.n_atoms; ++i) {
        const int n = s.child_start[i + 1] - s.child_start[i];
        require(n <= s.max_children, "more children than the most");
        require(
            s.pair_start[i + 1] - s.pair_start[i] == (i < s.n_tree ? holonomic::values_of_joint(n) : n * (n - 1) / 2),
            "places for pairs");
        for (int c = s.child_start[i]; c < s.child_start[i + 1]; ++c, ++children)
            require(s.parent[s.child[c]] == i, "a child of another atom");
        if (n == 0 || (i >= s.n_tree && s.type != EliminationPlan::tree)) continue;
        if (s.n_bonds > holonomic::largest_in_lanes)
            require(s.child[s.child_start[i + 1] - 1] == i - 1, "the last child's index is not the one before");
        for (int c = s.child_start[i]; c < s.child_start[i + 1] && s.n_bonds <= holonomic::largest_in_lanes; ++c)
            require(s.child[c] == c, "children of other atoms between those of an atom");
    }
    require(children == s.n_tree, "children are missing");
    if (s.type == EliminationPlan::tree)
        require(s.child_start[s.n_tree + 1] - s.child_start[s.n_tree] == 1, "a root with several bonds");
}

inline void meetings_are_right(const EliminationPlan &s)
{
    for (int p = 0; p < s.n_core && s.type == EliminationPlan::ring; ++p)
        require(s.from[p] == s.n_tree + p && s.to[p] == s.n_tree + (p + 1) % s.n_core, "a ring that does not go round");
    for (int p = 0; p < s.n_core; ++p)
        joins(s, s.n_tree + p, s.from[p], s.to[p], "a bond of the core joins other atoms");
    int n = 0;
    for (int c = 0; c < s.n_core_atoms; ++c)
        for (int a = s.meet_start[c]; a < s.meet_start[c + 1]; ++a, ++n)
            require(s.from[s.meet[a]] == s.n_tree + c || s.to[s.meet[a]] == s.n_tree + c,
                    "a bond that does not meet the atom");
    require(n == 2 * s.n_core, "meetings are missing");
}

// A random positive definite matrix in which all bonds at an atom are coupled, by the list and densely.
inline void list_solves(const holonomic::LdlPlan &s, std::mt19937 &random)
{
    std::normal_distribution<double> normal;
    const std::size_t n = static_cast<std::size_t>(s.n_bonds);
    std::vector<int> start = {0};
    for (const auto *run = s.run; start.size() <= n; ++run)
        for (int i = 0; i < run->columns; ++i) start.push_back(start.back() + run->entries);
    std::vector<double> entry(static_cast<std::size_t>(s.n_entries)), diagonal(n), x(n), rhs(n);
    std::vector<std::vector<double>> dense(n, std::vector<double>(n));
    for (std::size_t p = 0; p < n; ++p)
        for (int e = start[p]; e < start[p + 1]; ++e) {
            const std::size_t row = static_cast<std::size_t>(s.row[e]);
            require(row > p && row < n, "a row before its column");
            int shared = 0;
            for (const int i : {s.from[p], s.to[p]}) shared += i == s.from[row] || i == s.to[row];
            if (shared > 0) {
                require(s.row_4[e] == 4 * s.row[e] && s.column_4[e] == 4 * static_cast<int>(p),
                        "the bonds of an entry");
                const int atom = s.mass[e] / 2, sign = s.mass[e] % 2;
                require(4 * atom == s.from[p] || 4 * atom == s.to[p], "the mass of another atom");
                require(sign == ((4 * atom == s.from[p]) == (4 * atom == s.from[row])), "another sign");
                entry[static_cast<std::size_t>(e)] = dense[row][p] = dense[p][row] = normal(random);
            }
        }
    for (std::size_t p = 0; p < n; ++p)
        for (std::size_t q = 0; q < p; ++q) {
            bool shared = false;
            for (const int i : {s.from[p], s.to[p]}) shared = shared || i == s.from[q] || i == s.to[q];
            require(shared == (dense[p][q] != 0), "an entry is missing");
        }
    for (std::size_t p = 0; p < n; ++p) {
        double sum = 1;
        for (const double a : dense[p]) sum += std::fabs(a);
        diagonal[p] = dense[p][p] = sum;
        x[p] = normal(random);
    }
    for (std::size_t p = 0; p < n; ++p)
        for (std::size_t q = 0; q < n; ++q) rhs[p] += dense[p][q] * x[q];
    const int *update = s.update;
    for (std::size_t p = 0; p < n; ++p) {  // L D L^T; entries become multipliers
        const int first = start[p], m = start[p + 1] - first;
        double *const column = entry.data() + first;
        for (int a = 0; a < m; ++a) {
            const std::size_t row = static_cast<std::size_t>(s.row[first + a]);
            const double l = column[a] / diagonal[p];
            for (int b = 0; b < a; ++b) entry[static_cast<std::size_t>(*update++)] -= l * column[b];
            diagonal[row] -= l * column[a];
        }
        for (int a = 0; a < m; ++a) {
            column[a] /= diagonal[p];
            rhs[static_cast<std::size_t>(s.row[first + a])] -= column[a] * rhs[p];
        }
    }
    for (std::size_t p = n; p-- > 0;) {
        rhs[p] /= diagonal[p];
        for (int e = start[p]; e < start[p + 1]; ++e)
            rhs[p] -= entry[static_cast<std::size_t>(e)] * rhs[static_cast<std::size_t>(s.row[e])];
        require(std::fabs(rhs[p] - x[p]) < 1e-11, "the list does not solve it");
    }
}

// Branches of a list: what the columns of one give goes to columns of the same tile, to contributions that one tile
// alone has, and from there to later tiles of the same branch or to the separator.
inline void branches_need_nothing_of_others(const holonomic::LdlPlan &s, int least, double largest)
{
    require(s.n_subtrees >= least, "too few branches");
    std::vector<int> branch_of, tile_of_contribution(static_cast<std::size_t>(s.n_columns), -1);
    for (int b = 0; b <= s.n_subtrees; ++b) {
        require(s.subtree[b].first == static_cast<int>(branch_of.size()), "tiles of two branches, or of none");
        branch_of.resize(static_cast<std::size_t>(s.subtree[b].end), b);
    }
    require(static_cast<int>(branch_of.size()) == s.n_tiles, "tiles behind the trunk");
    std::vector<int> columns(static_cast<std::size_t>(s.n_subtrees) + 1);
    for (int t = 0; t < s.n_tiles; ++t) {
        const auto &tile = s.tile[t];
        require(tile.first % 4 == 0, "a tile shares four columns with the one before");
        columns[static_cast<std::size_t>(branch_of[static_cast<std::size_t>(t)])] += tile.end - tile.first;
        for (int e = tile.first_entry; e < tile.end_entry; ++e) {
            if (s.row[e] < s.n_bonds) {
                require(s.row[e] >= tile.first && s.row[e] < tile.end, "a row in another tile");
                continue;
            }
            int &owner = tile_of_contribution[static_cast<std::size_t>(s.row[e])];
            require(owner < 0 || owner == t, "two tiles have one contribution");
            owner = t;
        }
        for (int i = tile.first_late; i < tile.end_late; ++i) {
            const int from = tile_of_contribution[static_cast<std::size_t>(s.late[i].contribution)],
                      giver = branch_of[static_cast<std::size_t>(from)];
            require(s.late[i].number >= tile.first && s.late[i].number < tile.end, "a late column of another tile");
            require(from < t && (giver == branch_of[static_cast<std::size_t>(t)] ||
                                 branch_of[static_cast<std::size_t>(t)] == s.n_subtrees),
                    "a branch gives to another");
        }
    }
    for (int b = 0; b < s.n_subtrees; ++b)
        require(columns[static_cast<std::size_t>(b)] <= largest * s.n_bonds, "a branch is too large");
    require(columns.back() < s.n_bonds / 64, "the trunk is too long");
}

inline std::unique_ptr<const EliminationPlan> check(const char *name, const Bonds &bonds, int n_atoms,
                                                    EliminationPlan::CoreType type)
{
    static std::mt19937 random(1);
    current = name;
    auto s = plan_of_bonds(bonds, n_atoms);
    require(s->type == type, "another type");
    numbers_are_permutations(*s);
    trees_are_in_order(*s);
    meetings_are_right(*s);
    require((type == EliminationPlan::graph) == (s->ldl || s->network) || s->n_bonds > 2048, "a graph has a list");
    if (s->ldl && s->n_bonds <= 300) list_solves(*s->ldl, random);
    return s;
}

}  // namespace plan_checks
#endif
