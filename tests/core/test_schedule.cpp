// The order of elimination of molecules: numbers are permutations, parents come behind their children, and what the
// lists of the core say solves a system as dense elimination does.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <utility>
#include <vector>

#include "core/molecules/schedule.hpp"

using holonomic::make_schedule;
using holonomic::Schedule;
using Bonds = std::vector<std::pair<int, int>>;

namespace
{

const char *current = "";

void require(bool condition, const char *what)
{
    if (condition) return;
    std::printf("%s: %s\n", current, what);
    std::exit(1);
}

std::unique_ptr<const Schedule> schedule_of(const Bonds &bonds, int n_atoms)
{
    std::vector<std::int32_t> pairs;
    for (const auto &b : bonds) {
        pairs.push_back(b.first);
        pairs.push_back(b.second);
    }
    return make_schedule(n_atoms, static_cast<std::int32_t>(bonds.size()), pairs.data(), nullptr);
}

void numbers_are_permutations(const Schedule &s)
{
    for (int i = 0; i < s.n_atoms; ++i)
        require(s.slot_of[s.atom_of[i]] == i && s.atom_of[s.slot_of[i]] == i, "slots are no permutation");
    for (int k = 0; k < s.n_bonds; ++k)
        require(s.place_of[s.bond_of[k]] == k && s.bond_of[s.place_of[k]] == k, "places are no permutation");
    require(s.n_tree + s.n_core == s.n_bonds, "bonds are missing");
}

void joins(const Schedule &s, int place, int slot, int other, const char *what)
{
    const int i = s.atom_i[s.bond_of[place]], j = s.atom_j[s.bond_of[place]], a = s.atom_of[slot], b = s.atom_of[other];
    require((i == a && j == b) || (i == b && j == a), what);
}

void trees_are_in_post_order(const Schedule &s)
{
    int children = 0;
    for (int k = 0; k < s.n_tree; ++k) {
        require(s.parent[k] > k, "a parent before its child");
        joins(s, k, k, s.parent[k], "the bond of a place joins other atoms");
    }
    for (int i = 0; i < s.n_atoms; ++i) {
        const int n = s.child_start[i + 1] - s.child_start[i];
        require(n <= s.max_children, "more children than the most");
        require(s.pair_start[i + 1] - s.pair_start[i] == n * (n - 1) / 2, "places for pairs");
        for (int c = s.child_start[i]; c < s.child_start[i + 1]; ++c, ++children)
            require(s.parent[s.child[c]] == i, "a child of another atom");
    }
    require(children == s.n_tree, "children are missing");
    if (s.type == Schedule::tree)
        require(s.child_start[s.n_tree + 1] - s.child_start[s.n_tree] == 1, "a root with several bonds");
}

void meetings_are_right(const Schedule &s)
{
    for (int p = 0; p < s.n_core; ++p)
        joins(s, s.n_tree + p, s.from[p], s.to[p], "a bond of the core joins other atoms");
    int n = 0;
    for (int c = 0; c < s.n_core_atoms; ++c) {
        const int *pair = s.meet_pair + s.meet_pair_start[c];
        for (int a = s.meet_start[c]; a < s.meet_start[c + 1]; ++a, ++n) {
            const int p = s.meet[a] / 2, slot = s.n_tree + c;
            require((s.meet[a] % 2 ? s.to : s.from)[p] == slot, "a bond that does not meet the atom");
            for (int b = s.meet_start[c]; b < a; ++b, ++pair) {
                const int q = s.meet[b] / 2, row = p > q ? p : q, column = p > q ? q : p;
                require(*pair >= s.column_start[column] && *pair < s.column_start[column + 1] && s.row[*pair] == row,
                        "the entry of a pair of bonds");
            }
        }
        require(pair == s.meet_pair + s.meet_pair_start[c + 1], "pairs are missing");
    }
    require(n == 2 * s.n_core, "meetings are missing");
}

// A random positive definite matrix with the pattern of the core, by the lists and densely.
void lists_solve_the_core(const Schedule &s, std::mt19937 &random)
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

std::unique_ptr<const Schedule> check(const char *name, const Bonds &bonds, int n_atoms, Schedule::Type type)
{
    static std::mt19937 random(1);
    current = name;
    auto s = schedule_of(bonds, n_atoms);
    require(s->type == type, "another type");
    numbers_are_permutations(*s);
    trees_are_in_post_order(*s);
    meetings_are_right(*s);
    if (s->n_core <= 300) lists_solve_the_core(*s, random);
    return s;
}

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
    check("one bond", {{0, 1}}, 2, Schedule::tree);
    check("methane", {{0, 1}, {0, 2}, {0, 3}, {0, 4}}, 5, Schedule::tree);
    check("triangle", {{0, 1}, {0, 2}, {1, 2}}, 3, Schedule::triangle);
    check("ring of four", ring(4), 4, Schedule::ring);
    check("ring of 50", ring(50), 50, Schedule::ring);
    const auto lariat = check("lariat", {{0, 1}, {1, 2}, {2, 0}, {2, 3}, {3, 4}, {3, 5}}, 6, Schedule::graph);
    require(lariat->n_tree == 3 && lariat->n_core == 3, "the tail is not a tree");
    check("tetrahedron", {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}, 4, Schedule::graph);
    check("two rings and what joins them", {{0, 1}, {1, 2}, {2, 0}, {2, 3}, {3, 4}, {4, 5}, {5, 6}, {6, 4}}, 7,
          Schedule::graph);
    Bonds strip;
    for (int i = 0; i + 1 < 40; ++i) {
        strip.push_back({i, i + 1});
        if (i + 2 < 40) strip.push_back({i, i + 2});
    }
    const auto s = check("triangle strip", strip, 40, Schedule::graph);
    require(s->n_entries < 4 * s->n_core, "a strip fills");
}

