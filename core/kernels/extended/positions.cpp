// Position level of one molecule: Newton's method with a new mixed Jacobian (theory (58)) at each step. It decides by
// the rules that chains have (newton/rules.hpp). Differences of large pulls lose nothing in twice the precision.
#include "core/kernels/extended/solution.hpp"
#include "core/kernels/extended/verbs.hpp"
#include "core/kernels/newton/rules.hpp"
#include "core/kernels/tally.hpp"

namespace holonomic::HOL_ISA::extended {

// In the caller's units tau is T / (unit mass_unit). Atoms are displaced by w times the sum of T b.
struct PositionNewton {
    ScaledMolecule m;  // m.d: reference bonds b
    Joint joint;
    Graph graph;
    Wide3 *D, *first;  // [n_bonds] new bonds as moved so far and as they came, in the unit of b
    Wide3 *x;          // [n_atoms] displacements
    Wide *a2;          // [n_bonds] squares of the lengths in that unit
    Wide *T, *change, *sigma;
    double error;   // largest |D.D - a^2| / a^2
    int32_t worst;  // its bond
    PositionNewton(const ExtendedPlan &plan, const MoleculeLane &lane, ByteArena &memory)
        : m(plan, lane, memory), joint(take_joint(plan.most_arms, true, memory)), D(memory.take<Wide3>(plan.n_bonds)),
          first(memory.take<Wide3>(plan.n_bonds)), x(memory.take<Wide3>(plan.n_atoms)),
          a2(memory.take<Wide>(plan.n_bonds)), T(memory.take<Wide>(plan.n_bonds)),
          change(memory.take<Wide>(plan.n_bonds)), sigma(memory.take<Wide>(plan.n_bonds)), error(0), worst(0) {
        graph = take_graph(plan, D, m.d, memory);
    }
};

static bool load(PositionNewton &p, const PositionsCall &call) {
    ScaledMolecule &m = p.m;
    if (!load(m, call.r_ref, call.box_ref) || !load_vectors(m, call.r, call.box, p.first)) return false;
    for (int32_t k = 0; k < m.plan.n_bonds; ++k) {
        const double a = m.lane.length[k] / m.unit[k];
        p.first[k] = (1 / m.unit[k]) * p.first[k];
        p.a2[k] = two_product(a, a);
    }
    return true;
}

// Moves the bonds by T and finds what is left of D.D - a^2.
static void move(PositionNewton &p) {
    const ScaledMolecule &m = p.m;
    pulls(m, m.d, p.T, p.x);
    for (int32_t i = 0; i < m.plan.n_atoms; ++i) p.x[i] = m.w[i] * p.x[i];
    p.error = 0;
    p.worst = 0;
    for (int32_t k = 0; k < m.plan.n_bonds; ++k) {
        const Wide3 moved = (1 / m.unit[k]) * (p.x[m.plan.atom_j[k]] - p.x[m.plan.atom_i[k]]);
        p.D[k] = p.first[k] + moved;
        p.sigma[k] = dot(p.D[k], p.D[k]) - p.a2[k];
        const double error = abs(p.sigma[k].hi) / p.a2[k].hi;
        if (!(error <= p.error)) {  // keeps a NaN
            p.error = error;
            p.worst = k;
        }
        if (!is_finite(error)) return;
    }
}

static bool step(PositionNewton &p) {
    const ScaledMolecule &m = p.m;
    int32_t bad;
    if (!factorize(m, p.graph, p.joint, bad)) {
        if (is_tree(m.plan)) p.joint.loss.largest = __builtin_inf();  // it may be regular all the same
        return false;
    }
    for (int32_t k = 0; k < m.plan.n_bonds; ++k) p.sigma[k] = (0.5 * m.unit[k]) * p.sigma[k];
    solve(m, p.graph, p.sigma, p.change);
    for (int32_t k = 0; k < m.plan.n_bonds; ++k) p.T[k] += p.change[k];
    move(p);
    return is_finite(p.error);
}

enum ProjectionResult { projected_not, projected_untouched, projected };

// Returns the error |D.D - a^2| / a^2 that the coordinates carry. It is accepted.
static double carried(const PositionNewton &p, const PositionsCall &call) {
    double extent = 0, shortest = p.m.lane.length[0];
    for (int32_t i = 0; i < p.m.plan.n_atoms; ++i) {
        const Vector3<double> r = read(call.r, p.m.lane, i);
        const double largest = largest_component({wide(r.x), wide(r.y), wide(r.z)});
        extent = largest > extent ? largest : extent;
    }
    for (int32_t k = 1; k < p.m.plan.n_bonds; ++k)
        shortest = p.m.lane.length[k] < shortest ? p.m.lane.length[k] : shortest;
    const double carried = rounding_of_bonds(call) * (1 + extent / shortest);
    return carried > call.tolerance ? carried : call.tolerance;
}

// Newton's method that has lost its way: so many steps do not halve the smallest error.
constexpr int64_t patience = 12;

static ProjectionResult iterate(PositionNewton &p, const PositionsCall &call, bool guess, int64_t &solves) {
    const ScaledMolecule &m = p.m;
    const double accepted = carried(p, call), done = wanted_error(call);
    for (int32_t k = 0; k < m.plan.n_bonds; ++k) p.T[k] = wide(0);
    move(p);
    if (!is_finite(p.error) || p.error > call.far_trial) return projected_not;
    if (p.error <= accepted) return projected_untouched;
    if (guess) {
        const double before = p.error;
        for (int32_t k = 0; k < m.plan.n_bonds; ++k)
            p.T[k] = (2 * call.dt * call.dt * m.unit[k] * m.mass_unit) * wide(call.lambda[m.lane.first_bond + k]);
        move(p);
        if (!(p.error <= before)) return projected_not;  // where it did not help: from zero
        if (p.error <= done) return projected;
    }
    double rate = p.error, least = p.error;
    int64_t since = 0;
    for (solves = 1; solves <= call.max_iterations; ++solves) {
        const double before = p.error, expected = rate * before;
        if (!step(p)) return projected_not;
        const bool floor = any(at_floor(expected, before, p.error));
        if (p.error <= done || (floor && p.error <= accepted)) return projected;
        rate = p.error;  // new factors square it
        since = p.error <= 0.5 * least ? solves : since;
        least = p.error < least ? p.error : least;
        if (solves - since >= patience) return projected_not;
    }
    return projected_not;
}

static void note_worst(const PositionNewton &p, Tally &tally) {
    if (take_worst(tally, p.error, p.m.lane.molecule)) tally.worst_bond = p.worst;
}

// Writes new positions and velocities. Returns false, with nothing written, if one would not be finite.
static bool write_moves(const PositionNewton &p, const PositionsCall &call) {
    const ScaledMolecule &m = p.m;
    for (int pass = 0; pass < 2; ++pass)
        for (int32_t i = 0; i < m.plan.n_atoms; ++i) {
            if (!(m.w[i] > 0)) continue;
            for (int what = 0; what < (call.v.x ? 2 : 1); ++what) {
                const AtomArray &array = what == 0 ? call.r : call.v;
                const Vector3<double> old = read(array, m.lane, i);
                const Wide3 by = what == 0 ? p.x[i] : (1 / call.dt) * p.x[i];
                const Vector3<double> value = rounded(Wide3{wide(old.x), wide(old.y), wide(old.z)} + by);
                if (!is_finite(value)) return false;
                if (pass == 1) write(array, m.lane, i, value);
            }
        }
    return true;
}

void positions(const PositionsCall &call, const ExtendedPlan &plan, const MoleculeLane &lane, double *scratch,
               Tally &tally) {
    ByteArena memory = {reinterpret_cast<char *>(scratch)};
    PositionNewton p(plan, lane, memory);
    ProjectionResult result = projected_not;
    int64_t solves = 0;
    if (load(p, call) && (call.rescaled || is_in_ordinary_units(p.m))) {
        if (call.guess) result = iterate(p, call, true, solves);
        if (result == projected_not) result = iterate(p, call, false, solves);
    }
    if (ExtendedSolution::lacks_digits(plan, p.joint))
        return quad_double::extended::positions(call, plan, lane, scratch, tally);
    if (result == projected_not || (result == projected && !write_moves(p, call)))
        return note_bad(lane.molecule, tally);
    for (int32_t k = 0; k < plan.n_bonds; ++k) p.T[k] = over(over(p.T[k], p.m.unit[k]), p.m.mass_unit);
    for (int32_t k = 0; call.lambda && k < plan.n_bonds; ++k)
        call.lambda[lane.first_bond + k] = 0.5 / (call.dt * call.dt) * rounded(p.T[k]) + 0.0;
    if (call.report) note_worst(p, tally);
    if (result == projected_untouched) return;
    restore_vectors(p.m);
    if (call.virial) add_virial(p.m, p.m.d, p.T, 1 / (call.dt * call.dt), tally);
    ++tally.n_corrected;
    if (solves > tally.iterations) tally.iterations = solves;
}

}  // namespace holonomic::HOL_ISA::extended
