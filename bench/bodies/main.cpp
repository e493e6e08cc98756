/**
 * Rigid bodies moved by the library and by quaternions: how far a trajectory is off, and what a step takes.
 *     bench_bodies ROWS TABLE [seconds]
 * ROWS: a CSV file with a line for each body, method and step; TABLE: the same at equal error, as Markdown.
 */
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "bodies/movers.hpp"
#include "stopwatch.hpp"

using namespace bench;

namespace {

constexpr double whole_time = 4;  // in which the fastest modes go round a few times

struct Outcome {
    double dt, error, energy,
        ns;  // off after whole_time; largest change of the energy over the kinetic one; ns a body and step
};

std::vector<double> run(const BodyScene &s, Mover &mover, int steps, Outcome &out) {
    std::vector<double> f(s.r.size());
    out.dt = whole_time / steps;
    out.energy = 0;
    double seconds = 0;
    s.forces(mover.positions(), f.data());
    const double kinetic = mover.kinetic(), start = kinetic + s.potential(mover.positions());
    for (int step = 0; step < steps; ++step) {
        const Stopwatch first(1);
        mover.first_half(f.data(), out.dt);
        seconds += first.seconds();
        s.forces(mover.positions(), f.data());
        const Stopwatch second(1);
        mover.second_half(f.data(), out.dt);
        seconds += second.seconds();
        out.energy =
            std::fmax(out.energy, std::fabs(mover.kinetic() + s.potential(mover.positions()) - start) / kinetic);
    }
    out.ns = 1e9 * seconds / steps / static_cast<double>(s.n_bodies);
    return {mover.positions(), mover.positions() + s.r.size()};
}

using Maker = std::unique_ptr<Mover> (*)(const BodyScene &);

double distance(const std::vector<double> &a, const std::vector<double> &b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return std::sqrt(3 * sum / static_cast<double>(a.size()));
}

std::vector<Outcome> measure(const BodyScene &s, Maker make, const std::vector<double> &exact, double seconds) {
    std::vector<Outcome> all;
    for (int steps = 50; steps <= 1600; steps *= 2) {
        Outcome best{};
        const Stopwatch elapsed(2);
        for (int repeat = 0; repeat < 200 && (repeat < 3 || elapsed.seconds() < seconds / 6); ++repeat) {
            const std::unique_ptr<Mover> mover = make(s);
            Outcome now{};
            now.error = distance(run(s, *mover, steps, now), exact);
            if (repeat == 0 || now.ns < best.ns) best = now;
        }
        all.push_back(best);
    }
    return all;
}

// c of error = c dt^2, from the last steps but one: both ends have other laws.
double constant(const std::vector<Outcome> &all, double Outcome::*what) {
    const Outcome &o = all[all.size() - 2];
    return o.*what / (o.dt * o.dt);
}

}  // namespace

int main(int argc, char **argv) {
    if (argc < 3) return std::fprintf(stderr, "usage: bench_bodies ROWS TABLE [seconds]\n"), 2;
    std::FILE *const rows = std::fopen(argv[1], "w"), *const table = std::fopen(argv[2], "w");
    if (!rows || !table) return std::perror("bench_bodies"), 2;
    const double seconds = argc > 3 ? std::atof(argv[3]) : 3;
    std::fprintf(rows, "body,method,dt,error,energy,ns_per_step\n");
    std::fprintf(table,
                 "| body | ns a step, library | quaternions | error, library over quaternions | energy's error | time "
                 "at equal error |\n"
                 "|---|---|---|---|---|---|\n");
    bool good = true;
    for (const BodyScene &s : body_scenes(256)) {
        Outcome fine{};
        std::unique_ptr<Mover> exact = by_quaternions(s);
        const std::vector<double> end = run(s, *exact, 25600, fine);
        std::vector<Outcome> of[2];
        for (int method = 0; method < 2; ++method) {
            of[method] = measure(s, method == 0 ? by_the_library : by_quaternions, end, seconds);
            for (const Outcome &o : of[method])
                std::fprintf(rows, "%s,%s,%g,%.4e,%.4e,%.2f\n", s.name.c_str(), method == 0 ? "holonomic" : "no-squish",
                             o.dt, o.error, o.energy, o.ns);
            // Both are of second order, and come to the same trajectory.
            const std::vector<Outcome> &o = of[method];
            const double order = std::log2(o[o.size() - 3].error / o[o.size() - 2].error);
            if (std::fabs(order - 2) > 0.2) std::printf("%s: of order %.2f\n", s.name.c_str(), order), good = false;
        }
        const double ns[2] = {of[0].back().ns, of[1].back().ns},
                     error = constant(of[0], &Outcome::error) / constant(of[1], &Outcome::error),
                     energy = constant(of[0], &Outcome::energy) / constant(of[1], &Outcome::energy);
        std::fprintf(table, "| %s, %lld atoms | %.0f | %.0f | %.2f | %.2f | %.1f |\n", s.name.c_str(),
                     static_cast<long long>(s.atoms_each()), ns[0], ns[1], error, energy,
                     ns[0] / ns[1] * std::sqrt(error));
    }
    std::fclose(rows);
    std::fclose(table);
    return good ? 0 : 1;
}
