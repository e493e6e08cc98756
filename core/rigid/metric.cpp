// The metric determinant of molecules whose images are told, and its gradient: docs/theory.md (24)-(32), by the factors
// and the inverse's entries of their general equations.
#include <algorithm>
#include <cmath>

#include "core/index.hpp"
#include "core/rigid/run.hpp"
#include "core/rigid/verbs.hpp"

namespace holonomic::rigid {

namespace {

struct BodyMetric final : BodyWork {
    const Cell &box;
    const MetricCall &call;
    BodyMetric(const Chains &chains, const MetricCall &call_)
        : BodyWork(chains, call_.force), box(chains.box), call(call_) {}

    Outcome molecule(const System &system, const MoleculeView &view, Tally &tally) const override {
        const MoleculeKind &s = system.kind();
        system.read(call.r, box, view, system.now);
        system.differentiate(system.now);
        double log_det, log_det_z;
        const Outcome outcome = system.metric(system.now, &log_det, &log_det_z, system.a);
        if (outcome != Outcome::good) return outcome;
        if (call.log_det) call.log_det[view.number] = log_det;
        if (call.log_det_z) call.log_det_z[view.number] = log_det_z;
        tally.log_det += log_det;
        for (std::int32_t i = 0; call.force.x && i < s.n_atoms; ++i) {
            const Vector3<double> slope = rounded(system.a[s.node_of[at(i)]]);
            const double factor = -0.5 * call.kT;
            double force[3] = {factor * slope.x, factor * slope.y, factor * slope.z}, before[3];
            if (call.add || i >= s.n_movable) {
                read_atom(call.force, view.atoms[i], before);
                for (int c = 0; c < 3; ++c) force[c] += before[c];
            }
            write_atom(call.force, view.atoms[i], force);
        }
        return outcome;
    }
};

}  // namespace

// d ln det A is the sum of (A^-1)_kl dA_kl, and A_kl that of w gradient_k . gradient_l over nodes; of both factors each
// entry gets its part, and that of ln A_kk is taken away.
Outcome System::metric(const Conformation &where, double *log_det, double *log_det_z, PairVector *slope) const {
    const PairVector none = {as_pair(0), as_pair(0), as_pair(0)};
    std::fill(slope, slope + s_.n_nodes, none);
    if (assemble(wide_, where, where) >= 0) return Outcome::degenerate;
    PairVector *const of_entry = reference.gradient;
    std::fill(of_entry, of_entry + s_.entries.size(), none);
    for (const Product &p : s_.products) {
        const double w = s_.w[at(s_.entries[at(p.a)].node)];
        const DoublePair twice = 2 * w * (p.of_diagonal ? residual_[p.element] : inverse_[p.element]);
        of_entry[p.a] = of_entry[p.a] + twice * where.gradient[p.b];
        if (!p.of_diagonal) of_entry[p.b] = of_entry[p.b] + twice * where.gradient[p.a];
    }
    double det = 0, det_z = 0;
    for (std::int32_t k = 0; k < s_.n_rows; ++k) {
        const PairVector d = distance(where, k);
        const DoublePair square = dot(d, d);
        DoublePair weight = as_pair(0);
        PairVector of_row = (as_pair(-2) / square) * d;
        for (std::int32_t e = s_.entry_start[at(k)]; e < s_.entry_start[at(k + 1)]; ++e) {
            const Entry &entry = s_.entries[at(e)];
            weight = weight + s_.w[at(entry.node)] * (entry.factor * entry.factor);
            of_row = of_row + entry.factor * of_entry[e];
        }
        for (std::int32_t e = s_.entry_start[at(k)]; e < s_.entry_start[at(k + 1)]; ++e) {
            const Entry &entry = s_.entries[at(e)];
            slope[entry.node] = slope[entry.node] + entry.factor * of_row;
        }
        // Of Z, which is four times A
        const DoublePair whole = weight * square;
        det += std::log1p(rounded((wide_.diagonal[k] - whole) / whole));
        det_z += std::log(4 * rounded(wide_.diagonal[k]));
    }
    if (!std::isfinite(det) || !std::isfinite(det_z)) return Outcome::not_finite;
    *log_det = det;
    *log_det_z = det_z;
    return Outcome::good;
}

void need_metric(const Chains &chains) {
    const Bodies *const bodies = chains.bodies();
    for (std::int64_t m = 0; bodies && m < bodies->n_molecules(); ++m)
        if (!bodies->kind(m).has_images)
            throw make_error(
                Status::unsupported,
                "the metric determinant of molecules with rigid bodies is not implemented: of a body alone "
                "it is a constant; molecules without bodies need a set of their own");
}

double metric(const Chains &chains, const MetricCall &call) {
    return run_all(chains, BodyMetric(chains, call), {{"position", &call.r}}, nullptr).log_det;
}

}  // namespace holonomic::rigid
