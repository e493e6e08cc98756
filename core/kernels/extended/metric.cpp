// Metric determinant and Fixman force of one molecule of any shape, in twice the precision (theory (60)-(62)): those
// with cycles other than bare rings, and those at which plain products have lost too much.
#include "core/kernels/extended/logarithms.hpp"
#include "core/kernels/extended/neighbours.hpp"
#include "core/kernels/extended/solution.hpp"
#include "core/kernels/extended/verbs.hpp"

namespace holonomic::HOL_ISA::extended {

// Returns w_i times the sum of H_kl d_k x d_l over the other bonds l of atom i, for its arm a. All d point away from
// it.
static Wide3 weighed_normal(const ScaledMolecule &m, const Tree &tree, const Neighbours &x, int32_t i, int a) {
    const int32_t *const arms = m.plan.arms + m.plan.arm_start[i];
    const int n = m.plan.arm_start[i + 1] - m.plan.arm_start[i];
    if (n > most_arms && is_tree(m.plan)) {
        const auto outward = [&](int b) { return m.outward(m.d, arms[b], i); };
        const Wide f = wide(-m.w[i]) / (tree.up[arms[a]] + tree.down[arms[a]]);
        return f * cross(outward(a), directions_of_many(tree.L + m.plan.table_start[i], n, a, outward));
    }
    Wide3 sum = {};
    for (int b = 0; b < n; ++b)
        if (b != a)
            sum = sum + x.H[x.start[i] + a * n + b] * cross(m.outward(m.d, arms[a], i), m.outward(m.d, arms[b], i));
    return m.w[i] * sum;
}

// kT phi_k = kT d_k x (normals at both ends) / d_k.d_k turns bond k: its force on atom j, and minus that on atom i.
static void fixman_force(const ScaledMolecule &m, const Tree &tree, const Neighbours &x, double kT, Wide3 *normal,
                         Wide3 *force) {
    const ExtendedPlan &plan = m.plan;
    for (int32_t k = 0; k < plan.n_bonds; ++k) normal[k] = Wide3{};
    for (int32_t i = 0; i < plan.n_atoms; ++i) {
        force[i] = Wide3{};
        for (int a = 0; a < plan.arm_start[i + 1] - plan.arm_start[i]; ++a) {
            const int32_t k = plan.arms[plan.arm_start[i] + a];
            normal[k] = normal[k] + weighed_normal(m, tree, x, i, a);
        }
    }
    for (int32_t k = 0; k < plan.n_bonds; ++k) {
        const Wide factor = over(wide(kT) / dot(m.d[k], m.d[k]), m.unit[k]);
        const Wide3 phi = factor * cross(m.d[k], normal[k]);
        force[plan.atom_j[k]] = force[plan.atom_j[k]] + phi;
        force[plan.atom_i[k]] = force[plan.atom_i[k]] - phi;
    }
}

void metric(const MetricCall &call, const ExtendedPlan &plan, const MoleculeLane &lane, double *scratch, Tally &tally) {
    ByteArena memory = {reinterpret_cast<char *>(scratch)};
    ExtendedSolution x(plan, lane, memory);
    if (!x.open(call.r, call.box, true)) {
        if (x.lacks_digits()) return quad_double::extended::metric(call, plan, lane, scratch, tally);
        return note_bad(lane.molecule, tally);
    }
    const Wide det = log_det(x.m, x.system, memory), diagonal = log_of_diagonal(x.m);
    bool good = is_finite(det.hi) && is_finite(diagonal.hi);
    if (call.force.x && good) {
        const Neighbours neighbours = take_neighbours(plan, memory);
        find_neighbours(x.m, x.system, neighbours);
        fixman_force(x.m, x.system.tree, neighbours, call.kT, memory.take<Wide3>(plan.n_bonds), x.system.pull);
        good = finite_pulls(x.m, x.system.pull);
    }
    if (x.lacks_digits()) return quad_double::extended::metric(call, plan, lane, scratch, tally);
    if (!good) return note_bad(lane.molecule, tally);
    if (call.force.x) write_forces(x.m, call.force, call.add, x.system.pull);
    if (call.log_det) call.log_det[lane.molecule] = rounded(det);
    if (call.log_det_z) call.log_det_z[lane.molecule] = rounded(det + diagonal);
    tally.log_det += rounded(det);
}

}  // namespace holonomic::HOL_ISA::extended