// A strip of triangles, its atoms numbered and its bonds given in any order.
Bonds strip_of(int n, std::mt19937 &random)
{
    std::vector<int> name(static_cast<std::size_t>(n));
    for (int i = 0; i < n; ++i) name[static_cast<std::size_t>(i)] = i;
    std::shuffle(name.begin(), name.end(), random);
    Bonds bonds;
    for (int i = 0; i < n; ++i)
        for (int j = i + 1; j < n && j <= i + 2; ++j)
            bonds.push_back({name[static_cast<std::size_t>(i)], name[static_cast<std::size_t>(j)]});
    std::shuffle(bonds.begin(), bonds.end(), random);
    return bonds;
}

void strips()
{
    std::mt19937 random(11);
    for (int n = 4; n < 80; ++n) {
        Bonds bonds = strip_of(n, random);
        const auto s = check("strip", bonds, n, Schedule::graph);
        require(s->is_strip, "a strip is not recognised");
        for (int i = 1; i < n; ++i) {
            joins(*s, 2 * i - 2, i - 1, i, "a short bond of a strip stands elsewhere");
            require(s->from[2 * i - 2] == i - 1, "a short bond points backwards");
            if (i < 2) continue;
            joins(*s, 2 * i - 3, i - 2, i, "a long bond of a strip stands elsewhere");
            require(s->from[2 * i - 3] == i - 2, "a long bond points backwards");
        }
        require(s->atom_of[0] < s->atom_of[n - 1], "a strip begins at its other end");
        bonds.push_back({s->atom_of[0], n});
        require(!schedule_of(bonds, n + 1)->is_strip, "a strip with a bond more is one");
        if (n < 6) continue;
        bonds.pop_back();
        bonds[static_cast<std::size_t>(s->bond_of[n])] = {std::min(s->atom_of[0], s->atom_of[n - 1]),
                                                          std::max(s->atom_of[0], s->atom_of[n - 1])};
        require(!schedule_of(bonds, n)->is_strip, "with another bond it is a strip");
    }
    require(!schedule_of(strip_of(holonomic::largest_in_lanes, random), holonomic::largest_in_lanes)->is_strip,
            "a strip that does not fit into lanes is one");
}

