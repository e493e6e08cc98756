// From C++: a Context with HolonomicConstraints moves as it must, and what cannot be done is refused in words.
#include <OpenMM.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "HolonomicConstraints.h"
#include "ReferencePlatform.h"

using namespace OpenMM;

namespace {

int failures = 0;

void expect(bool holds, const char *what) {
    if (holds) return;
    std::printf("not so: %s\n", what);
    ++failures;
}

// Stands in for a platform that keeps its coordinates on a device.
class DevicePlatform : public ReferencePlatform {
public:
    const std::string &getName() const {
        static const std::string name = "OpenCL";
        return name;
    }
};

template <class Body>
void expectRefusal(const char *words, Body body) {
    try {
        body();
        std::printf("not refused: %s\n", words);
        ++failures;
    } catch (const OpenMMException &error) {
        if (std::strstr(error.what(), words)) return;
        std::printf("\"%s\" is not in: %s\n", words, error.what());
        ++failures;
    }
}

void triangle(System &system) {
    for (int i = 0; i < 3; ++i) system.addParticle(1 + i);
    system.addConstraint(0, 1, 0.1);
    system.addConstraint(1, 2, 0.12);
    system.addConstraint(2, 0, 0.15);
    system.addForce(new HolonomicConstraints());
}

void aTriangleMoves() {
    System system;
    triangle(system);
    VerletIntegrator integrator(0.002);
    Context context(system, integrator, Platform::getPlatformByName("Reference"));
    context.setPositions({Vec3(0, 0, 0), Vec3(0.11, 0, 0), Vec3(0.1, 0.13, 0)});
    context.applyConstraints(1e-3);
    context.setVelocities({Vec3(0.3, 0.1, -2), Vec3(-0.5, 1, 0.2), Vec3(0.1, -1, 0)});
    integrator.step(500);
    const auto r = context.getState(State::Positions).getPositions();
    const double lengths[3] = {0.1, 0.12, 0.15};
    for (int k = 0; k < 3; ++k) {
        const Vec3 d = r[(k + 1) % 3] - r[k];
        expect(std::abs(std::sqrt(d.dot(d)) / lengths[k] - 1) < 1e-14, "lengths are right to their rounding");
    }
}

}  // namespace

int main() {
    aTriangleMoves();
    expectRefusal("the platform OpenCL solves constraints by itself", [] {
        System system;
        triangle(system);
        VerletIntegrator integrator(0.002);
        static DevicePlatform platform;
        Context context(system, integrator, platform);
    });
    expectRefusal("at least 1", [] { HolonomicConstraints force(0); });
    expectRefusal("more than the two other sides of its triangle", [] {
        System system;
        triangle(system);
        system.setConstraintParameters(0, 0, 1, 0.9);
        VerletIntegrator integrator(0.002);
        Context context(system, integrator, Platform::getPlatformByName("Reference"));
    });
    return failures == 0 ? 0 : 1;
}
