#include <cmath>

#include "core/index.hpp"
#include "core/kernel_choice.hpp"
#include "core/rigid/rates.hpp"
#include "core/rigid/run.hpp"
#include "core/rigid/verbs.hpp"
#include "core/rigid/within.hpp"
#include "core/run/execute.hpp"

namespace holonomic::rigid {

namespace {

struct BodyVelocities final : BodyWork {
    AtomArray r, v;
    const Cell &box;
    const BoxRate *rate;
    double *lambda;
    bool virial;
    VelocitiesCall call;

    BodyVelocities(const Chains &chains, const AtomArray &r_, const AtomArray &v_, double *lambda_, bool virial_)
        : BodyWork(chains), r(r_), v(v_), box(chains.box), rate(chains.box_rate()), lambda(lambda_),
          virial(virial_), call{r_, v_, nullptr, virial_, nullptr, {}} {
        put_box(box, call.box);
    }
    bool takes_blocks(bool bonds) const override { return !rate && !(bonds && lambda); }
    std::uint64_t bodies(const BodyUnit &unit, double *scratch, BodyResult *results) const override {
        return kernels().bodies.velocities(call, unit, scratch, results);
    }
    bool has_results() const override { return virial; }

    Outcome molecule(const System &system, const MoleculeView &view, Tally &tally) const override {
        const MoleculeKind &s = system.kind();
        system.read(r, box, view, system.now);
        system.differentiate(system.now);
        if (rate)
            for_rates(system, nullptr, rate,
                      [&](std::int32_t row, std::int32_t, bool square, const PairVector &p, const PairVector &q,
                          const PairVector &u,
                          const PairVector &w) { system.c[row] = square ? dot(p, u) : dot(p, w) + dot(q, u); });
        PairVector *const z = system.a;
        system.velocities(v, view, z);
        const Outcome outcome = system.project(system.now, rate ? system.c : nullptr, z, system.t);
        if (outcome != Outcome::good) return outcome;
        double sum = 0;
        for (std::int32_t i = 0; i < s.n_movable; ++i) {
            const Vector3<double> of_atom = rounded(system.velocity_of(system.now, z, rate, i)),
                                  x = rounded(system.now.x[i]);
            sum += std::fabs(of_atom.x) + std::fabs(of_atom.y) + std::fabs(of_atom.z) + x.x + x.y + x.z;
        }
        if (!std::isfinite(sum)) return Outcome::not_finite;
        if (s.by_lengths && lambda) share(system, view, z);
        for (std::int32_t i = 0; i < s.n_movable; ++i) {
            const Vector3<double> of_atom = rounded(system.velocity_of(system.now, z, rate, i));
            const double x[3] = {of_atom.x, of_atom.y, of_atom.z};
            write_atom(v, view.atoms[i], x);
        }
        for (std::size_t k = 0; lambda && k < s.bonds.size(); ++k) lambda[view.bonds[k]] = multiplier_of(system, k) / 2;
        if (virial) system.add_virial(system.now, system.t, 1, tally.virial);
        return outcome;
    }

    // The change of momenta.
    void share(const System &system, const MoleculeView &view, const PairVector *z) const {
        const MoleculeKind &s = system.kind();
        double *force = force_within(system);
        for (std::int32_t i = 0; i < s.n_held; ++i) {
            const PairVector before = vector_of_atom(v, view.atoms[i]);
            const Vector3<double> impulse = rounded(s.mass[at(i)] * (system.at_atom(z, i) - before));
            *force++ = impulse.x, *force++ = impulse.y, *force++ = impulse.z;
        }
        share_within(system, system.now);
    }
};

}  // namespace

void project_velocities(const Chains &chains, const AtomArray &r, const AtomArray &v, double *lambda, double *virial) {
    run_all(chains, BodyVelocities(chains, r, v, lambda, virial != nullptr), {{"position", &r}, {"velocity", &v}},
            virial);
}

}  // namespace holonomic::rigid
