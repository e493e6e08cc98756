// Energy drift of a melt at constant energy against the tolerance of its constraints. Rows: error is the drift of the
// total energy in units of the kinetic energy, per unit of time, from a straight line through the energies; ns_per_bond
// is the time of position and velocity constraints together, per step.
#include <algorithm>
#include <cmath>

#include "melt_run.hpp"
#include "memory_pass.hpp"
#include "methods/methods.hpp"
#include "sections.hpp"

namespace bench {
namespace {

double slope(const std::vector<double> &t, const std::vector<double> &e) {
    double mean_t = 0, mean_e = 0, tt = 0, te = 0;
    const double n = static_cast<double>(t.size());
    for (std::size_t i = 0; i < t.size(); ++i) mean_t += t[i] / n, mean_e += e[i] / n;
    for (std::size_t i = 0; i < t.size(); ++i) {
        tt += (t[i] - mean_t) * (t[i] - mean_t);
        te += (t[i] - mean_t) * (e[i] - mean_e);
    }
    return te / tt;
}

Row drift(MeltRun &run, const Constraints &constraints, const std::string &setting, int steps) {
    std::vector<double> t, e;
    run.start_clock();
    for (int i = 0; i < steps; ++i) {
        run.step(constraints);
        t.push_back((i + 1) * run.problem().dt);
        e.push_back(run.energy());
    }
    const Problem &p = run.problem();
    const double bonds = static_cast<double>(p.all_bonds());
    const double seconds = run.constraint_seconds() / steps, ns = 1e9 * seconds / bonds;
    return {"position",
            p.name,
            p.chains,
            p.bonds,
            1,
            constraints.positions.name,
            "energy drift " + setting,
            std::abs(slope(t, e)) / run.kinetic(),
            ns,
            seconds / memory_pass_seconds(p.r.size()),
            ns,
            ns,
            ns,
            ns,
            1};
}

Method plain_positions(const Problem &p) {
    for (Method &m : holonomic_skips(Level::position, p))
        if (m.setting == "r alone") return m;
    return {};
}

}  // namespace

void drift_section(const Run &run) {
    const bool tiny = run.extent == Extent::tiny;
    const int steps = tiny ? 4 : run.full() ? 4000 : 300;
    MeltRun melt(tiny ? 8 : 64, 31, 0.003);
    const Problem &p = melt.problem();
    const Constraints exact = {plain_positions(p), holonomic(Level::velocity, p)};
    for (int i = 0; i < (tiny ? 2 : run.full() ? 4000 : 500); ++i) {
        melt.step(exact);
        if (i % 20 == 0) melt.rescale();
    }
    const MeltRun::Point start = melt.save();
    std::printf("   energy drift of %lld chains of %lld bonds over %d steps\n", static_cast<long long>(p.chains),
                static_cast<long long>(p.bonds), steps);
    auto measure = [&](const Constraints &constraints, const std::string &setting) {
        melt.load(start);
        run.results.add({drift(melt, constraints, setting, steps)});
    };
    measure(exact, "to rounding");
    std::vector<double> tolerances = {1e-3, 1e-4, 1e-6, 1e-12};
    if (run.full()) tolerances = {1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-12};
    for (double tolerance : tolerances)
        measure({rattle(Level::position, p, tolerance), rattle(Level::velocity, p, tolerance)},
                tolerance_setting(tolerance));
}

}  // namespace bench
