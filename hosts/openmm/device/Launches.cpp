#include "Launches.h"

#include <algorithm>
#include <map>
#include <string>

#include "BlockPlan.h"
#include "Source.h"
#include "openmm/common/IntegrationUtilities.h"

using namespace OpenMM;

namespace {

constexpr std::size_t mostBondsOfSmall = 6;
// Of blocks whose molecules stand in local memory, and of others, which are larger.
constexpr int localBlock = 64, globalBlock = 256;
constexpr std::size_t localBytes = 32000;  // each device has 32 KiB

// Numbers of a molecule that a block solves, by BlockSource.cpp.
std::size_t nMixed(const Kind &kind) { return 3 * (kind.nAtoms + kind.bonds.size()); }
std::size_t nReals(const Kind &kind) { return 5 * kind.bonds.size() + 2 * kind.entries.size(); }

bool usesDoubles(const ComputeContext &device) {
    return device.getUseDoublePrecision() || device.getUseMixedPrecision();
}

std::size_t bytes(const Kind &kind, const ComputeContext &device) {
    return nMixed(kind) * (usesDoubles(device) ? sizeof(double) : sizeof(float)) +
           nReals(kind) * (device.getUseDoublePrecision() ? sizeof(double) : sizeof(float)) +
           localBlock * sizeof(double);
}

}  // namespace

struct Launches::Data {
    std::vector<mm_int2> groups;
    std::vector<mm_int4> blocks;
    std::vector<int> atoms, plans;
    std::vector<double> parameters;
    std::map<std::vector<double>, int> known;  // where molecules that are alike have their parameters
    int nMixed = 0, nReals = 0;                // of molecules that do not stand in local memory
};

Launches::Launches(ComputeContext &device, const std::vector<MoleculesOfKind> &sorted,
                   const std::vector<double> &inverse)
    : context(device), inverseMasses(inverse) {
    Data data;
    std::size_t nForThreads = 0, nSmall = 0, nInArrays = 0;
    for (std::size_t kind = 0; kind < sorted.size(); ++kind) {
        if (sorted[kind].kind.isForBlock()) {
            if (bytes(sorted[kind].kind, context) > localBytes) nInArrays = kind + 1;
        } else {
            ++nForThreads;
            nSmall += sorted[kind].kind.bonds.size() <= mostBondsOfSmall;
        }
    }
    nInArrays = std::max(nInArrays, nForThreads);
    for (std::size_t kind = 0; kind < nForThreads; ++kind) takeGroups(sorted[kind], static_cast<int>(kind), data);
    firstBlock = static_cast<int>(beginnings.size());
    for (std::size_t kind = nForThreads; kind < sorted.size(); ++kind)
        takeBlocks(sorted[kind], kind >= nInArrays, data);
    if (beginnings.empty()) return;
    allocate(data);
    // A kernel takes the registers of its largest molecule, so that the small ones, water above all, have one of their
    // own.
    launchGroups(sorted, 0, nForThreads - nSmall);
    launchGroups(sorted, nForThreads - nSmall, nForThreads);
    launchBlocks(sorted, nForThreads, nInArrays, false);
    launchBlocks(sorted, nInArrays, sorted.size(), true);
}

void Launches::takeGroups(const MoleculesOfKind &some, int kind, Data &data) {
    const int nAtoms = some.kind.nAtoms;
    for (std::size_t first = 0; first < some.molecules.size(); first += groupWidth) {
        data.groups.push_back(mm_int2(kind, static_cast<int>(data.atoms.size())));
        const std::size_t begin = data.atoms.size();
        data.atoms.resize(begin + (nAtoms + 1) * groupWidth, -1);
        const int firstSlot = static_cast<int>(beginnings.size());
        beginnings.resize(beginnings.size() + groupWidth, -1);
        for (int lane = 0; lane < groupWidth && first + lane < some.molecules.size(); ++lane) {
            const Molecule &molecule = some.molecules[first + lane];
            int *const column = &data.atoms[begin + lane];
            for (int row = 0; row < nAtoms; ++row) column[row * groupWidth] = molecule.atoms[row];
            column[nAtoms * groupWidth] = takeParameters(molecule, firstSlot + lane, data);
        }
    }
}

void Launches::takeBlocks(const MoleculesOfKind &some, bool inLocalMemory, Data &data) {
    const int plan = static_cast<int>(data.plans.size());
    const std::vector<int> ofKind = blockPlan(some.kind);
    data.plans.insert(data.plans.end(), ofKind.begin(), ofKind.end());
    for (const Molecule &molecule : some.molecules) {
        data.blocks.push_back(mm_int4(plan, static_cast<int>(data.atoms.size()), data.nMixed, data.nReals));
        data.atoms.insert(data.atoms.end(), molecule.atoms.begin(), molecule.atoms.end());
        beginnings.push_back(-1);
        data.atoms.push_back(takeParameters(molecule, static_cast<int>(beginnings.size()) - 1, data));
        if (inLocalMemory) continue;
        data.nMixed += static_cast<int>(nMixed(some.kind));
        data.nReals += static_cast<int>(nReals(some.kind));
    }
}

// Gives where they are.
int Launches::takeParameters(const Molecule &molecule, int slot, Data &data) {
    std::vector<double> values;
    for (int atom : molecule.atoms) values.push_back(inverseMasses[atom]);
    for (double length : molecule.lengths) values.push_back(1 / (length * length));
    const auto place = data.known.emplace(values, static_cast<int>(data.parameters.size()));
    if (place.second) data.parameters.insert(data.parameters.end(), values.begin(), values.end());
    beginnings[slot] = molecule.atoms[0];
    return place.first->second;
}