void random_shapes()
{
    std::mt19937 random(7);
    for (int n = 2; n < 200; ++n) {
        Bonds bonds = random_tree(n, 2 + n % 5, random);
        check("random tree", bonds, n, Schedule::tree);
        if (n < 5) continue;
        for (int extra = 0; extra < 1 + n / 20; ++extra) {
            const int i = static_cast<int>(random() % static_cast<unsigned>(n)),
                      j = static_cast<int>(random() % static_cast<unsigned>(n));
            bool there = i == j;
            for (const auto &b : bonds)
                there = there || (b.first == i && b.second == j) || (b.first == j && b.second == i);
            if (!there) bonds.push_back({i, j});
        }
        const auto s = schedule_of(bonds, n);
        check("random graph", bonds, n, s->type);
    }
}

void large_shapes()
{
    std::mt19937 random(3);
    check("large random tree", random_tree(300000, 4, random), 300000, Schedule::tree);
    check("large ring", ring(300000), 300000, Schedule::ring);
    Bonds strip = ring(300000);
    for (int i = 0; i + 2 < 300000; ++i) strip.push_back({i, i + 2});
    const auto s = check("large strip", strip, 300000, Schedule::graph);
    require(s->n_entries < 8 * s->n_core, "a large strip fills");
}

/** Every slot and place of a tree is in a stretch between arms or inside of one arm, whose atoms are consecutive. */
void arms_and_stretches_hold_everything(const Schedule &s)
{
    std::vector<int> slots(static_cast<std::size_t>(s.n_tree), 0), places(slots);
    const auto count = [](std::vector<int> &of, int first, int end) {
        for (int i = first; i < end; ++i) ++of[static_cast<std::size_t>(i)];
    };
    for (int i = 0; i < s.stretch_start[s.n_pieces]; ++i) {
        count(slots, s.stretch[i].first, s.stretch[i].end);
        count(places, s.stretch[i].first_place, s.stretch[i].end_place);
    }
    for (int a = 0; a < s.n_arms; ++a) {
        const Schedule::Arm &arm = s.arm[a];
        count(slots, arm.bottom + 1, arm.top() + 1);
        const int first = arm.ascending ? arm.bottom : arm.bottom + 1;
        count(places, first, first + arm.n_bonds - 1);
        for (int k = 0; k < arm.n_bonds; ++k) {
            const int place = arm.ascending ? arm.bottom + k : arm.top() - k;
            const int lower = s.atom_of[arm.ascending ? place : s.parent[place]];
            const int upper = s.atom_of[arm.ascending ? s.parent[place] : place];
            require(s.bond_of[place] == arm.first_bond + k, "an arm's bonds are not consecutive");
            require(lower == arm.first_atom + k && upper == lower + 1, "an arm's atoms are not consecutive");
            require(k == 0 || s.parent[arm.bottom + k - 1] == arm.bottom + k, "an arm's slots are not consecutive");
        }
    }
    for (int i = 0; i < s.n_tree; ++i) {
        require(slots[static_cast<std::size_t>(i)] == 1, "a slot is not in one stretch or arm");
        require(places[static_cast<std::size_t>(i)] == 1, "a place is not in one stretch or arm");
    }
}

void arms_of_all_lengths()
{
    std::mt19937 random(5);
    for (int longest : {100, 3000, 40000}) {
        Bonds bonds;
        int n = 1;
        std::vector<int> ends{0};
        for (int length = 1; n < 20 * longest; length = 1 + (length + 16) % longest) {
            int last = ends[random() % ends.size()];
            const bool inwards = random() % 2;
            for (int k = 0; k < length; ++k) {
                const int i = n + (inwards ? length - 1 - k : k);
                bonds.emplace_back(std::min(last, i), std::max(last, i));
                last = i;
            }
            n += length;
            ends.push_back(last);
        }
        std::sort(bonds.begin(), bonds.end());
        const auto s = check("arms", bonds, n, Schedule::tree);
        require(s->n_arms > 0, "there are no arms");
        arms_and_stretches_hold_everything(*s);
    }
}

}  // namespace

int main()
{
    arms_of_all_lengths();
    small_shapes();
    strips();
    random_shapes();
    large_shapes();
    return 0;
}
