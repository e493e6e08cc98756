// What holds of the order of elimination of any molecule: numbers are permutations, parents come behind their children,
// and what the lists of the core say solves a system as dense elimination does.
#ifndef HOLONOMIC_TESTS_SCHEDULE_CHECKS_HPP
#define HOLONOMIC_TESTS_SCHEDULE_CHECKS_HPP

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "core/molecules/schedule.hpp"

namespace schedule_checks
{

using holonomic::make_schedule;
using holonomic::Schedule;
using Bonds = std::vector<std::pair<int, int>>;

inline const char *current = "";

inline void require(bool condition, const char *what)
{
    if (condition) return;
    std::printf("%s: %s\n", current, what);
    std::exit(1);
}

inline std::unique_ptr<const Schedule> schedule_of(const Bonds &bonds, int n_atoms)
{
    std::vector<std::int32_t> pairs;
    for (const auto &b : bonds) {
        pairs.push_back(b.first);
        pairs.push_back(b.second);
    }
    return make_schedule(n_atoms, static_cast<std::int32_t>(bonds.size()), pairs.data(), nullptr);
}

inline void numbers_are_permutations(const Schedule &s)
{
    for (int i = 0; i < s.n_atoms; ++i)
        require(s.slot_of[s.atom_of[i]] == i && s.atom_of[s.slot_of[i]] == i, "slots are no permutation");
    std::vector<int> placed(static_cast<std::size_t>(s.n_bonds));
    for (int p = 0; p < s.n_bonds; ++p)
        require(placed[static_cast<std::size_t>(s.bond_of[p])]++ == 0, "places are no permutation");
    require(s.n_tree + s.n_core == s.n_bonds, "bonds are missing");
}

inline void joins(const Schedule &s, int place, int slot, int other, const char *what)
{
    const int i = s.atom_i[s.bond_of[place]], j = s.atom_j[s.bond_of[place]], a = s.atom_of[slot], b = s.atom_of[other];
    require((i == a && j == b) || (i == b && j == a), what);
}

inline void trees_are_in_post_order(const Schedule &s)
{
    int children = 0;
    for (int k = 0; k < s.n_tree; ++k) {
        require(s.parent[k] > k, "a parent before its child");
        joins(s, k, k, s.parent[k], "the bond of a place joins other atoms");
    }
    for (int i = 0; i < s.n_atoms; ++i) {
        const int n = s.child_start[i + 1] - s.child_start[i];
        require(n <= s.max_children, "more children than the most");
        require(
            s.pair_start[i + 1] - s.pair_start[i] == (i < s.n_tree ? holonomic::values_of_joint(n) : n * (n - 1) / 2),
            "places for pairs");
        for (int c = s.child_start[i]; c < s.child_start[i + 1]; ++c, ++children)
            require(s.parent[s.child[c]] == i, "a child of another atom");
        if (n > 0 && (i < s.n_tree || s.type == Schedule::tree))
            require(s.child[s.child_start[i + 1] - 1] == i - 1, "the last child's slot is not the one before");
    }
    require(children == s.n_tree, "children are missing");
    if (s.type == Schedule::tree)
        require(s.child_start[s.n_tree + 1] - s.child_start[s.n_tree] == 1, "a root with several bonds");
}

inline void meetings_are_right(const Schedule &s)
{
    for (int p = 0; p < s.n_core && s.type == Schedule::ring; ++p)
        require(s.from[p] == s.n_tree + p && s.to[p] == s.n_tree + (p + 1) % s.n_core, "a ring that does not go round");
    for (int p = 0; p < s.n_core; ++p)
        joins(s, s.n_tree + p, s.from[p], s.to[p], "a bond of the core joins other atoms");
    int n = 0;
    for (int c = 0; c < s.n_core_atoms; ++c) {
        const int *pair = s.flat ? nullptr : s.meet_pair + s.meet_pair_start[c];  // a list has an order of its own
        for (int a = s.meet_start[c]; a < s.meet_start[c + 1]; ++a, ++n) {
            const int p = s.meet[a] / 2, slot = s.n_tree + c;
            require((s.meet[a] % 2 ? s.to : s.from)[p] == slot, "a bond that does not meet the atom");
            for (int b = s.meet_start[c]; b < a && !s.flat; ++b, ++pair) {
                const int q = s.meet[b] / 2, row = p > q ? p : q, column = p > q ? q : p;
                require(*pair >= s.column_start[column] && *pair < s.column_start[column + 1] && s.row[*pair] == row,
                        "the entry of a pair of bonds");
            }
        }
        require(s.flat || pair == s.meet_pair + s.meet_pair_start[c + 1], "pairs are missing");
    }
    require(n == 2 * s.n_core, "meetings are missing");
}

// A random positive definite matrix with the pattern of the core, by the lists and densely.
inline void lists_solve_the_core(const Schedule &s, std::mt19937 &random)
{
    std::normal_distribution<double> normal;
    const std::size_t n = static_cast<std::size_t>(s.n_core);
    std::vector<double> entry(static_cast<std::size_t>(s.n_entries)), diagonal(n), x(n), rhs(n);
    std::vector<std::vector<double>> dense(n, std::vector<double>(n));
    for (int i = 0; i < s.meet_pair_start[s.n_core_atoms]; ++i)
        entry[static_cast<std::size_t>(s.meet_pair[i])] = normal(random);
    for (std::size_t p = 0; p < n; ++p)
        for (int e = s.column_start[p]; e < s.column_start[p + 1]; ++e)
            dense[static_cast<std::size_t>(s.row[e])][p] = dense[p][static_cast<std::size_t>(s.row[e])] =
                entry[static_cast<std::size_t>(e)];
    for (std::size_t p = 0; p < n; ++p) {
        double sum = 1;
        for (const double a : dense[p]) sum += std::fabs(a);
        diagonal[p] = dense[p][p] = sum;
        x[p] = normal(random);
    }
    for (std::size_t p = 0; p < n; ++p)
        for (std::size_t q = 0; q < n; ++q) rhs[p] += dense[p][q] * x[q];
    for (std::size_t p = 0; p < n; ++p) {  // LDL^T; entries become multipliers
        const int first = s.column_start[p], m = s.column_start[p + 1] - first;
        double *const column = entry.data() + first;
        const int *update = s.update + s.update_start[p];
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
        for (int e = s.column_start[p]; e < s.column_start[p + 1]; ++e)
            rhs[p] -= entry[static_cast<std::size_t>(e)] * rhs[static_cast<std::size_t>(s.row[e])];
        require(std::fabs(rhs[p] - x[p]) < 1e-11, "the core's lists do not solve it");
    }
}

inline std::unique_ptr<const Schedule> check(const char *name, const Bonds &bonds, int n_atoms, Schedule::Type type)
{
    static std::mt19937 random(1);
    current = name;
    auto s = schedule_of(bonds, n_atoms);
    require(s->type == type, "another type");
    numbers_are_permutations(*s);
    trees_are_in_post_order(*s);
    meetings_are_right(*s);
    if (s->n_core <= 300 && !s->flat) lists_solve_the_core(*s, random);
    return s;
}

}  // namespace schedule_checks
#endif
