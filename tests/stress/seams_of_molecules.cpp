/**
 * Large molecules with features where they are cut and beside it: all outputs of forces, velocities and positions, by
 * one thread and two, against the elimination of the whole matrix; with every set of kernels of molecules that runs
 * here, or with that which HOLONOMIC_ISA names.
 *
 *   seams_of_molecules [-v] [ROUND]   one round alone; -v: how near its bounds each comes
 */
#include <holonomic.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "random.h"
#include "seam_reference.hpp"
#include "soak.hpp"

namespace
{

using namespace stress;
using numbers = std::vector<double>;

int failures = 0;
double worst = 0;  // error over bound of this round
std::string current;

void fail(const char *what, double ratio)
{
    if (++failures <= 40) std::printf("%s: %s %.3g\n", current.c_str(), what, ratio);
}

void require_ok(const char *what, int status)
{
    if (status == HOL_OK) return;
    std::printf("%s: %s: %s\n", current.c_str(), what, hol_error_message());
    ++failures;
}

/** Each number to some roundings of its scale, of which there is one per `per` numbers. `least`: of the largest scale,
 * for what dies away as a product of many factors. */
void compare(const char *what, const numbers &values, const quads &exact, const quads &scale, std::size_t per,
             double least)
{
    const double unit = 4 * (16 + std::sqrt(static_cast<double>(values.size()))) * DBL_EPSILON;
    const quad tail = scale.empty() ? quad(0) : *std::max_element(scale.begin(), scale.end()) * quad(least);
    double most = 0;
    for (std::size_t k = 0; k < values.size(); ++k) {
        const double error = static_cast<double>(reference::absolute(values[k] - exact[k]));
        if (error == 0) continue;
        const double ratio = error / (unit * static_cast<double>(scale[k / per] + tail));
        if (!(ratio <= most)) most = std::isnan(ratio) ? HUGE_VAL : ratio;
    }
    worst = std::max(worst, most);
    if (most > 1) fail(what, most);
}

/** Bond lengths to the rounding of the coordinates. */
void compare_lengths(const seam_molecule &m, const numbers &r)
{
    double most = 0;
    for (std::size_t k = 0; k < m.length.size(); ++k) {
        const std::size_t i = static_cast<std::size_t>(m.pairs[2 * k]),
                          j = static_cast<std::size_t>(m.pairs[2 * k + 1]);
        if (m.w[i] == 0 && m.w[j] == 0) continue;
        long double square = 0, extent = 0;
        for (std::size_t x = 0; x < 3; ++x) {
            const long double d = static_cast<long double>(r[3 * j + x]) - r[3 * i + x];
            square += d * d;
            extent += std::fabs(r[3 * j + x]) + std::fabs(r[3 * i + x]);
        }
        const long double bound = DBL_EPSILON * (4 * m.length[k] + extent);
        most = std::max(most, static_cast<double>(std::fabs(std::sqrt(square) - m.length[k]) / bound));
    }
    worst = std::max(worst, most);
    if (!(most <= 1)) fail("bond lengths", most);
}

struct outputs {
    numbers lambda, g, mu, v, nu, r;

