// What multipliers of bonds do in molecules with bodies. Bonds alone: what holds a body together is not in them.
#include <algorithm>
#include <cmath>

#include "core/index.hpp"
#include "core/rigid/run.hpp"
#include "core/rigid/verbs.hpp"
#include "core/rigid/within.hpp"
#include "core/run/execute.hpp"

namespace holonomic::rigid {

namespace {

struct BodyReactions final : BodyWork {
    AtomArray r;
    const Cell &box;
    const double *lambda;
    Reactions out;

    BodyReactions(const Chains &chains, const AtomArray &r_, const Cell &box_, const double *lambda_,
                  const Reactions &out_)
        : BodyWork(chains, out_.g), r(r_), box(box_), lambda(lambda_), out(out_) {}

    Outcome molecule(const System &system, const MoleculeView &view, Tally &tally) const override {
        const MoleculeKind &s = system.kind();
        system.read(r, box, view, system.now);
        double size = 0;
        for (std::size_t k = 0; k < s.bonds.size(); ++k) {
            const Vector3<double> d = vector_of(system, system.now, k);
            const double square = d.x * d.x + d.y * d.y + d.z * d.z, t = 2 * lambda[view.bonds[k]];
            size += std::fabs(t) * (square + 4 * std::sqrt(square)) + square;
        }
        if (!std::isfinite(size)) return Outcome::not_finite;
        double *const force = system.raw;  // positions have been read
        std::fill(force, force + 3 * std::ptrdiff_t{s.n_atoms}, 0.0);
        for (const Bond &bond : s.bonds) {
            const std::size_t k = static_cast<std::size_t>(&bond - s.bonds.data());
            const std::int64_t number = view.bonds[k];
            const Vector3<double> v = vector_of(system, system.now, k);
            const double d[3] = {v.x, v.y, v.z}, t = 2 * lambda[number];
            if (out.tension) out.tension[number] = t * std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
            double w[6], *next = w;
            for (int a = 0; a < 3; ++a) {
                force[3 * bond.i + a] += t * d[a];
                force[3 * bond.j + a] -= t * d[a];
                for (int b = a; b < 3; ++b) *next++ = 0 - t * d[a] * d[b];
            }
            if (out.bond_virial) std::copy(w, w + 6, out.bond_virial + 6 * number);
            for (int c = 0; out.virial && c < 6; ++c) tally.virial[c] += w[c];
        }
        for (std::int32_t i = 0; out.g.x && i < s.n_atoms; ++i) {
            double x[3] = {0, 0, 0};
            if (out.add || i >= s.n_movable) read_atom(out.g, view.atoms[i], x);
            for (int c = 0; c < 3; ++c) x[c] += force[3 * at(i) + at(c)];
            write_atom(out.g, view.atoms[i], x);
        }
        return Outcome::good;
    }
};

}  // namespace

void reactions(const Chains &chains, const AtomArray &r, const Cell &box, const double *lambda, const Reactions &out,
               double *virial) {
    const NamedValues given{"multiplier", lambda};
    run_all(chains, BodyReactions(chains, r, box, lambda, out), {{"position", &r}}, virial, &given);
}

}  // namespace holonomic::rigid
