// The same for the methods that take molecules of any topology, on all the kinds that are measured.
#include <algorithm>
#include <cmath>

#include "errors.hpp"
#include "methods/graph_methods.hpp"
#include "methods/methods.hpp"
#include "molecules/molecule_errors.hpp"
#include "validate.hpp"

namespace bench {
namespace {

const double eps = 0x1p-52;

struct Outcome {
    double error;
    std::int64_t iterations;
};

Outcome run(Level level, const Molecules &m, const Method &method) {
    State s(m, level);
    if (method.before) method.before(s);
    method.call(s);
    if (method.after) method.after(s);
    return {MoleculeReference(m, level, 2000).error(s), s.iterations};
}

void positions(const Molecules &m) {
    const Level level = Level::position;
    const std::string name = m.name + ": ";
    const bool coupled = m.name == "triangles" || m.name == "protein" || m.name == "water" || m.name == "random_tree";
    for (double tolerance : {1e-4, 1e-9})
        expect(name + "SHAKE sweeps end just below " + tolerance_setting(tolerance),
               run(level, m, graph_rattle(level, m, tolerance)).error, 0, 1.001 * tolerance);
    const Outcome once = run(level, m, graph_newton(m, 1e-6)), end = run(level, m, graph_newton(m, 1e-12));
    expect(name + "Newton, solves to 1e-6", static_cast<double>(once.iterations), 1, 3);
    expect(name + "Newton, solves to 1e-12", static_cast<double>(end.iterations), 2, 4);
    expect(name + "Newton, error then", end.error, 0, 1e-12);
    const Outcome quasi = run(level, m, graph_quasi_newton(m, 1e-12));
    expect(name + "quasi-Newton, solves to 1e-12", static_cast<double>(quasi.iterations), 2, 10);
    expect(name + "quasi-Newton, error then", quasi.error, 0, 1e-12);
    // The expansion of the inverse converges badly or not at all where many bonds meet or angles are rigid: known of
    // LINCS.
    if (!coupled) {
        const double rough = run(level, m, graph_lincs(m, 4, 1)).error,
                     fine = run(level, m, graph_lincs(m, 8, 4)).error;
        expect(name + "LINCS order 4, 1 iteration", rough, 1e-9, 3e-3);
        expect(name + "LINCS order 8, 4 iterations is better", fine / rough, 0, 0.5);
    }
    if (have_openmm()) expect(name + "OpenMM at 1e-6", run(level, m, openmm(level, m, {1e-6})[0]).error, 0, 2.1e-6);
}

void velocities(const Molecules &m) {
    const Level level = Level::velocity;
    const std::string name = m.name + ": velocities by ";
    expect(name + "L D L^T", run(level, m, graph_direct(level, m)).error, 0, 400 * eps);
    expect(name + "Eigen", run(level, m, graph_eigen(level, m)).error, 0, 400 * eps);
    expect(name + "sweeps to 1e-9", run(level, m, graph_rattle(level, m, 1e-9)).error, 0, 3e-9);
    if (have_openmm()) expect(name + "OpenMM at 1e-10", run(level, m, openmm(level, m, {1e-10})[0]).error, 0, 3e-9);
}

void accelerations(const Molecules &m) {
    const Level level = Level::acceleration;
    expect(m.name + ": multipliers by L D L^T", run(level, m, graph_direct(level, m)).error, 0, 400 * eps);
    expect(m.name + ": multipliers by Eigen", run(level, m, graph_eigen(level, m)).error, 0, 400 * eps);
}

/// A chain as a graph: multipliers, their reference and its scale are those of chains, found in 113 bits.
void a_chain_is_a_graph() {
    KindMaker maker;
    maker.atom(1);
    for (int i = 0; i < 40; ++i) maker.atom(i % 3 + 1, i, 1);
    const Molecules m = make_molecules("chain", {maker.done()}, 1);
    Problem p;
    static_cast<Scene &>(p) = m;
    p.mass = m.mass, p.w = m.kinds[0].w, p.length = m.kinds[0].length;
    State s(m, Level::acceleration);
    graph_direct(Level::acceleration, m).call(s);
    s.lambda[20] *= 1 + 1e-6;  // an error that both must see alike
    const double here = MoleculeReference(m, Level::acceleration, 40).error(s);
    const double there = Reference(p, Level::acceleration, nullptr, 40).error(s);
    // The scale of chains leaves out |d.a|: it is the smaller one, by less than half.
    expect("a chain as a graph: error over that of the chains' reference", here / there, 0.3, 1.001);
    s.lambda[20] /= 1 + 1e-6;
    expect("a chain as a graph: multipliers", Reference(p, Level::acceleration, nullptr, 40).error(s), 0, 20 * eps);
}

/// SETTLE is exact; OpenMM's, in the same arithmetic, was seen to leave 1e-8 of the squared lengths.
void water() {
    const Molecules m = make_molecules("water", {water_kind()}, 100);
    expect("water: SETTLE, positions", run(Level::position, m, settle(Level::position, m)).error, 0, 1e-13);
    expect("water: SETTLE, velocities", run(Level::velocity, m, settle(Level::velocity, m)).error, 0, 20 * eps);
    if (have_openmm())
        expect("water: OpenMM's SETTLE", run(Level::position, m, openmm(Level::position, m, {1e-12})[0]).error, 0,
               1e-7);
    // The velocities that go with the positions are the displacement over dt, as Newton's method has it.
    State a(m, Level::position), b(m, Level::position);
    settle(Level::position, m).call(a);
    graph_newton(m, 1e-15).call(b);
    double worst = 0;
    for (std::size_t i = 0; i < a.r.size(); ++i) {
        worst = std::max(worst, std::abs(a.r[i] - b.r[i]));
        worst = std::max(worst, m.dt * std::abs(a.v[i] - m.v[i] - (b.r[i] - m.drifted[i]) / m.dt));
    }
    expect("water: SETTLE's positions and velocities are Newton's, nm", worst, 0, 1e-14);
}

}  // namespace

std::vector<Molecules> validated_scenes() {
    std::vector<Molecules> list;
    list.push_back(make_molecules("water", {water_kind()}, 100));
    list.push_back(
        make_molecules("hydrogens", {formula_kind("CH"), formula_kind("NHH"), formula_kind("C(H)(H)H")}, 90));
    list.push_back(make_molecules("ethane", {formula_kind("C(H)(H)(H)C(H)(H)H")}, 20));
    list.push_back(make_molecules("dendrimer", {dendrimer_kind(3, 2, 4)}, 4));
    list.push_back(make_molecules("comb", {comb_kind(10, 2)}, 4));
    list.push_back(make_molecules("ring", {ring_kind(50)}, 4));
    list.push_back(make_molecules("triangles", {triangles_kind(20)}, 4));
    list.push_back(make_molecules("arms", {arms_kind(400, 50)}, 1));
    list.push_back(make_molecules("random_tree", {random_tree_kind(300)}, 1));
    list.push_back(make_molecules("protein", {protein_kind(400)}, 1));
    return list;
}

void validate_molecules() {
    for (const Molecules &m : validated_scenes()) {
        positions(m);
        velocities(m);
        accelerations(m);
    }
    a_chain_is_a_graph();
    water();
}

}  // namespace bench
