// Networks beside chains in the same program: processor time a bond of the three levels, of adding, and memory; and
// what others take for the same, if they are asked for and CHOLMOD is there.
#include <holonomic.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <new>

#ifdef BENCH_HAVE_CHOLMOD
#include "networks/peers.hpp"
#endif
#include "networks/scenes.hpp"
#include "stopwatch.hpp"

using namespace bench;

namespace {

struct Call {
    int status;
    double time;
};
Call best_of(int repeats, int threads, const std::function<void()> &prepare, const std::function<int()> &body) {
    Call best = {0, 1e30};
    const Stopwatch elapsed(2);
    for (int i = 0; i < repeats && (i < 2 || elapsed.seconds() < 4); ++i) {
        prepare();
        const Stopwatch watch(threads);
        best.status = body();
        best.time = std::fmin(best.time, watch.seconds());
        if (best.status != HOL_OK) break;
    }
    return best;
}
void print(const Call &c, double n) {
    if (c.status == HOL_OK)
        std::printf(" %8.1f", 1e9 * c.time / n);
    else
        std::printf(" %8s(%.3g s)",
                    c.status == HOL_ERR_DEGENERATE ? "deg"
                    : c.status == HOL_ERR_MEMORY   ? "mem"
                                                   : "err",
                    c.time);
    std::fflush(stdout);
}

/** Rounds that the iteration for a network takes; 0 of what is solved directly. */
int rounds_of_forces(const Network &s, hol_chains *chains, const std::vector<double> &v, const std::vector<double> &f,
                     std::vector<double> &g) {
    std::vector<int> iterations(static_cast<std::size_t>(hol_chains_n_molecules(chains)));
    hol_chains_set_outcomes(chains, 1);
    hol_forces(chains, s.r.data(), v.data(), f.data(), nullptr, nullptr, g.data(), HOL_WRITE, nullptr);
    hol_outcomes(chains, nullptr, iterations.data());
    hol_chains_set_outcomes(chains, 0);
    return iterations.empty() ? 0 : *std::max_element(iterations.begin(), iterations.end());
}

#ifdef BENCH_HAVE_CHOLMOD

/** Largest error over the largest multiplier. */
double error_of(const std::vector<double> &x, const std::vector<double> &exact) {
    double worst = 0, most = 0;
    for (std::size_t k = 0; k < x.size(); ++k) {
        worst = std::fmax(worst, std::fabs(x[k] - exact[k]));
        most = std::fmax(most, std::fabs(exact[k]));
    }
    return worst / most;
}

/** Rows below the library's: multipliers from positions (of it, the numbers of the factor), their error, positions. */
void measure_peers(const Network &s, const hol_chains *chains, const std::vector<double> &trial, int repeats) {
    const double n = static_cast<double>(s.n_bonds());
    std::mt19937_64 random(11);
    std::normal_distribution<double> normal;
    std::vector<double> rhs(s.lengths.size()), x(rhs.size());
    for (double &y : rhs) y = normal(random);
    BondMatrix matrix(s);
    matrix.assemble(s.r);
    const std::vector<double> exact = matrix.refined(rhs);
    if (hol_solve(chains, s.r.data(), rhs.data(), x.data(), nullptr, HOL_WRITE, nullptr) == HOL_OK)
        std::printf("    %-30s error %.1e\n", "holonomic", error_of(x, exact));
    for (const Peer &peer : peers()) {
        std::printf("    %-30s", peer.name.c_str());
        try {
            const Stopwatch analysis(1);
            peer.analyse(matrix);
            const double analysed = analysis.seconds();
            double numbers = 1e30, all = 1e30, positions = 1e30;
            int rounds = 0;
            for (int i = 0; i < repeats && (i == 0 || all < 1); ++i) {
                const Stopwatch watch(1);
                matrix.assemble(s.r);
                const double assembled = watch.seconds();
                peer.factorize(matrix);
                numbers = std::fmin(numbers, watch.seconds() - assembled);
                x = peer.solve(rhs);
                all = std::fmin(all, watch.seconds());
            }
            const long iterations = peer.iterations();
            const bool converged = iterations < 2000;
            for (int i = 0; i < repeats && (i == 0 || positions < 1) && converged; ++i) {
                std::vector<double> r = trial;
                const Stopwatch watch(1);
                rounds = project(matrix, peer, r, 1e-12);
                positions = std::fmin(positions, watch.seconds());
            }
            std::printf(" error %.1e  solve %9.1f (numbers %9.1f; %ld)", error_of(x, exact), 1e9 * all / n,
                        1e9 * numbers / n, iterations);
            if (converged) std::printf("  positions %9.1f (%d)", 1e9 * positions / n, rounds);
            std::printf("  analysis %9.1f  entries %7.1f\n", 1e9 * analysed / n, peer.entries() / n);
        } catch (const std::bad_alloc &) {
            std::printf(" no memory, or no factor\n");
        }
        std::fflush(stdout);
    }
}

#else

void measure_peers(const Network &, const hol_chains *, const std::vector<double> &, int) {
    std::printf("    this program was built without CHOLMOD (libsuitesparse-dev)\n");
}

#endif

void measure(const Network &s, int threads, int repeats, bool beside) {
    const double n = static_cast<double>(s.n_bonds());
    hol_chains *chains = nullptr;
    const double box[9] = {s.side[0], 0, 0, 0, s.side[1], 0, 0, 0, s.side[2]};
    const Call build = best_of(
        repeats, 1,
        [&] {
            hol_chains_destroy(chains);
            chains = nullptr;
        },
        [&] {
            int status = hol_chains_create(s.n_atoms(), s.masses.data(), &chains);
            if (status == HOL_OK && s.side[0] > 0) status = hol_chains_set_box(chains, box);
            if (status == HOL_OK) status = hol_chains_add_bonds(chains, s.n_bonds(), s.pairs.data(), s.lengths.data());
            return status;
        });
    std::printf("%-52s %8.0f", s.name.c_str(), n);
    if (build.status != HOL_OK) {
        std::printf(" not added after %.3g s: %s\n", build.time, hol_error_message());
        hol_chains_destroy(chains);
        return;
    }
    hol_chains_set_threads(chains, threads);
    hol_chains_set_checks(chains, HOL_NEVER);
    std::mt19937_64 random(7);
    std::normal_distribution<double> normal;
    std::vector<double> v(s.r.size()), f(s.r.size()), g(s.r.size()), out, drifted, lambda(s.lengths.size());
    for (double &x : v) x = normal(random);
    for (double &x : f) x = normal(random);
    std::vector<double> raw = v;
    Call c = best_of(
        repeats, threads, [] {},
        [&] {
            return hol_forces(chains, s.r.data(), raw.data(), f.data(), lambda.data(), nullptr, g.data(), HOL_WRITE,
                              nullptr);
        });
    print(c, n);
    if (c.status != HOL_OK) std::printf(" %s", hol_error_message());
    const int rounds = rounds_of_forces(s, chains, raw, f, g);
    c = best_of(
        repeats, threads, [&] { v = raw; },
        [&] { return hol_project_velocities(chains, s.r.data(), v.data(), nullptr, nullptr); });
    print(c, n);
    for (std::size_t i = 0; i < v.size(); ++i) out.push_back(s.r[i] + s.step * v[i]);
    hol_report report = {};
    c = best_of(
        repeats, threads, [&] { drifted = out; },
        [&] {
            return hol_project_positions(chains, s.r.data(), drifted.data(), nullptr, s.step, nullptr, 0, nullptr,
                                         &report);
        });
    print(c, n);
    std::printf(" (%lld)  rounds %d  build %7.1f  bytes %7.1f\n", static_cast<long long>(report.iterations), rounds,
                1e9 * build.time / n, static_cast<double>(hol_chains_memory(chains)) / n);
    if (beside) measure_peers(s, chains, out, repeats);
    hol_chains_destroy(chains);
}

}  // namespace

