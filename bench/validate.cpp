// The methods that stand in for others must behave as published: error and iterations at given settings, on the
// problems and with the error measures for which they were published or measured from the packages themselves. A window
// of a factor three either way allows for other random chains.
#include <cmath>
#include <cstdio>
#include <string>

#include "errors.hpp"
#include "methods/methods.hpp"
#include "validate.hpp"

namespace {

int failures = 0;

}  // namespace

void bench::expect(const std::string &what, double value, double low, double high) {
    const bool good = value >= low && value <= high;
    std::printf("%s  %-66s %10.3g  in [%.3g, %.3g]\n", good ? "ok  " : "FAIL", what.c_str(), value, low, high);
    if (!good) ++failures;
}

namespace {

using namespace bench;

struct Outcome {
    double error;
    std::int64_t iterations;
};

Outcome run(Level level, const Problem &p, const Method &m) {
    State s(p, level);
    if (m.before) m.before(s);
    m.call(s);
    if (m.after) m.after(s);
    return {Reference(p, level, nullptr, 2000).error(s), s.iterations};
}

const double eps = 0x1p-52;

/// Position level on coils, dt 0.005.
void coils() {
    const Problem p = make_problem(batch("coil", 100, 100));
    const Level level = Level::position;
    // SHAKE stops at the first sweep in which all bonds are within the tolerance: just below it, by linear convergence.
    for (double tolerance : {1e-4, 1e-6, 1e-9, 1e-12}) {
        const Outcome o = run(level, p, rattle(level, p, tolerance));
        expect("coil: SHAKE sweeps end just below " + tolerance_setting(tolerance), o.error, 0.3 * tolerance,
               1.001 * tolerance);
    }
    // Newton: largest violation 1e-3 before, 3e-7 after one solve, 2e-14 after two; one solve to 1e-6, two to 1e-12.
    const Outcome once = run(level, p, sparse_newton(p, 1e-6)), twice = run(level, p, sparse_newton(p, 1e-12));
    expect("coil: sparse Newton, solves to 1e-6", static_cast<double>(once.iterations), 1, 1);
    expect("coil: sparse Newton, error then", once.error, 1e-7, 9e-7);
    expect("coil: sparse Newton, solves to 1e-12", static_cast<double>(twice.iterations), 2, 2);
    expect("coil: sparse Newton, error then", twice.error, 0, 6e-14);
    // The first matrix kept: 3e-7, 1.5e-10, 9e-14.
    if (have_lapack()) {
        const Outcome o = run(level, p, milc_shake(p, 1e-8)), end = run(level, p, milc_shake(p, 1e-12));
        expect("coil: MILC-SHAKE, solves to 1e-8", static_cast<double>(o.iterations), 2, 2);
        expect("coil: MILC-SHAKE, error then", o.error, 0.5e-10, 4.5e-10);
        expect("coil: MILC-SHAKE, solves to 1e-12", static_cast<double>(end.iterations), 3, 3);
        expect("coil: MILC-SHAKE, error then", end.error, 3e-15, 2.7e-13);
    }
    // GROMACS 2022: order 4, one iteration 6e-5 .. 1e-4; order 8, four iterations 3.5e-10 (N = 1) .. 5.5e-7.
    expect("coil: LINCS order 4, 1 iteration", run(level, p, lincs(p, 4, 1)).error, 2e-5, 3e-4);
    expect("coil: LINCS order 8, 4 iterations", run(level, p, lincs(p, 8, 4)).error, 1e-10, 1.7e-6);
    if (have_openmm()) {
        const Problem q = make_problem(batch("coil", 20, 100));
        // Its tolerance is of lengths, half that of squares.
        expect("coil: CCMA at 1e-6", run(level, q, openmm_ccma(level, q, {1e-6}, false)[0]).error, 0.6e-6, 2.001e-6);
    }
}

/// Each bond turned by 0..5 degrees from the one before, dt 0.005.
void nearly_straight() {
    const Problem p = make_problem(batch("straight5", 5, 100)), longer = make_problem(batch("straight5", 2, 1000));
    const Level level = Level::position;
    expect("straight5: SHAKE needs thousands of sweeps (1e-6)",
           static_cast<double>(run(level, p, rattle(level, p, 1e-6)).iterations), 1000, 30000);
    expect("straight5: LINCS order 4, 1 iteration", run(level, p, lincs(p, 4, 1)).error, 1.2e-4, 1e-3);
    expect("straight5: LINCS order 8, 4 iterations", run(level, p, lincs(p, 8, 4)).error, 0.7e-4, 6e-4);
    expect("straight5, N = 1000: sparse Newton, solves to 1e-12",
           static_cast<double>(run(level, longer, sparse_newton(longer, 1e-12)).iterations), 3, 3);
    if (have_lapack()) {
        const Outcome o = run(level, longer, milc_shake(longer, 1e-9));
        expect("straight5, N = 1000: MILC-SHAKE, solves to 1e-9", static_cast<double>(o.iterations), 2, 6);
        const Problem longest = make_problem(batch("straight5", 1, 10000));
        expect("straight5, N = 10,000: MILC-SHAKE stalls near 3e-12",
               run(level, longest, milc_shake(longest, 1e-13)).error, 1e-13, 1e-11);
    }
    if (have_openmm())
        expect("straight5: CCMA stops after 150 iterations",
               run(level, p, openmm_ccma(level, p, {1e-6}, false)[0]).error, 4e-5, 4.5e-4);
}

/// Velocity level: a direct solve leaves rounding, sweeps their tolerance.
void velocities() {
    const Problem p = make_problem(batch("coil", 20, 100));
    const Level level = Level::velocity;
    if (have_lapack())
        expect("coil: velocities by dgtsv", run(level, p, direct_velocities(p, "", "", lapack_dgtsv())).error, 0,
               20 * eps);
    for (double tolerance : {1e-6, 1e-9})
        expect("coil: velocities by sweeps, " + tolerance_setting(tolerance),
               run(level, p, rattle(level, p, tolerance)).error, 0.3 * tolerance, 3 * tolerance);
}

/// Accelerations: all direct ways agree on coils; those that subtract lose digits with the condition number, 1e4 here.
void accelerations() {
    const Problem coil = make_problem(batch("coil", 20, 100)), straight = make_problem(batch("straight5", 5, 100));
    const Level level = Level::acceleration;
    auto both = [&](const char *name, const Solver &solver) {
        expect(std::string("coil: multipliers by ") + name, run(level, coil, direct_forces(coil, "", "", solver)).error,
               0, 20 * eps);
        expect(std::string("straight5: multipliers by ") + name,
               run(level, straight, direct_forces(straight, "", "", solver)).error, 2 * eps, 1e4 * eps);
    };
    both("Eq. (20)", eq20());
    both("the Omega recursion", omega_recursion());
    both("Eigen's dense LDL^T", eigen_ldlt());
    both("Eigen's simplicial LDL^T", eigen_simplicial());
    if (have_lapack()) both("dptsv", lapack_dptsv());
    if (have_lapack()) both("dgtsv", lapack_dgtsv());
    // Nearly straight with joints 1e12 times lighter: the recursion as printed has no digit left.
    const Problem light = make_problem(with_joints(batch("light_joints", 5, 64), 1e-12, 0.5e-6, 1e-6));
    expect("light straight joints: the Omega recursion",
           run(level, light, direct_forces(light, "", "", omega_recursion())).error, 1e-5, 1e300);
    expect("light straight joints: the library", run(level, light, holonomic(level, light)).error, 0, (16 + 8) * eps);
}

/// A straight chain of equal masses has det Z~ = (N+1)/2^N.
void determinants() {
    const Problem p = make_problem(with_joints(batch("light_joints", 1, 20), 1, 0, 0));
    State s(p, Level::metric);
    direct_metric(p, "", "", omega_recursion_log_det()).call(s);
    const double exact = std::log(21.0) - 20 * std::log(2.0);
    expect("straight chain of 20: ln det by the Omega recursion, relative error", std::fabs(s.log_det[0] / exact - 1),
           0, 1000 * eps);
}

}  // namespace

int main() {
    coils();
    nearly_straight();
    velocities();
    accelerations();
    determinants();
    validate_molecules();
    validate_checks();
    std::printf(failures ? "%d of the expectations above failed\n" : "all as published\n", failures);
    return failures != 0;
}
