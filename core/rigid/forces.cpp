// Accelerations: forces, and the multipliers of given right-hand sides.
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

struct ForceOutputs {
    double *lambda, *tension;
    AtomArray g;
    bool add;
};

bool is_finite(const PairVector &a) { return std::isfinite(a.x.hi) && std::isfinite(a.y.hi) && std::isfinite(a.z.hi); }

void write_force(const ForceOutputs &out, std::int64_t atom, const PairVector &force, bool add) {
    double x[3] = {rounded(force.x), rounded(force.y), rounded(force.z)};
    if (add) {
        double before[3];
        read_atom(out.g, atom, before);
        for (int c = 0; c < 3; ++c) x[c] = before[c] + x[c];
    }
    write_atom(out.g, atom, x);
}

// z: accelerations of the nodes.
void write(const System &system, const MoleculeView &view, const PairVector *z, const AtomArray &f,
           const ForceOutputs &out, bool virial, Tally &tally) {
    const MoleculeKind &s = system.kind();
    const auto of_constraints = [&](std::int32_t i) {
        const PairVector whole = s.mass[at(i)] * system.at_atom(z, i);
        return whole - (f.x ? vector_of_atom(f, view.atoms[i]) : PairVector{});
    };
    if (s.by_lengths && (out.lambda || out.tension)) {
        double *force = force_within(system);
        for (std::int32_t i = 0; i < s.n_held; ++i) {
            const Vector3<double> whole = rounded(of_constraints(i));
            *force++ = whole.x, *force++ = whole.y, *force++ = whole.z;
        }
        share_within(system, system.now);
    }
    for (std::size_t k = 0; k < s.bonds.size(); ++k) {
        const double t = multiplier_of(system, k);
        if (out.lambda) out.lambda[view.bonds[k]] = t / 2;
        if (!out.tension) continue;
        const Vector3<double> d = vector_of(system, system.now, k);
        out.tension[view.bonds[k]] = t * std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
    }
    if (virial) system.add_virial(system.now, system.t, 1, tally.virial);
    if (virial && f.x) system.add_virial_of_sites(system.now, f, view, tally.virial);
    if (!out.g.x) return;
    for (std::int32_t i = 0; i < s.n_held; ++i) {
        write_force(out, view.atoms[i], of_constraints(i), out.add);
    }
    if (s.n_held == s.n_atoms) return;
    system.pulls(system.now, system.t, system.b);
    if (f.x) system.pass_to_fixed(f, view, system.b);
    for (std::int32_t i = s.n_held; i < s.n_atoms; ++i)
        write_force(out, view.atoms[i], system.b[s.node_of[at(i)]], out.add || i >= s.n_movable);
}

bool all_finite(const System &system, const PairVector *z) {
    const MoleculeKind &s = system.kind();
    bool finite = true;
    for (std::int32_t n = 0; n < s.n_nodes; ++n) finite = finite && is_finite(z[n]) && is_finite(system.now.q[n]);
    for (std::int32_t i = 0; i < s.n_atoms; ++i) finite = finite && is_finite(system.now.x[i]);
    return finite;
}

struct BodyForces final : BodyWork {
    AtomArray r, v, f;
    const Cell &box;
    const BoxRate *rate;
    ForceOutputs out;
    bool virial;
    ForcesCall call;

    BodyForces(const Chains &chains, const AtomArray &r_, const AtomArray &v_, const AtomArray &f_,
               const ForceOutputs &out_, bool virial_)
        : BodyWork(chains, out_.g), r(r_), v(v_), f(f_), box(chains.box), rate(chains.box_rate()), out(out_),
          virial(virial_), call{r_, v_, f_, out_.g, nullptr, nullptr, out_.add, virial_, {}} {
        put_box(box, call.box);
    }
    bool takes_blocks(bool bonds) const override { return !rate && !(bonds && (out.lambda || out.tension)); }
    std::uint64_t bodies(const BodyUnit &unit, double *scratch, BodyResult *results) const override {
        return kernels().bodies.forces(call, unit, scratch, results);
    }
    bool has_results() const override { return virial; }

    Outcome molecule(const System &system, const MoleculeView &view, Tally &tally) const override {
        const MoleculeKind &s = system.kind();
        system.read(r, box, view, system.now);
        system.differentiate(system.now);
        const bool moves = v.x || rate;
        if (v.x) system.velocities(v, view, system.b);
        if (moves)
            for_rates(system, v.x ? system.b : nullptr, rate,
                      [&](std::int32_t row, std::int32_t, bool square, const PairVector &, const PairVector &,
                          const PairVector &u, const PairVector &w) {
                          const DoublePair product = dot(u, w);
                          system.c[row] = square ? product : 2.0 * product;
                      });
        PairVector *const z = system.a;
        if (f.x) system.forces(system.now, f, view, z);
        for (std::int32_t n = 0; n < s.n_nodes; ++n)
            z[n] = f.x ? s.w[at(n)] * z[n] : PairVector{as_pair(0), as_pair(0), as_pair(0)};
        const Outcome outcome = system.project(system.now, moves ? system.c : nullptr, z, system.t);
        if (outcome != Outcome::good) return outcome;
        if (!all_finite(system, z)) return Outcome::not_finite;
        write(system, view, z, f, out, virial, tally);
        return outcome;
    }
};

struct BodySolve final : BodyWork {
    AtomArray r;
    const Cell &box;
    const double *rhs;
    ForceOutputs out;
    bool virial;

    BodySolve(const Chains &chains, const AtomArray &r_, const double *rhs_, const ForceOutputs &out_, bool virial_)
        : BodyWork(chains, out_.g), r(r_), box(chains.box), rhs(rhs_), out(out_), virial(virial_) {}

    Outcome molecule(const System &system, const MoleculeView &view, Tally &tally) const override {
        const MoleculeKind &s = system.kind();
        system.read(r, box, view, system.now);
        system.differentiate(system.now);
        for (std::int32_t k = 0; k < s.n_rows; ++k) {
            const std::int32_t bond = s.bond_of_row[at(k)];
            system.c[k] = as_pair(bond < 0 ? 0 : rhs[view.bonds[bond]] / 2);
        }
        PairVector *const z = system.a;
        for (std::int32_t n = 0; n < s.n_nodes; ++n) z[n] = {as_pair(0), as_pair(0), as_pair(0)};
        const Outcome outcome = system.project(system.now, system.c, z, system.t);
        if (outcome != Outcome::good) return outcome;
        if (!all_finite(system, z)) return Outcome::not_finite;
        write(system, view, z, AtomArray{}, out, virial, tally);
        return outcome;
    }
};

}  // namespace

void forces(const Chains &chains, const AtomArray &r, const AtomArray &v, const AtomArray &f, double *lambda,
            double *tension, const AtomArray &g, bool add, double *virial) {
    run_all(chains, BodyForces(chains, r, v, f, {lambda, tension, g, add}, virial != nullptr),
            {{"position", &r}, {"velocity", &v}, {"force", &f}}, virial);
}

void solve(const Chains &chains, const AtomArray &r, const double *rhs, double *lambda, const AtomArray &g, bool add,
           double *virial) {
    const NamedValues given{"right-hand side", rhs};
    run_all(chains, BodySolve(chains, r, rhs, {lambda, nullptr, g, add}, virial != nullptr), {{"position", &r}}, virial,
            &given);
}

}  // namespace holonomic::rigid