int main(int argc, char **argv) {
    const int threads = argc > 1 ? std::atoi(argv[1]) : 1, repeats = argc > 2 ? std::atoi(argv[2]) : 20;
    const char *const wanted = argc > 3 ? argv[3] : "";
    const bool beside = argc > 4 && std::strcmp(argv[4], "peers") == 0;
    const auto one = [&](const char *key, const std::function<Network()> &make) {
        if (!*wanted || std::strstr((std::string(",") + wanted + ",").c_str(), (std::string(",") + key + ",").c_str()))
            measure(make(), threads, repeats, beside);
    };
    std::printf("%-52s %8s %8s %8s %8s   ns a bond; %s, threads %d\n", "", "bonds", "forces", "veloc.", "posit.",
                hol_instruction_set(), threads);
    one("chains", [] { return coils(1000, 100); });
    one("gel100", [] { return gel(1000, 100); });
    one("small", [] { return gel(100, 100); });
    one("smaller", [] { return gel(140, 20); });
    one("gel30", [] { return gel(3000, 30); });
    one("gel10", [] { return gel(9000, 10); });
    one("gel3", [] { return gel(30000, 3); });
    one("open", [] { return diamond(6, 30, false); });
    one("diamond", [] { return diamond(6, 30, true); });
    one("million", [] { return gel(33000, 30); });
    one("straight", [] { return gel(9000, 10, 0.05); });
    one("cubic10", [] { return cubic(10); });
    one("cubic20", [] { return cubic(20); });
    one("sheet50", [] { return sheet(50, 0.3); });
    one("flat50", [] { return sheet(50, 0); });
    one("sheet", [] { return sheet(200, 0.3); });
    one("flat", [] { return sheet(200, 0); });
    one("ladders", [] { return ladder(1000, 100); });
    one("ladder", [] { return ladder(1, 100000); });
    return 0;
}
