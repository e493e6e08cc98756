#include <algorithm>
#include <cmath>
#include <limits>

#include "core/index.hpp"
#include "core/kernel_choice.hpp"
#include "core/rigid/run.hpp"
#include "core/rigid/verbs.hpp"
#include "core/rigid/within.hpp"
#include "core/run/execute.hpp"

namespace holonomic::rigid {

namespace {

// Below this residuals are far beyond the rounding of coordinates, and multipliers have all their digits.
constexpr double exact = 1e-20;

struct BodyPositions final : BodyWork {
    AtomArray r_ref, r, v;
    const Cell &box_ref, &box;
    const BoxRate *rate;
    double dt, *lambda, tolerance;
    int most_iterations;
    bool virial, report, check;
    PositionsCall call;

    BodyPositions(const Chains &chains, const AtomArray &r_ref_, const Cell &box_ref_, const AtomArray &r_,
                  const AtomArray &v_, double dt_, double *lambda_, bool virial_, bool report_, bool check_)
        : BodyWork(chains), r_ref(r_ref_), r(r_), v(v_), box_ref(box_ref_), box(chains.box), rate(chains.box_rate()),
          dt(dt_), lambda(lambda_), tolerance(chains.tolerance), most_iterations(chains.max_iterations),
          virial(virial_), report(report_ || chains.keeps_outcomes), check(check_) {
        call.r_ref = r_ref;
        call.r = r;
        call.v = v;
        call.dt = dt;
        call.virial = virial;
        call.report = report;
        call.flow = rate ? rate->L : nullptr;
        call.max_iterations = most_iterations;
        put_box(box, call.box);
        put_box(box_ref, call.box_ref);
    }
    bool takes_blocks(bool bonds) const override { return tolerance == 0 && !(bonds && lambda); }
    std::uint64_t bodies(const BodyUnit &unit, double *scratch, BodyResult *results) const override {
        return kernels().bodies.positions(call, unit, scratch, results);
    }
    bool has_results() const override { return virial || report; }
    void done(const BodyResult &result, std::int64_t number, Tally &tally) const override {
        if (virial) BodyWork::done(result, number, tally);
        note(number, result.iterations, true, result.error, -1, tally);
    }

    // Whether everything is where it should be, to the rounding of the coordinates. system.t: residuals of rows.
    bool is_done(const System &system) const {
        const MoleculeKind &s = system.kind();
        double largest = 0;
        for (std::int64_t i = 0; i < 3 * std::int64_t{s.n_atoms}; ++i)
            largest = std::max(largest, std::fabs(system.raw[i]));
        const double rounding = (r.is_float ? 1.2e-7 : std::numeric_limits<double>::epsilon()) * largest;
        for (std::int32_t k = 0; k < s.n_rows; ++k)
            if (!(std::fabs(system.t[k].hi) <= std::max(tolerance / 2 * s.scale[at(k)], rounding * s.reach[at(k)])))
                return false;
        for (std::int32_t i = 0; i < s.n_held; ++i) {
            const double size = system.body(s.parts[at(s.part_of[at(i)])]).extent;
            if (!(size_of(system.position_of(system.now, i) - system.now.x[i]) <=
                  std::max(2 * rounding, tolerance / 2 * size)))
                return false;
        }
        return true;
    }

    bool is_stretched(const System &system) const {
        const MoleculeKind &s = system.kind();
        for (std::int32_t k = 0; k < s.n_rows; ++k) {
            const std::int32_t bond = s.bond_of_row[at(k)];
            if (bond >= 0 && size_of(system.bond_vector(system.now, bond)) > most_stretched * s.bonds[at(bond)].length)
                return true;
        }
        for (std::int32_t i = 0; i < s.n_held; ++i) {
            const Part &part = s.parts[at(s.part_of[at(i)])];
            if (system.body(part).is_rigid &&
                size_of(system.now.x[i] - system.now.q[part.first_node]) > most_stretched * system.body(part).extent)
                return true;
        }
        return false;
    }

    void note(std::int64_t number, int iterations, bool corrected, double error, std::int32_t bond,
              Tally &tally) const {
        if (!report) return;
        count_moved(tally, corrected, iterations);
        if (take_worst(tally, error, number)) tally.worst_bond = bond;
    }

    void write_lambda(const System &system, const MoleculeView &view, double factor) const {
        const MoleculeKind &s = system.kind();
        for (std::size_t k = 0; lambda && k < s.bonds.size(); ++k)
            lambda[view.bonds[k]] = factor * multiplier_of(system, k);
    }