    outputs(const seam_molecule &m, const hol_chains *chains)
        : lambda(m.length.size()), g(m.r.size()), mu(lambda), v(m.v), nu(lambda), r(m.drifted)
    {
        require_ok("forces", hol_forces(chains, m.r.data(), m.v.data(), m.f.data(), lambda.data(), nullptr, g.data(),
                                        HOL_WRITE, nullptr));
        require_ok("velocities", hol_project_velocities(chains, m.r.data(), v.data(), mu.data(), nullptr));
        require_ok("positions",
                   hol_project_positions(chains, m.r.data(), r.data(), nullptr, m.dt, nu.data(), 0, nullptr, nullptr));
    }
    bool operator==(const outputs &o) const
    {
        return lambda == o.lambda && g == o.g && mu == o.mu && v == o.v && nu == o.nu && r == o.r;
    }
};

struct exact_solutions {
    linear_solutions linear;
    seam_solution positions;
    explicit exact_solutions(const seam_molecule &m) : linear(exact_linear(m)), positions(exact_positions(m))
    {
    }
};

void check(seam_shape shape, const seam_molecule &m, const exact_solutions &exact)
{
    hol_chains *chains = nullptr;
    require_ok("creation", hol_chains_create(static_cast<std::int64_t>(m.w.size()), m.mass.data(), &chains));
    require_ok("bonds", hol_chains_add_bonds(chains, static_cast<std::int64_t>(m.length.size()), m.pairs.data(),
                                             m.length.data()));
    const outputs one(m, chains);
    require_ok("threads", hol_chains_set_threads(chains, 2));
    if (!(outputs(m, chains) == one)) fail("two threads give other bits", 0);
    hol_chains_destroy(chains);
    const double least = shape == TILES ? 1e-40 : 1e-80;
    const auto &[f, v] = exact.linear;
    const seam_solution &r = exact.positions;
    compare("lambda of forces", one.lambda, f.lambda, f.lambda_scale, 1, least);
    compare("G", one.g, f.g, f.g_scale, 3, least);
    compare("lambda of velocities", one.mu, v.lambda, v.lambda_scale, 1, least);
    compare("velocities", one.v, v.moved, v.moved_scale, 3, 0);
    compare_lengths(m, one.r);
    if (r.lambda.empty()) return fail("the reference does not converge", 0);
    compare("lambda of positions", one.nu, r.lambda, r.lambda_scale, 1, least);
    compare("positions", one.r, r.moved, r.moved_scale, 3, 0);
}

/** Whether an atom can be held fixed without taking the molecule apart, so that it is no longer cut there. */
bool is_leaf(const seam_graph &g, std::int64_t atom)
{
    return g.neighbours[static_cast<std::size_t>(atom)].size() == 1;
}

/** The same at some seams of each sort: `steps` behind them, or in large molecules anywhere about them. One sort of
 * feature at a time: what is refused for one of them is worked on in another way everywhere. */
std::vector<put_at> draw_puts(const seam_graph &g, const std::vector<std::vector<std::int64_t>> &seams, seam_kind kind,
                              int steps, bool large, random_stream &s)
{
    std::vector<put_at> puts;
    for (const std::vector<std::int64_t> &list : seams)
        for (int n = 0; n < (large ? 4 : 2); ++n) {
            const std::int64_t seam =
                list[static_cast<std::size_t>(random_integer(&s, 0, static_cast<std::int64_t>(list.size()) - 1))];
            const std::int64_t anywhere = random_integer(&s, first_seam_step, first_seam_step + n_seam_steps - 1);
            std::int64_t atom = g.walk(seam, large ? static_cast<int>(anywhere) : steps);
            if (large && kind == FIXED_SEAM) {
                for (const std::int64_t i : g.neighbours[static_cast<std::size_t>(atom)])
                    if (is_leaf(g, i)) atom = i;
                if (!is_leaf(g, atom)) continue;
            }
            const std::int64_t next = g.walk(atom, 1);
            bool is_free = true;  // features do not touch
            for (const put_at &p : puts)
                for (const std::int64_t i : g.neighbours[static_cast<std::size_t>(p.atom)])
                    is_free = is_free && i != atom && i != next && p.atom != atom && p.atom != next;
            if (is_free) puts.push_back({atom, kind});
        }
    return puts;
}

}  // namespace

int main(int argc, char **argv)
{
    const bool verbose = argc > 1 && std::strcmp(argv[1], "-v") == 0;
    const int only = argc > 1 + verbose ? std::atoi(argv[1 + verbose]) : -1;
    std::vector<std::string> sets = sets_of_kernels();
    sets.erase(std::remove(sets.begin(), sets.end(), "scalar"), sets.end());  // it has none of molecules
    int round = 0, bad = 0;
    for (int shape = 0; shape < N_SEAM_SHAPES; ++shape) {
        const bool large = shape == TREE_TILES || shape == TILES;
        const seam_graph g = make_seam_graph(static_cast<seam_shape>(shape));
        const std::vector<std::vector<std::int64_t>> seams = seams_of(static_cast<seam_shape>(shape), g);
        for (int kind = 0; kind < N_SEAM_KINDS; ++kind)
            for (int steps = first_seam_step; steps < first_seam_step + (large ? 1 : n_seam_steps); ++steps, ++round) {
                if (only >= 0 && only != round) continue;
                random_stream s = random_seed(static_cast<std::uint64_t>(round) + 1);
                const auto puts = draw_puts(g, seams, static_cast<seam_kind>(kind), steps, large, s);
                current = "round " + std::to_string(round) + ", " + seam_shape_name(shape) + ", " +
                          seam_kind_name(kind) + (large ? " about" : " " + std::to_string(steps) + " behind") +
                          " the seam";
                const seam_molecule m = make_seam_molecule(g, puts, static_cast<std::uint64_t>(round));
                const exact_solutions exact(m);
                for (const std::string &set : sets)
                    bad += !with_set(set, [&] {
                        check(static_cast<seam_shape>(shape), m, exact);
                        if (verbose || failures > 0)
                            std::printf("%s, %s: %zu features, %.3g of the bounds\n", current.c_str(), set.c_str(),
                                        puts.size(), worst);
                        return failures > 0;
                    });
            }
    }
    if (bad > 0) std::printf("%d molecules failed\n", bad);
    return bad > 0;
}
