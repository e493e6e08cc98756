// The unknowns of networks eliminated front by front, beside a dense elimination in long double; how graphs are halved.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>

#include "core/molecules/planned/bisection.hpp"
#include "core/molecules/planned/elimination_order.hpp"
#include "core/molecules/planned/elimination_plan.hpp"
#include "core/molecules/planned/network.hpp"
#include "fronts_case.hpp"

using namespace fronts_case;
using holonomic::at;

namespace
{

void require(bool what, const char *name, const char *words)
{
    if (what) return;
    std::fprintf(stderr, "%s: %s\n", name, words);
    std::exit(1);
}

struct Bonds {
    std::int32_t n_atoms = 0;
    std::vector<std::int32_t> pairs;
    void add_strand(std::int32_t i, std::int32_t j, int bonds)
    {
        for (; bonds > 1; --bonds) {
            pairs.insert(pairs.end(), {i, n_atoms});
            i = n_atoms++;
        }
        pairs.insert(pairs.end(), {i, j});
    }
};

Bonds lattice(int n, int longest, std::mt19937 &random)
{
    Bonds b;
    b.n_atoms = n * n * n;
    for (int i = 0; i < n * n * n; ++i) {
        const int place[3] = {i % n, i / n % n, i / (n * n)}, step[3] = {1, n, n * n};
        for (int x = 0; x < 3; ++x)
            if (place[x] + 1 < n && random() % 5 > 0)
                b.add_strand(i, i + step[x], 1 + static_cast<int>(random() % static_cast<unsigned>(longest)));
    }
    return b;
}

// Any nodes with each other, some with themselves, some not joined to the others.
Bonds tangle(int nodes, int strands, std::mt19937 &random)
{
    Bonds b;
    b.n_atoms = nodes;
    for (int k = 0; k < strands; ++k) {
        const std::int32_t i = static_cast<std::int32_t>(random() % static_cast<unsigned>(nodes)),
                           j = static_cast<std::int32_t>(random() % static_cast<unsigned>(nodes));
        b.add_strand(i, j, i == j ? 3 : 2 + static_cast<int>(random() % 3));
    }
    return b;
}

// A matrix with the terms of a network: dense blocks of the ends at each node, the two ends of a strand.
struct Matrix {
    std::size_t n;
    std::vector<long double> element;
    Terms terms;

