// Forces, velocities and given right-hand sides of one molecule of any shape, in twice the precision: A t = b
// (theory (51)). Terms b are exact products of the caller's numbers; solution.hpp loads, solves and writes. For
// molecules at which plain products have lost too much, and those of no other way.
#include "core/kernels/extended/solution.hpp"
#include "core/kernels/extended/verbs.hpp"

namespace holonomic::HOL_ISA::extended {

// Finds d.(w_j f_j - w_i f_i) + |v_j - v_i|^2 of each bond, both terms in the solver's units.
static void force_terms(const ScaledMolecule &m, const ForcesCall &call, Wide *b) {
    for (int32_t k = 0; k < m.plan.n_bonds; ++k) {
        const int32_t i = m.plan.atom_i[k], j = m.plan.atom_j[k];
        b[k] = wide(0);
        if (call.f.x) {
            const Vector3<double> fi = read(call.f, m.lane, i), fj = read(call.f, m.lane, j);
            const Wide3 a = {two_product(m.w[j], fj.x) - two_product(m.w[i], fi.x),
                             two_product(m.w[j], fj.y) - two_product(m.w[i], fi.y),
                             two_product(m.w[j], fj.z) - two_product(m.w[i], fi.z)};
            b[k] = dot(m.d[k], a);
        }
        if (call.v.x) {
            const Wide3 dv = difference(read(call.v, m.lane, i), read(call.v, m.lane, j));
            b[k] += dot((1 / m.mass_unit / m.unit[k]) * dv, dv);
        }
    }
}

void forces(const ForcesCall &call, const ExtendedPlan &plan, const MoleculeLane &lane, double *scratch, Tally &tally) {
    ByteArena memory = {reinterpret_cast<char *>(scratch)};
    ExtendedSolution x(plan, lane, memory);
    bool good = x.open(call.r, call.box, call.rescaled);
    if (good) {
        force_terms(x.m, call, x.b);
        good = x.close();
    }
    if (x.lacks_digits()) return quad_double::extended::forces(call, plan, lane, scratch, tally);
    if (!good) return note_bad(lane.molecule, tally);
    write_multipliers(x.m, x.t, call.lambda, call.tension);
    if (call.g.x) write_forces(x.m, call.g, call.add, x.system.pull);
    if (call.virial) add_virial(x.m, x.m.d, x.t, 1, tally);
}

void solve(const SolveCall &call, const ExtendedPlan &plan, const MoleculeLane &lane, double *scratch, Tally &tally) {
    ByteArena memory = {reinterpret_cast<char *>(scratch)};
    ExtendedSolution x(plan, lane, memory);
    bool good = x.open(call.r, call.box, call.rescaled);
    if (good) {
        // Z = 4 A and t = 2 lambda.
        for (int32_t k = 0; k < plan.n_bonds; ++k)
            x.b[k] = wide(0.5 * call.rhs[lane.first_bond + k] / x.m.mass_unit / x.m.unit[k]);
        good = x.close();
    }
    if (x.lacks_digits()) return quad_double::extended::solve(call, plan, lane, scratch, tally);
    if (!good) return note_bad(lane.molecule, tally);
    write_multipliers(x.m, x.t, call.lambda, call.tension);
    if (call.g.x) write_forces(x.m, call.g, call.add, x.system.pull);
    if (call.virial) add_virial(x.m, x.m.d, x.t, 1, tally);
}

// d.(L d) in a box that changes.
static Wide stretching_of(const double *s, const Wide3 &d) {
    return dot(d, Wide3{s[0] * d.x + s[1] * d.y + s[2] * d.z, s[3] * d.y + s[4] * d.z, s[5] * d.z});
}

// d.(v_j - v_i) of each bond.
static void rate_terms(const ScaledMolecule &m, const VelocitiesCall &call, Wide *b) {
    for (int32_t k = 0; k < m.plan.n_bonds; ++k) {
        const int32_t i = m.plan.atom_i[k], j = m.plan.atom_j[k];
        Wide rate = dot(m.d[k], difference(read(call.v, m.lane, i), read(call.v, m.lane, j)));
        if (call.strain) rate += m.unit[k] * stretching_of(call.strain, m.d[k]);
        b[k] = over(rate, m.mass_unit);
    }
}

void velocities(const VelocitiesCall &call, const ExtendedPlan &plan, const MoleculeLane &lane, double *scratch,
                Tally &tally) {
    ByteArena memory = {reinterpret_cast<char *>(scratch)};
    ExtendedSolution x(plan, lane, memory);
    const ScaledMolecule &m = x.m;
    bool good = x.open(call.r, call.box, call.rescaled);
    if (good) {
        rate_terms(m, call, x.b);
        good = x.close();
    }
    if (x.lacks_digits()) return quad_double::extended::velocities(call, plan, lane, scratch, tally);
    if (!good) return note_bad(lane.molecule, tally);
    for (int32_t i = 0; i < plan.n_atoms; ++i) {
        const Vector3<double> v = read(call.v, lane, i);
        x.system.pull[i] = Wide3{wide(v.x), wide(v.y), wide(v.z)} + lane.w[i] * x.system.pull[i];
    }
    if (!finite_pulls(m, x.system.pull)) return note_bad(lane.molecule, tally);
    for (int32_t i = 0; i < plan.n_atoms; ++i)
        if (lane.w[i] > 0) write(call.v, lane, i, rounded(x.system.pull[i]));
    write_multipliers(m, x.t, call.lambda, nullptr);
    if (call.virial) add_virial(m, m.d, x.t, 1, tally);
}

}  // namespace holonomic::HOL_ISA::extended
