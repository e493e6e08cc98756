// One molecule in twice the precision: loads it, solves its equations (system.hpp) and writes its outputs, for every
// level. Lengths and masses are in units of the molecule's own, so that no product over- or underflows.
#pragma once

#include "core/kernels/extended/system.hpp"
#include "core/kernels/tally.hpp"

namespace holonomic::HOL_ISA::extended {

// Turns t into the caller's units. Returns false if one is no number. With d = unit d' and w = mass_unit w', both sides
// of an equation are divided by mass_unit / unit.
HOL_NOINLINE bool to_callers_units(const ScaledMolecule &m, Wide *t) {
    bool good = true;
    for (int32_t k = 0; k < m.plan.n_bonds; ++k) {
        t[k] = over(t[k], m.unit[k]);
        good = good && is_finite(t[k].hi);
    }
    return good;
}

// The bond vectors in the caller's units: sums over bonds need one unit.
HOL_NOINLINE void restore_vectors(const ScaledMolecule &m) {
    for (int32_t k = 0; k < m.plan.n_bonds; ++k) m.d[k] = m.unit[k] * m.d[k];
}

HOL_NOINLINE void write_multipliers(const ScaledMolecule &m, const Wide *t, double *lambda, double *tension) {
    for (int32_t k = 0; k < m.plan.n_bonds; ++k) {
        if (lambda) lambda[m.lane.first_bond + k] = 0.5 * rounded(t[k]) + 0.0;
        if (tension) tension[m.lane.first_bond + k] = rounded(t[k] * square_root(dot(m.d[k], m.d[k]))) + 0.0;
    }
}

HOL_NOINLINE void add_virial(const ScaledMolecule &m, const Wide3 *d, const Wide *t, double factor, Tally &tally) {
    Wide s[6] = {};
    for (int32_t k = 0; k < m.plan.n_bonds; ++k) {
        const Wide3 p = t[k] * d[k];
        s[0] += p.x * d[k].x;
        s[1] += p.x * d[k].y;
        s[2] += p.x * d[k].z;
        s[3] += p.y * d[k].y;
        s[4] += p.y * d[k].z;
        s[5] += p.z * d[k].z;
    }
    for (int c = 0; c < 6; ++c) tally.virial[c] -= factor * rounded(s[c]);
}

// Writes the forces of all atoms, but leaves those of fixed atoms that other molecules share to core.
HOL_NOINLINE void write_forces(const ScaledMolecule &m, const AtomArray &g, bool add, const Wide3 *pull) {
    for (int32_t i = 0; i < m.plan.n_atoms; ++i) {
        if (m.lane.shared && m.lane.shared[i]) continue;
        Vector3<double> value = rounded(pull[i]);
        if (add) {
            const Vector3<double> before = read(g, m.lane, i);
            value = {before.x + value.x, before.y + value.y, before.z + value.z};
        }
        write(g, m.lane, i, value);
    }
}

HOL_NOINLINE bool finite_pulls(const ScaledMolecule &m, const Wide3 *pull) {
    bool good = true;
    for (int32_t i = 0; i < m.plan.n_atoms; ++i) good = good && is_finite(rounded(pull[i]));
    return good;
}

// Loads and factorizes a molecule, then finds t in the caller's units, and its pulls on the atoms. Both steps return
// false if the molecule is bad.
struct ExtendedSolution {
    ScaledMolecule m;
    ExtendedSystem system;
    Wide *b, *t;
    ExtendedSolution(const ExtendedPlan &plan, const MoleculeLane &lane, ByteArena &memory)
        : m(plan, lane, memory), system(take_system(m, memory)), b(memory.take<Wide>(plan.n_bonds)),
          t(memory.take<Wide>(plan.n_bonds)) {}
    // A molecule of which a pivot seems to vanish may be regular all the same; more digits say so. Those of a ring are
    // right as they are.
    // in_any_units: else those that are not ordinary are left to core.
    bool open(const AtomArray &r, const Box &box, bool in_any_units) {
        if (!load(m, r, box) || (!in_any_units && !is_in_ordinary_units(m))) return false;
        const bool good = factorize(m, system);
        if (!good) system.joint.loss.largest = is_ring(m.plan) ? 0 : __builtin_inf();
        return good;
    }
    bool close() {
        solve(m, system, b, t);
        if (!to_callers_units(m, t)) return false;
        restore_vectors(m);
        pulls(m, m.d, t, system.pull);
        return finite_pulls(m, system.pull);
    }
    // Nothing has been written yet: the molecule is to be done in four times the precision.
    bool lacks_digits() const { return lacks_digits(m.plan, system.joint); }
    static bool lacks_digits(const ExtendedPlan &plan, const Joint &joint) {
        return joint.loss.too_much() && plan.n_bonds <= most_quad_double;
    }
};

}  // namespace holonomic::HOL_ISA::extended
