#include "HolonomicConstraints.h"

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "Algorithm.h"
#include "DeviceKernel.h"
#include "ReferenceConstraints.h"
#include "ReferencePlatform.h"
#include "openmm/OpenMMException.h"
#include "openmm/internal/ContextImpl.h"
#include "openmm/internal/ForceImpl.h"
#include "openmm/serialization/SerializationNode.h"
#include "openmm/serialization/SerializationProxy.h"

using namespace OpenMM;

namespace {

class HolonomicConstraintsImpl : public ForceImpl {
public:
    explicit HolonomicConstraintsImpl(const HolonomicConstraints &force) : owner(force) {}

    // The platform has made its data by now, algorithms of its own among them; the integrators' kernels ask those data
    // for the algorithm at each step. Data of the CPU platform begin as those of the Reference platform: it is derived
    // from it.
    void initialize(ContextImpl &context) override {
        const std::string &platform = context.getPlatform().getName();
        if (context.getPlatform().supportsKernels({HolonomicDeviceKernel::Name()})) {
            device = context.getPlatform().createKernel(HolonomicDeviceKernel::Name(), context);
            device->getAs<HolonomicDeviceKernel>().initialize(context, owner.getNumThreads());
            return;
        }
        if (platform != "Reference" && platform != "CPU")
            throw OpenMMException(
                "holonomic: the platform " + platform +
                " solves constraints by itself, on its device; make the Context with the platform CPU "
                "or Reference, or without HolonomicConstraints");
        std::unique_ptr<HolonomicAlgorithm> algorithm(
            new HolonomicAlgorithm(context.getSystem(), owner.getNumThreads()));
        auto *const data = static_cast<ReferencePlatform::PlatformData *>(context.getPlatformData());
        delete data->constraints->ccma;
        delete data->constraints->settle;
        data->constraints->ccma = algorithm.release();  // deleted with the data
        data->constraints->settle = nullptr;
    }

    const Force &getOwner() const override { return owner; }
    void updateContextState(ContextImpl &, bool &) override {}
    double calcForcesAndEnergy(ContextImpl &, bool, bool withEnergy, int) override {
        if (device) device->getAs<HolonomicDeviceKernel>().forcesAreComputed(withEnergy);
        return 0;
    }
    std::map<std::string, double> getDefaultParameters() override { return {}; }
    std::vector<std::string> getKernelNames() override { return {}; }

private:
    const HolonomicConstraints &owner;
    std::optional<Kernel> device;  // of a platform that has its own
};

// Systems are copied and saved by way of this.
class HolonomicConstraintsProxy : public SerializationProxy {
public:
    HolonomicConstraintsProxy() : SerializationProxy("HolonomicConstraints") {}
    void serialize(const void *object, SerializationNode &node) const override {
        const auto &force = *static_cast<const HolonomicConstraints *>(object);
        node.setIntProperty("version", 1);
        node.setIntProperty("threads", force.getNumThreads());
        node.setIntProperty("forceGroup", force.getForceGroup());
        node.setStringProperty("name", force.getName());
    }
    void *deserialize(const SerializationNode &node) const override {
        if (node.getIntProperty("version") != 1) throw OpenMMException("HolonomicConstraints: unknown version");
        auto *const force = new HolonomicConstraints(node.getIntProperty("threads"));
        force->setForceGroup(node.getIntProperty("forceGroup", 0));
        force->setName(node.getStringProperty("name", force->getName()));
        return force;
    }
};

const bool proxyIsRegistered = [] {
    SerializationProxy::registerProxy(typeid(HolonomicConstraints), new HolonomicConstraintsProxy());
    return true;
}();

}  // namespace

HolonomicConstraints::HolonomicConstraints(int threads) : nThreads(threads) {
    if (threads < 1) throw OpenMMException("HolonomicConstraints: the number of threads must be at least 1");
    setName("HolonomicConstraints");
}

ForceImpl *HolonomicConstraints::createImpl() const { return new HolonomicConstraintsImpl(*this); }

// No exception may leave: the caller may be in C. -1 says that it was one.
int holonomicOpenMMAdd(void *system, int nThreads) try {
    return static_cast<System *>(system)->addForce(new HolonomicConstraints(nThreads));
} catch (...) {
    return -1;
}

// OpenMM calls these when it loads a plugin from its folder; what there is to register is registered by then.
extern "C" HOLONOMIC_OPENMM_EXPORT void registerPlatforms() {}
extern "C" HOLONOMIC_OPENMM_EXPORT void registerKernelFactories() {}
