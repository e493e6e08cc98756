// The plugin of a platform that keeps its coordinates on a device, OpenCL, CUDA or HIP: registers what
// HolonomicConstraints asks for when a Context is made. Which platform it is, cmake says: its name, its class, its
// header.
#include "../DeviceKernel.h"
#include "../HolonomicConstraints.h"
#include "StandIn.h"
#include "openmm/KernelFactory.h"
#include "openmm/OpenMMException.h"
#include "openmm/common/ContextSelector.h"
#include "openmm/kernels.h"
#include HOLONOMIC_PLATFORM_HEADER

using namespace OpenMM;

namespace {

using DevicePlatform = HOLONOMIC_PLATFORM_CLASS;

// With several devices it is the first that moves the atoms. An OpenCLContext, or its like, begins as the
// ComputeContext that it is derived from; its header needs others that are not installed everywhere.
ComputeContext &deviceOf(ContextImpl &context) {
    auto *const data = static_cast<DevicePlatform::PlatformData *>(context.getPlatformData());
    return *reinterpret_cast<ComputeContext *>(data->contexts.at(0));
}

class Constraints : public HolonomicDeviceKernel {
public:
    using HolonomicDeviceKernel::HolonomicDeviceKernel;
    void initialize(ContextImpl &context, int nThreads) override {
        ComputeContext &device = deviceOf(context);
        ContextSelector selector(device);
        constraints = std::make_shared<DeviceConstraints>(device, context.getSystem(), nThreads);
        putInPlace(device, constraints);
    }
    void forcesAreComputed(bool withEnergy) override {
        if (withEnergy || ++sinceCheck == 16) {
            sinceCheck = 0;
            constraints->check();
        }
    }

private:
    std::shared_ptr<DeviceConstraints> constraints;
    int sinceCheck = 0;
};

// Context::applyConstraints and its sister: the platform's own kernel, and word that it is not in a step.
class OutsideOfSteps : public ApplyConstraintsKernel {
public:
    OutsideOfSteps(const Platform &of, ContextImpl &context) : ApplyConstraintsKernel(Name(), of) {
        static const DevicePlatform asItWas;
        own = asItWas.createKernel(Name(), context);
    }
    void initialize(const System &system) override { ownKernel().initialize(system); }
    void apply(ContextImpl &context, double tolerance) override {
        const Mark mark(inPlace(deviceOf(context)));
        ownKernel().apply(context, tolerance);
    }
    void applyToVelocities(ContextImpl &context, double tolerance) override {
        const Mark mark(inPlace(deviceOf(context)));
        ownKernel().applyToVelocities(context, tolerance);
    }

private:
    struct Mark {
        explicit Mark(DeviceConstraints *what) : constraints(what) {
            if (constraints) constraints->outsideOfSteps = true;
        }
        ~Mark() {
            if (constraints) constraints->outsideOfSteps = false;
        }
        DeviceConstraints *const constraints;
    };
    ApplyConstraintsKernel &ownKernel() { return own.getAs<ApplyConstraintsKernel>(); }

    Kernel own;
};

class Factory : public KernelFactory {
public:
    KernelImpl *createKernelImpl(std::string name, const Platform &platform, ContextImpl &context) const override {
        if (name == HolonomicDeviceKernel::Name()) return new Constraints(platform);
        return new OutsideOfSteps(platform, context);
    }
};

}  // namespace

extern "C" HOLONOMIC_OPENMM_EXPORT void registerPlatforms() {}

extern "C" HOLONOMIC_OPENMM_EXPORT void registerKernelFactories() {
    for (int i = 0; i < Platform::getNumPlatforms(); ++i) {
        Platform &platform = Platform::getPlatform(i);
        if (platform.getName() != HOLONOMIC_PLATFORM_NAME || platform.supportsKernels({HolonomicDeviceKernel::Name()}))
            continue;
        auto *const factory = new Factory();
        platform.registerKernelFactory(HolonomicDeviceKernel::Name(), factory);
        platform.registerKernelFactory(ApplyConstraintsKernel::Name(), factory);
    }
}