    Outcome molecule(const System &system, const MoleculeView &view, Tally &tally) const override {
        const MoleculeKind &s = system.kind();
        system.read(r_ref, box_ref, view, system.reference);
        system.read(r, box, view, system.now);
        std::int32_t worst_bond;
        const double before = system.residuals(system.now, system.t, &worst_bond);
        if (!std::isfinite(before)) return Outcome::not_finite;
        if (check && is_stretched(system)) return Outcome::stretched;
        if (is_done(system)) {
            std::fill(system.t, system.t + s.n_rows, as_pair(0));
            if (s.by_lengths) std::fill(system.within, system.within + s.bonds.size(), 0.0);
            write_lambda(system, view, 1);
            note(view.number, 0, false, before, worst_bond, tally);
            return Outcome::good;
        }
        system.differentiate(system.reference);
        int iterations;
        double error;
        const Outcome outcome = system.restore(system.reference, system.now, std::max(tolerance, exact),
                                               most_iterations, system.t, &iterations, &error);
        if (outcome != Outcome::good) return outcome;
        double sum = 0;
        for (std::int32_t i = 0; i < s.n_movable; ++i)
            sum +=
                size_of(system.position_of(system.now, i)) + size_of(system.now.x[i]) + size_of(system.reference.x[i]);
        if (!std::isfinite(sum)) return Outcome::not_finite;
        if (s.by_lengths && lambda) share(system);
        write_atoms(system, view);
        write_lambda(system, view, 0.5 / (dt * dt));
        if (virial) system.add_virial(system.reference, system.t, 1 / (dt * dt), tally.virial);
        note(view.number, iterations, true, error, -1, tally);
        return outcome;
    }

    // The moves, times the masses.
    void share(const System &system) const {
        const MoleculeKind &s = system.kind();
        double *force = force_within(system);
        for (std::int32_t i = 0; i < s.n_held; ++i) {
            const PairVector moved = system.position_of(system.now, i) - system.now.x[i];
            const Vector3<double> push = rounded(s.mass[at(i)] * moved);
            *force++ = push.x, *force++ = push.y, *force++ = push.z;
        }
        share_within(system, system.reference);
    }

    // Sites have no momentum of their own: their velocities are those of the body where they are.
    void write_atoms(const System &system, const MoleculeView &view) const {
        const MoleculeKind &s = system.kind();
        for (std::int32_t i = 0; i < s.n_movable; ++i) {
            const PairVector moved = system.position_of(system.now, i) - system.now.x[i];
            const double *const from = system.raw + 3 * std::ptrdiff_t{i};
            const double x[3] = {rounded(as_pair(from[0]) + moved.x), rounded(as_pair(from[1]) + moved.y),
                                 rounded(as_pair(from[2]) + moved.z)};
            write_atom(r, view.atoms[i], x);
            if (!v.x || s.mass[at(i)] == 0) continue;
            double u[3];
            read_atom(v, view.atoms[i], u);
            u[0] += rounded(moved.x) / dt;
            u[1] += rounded(moved.y) / dt;
            u[2] += rounded(moved.z) / dt;
            write_atom(v, view.atoms[i], u);
        }
        if (!v.x) return;
        bool any = false;
        for (std::int32_t i = 0; i < s.n_held; ++i) any = any || s.mass[at(i)] == 0;
        if (!any) return;
        system.velocities(v, view, system.a);
        for (std::int32_t i = 0; i < s.n_held; ++i) {
            if (s.mass[at(i)] > 0) continue;
            const Vector3<double> u = rounded(system.velocity_of(system.now, system.a, rate, i));
            const double x[3] = {u.x, u.y, u.z};
            write_atom(v, view.atoms[i], x);
        }
    }
};

// Goes through all molecules, and adds to the report. Returns the sums.
Tally run_positions(const Chains &chains, const BodyPositions &work, Report *report) {
    const RunResult found = run(chains, work);
    const Tally &tally = found.tally;
    if (report) {
        report->iterations = std::max(report->iterations, tally.iterations);
        report->n_corrected += tally.n_corrected;
        report->n_failed += tally.n_bad;
        report->made = true;
        if (tally.worst_chain >= 0 && (report->chain < 0 || tally.worst > report->max_error)) {
            report->max_error = tally.worst;
            report->chain = tally.worst_chain + chains.base;
            report->bond = tally.worst_bond < 0 ? -1 : tally.worst_bond + chains.base;
        }
    }
    throw_if_bad(chains, found, {{"reference position", &work.r_ref}, {"position", &work.r}});
    return tally;
}

}  // namespace

void project_positions(const Chains &chains, const AtomArray &r_ref, const AtomArray &r, const AtomArray &v, double dt,
                       double *lambda, double *virial, Report *report) {
    const Tally tally =
        run_positions(chains,
                      BodyPositions(chains, r_ref, chains.box_of_reference(), r, v, dt, lambda, virial != nullptr,
                                    report != nullptr, chains.checks() != Checks::never),
                      report);
    if (virial) add_virial(tally, virial);
}

void impose(const Chains &chains, const AtomArray &r, Report *report) {
    run_positions(chains,
                  BodyPositions(chains, r, chains.box, r, AtomArray{}, 1, nullptr, false, report != nullptr, false),
                  report);
}

}  // namespace holonomic::rigid
