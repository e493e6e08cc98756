#include "Launches.h"

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <string>

#include "../Algorithm.h"
#include "openmm/common/IntegrationUtilities.h"

using namespace OpenMM;

namespace {

// Where OpenMM has positions, what is added to them, and velocities with inverse masses.
const char arrays[] = R"(
#ifdef USE_MIXED_PRECISION
#define HOL_POSITION_ARRAYS GLOBAL mixed4* RESTRICT state, GLOBAL const real4* RESTRICT posq, \
    GLOBAL const real4* RESTRICT posqCorrection
#define HOL_POSITION(a) make_mixed3(posq[a].x + (mixed) posqCorrection[a].x, posq[a].y + (mixed) posqCorrection[a].y, \
    posq[a].z + (mixed) posqCorrection[a].z)
#else
#define HOL_POSITION_ARRAYS GLOBAL mixed4* RESTRICT state, GLOBAL const real4* RESTRICT posq
#define HOL_POSITION(a) trimTo3(posq[a])
#endif
#define HOL_VELOCITY_ARRAYS HOL_POSITION_ARRAYS
#define HOL_STATE mixed4
#define HOL_DISPLACEMENT(a) state[a]
#define HOL_VELOCITY(a) state[a]
#define HOL_DISPLACE(a, before, after) state[a] = make_mixed4(after.x, after.y, after.z, before.w)
#define HOL_SET_VELOCITY HOL_DISPLACE
)";

hol_device_precision precisionOf(const ComputeContext &device) {
    if (device.getUseDoublePrecision()) return HOL_DEVICE_DOUBLE;
    return device.getUseMixedPrecision() ? HOL_DEVICE_MIXED : HOL_DEVICE_SINGLE;
}

// A processor has no registers to spare for few molecules in many threads; its compiler takes a minute for larger
// molecules than a tree of some 150 bonds.
std::int64_t maxEntriesOfThread(const ComputeContext &device) {
    const char *const asked = std::getenv("HOLONOMIC_OPENMM_ENTRIES");
    if (asked) return std::strtol(asked, nullptr, 10);
    return device.getIsCPU() ? 300 : -1;
}

struct DestroyPlan {
    void operator()(hol_device_plan *plan) const { hol_device_plan_destroy(plan); }
};

}  // namespace

Launches::Launches(ComputeContext &device, const hol_chains *chains) : context(device) {
    hol_device_plan *made = nullptr;
    ask(hol_device_plan_create(chains, precisionOf(device), maxEntriesOfThread(device), &made));
    const std::unique_ptr<hol_device_plan, DestroyPlan> plan(made);
    left.resize(hol_device_plan_n_left(made));
    ask(hol_device_plan_left(made, left.data()));
    if (hol_device_plan_n_launches(made) == 0) return;
    allocate(made);
    create(made);
}

void Launches::allocate(const hol_device_plan *plan) {
    struct {
        ComputeArray &array;
        const char *name;
    } const all[] = {{integers, "holonomicIntegers"},
                     {numbers, "holonomicNumbers"},
                     {scratch, "holonomicScratch"},
                     {failures, "holonomicFailures"}};
    const int elementSize[] = {sizeof(int), precisionOf(context) == HOL_DEVICE_SINGLE ? 4 : 8, 4, sizeof(int)};
    for (int which = 0; which < 4; ++which) {
        const void *data;
        std::int64_t bytes;
        ask(hol_device_plan_array(plan, static_cast<hol_device_array>(which), &data, &bytes));
        all[which].array.initialize(context, bytes / elementSize[which], elementSize[which], all[which].name);
        if (data) all[which].array.upload(data, true);
    }
}

ComputeKernel Launches::kernel(const ComputeProgram &program, const char *name, ArrayInterface &state) {
    ComputeKernel made = program->createKernel(name);
    for (ComputeArray *array : {&integers, &numbers, &scratch, &failures}) made->addArg(*array);
    made->addArg(1);
    made->addArg(state);
    made->addArg(context.getPosq());
    if (context.getUseMixedPrecision()) made->addArg(context.getPosqCorrection());
    return made;
}

void Launches::create(const hol_device_plan *plan) {
    const ComputeProgram program = context.compileProgram(std::string(arrays) + hol_device_plan_source(plan));
    for (std::int64_t k = 0; k < hol_device_plan_n_launches(plan); ++k) {
        const char *positions, *velocities;
        std::int64_t nGroups, groupSize;
        ask(hol_device_plan_launch(plan, k, &positions, &velocities, &nGroups, &groupSize));
        const int size = std::min(static_cast<int>(groupSize), context.getMaxThreadBlockSize());
        launches.push_back({kernel(program, positions, context.getIntegrationUtilities().getPosDelta()),
                            kernel(program, velocities, context.getVelm()), static_cast<int>(nGroups) * size, size});
    }
}

void Launches::execute(bool toVelocities, int call) {
    for (const Launch &launch : launches) {
        const ComputeKernel &kernel = toVelocities ? launch.velocities : launch.positions;
        kernel->setArg(4, call);
        kernel->execute(launch.nThreads, launch.blockSize);
    }
}

std::vector<std::int64_t> Launches::failedMolecules(int &firstCall) {
    if (launches.empty()) return {};
    std::vector<int> calls;
    failures.download(calls);
    if (calls[0] == 0) return {};
    context.clearBuffer(failures);
    firstCall = 0;
    for (std::size_t k = 1; k < calls.size(); ++k)
        if (calls[k] != 0 && (firstCall == 0 || calls[k] < firstCall)) firstCall = calls[k];
    std::vector<std::int64_t> molecules;
    for (std::size_t k = 1; k < calls.size(); ++k)
        if (calls[k] == firstCall) molecules.push_back(static_cast<std::int64_t>(k) - 1);
    return molecules;
}