void Launches::allocate(const Data &data) {
    const std::size_t ofMixed = usesDoubles(context) ? sizeof(double) : sizeof(float);
    const std::size_t ofReal = context.getUseDoublePrecision() ? sizeof(double) : sizeof(float);
    if (!data.groups.empty()) {
        groups.initialize<mm_int2>(context, static_cast<int>(data.groups.size()), "holonomicGroups");
        groups.upload(data.groups);
    }
    if (!data.blocks.empty()) {
        blocks.initialize<mm_int4>(context, static_cast<int>(data.blocks.size()), "holonomicBlocks");
        blocks.upload(data.blocks);
        plans.initialize<int>(context, static_cast<int>(data.plans.size()), "holonomicPlans");
        plans.upload(data.plans);
    }
    if (data.nMixed > 0) {
        mixedScratch.initialize(context, data.nMixed, static_cast<int>(ofMixed), "holonomicMixedScratch");
        realScratch.initialize(context, data.nReals, static_cast<int>(ofReal), "holonomicRealScratch");
    }
    atoms.initialize<int>(context, static_cast<int>(data.atoms.size()), "holonomicAtoms");
    atoms.upload(data.atoms);
    parameters.initialize(context, static_cast<int>(data.parameters.size()), static_cast<int>(ofMixed),
                          "holonomicParameters");
    parameters.upload(data.parameters, true);
    failures.initialize<int>(context, static_cast<int>(beginnings.size()), "holonomicFailures");
    anyFailure.initialize<int>(context, 1, "holonomicAnyFailure");
    context.clearBuffer(failures);
    context.clearBuffer(anyFailure);
}

void Launches::addLaunch(const ComputeKernel &positions, const ComputeKernel &velocities, int firstSlot, int lastSlot,
                         int threadsOfSlot, int blockSize, const std::vector<ArrayInterface *> &own) {
    launches.push_back({positions, velocities, firstSlot, lastSlot, threadsOfSlot, blockSize});
    for (bool ofVelocities : {false, true}) {
        const ComputeKernel &kernel = launches.back().kernel(ofVelocities);
        kernel->addArg(firstSlot);
        kernel->addArg(lastSlot);
        kernel->addArg(*own[0]);
        for (ComputeArray *array : {&atoms, &parameters, &failures, &anyFailure}) kernel->addArg(*array);
        kernel->addArg(1);
        kernel->addArg(ofVelocities ? context.getVelm() : context.getIntegrationUtilities().getPosDelta());
        for (std::size_t k = 1; k < own.size(); ++k) kernel->addArg(*own[k]);
        kernel->addArg(context.getPosq());
        if (context.getUseMixedPrecision()) kernel->addArg(context.getPosqCorrection());
    }
}

void Launches::launchGroups(const std::vector<MoleculesOfKind> &sorted, std::size_t first, std::size_t last) {
    if (first == last) return;
    const int firstSlot = launches.empty() ? 0 : launches.back().lastSlot;
    int lastSlot = firstSlot;
    for (std::size_t kind = first; kind < last; ++kind)
        lastSlot += static_cast<int>((sorted[kind].molecules.size() + groupWidth - 1) / groupWidth * groupWidth);
    const ComputeProgram program = context.compileProgram(kernelSource(sorted, first, last));
    addLaunch(program->createKernel("solvePositions"), program->createKernel("solveVelocities"), firstSlot, lastSlot, 1,
              groupWidth, {&groups});
}

void Launches::launchBlocks(const std::vector<MoleculesOfKind> &sorted, std::size_t first, std::size_t last,
                            bool inLocalMemory) {
    if (first == last) return;
    const int firstSlot = launches.empty() ? 0 : launches.back().lastSlot;
    int lastSlot = firstSlot;
    LocalScratch scratch{0, 0};
    for (std::size_t kind = first; kind < last; ++kind) {
        lastSlot += static_cast<int>(sorted[kind].molecules.size());
        if (!inLocalMemory) continue;
        scratch.nMixed = std::max(scratch.nMixed, static_cast<int>(nMixed(sorted[kind].kind)));
        scratch.nReals = std::max(scratch.nReals, static_cast<int>(nReals(sorted[kind].kind)));
    }
    const int size = std::min(inLocalMemory ? localBlock : globalBlock, context.getMaxThreadBlockSize());
    const auto kernel = [&](bool ofVelocities) {
        const std::string text = blockSource(ofVelocities, size, firstBlock, scratch);
        return context.compileProgram(text)->createKernel(ofVelocities ? "solveVelocities" : "solvePositions");
    };
    std::vector<ArrayInterface *> own{&blocks, &plans};
    if (!inLocalMemory) own.insert(own.end(), {&mixedScratch, &realScratch});
    addLaunch(kernel(false), kernel(true), firstSlot, lastSlot, size, size, own);
}

void Launches::execute(bool toVelocities, int call) {
    for (const Launch &launch : launches) {
        const ComputeKernel &kernel = launch.kernel(toVelocities);
        kernel->setArg(7, call);
        kernel->execute((launch.lastSlot - launch.firstSlot) * launch.threadsOfSlot, launch.blockSize);
    }
}

std::vector<int> Launches::failedSlots(int &firstCall) {
    if (launches.empty()) return {};
    std::vector<int> any(1), calls;
    anyFailure.download(any);
    if (any[0] == 0) return {};
    failures.download(calls);
    context.clearBuffer(failures);
    context.clearBuffer(anyFailure);
    firstCall = 0;
    for (int call : calls)
        if (call != 0 && (firstCall == 0 || call < firstCall)) firstCall = call;
    std::vector<int> slots;
    for (std::size_t slot = 0; slot < calls.size(); ++slot)
        if (calls[slot] == firstCall) slots.push_back(static_cast<int>(slot));
    return slots;
}
