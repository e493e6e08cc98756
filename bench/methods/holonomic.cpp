// The library through its public header: a call of each level's verb.
#include "holonomic_parts.hpp"

namespace bench {
namespace {

double *at(std::vector<double> &x, std::size_t i, bool wanted = true) { return wanted ? x.data() + i : nullptr; }
const double *at(const std::vector<double> &x, std::size_t i, bool wanted = true) {
    return wanted ? x.data() + i : nullptr;
}

void forces(const Problem &p, const Parts &with, Handles &h, State &s) {
    double virial[9];
    for (std::size_t c = 0; c < h.all.size(); ++c) {
        const std::size_t atom = 3 * c * h.atoms_each, bond = c * h.bonds_each;
        check(hol_forces(h.all[c].get(), at(p.r, atom), at(p.v, atom, with.v), at(p.f, atom, with.f),
                         at(s.lambda, bond, with.lambda), at(h.tension, bond, with.tension), at(s.g, atom, with.g),
                         with.add ? HOL_ADD : HOL_WRITE, with.virial ? virial : nullptr));
    }
}

void velocities(const Problem &p, const Parts &with, Handles &h, State &s) {
    double virial[9];
    for (std::size_t c = 0; c < h.all.size(); ++c) {
        const std::size_t atom = 3 * c * h.atoms_each;
        check(hol_project_velocities(h.all[c].get(), at(p.r, atom), at(s.v, atom),
                                     at(s.lambda, c * h.bonds_each, with.lambda), with.virial ? virial : nullptr));
    }
}

void positions(const Problem &p, const Parts &with, Handles &h, State &s) {
    double virial[9];
    hol_report report;
    for (std::size_t c = 0; c < h.all.size(); ++c) {
        const std::size_t atom = 3 * c * h.atoms_each;
        check(hol_project_positions(h.all[c].get(), at(p.r, atom), at(s.r, atom), at(s.v, atom, with.v), p.dt,
                                    at(s.lambda, c * h.bonds_each, with.lambda), with.guess,
                                    with.virial ? virial : nullptr, with.report ? &report : nullptr));
    }
}

void metric(const Problem &p, const Parts &with, Handles &h, State &s) {
    double energy;
    for (std::size_t c = 0; c < h.all.size(); ++c) {
        const std::size_t atom = 3 * c * h.atoms_each;
        check(hol_metric(h.all[c].get(), at(p.r, atom), 1.0, at(s.log_det, c * (h.bonds_each / p.n()), with.log_det),
                         nullptr, with.gradient ? &energy : nullptr, at(s.g, atom, with.gradient), HOL_WRITE));
    }
}

}  // namespace

void call(Level level, const Problem &p, const Parts &with, Handles &h, State &s) {
    switch (level) {
        case Level::acceleration:
            return forces(p, with, h, s);
        case Level::velocity:
            return velocities(p, with, h, s);
        case Level::position:
            return positions(p, with, h, s);
        case Level::metric:
            return metric(p, with, h, s);
        case Level::solve:
            break;
    }
}

Method holonomic_row(Level level, const Problem &p, const std::string &setting, const std::vector<Parts> &parts,
                     const Shared &h) {
    Method m;
    m.name = "holonomic";
    m.setting = setting;
    m.call = [level, &p, parts, h](State &s) {
        for (const Parts &with : parts) call(level, p, with, *h, s);
    };
    return m;
}

Method holonomic(Level level, const Problem &p, int threads) {
    Method m = holonomic_row(level, p, "default", {Parts()}, std::make_shared<Handles>(p, threads));
    m.threads = threads;
    return m;
}

Method holonomic_tolerance(const Problem &p, double tolerance) {
    auto h = std::make_shared<Handles>(p, 1);
    for (Handle &handle : h->all) check(hol_chains_set_tolerance(handle.get(), tolerance));
    return holonomic_row(Level::position, p, tolerance_setting(tolerance), {Parts()}, h);
}

Method holonomic_solve(const Problem &p, const UnitSystems &systems) {
    return {"holonomic", "default", [&p, &systems](State &s) {
                const std::size_t n = p.n();
                for (std::size_t c = 0; c < p.n_chains(); ++c)
                    check(hol_tridiagonal_solve(p.bonds, systems.gamma.data() + c * n + (n > 1 ? 1 : 0),
                                                &systems.right_side[c * n], &s.lambda[c * n]));
            }};
}

}  // namespace bench