    Matrix(const holonomic::NetworkPlan &s, bool symmetric, double least, std::mt19937 &random)
        : n(static_cast<std::size_t>(s.n_unknowns)), element(n * n), terms{{}, std::vector<double>(n)}
    {
        std::uniform_real_distribution<double> any(-1, 1);
        const holonomic::FrontPlan &f = s.fronts;
        terms.of_node.resize(static_cast<std::size_t>(s.n_nodes));
        for (std::int32_t node = 0; node < s.n_nodes; ++node) {
            struct End {
                std::int32_t unknown, row;
                double left[3], right[3];
            };
            std::vector<End> ends;
            const auto enter = [&](std::int32_t u, std::int32_t row) {
                End e = {u, row, {any(random), any(random), any(random)}, {}};
                for (int x = 0; x < 3; ++x) e.right[x] = symmetric ? e.left[x] : e.left[x] + 0.1 * any(random);
                ends.push_back(e);
            };
            holonomic::for_own(s, node, [&](std::int32_t u) { enter(u, f.own_row[u]); });
            for (std::int32_t k = s.foreign_start[node]; k < s.foreign_start[node + 1]; ++k)
                enter(s.foreign[k], f.foreign_row[k]);
            for (const End &a : ends)
                for (const End &b : ends)
                    add(node, a.unknown, b.unknown, a.row, b.row,
                        a.left[0] * b.right[0] + a.left[1] * b.right[1] + a.left[2] * b.right[2]);
            holonomic::for_own(s, node, [&](std::int32_t u) {
                add(node, u, u, f.own_row[u], f.own_row[u], least);
                if (f.partner_row[u] < 0) return;
                const std::int32_t p = s.partner[u];
                const double there = 0.5 * least * any(random), back = symmetric ? there : 0.5 * least * any(random);
                add(node, u, p, f.own_row[u], f.partner_row[u], there);
                add(node, p, u, f.partner_row[u], f.own_row[u], back);
            });
        }
        for (std::size_t u = 0; u < n; ++u) terms.diagonal[u] = static_cast<double>(element[u * n + u]);
    }
    void add(std::int32_t node, std::int32_t u, std::int32_t v, std::int32_t row, std::int32_t column, double value)
    {
        element[at(u) * n + at(v)] += value;
        terms.of_node[at(node)].push_back({row, column, value});
    }
    // By elimination with rows exchanged.
    std::vector<long double> solved(const std::vector<double> &rhs) const
    {
        std::vector<long double> a = element, x(rhs.begin(), rhs.end());
        for (std::size_t k = 0; k < n; ++k) {
            std::size_t p = k;
            for (std::size_t i = k + 1; i < n; ++i)
                if (std::fabs(a[i * n + k]) > std::fabs(a[p * n + k])) p = i;
            for (std::size_t j = 0; j < n && p != k; ++j) std::swap(a[k * n + j], a[p * n + j]);
            std::swap(x[k], x[p]);
            for (std::size_t i = k + 1; i < n; ++i) {
                const long double f = a[i * n + k] / a[k * n + k];
                if (f == 0) continue;
                for (std::size_t j = k; j < n; ++j) a[i * n + j] -= f * a[k * n + j];
                x[i] -= f * x[k];
            }
        }
        for (std::size_t k = n; k-- > 0;) {
            for (std::size_t j = k + 1; j < n; ++j) x[k] -= a[k * n + j] * x[j];
            x[k] /= a[k * n + k];
        }
        return x;
    }
};

std::unique_ptr<const holonomic::EliminationPlan> network_of(const Bonds &b)
{
    std::vector<unsigned char> fixed(at(b.n_atoms), 0);
    return holonomic::make_elimination_plan(b.n_atoms, static_cast<std::int32_t>(b.pairs.size() / 2), b.pairs.data(),
                                            fixed.data(), holonomic::no_limit);
}

typedef bool (*Solve)(const holonomic::NetworkPlan &, bool, const Terms &, double, int, std::vector<double> &);
const Solve solves[] = {fronts2::solve, fronts4::solve, fronts8::solve, fronts16::solve};

void they_solve_what_a_dense_elimination_does(const char *name, const Bonds &b, std::mt19937 &random)
{
    const auto elimination = network_of(b);
    require(elimination->network, name, "is no network");
    const holonomic::NetworkPlan &s = *elimination->network;
    require(s.fronts.n_fronts > 3, name, "has no fronts");
    for (const bool symmetric : {true, false}) {
        const Matrix matrix(s, symmetric, 0.2, random);
        std::vector<double> rhs(matrix.n);
        for (double &y : rhs) y = std::uniform_real_distribution<double>(-1, 1)(random);
        const std::vector<long double> exact = matrix.solved(rhs);
        long double most = 0;
        for (const long double x : exact) most = std::max(most, std::fabs(x));
        for (const Solve solve : solves) {
            std::vector<double> x = rhs;
            require(solve(s, symmetric, matrix.terms, 1e-14, 0, x), name, "has a pivot that is none");
            long double worst = 0;
            for (std::size_t u = 0; u < matrix.n; ++u) worst = std::max(worst, std::fabs(x[u] - exact[u]));
            // The condition of these matrices is below a thousand.
            require(worst <= 4096 * 2.2e-16L * most, name, "differs from a dense elimination");
            x = rhs;
            require(!solve(s, symmetric, matrix.terms, 0.999, 0, x), name, "has pivots that nothing was taken from");
        }
    }
}

// So many that the separator is shared among them, too.
void threads_change_no_digit()
{
    std::mt19937 random(3);
    const auto elimination = network_of(tangle(600, 1320, random));
    const holonomic::NetworkPlan &s = *elimination->network;
    bool is_large = false;
    for (std::int32_t f = 0; f < s.fronts.n_fronts; ++f) {
        const holonomic::FrontPlan::Front &front = s.fronts.front[f];
        is_large = is_large || (front.subtree < 0 && front.n_rows - front.n_own >= 192);
    }
    require(s.fronts.n_subtrees > 1 && is_large, "a large tangle", "has nothing to share");
    for (const bool symmetric : {true, false}) {
        const Matrix matrix(s, symmetric, 0.2, random);
        std::vector<double> rhs(matrix.n, 1);
        for (const Solve solve : solves) {
            std::vector<double> x = rhs, y = rhs;
            require(solve(s, symmetric, matrix.terms, 1e-14, 0, x) && solve(s, symmetric, matrix.terms, 1e-14, 3, y),
                    "a large tangle", "has a pivot that is none");
            require(x == y, "a large tangle", "depends on threads");
            require(!solve(s, symmetric, matrix.terms, 0.999, 3, x), "a large tangle",
                    "has pivots that nothing was taken from");
        }
    }
}

// Each edge is cut once in a square: n or few more.
void halves_of_a_square_share_few_edges()
{
    for (const std::int32_t n : {8, 40, 100}) {
        holonomic::WeightedGraph g;
        g.start.assign(1, 0);
        for (std::int32_t i = 0; i < n * n; ++i) {
            if (i % n > 0) g.edge.push_back({i - 1, 1});
            if (i % n + 1 < n) g.edge.push_back({i + 1, 1});
            if (i >= n) g.edge.push_back({i - n, 1});
            if (i + n < n * n) g.edge.push_back({i + n, 1});
            g.start.push_back(static_cast<std::int32_t>(g.edge.size()));
            g.weight.push_back(1);
        }
        const std::vector<unsigned char> side = holonomic::bisect(g);
        std::int32_t cut = 0, first = 0;
        for (std::int32_t i = 0; i < n * n; ++i) {
            first += side[at(i)] == 0;
            for (std::int32_t e = g.start[at(i)]; e < g.start[at(i) + 1]; ++e)
                cut += side[at(i)] < side[at(g.edge[at(e)].to)];
        }
        require(cut <= n + n / 4, "a square", "is cut along too many edges");
        require(20 * first >= 9 * n * n && 20 * first <= 11 * n * n, "a square", "has uneven halves");
    }
}

void they_take_no_more_memory_than_they_may()
{
    std::mt19937 random(5);
    const Bonds b = lattice(8, 1, random);
    const auto elimination = network_of(b);
    require(elimination->network && elimination->network->fronts.n_fronts > 0, "a lattice", "has no fronts");
    holonomic::NetworkArrays arrays;
    holonomic::make_network(*elimination, 100000, arrays);
    require(arrays.plan.fronts.n_fronts == 0 && arrays.plan.n_unknowns > 0, "a lattice", "has fronts above the limit");
}

}  // namespace

int main()
{
    std::mt19937 random(1);
    halves_of_a_square_share_few_edges();
    they_solve_what_a_dense_elimination_does("a lattice", lattice(8, 1, random), random);
    they_solve_what_a_dense_elimination_does("a lattice with strands", lattice(5, 9, random), random);
    they_solve_what_a_dense_elimination_does("a tangle", tangle(120, 260, random), random);
    threads_change_no_digit();
    they_take_no_more_memory_than_they_may();
    return 0;
}
