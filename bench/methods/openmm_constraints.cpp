#include "openmm_constraints.hpp"

#include <cmath>
#include <memory>

#include "methods.hpp"

#ifdef BENCH_HAVE_OPENMM
#include <OpenMM.h>
#endif

namespace bench {

double angle_between(const double *a, const double *b, const double *c) {
    double in = 0, out = 0, along = 0;
    for (int x = 0; x < 3; ++x) {
        const double u = a[x] - b[x], v = c[x] - b[x];
        in += u * u, out += v * v, along += u * v;
    }
    return std::acos(along / std::sqrt(in * out));
}

#ifdef BENCH_HAVE_OPENMM

namespace {

struct Constrained {
    OpenMM::System system;
    std::unique_ptr<OpenMM::VerletIntegrator> integrator;
    std::unique_ptr<OpenMM::Context> context;
    std::vector<OpenMM::Vec3> moving;

    Constrained(const OpenmmInput &input, const Scene &p) : moving(input.mass.size()) {
        for (double mass : input.mass) system.addParticle(mass);
        for (std::size_t k = 0; k < input.pairs.size(); ++k)
            system.addConstraint(input.pairs[k][0], input.pairs[k][1], input.length[k]);
        if (!input.angles.empty()) {
            auto force = std::make_unique<OpenMM::HarmonicAngleForce>();
            for (std::size_t a = 0; a < input.angles.size(); ++a)
                force->addAngle(input.angles[a][0], input.angles[a][1], input.angles[a][2], input.angle[a], 0.0);
            system.addForce(force.release());
        }
        integrator = std::make_unique<OpenMM::VerletIntegrator>(p.dt);
        context =
            std::make_unique<OpenMM::Context>(system, *integrator, OpenMM::Platform::getPlatformByName("Reference"));
        copy_in(p.r);
        context->setPositions(moving);
    }
    void copy_in(const std::vector<double> &from) {
        for (std::size_t i = 0; i < moving.size(); ++i)
            moving[i] = OpenMM::Vec3(from[3 * i], from[3 * i + 1], from[3 * i + 2]);
    }
};

}  // namespace

bool have_openmm() { return true; }

Methods openmm_methods(const std::string &name, Level level, const Scene &p, const OpenmmInput &input,
                       const std::vector<double> &tolerances, const std::string &note) {
    auto all = std::make_shared<Constrained>(input, p);
    const bool position = level == Level::position;
    Methods list;
    for (double tolerance : tolerances) {
        Method m;
        m.name = name;
        m.setting = tolerance_setting(tolerance) + note;
        m.bonds_worked = input.pairs.size();
        m.part_done = static_cast<double>(input.molecules_done) / static_cast<double>(p.chains);
        // OpenMM keeps vectors of its own; copying to and from them is not its fault and not timed.
        m.before = [all, position](State &state) {
            all->copy_in(position ? state.r : state.v);
            position ? all->context->setPositions(all->moving) : all->context->setVelocities(all->moving);
        };
        m.call = [all, tolerance, position](State &) {
            position ? all->context->applyConstraints(tolerance) : all->context->applyVelocityConstraints(tolerance);
        };
        m.after = [all, position](State &state) {
            const OpenMM::State result = all->context->getState(OpenMM::State::Positions | OpenMM::State::Velocities);
            const std::vector<OpenMM::Vec3> &moved = position ? result.getPositions() : result.getVelocities();
            for (std::size_t i = 0; i < moved.size(); ++i)
                for (std::size_t x = 0; x < 3; ++x)
                    (position ? state.r : state.v)[3 * i + x] = moved[i][static_cast<int>(x)];
        };
        list.push_back(m);
    }
    return list;
}

#else

bool have_openmm() { return false; }

Methods openmm_methods(const std::string &, Level, const Scene &, const OpenmmInput &, const std::vector<double> &,
                       const std::string &) {
    return {};
}

#endif

}  // namespace bench
