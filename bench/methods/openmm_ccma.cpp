// OpenMM's CCMA (Eastman and Pande 2010, J. Chem. Theory Comput. 6, 434) in its reference platform, through
// Context::applyConstraints and applyVelocityConstraints. They take the positions that they are given as the reference
// too, those after the drift, instead of the ones before it as an integrator does; on coils the
// work is the same.
#include <cmath>
#include <memory>

#include "methods.hpp"

#ifdef BENCH_HAVE_OPENMM

#include <OpenMM.h>

namespace bench {
namespace {

/// One constraint set: all chains of a call, as they would stand in one simulation.
struct Molecules {
    std::unique_ptr<OpenMM::System> system;
    std::unique_ptr<OpenMM::VerletIntegrator> integrator;
    std::unique_ptr<OpenMM::Context> context;
    std::vector<OpenMM::Vec3> moving;
    std::size_t first_atom = 0;
};

double angle_at(const double *r) {
    double in = 0, out = 0, along = 0;
    for (int x = 0; x < 3; ++x) {
        const double a = r[x - 3] - r[x], b = r[x + 3] - r[x];
        in += a * a, out += b * b, along += a * b;
    }
    return std::acos(along / std::sqrt(in * out));
}

Molecules make(const Problem &p, std::size_t first_chain, std::size_t chains, bool angles) {
    auto system_owner = std::make_unique<OpenMM::System>();
    OpenMM::System &system = *system_owner;
    auto angle_force = std::make_unique<OpenMM::HarmonicAngleForce>();
    Molecules m;
    m.first_atom = p.first_atom(first_chain);
    for (std::size_t c = 0; c < chains; ++c) {
        const int base = static_cast<int>(c * (p.n() + 1));
        for (double mass : p.mass) system.addParticle(mass);
        for (std::size_t k = 0; k < p.n(); ++k) {
            const int atom = base + static_cast<int>(k);
            // OpenMM refuses constraints to massless particles; between fixed atoms they are left out by its users.
            system.addConstraint(atom, atom + 1, p.length[k]);
            if (angles && k + 1 < p.n()) {
                const double *middle = &p.r[3 * (m.first_atom + c * (p.n() + 1) + k + 1)];
                angle_force->addAngle(atom, atom + 1, atom + 2, angle_at(middle), 0.0);
            }
        }
    }
    if (angles) system.addForce(angle_force.release());
    m.system = std::move(system_owner);
    m.integrator = std::make_unique<OpenMM::VerletIntegrator>(p.dt);
    m.context =
        std::make_unique<OpenMM::Context>(*m.system, *m.integrator, OpenMM::Platform::getPlatformByName("Reference"));
    m.moving.resize(chains * (p.n() + 1));
    return m;
}

void copy_in(const std::vector<double> &from, std::size_t first_atom, std::vector<OpenMM::Vec3> &to) {
    for (std::size_t i = 0; i < to.size(); ++i) {
        const double *x = &from[3 * (first_atom + i)];
        to[i] = OpenMM::Vec3(x[0], x[1], x[2]);
    }
}

}  // namespace

bool have_openmm() { return true; }

Method openmm_ccma(Level level, const Problem &p, double tolerance, bool angles) {
    const std::size_t chains_per_call = p.one_by_one ? 1 : p.n_chains();
    auto all = std::make_shared<std::vector<Molecules>>();
    for (std::size_t c = 0; c < p.n_chains(); c += chains_per_call) {
        all->push_back(make(p, c, chains_per_call, angles));
        Molecules &m = all->back();
        copy_in(p.r, m.first_atom, m.moving);
        m.context->setPositions(m.moving);
    }
    const bool position = level == Level::position;
    Method method;
    method.name = "openmm-ccma";
    method.setting = tolerance_setting(tolerance) + (angles ? " exact angles" : "");
    // OpenMM keeps vectors of its own; copying to and from them is not its fault and not timed.
    method.before = [all, position](State &state) {
        for (Molecules &m : *all) {
            copy_in(position ? state.r : state.v, m.first_atom, m.moving);
            position ? m.context->setPositions(m.moving) : m.context->setVelocities(m.moving);
        }
    };
    method.call = [all, tolerance, position](State &) {
        for (Molecules &m : *all)
            position ? m.context->applyConstraints(tolerance) : m.context->applyVelocityConstraints(tolerance);
    };
    method.after = [all, position](State &state) {
        for (const Molecules &m : *all) {
            const OpenMM::State result = m.context->getState(OpenMM::State::Positions | OpenMM::State::Velocities);
            const std::vector<OpenMM::Vec3> &moved = position ? result.getPositions() : result.getVelocities();
            for (std::size_t i = 0; i < moved.size(); ++i)
                for (std::size_t x = 0; x < 3; ++x)
                    (position ? state.r : state.v)[3 * (m.first_atom + i) + x] = moved[i][static_cast<int>(x)];
        }
    };
    return method;
}

}  // namespace bench

#else

namespace bench {

bool have_openmm() { return false; }

Method openmm_ccma(Level, const Problem &, double tolerance, bool) {
    return {"openmm-ccma", tolerance_setting(tolerance), [](State &) {}};
}

}  // namespace bench

#endif
