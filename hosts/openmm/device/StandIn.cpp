#include "StandIn.h"

#include <new>
#include <string>

#include "openmm/common/IntegrationUtilities.h"

using namespace OpenMM;

namespace {

// Stands where OpenMM has a kernel for rigid water. It has its arguments already.
class StandIn : public ComputeKernelImpl {
public:
    StandIn(std::shared_ptr<DeviceConstraints> what, bool velocities)
        : constraints(std::move(what)), toVelocities(velocities) {}
    std::string getName() const override { return "holonomic"; }
    int getMaxBlockSize() const override { return 1; }
    void execute(int, int) override { constraints->apply(toVelocities); }

    const std::shared_ptr<DeviceConstraints> constraints;

protected:
    void addArrayArg(ArrayInterface &) override {}
    void addPrimitiveArg(const void *, int) override {}
    void addEmptyArg() override {}
    void setArrayArg(int, ArrayInterface &) override {}
    void setPrimitiveArg(int, const void *, int) override {}

private:
    const bool toVelocities;
};

// Members of IntegrationUtilities that only its heirs may name.
struct Door : IntegrationUtilities {
    static ComputeKernel &positions(IntegrationUtilities &of) { return of.*(&Door::settlePosKernel); }
    static ComputeKernel &velocities(IntegrationUtilities &of) { return of.*(&Door::settleVelKernel); }
    static ComputeArray &water(IntegrationUtilities &of) { return of.*(&Door::settleAtoms); }
    static ComputeArray &clusters(IntegrationUtilities &of) { return of.*(&Door::shakeAtoms); }
    static ComputeArray &others(IntegrationUtilities &of) { return of.*(&Door::ccmaConstraintAtoms); }
};

void empty(ComputeArray &array) {
    array.~ComputeArray();
    new (&array) ComputeArray();
}

}  // namespace

// OpenMM runs each of its three methods where an array of what it is for has been initialized. What else they have
// allocated is freed with the Context.
void OpenMM::putInPlace(ComputeContext &context, const std::shared_ptr<DeviceConstraints> &constraints) {
    IntegrationUtilities &utilities = context.getIntegrationUtilities();
    if (!Door::water(utilities).isInitialized()) Door::water(utilities).initialize<mm_int4>(context, 1, "settleAtoms");
    empty(Door::clusters(utilities));
    empty(Door::others(utilities));
    Door::positions(utilities) = std::make_shared<StandIn>(constraints, false);
    Door::velocities(utilities) = std::make_shared<StandIn>(constraints, true);
}

DeviceConstraints *OpenMM::inPlace(ComputeContext &context) {
    auto *const standIn = dynamic_cast<StandIn *>(Door::positions(context.getIntegrationUtilities()).get());
    return standIn ? standIn->constraints.get() : nullptr;
}
