#include "Constraints.h"

#include <algorithm>
#include <map>
#include <string>

#include "Source.h"
#include "openmm/OpenMMException.h"
#include "openmm/common/ContextSelector.h"
#include "openmm/common/IntegrationUtilities.h"

using namespace OpenMM;

namespace {

// Beyond so many entries of a molecule's matrix (a tree of some 150 bonds) the host is the better place.
constexpr std::size_t maxEntries = 300;
constexpr std::size_t mostBondsOfSmall = 6;

struct ReorderedAtoms : ComputeContext::ReorderListener {
    explicit ReorderedAtoms(std::function<void()> what) : tell(std::move(what)) {}
    void execute() override { tell(); }
    std::function<void()> tell;
};

// Arrays of four numbers for each atom, floats or doubles.
template <class Number>
std::vector<double> downloaded(const ArrayInterface &array) {
    std::vector<Number> numbers(4 * static_cast<std::size_t>(array.getSize()));
    array.download(numbers.data(), true);
    return std::vector<double>(numbers.begin(), numbers.end());
}

template <class Number>
void uploaded(ArrayInterface &array, const std::vector<double> &values) {
    const std::vector<Number> numbers(values.begin(), values.end());
    array.upload(numbers.data(), true);
}

bool ofDoubles(const ArrayInterface &array) { return array.getElementSize() == 4 * sizeof(double); }

std::vector<double> read(const ArrayInterface &array) {
    return ofDoubles(array) ? downloaded<double>(array) : downloaded<float>(array);
}

void write(ArrayInterface &array, const std::vector<double> &values) {
    ofDoubles(array) ? uploaded<double>(array, values) : uploaded<float>(array, values);
}

std::vector<int> atomsOf(const hol_chains *chains, std::int64_t molecule) {
    std::int64_t n;
    ask(hol_chains_molecule(chains, molecule, nullptr, &n, nullptr));
    std::vector<std::int64_t> atoms(n);
    ask(hol_chains_atoms(chains, molecule, atoms.data()));
    return std::vector<int>(atoms.begin(), atoms.end());
}

// The next call is about these molecules alone.
void activate(hol_chains *chains, const std::vector<std::int64_t> &which) {
    std::vector<unsigned char> active(hol_chains_n_molecules(chains), 0);
    for (std::int64_t molecule : which) active[molecule] = 1;
    ask(hol_chains_set_active(chains, active.data()));
}

std::vector<double> inverseMassesOf(const System &system) {
    std::vector<double> inverse(system.getNumParticles());
    for (int i = 0; i < system.getNumParticles(); ++i) {
        const double mass = system.getParticleMass(i);
        inverse[i] = mass == 0 ? 0 : 1 / mass;
    }
    return inverse;
}

}  // namespace

DeviceConstraints::DeviceConstraints(ComputeContext &device, const System &system, int nThreads)
    : context(device), host(system, nThreads), inverseMasses(inverseMassesOf(system)) {
    takeMolecules(system, sortedByKind(host.chains(), maxEntries));
    findAtoms();
    // Molecules of one kind may change places, as a whole: what stands in the arrays above stays true, and what was
    // told of atoms by their places must be told before.
    context.addReorderListener(new ReorderedAtoms([this] {
        check();
        findAtoms();
    }));
}

void DeviceConstraints::findAtoms() {
    atomOf.assign(context.getAtomIndex().begin(), context.getAtomIndex().begin() + context.getNumAtoms());
}

void DeviceConstraints::takeMolecules(const System &system, const std::vector<MoleculesOfKind> &sorted) {
    std::vector<mm_int2> groupData;
    std::vector<int> atomData;
    std::vector<double> parameterData;
    std::map<std::vector<double>, int> known;  // where molecules that are alike have their parameters
    moleculeOf.assign(system.getNumParticles(), -1);
    std::vector<bool> isOnDevice(hol_chains_n_molecules(host.chains()), false);
    for (std::size_t kind = 0; kind < sorted.size(); ++kind) {
        const int rows = sorted[kind].kind.nAtoms + 1;
        const auto &molecules = sorted[kind].molecules;
        for (std::size_t first = 0; first < molecules.size(); first += groupWidth) {
            groupData.push_back(mm_int2(static_cast<int>(kind), static_cast<int>(atomData.size())));
            atomData.resize(atomData.size() + rows * groupWidth, -1);
            beginnings.resize(beginnings.size() + groupWidth, -1);
            int *const data = &atomData[groupData.back().y];
            for (int lane = 0; lane < groupWidth && first + lane < molecules.size(); ++lane) {
                const Molecule &molecule = molecules[first + lane];
                std::vector<double> values;
                for (int atom : molecule.atoms) values.push_back(1 / system.getParticleMass(atom));
                for (double length : molecule.lengths) values.push_back(1 / (length * length));
                const auto place = known.emplace(values, static_cast<int>(parameterData.size()));
                if (place.second) parameterData.insert(parameterData.end(), values.begin(), values.end());
                for (int row = 0; row + 1 < rows; ++row) data[row * groupWidth + lane] = molecule.atoms[row];
                data[(rows - 1) * groupWidth + lane] = place.first->second;
                for (int atom : molecule.atoms) moleculeOf[atom] = molecule.number;
                beginnings[beginnings.size() - groupWidth + lane] = molecule.atoms[0];
                isOnDevice[molecule.number] = true;
            }
        }
    }
    for (std::size_t number = 0; number < isOnDevice.size(); ++number)
        if (!isOnDevice[number]) left.push_back(static_cast<std::int64_t>(number));
    if (beginnings.empty()) return;
    allocate(groupData, atomData, parameterData);
    // A kernel takes the registers of its largest molecule, so that the small ones, water above all, have one of their
    // own.
    const std::size_t nLarge = std::count_if(sorted.begin(), sorted.end(), [](const MoleculesOfKind &one) {
        return one.kind.bonds.size() > mostBondsOfSmall;
    });
    addLaunch(sorted, 0, nLarge, 0);
    addLaunch(sorted, nLarge, sorted.size(), launches.empty() ? 0 : launches.back().lastSlot);
}

void DeviceConstraints::allocate(const std::vector<mm_int2> &groupData, const std::vector<int> &atomData,
                                 const std::vector<double> &parameterData) {
    const bool doubles = context.getUseDoublePrecision() || context.getUseMixedPrecision();
    groups.initialize<mm_int2>(context, static_cast<int>(groupData.size()), "holonomicGroups");
    groups.upload(groupData);
    atoms.initialize<int>(context, static_cast<int>(atomData.size()), "holonomicAtoms");
    atoms.upload(atomData);
    parameters.initialize(context, static_cast<int>(parameterData.size()), doubles ? sizeof(double) : sizeof(float),
                          "holonomicParameters");
    parameters.upload(parameterData, true);
    failures.initialize<int>(context, static_cast<int>(beginnings.size()), "holonomicFailures");
    anyFailure.initialize<int>(context, 1, "holonomicAnyFailure");
    context.clearBuffer(failures);
    context.clearBuffer(anyFailure);
}

void DeviceConstraints::addLaunch(const std::vector<MoleculesOfKind> &sorted, std::size_t first, std::size_t last,
                                  int firstSlot) {
    if (first == last) return;
    int lastSlot = firstSlot;
    for (std::size_t kind = first; kind < last; ++kind)
        lastSlot += static_cast<int>((sorted[kind].molecules.size() + groupWidth - 1) / groupWidth * groupWidth);
    const ComputeProgram program = context.compileProgram(kernelSource(sorted, first, last));
    launches.push_back(
        {program->createKernel("solvePositions"), program->createKernel("solveVelocities"), firstSlot, lastSlot});
    for (bool velocities : {false, true}) {
        const ComputeKernel &kernel = launches.back().kernel(velocities);
        kernel->addArg(firstSlot);
        kernel->addArg(lastSlot);
        for (ComputeArray *array : {&groups, &atoms, &parameters, &failures, &anyFailure}) kernel->addArg(*array);
        kernel->addArg(1);
        kernel->addArg(velocities ? context.getVelm() : context.getIntegrationUtilities().getPosDelta());
        kernel->addArg(context.getPosq());
        if (context.getUseMixedPrecision()) kernel->addArg(context.getPosqCorrection());
    }
}

void DeviceConstraints::apply(bool toVelocities) {
    ContextSelector selector(context);
    if (outsideOfSteps) check();  // a failure of the last steps is none of this call's
    firstStep = std::min(firstStep, context.getStepCount());
    for (const Launch &launch : launches) {
        const ComputeKernel &kernel = launch.kernel(toVelocities);
        kernel->setArg(7, static_cast<int>(context.getStepCount() - firstStep) + 1);
        kernel->execute(launch.lastSlot - launch.firstSlot, groupWidth);
    }
    if (outsideOfSteps && !launches.empty()) {
        int call;
        std::vector<std::int64_t> which;
        for (int slot : failedSlots(call)) which.push_back(moleculeIn(slot));
        if (!which.empty()) solveOnHost(toVelocities, which);
    }
    if (!left.empty()) solveOnHost(toVelocities, left);
}

std::int64_t DeviceConstraints::moleculeIn(int slot) const { return moleculeOf[atomOf[beginnings[slot]]]; }

std::vector<int> DeviceConstraints::failedSlots(int &firstCall) {
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

void DeviceConstraints::check() {
    if (launches.empty()) return;
    ContextSelector selector(context);
    const long long since = firstStep;
    firstStep = context.getStepCount();
    int call;
    const std::vector<int> failed = failedSlots(call);
    if (failed.empty()) return;
    std::string words;
    for (int atom : atomsOf(host.chains(), moleculeIn(failed[0])))
        words += (words.empty() ? " " : ", ") + std::to_string(atom);
    throw OpenMMException(
        "holonomic: the constraints of the molecule of atoms" + words + " could not be solved in step " +
        std::to_string(since + call) + ": the step is too long, or a coordinate is not finite" +
        (failed.size() > 1 ? "; so it is with " + std::to_string(failed.size() - 1) + " others" : ""));
}

void DeviceConstraints::solveOnHost(bool toVelocities, const std::vector<std::int64_t> &which) {
    const int n = context.getNumAtoms();
    const std::vector<int> &atomAt = context.getAtomIndex();
    std::vector<double> places = read(context.getPosq());
    if (context.getUseMixedPrecision()) {
        const std::vector<double> correction = read(context.getPosqCorrection());
        for (std::size_t k = 0; k < places.size(); ++k) places[k] += correction[k];
    }
    ArrayInterface &array = toVelocities ? context.getVelm() : context.getIntegrationUtilities().getPosDelta();
    std::vector<double> state = read(array);
    std::vector<Vec3> r(n), moved(n);
    for (int k = 0; k < n; ++k) {
        r[atomAt[k]] = Vec3(places[4 * k], places[4 * k + 1], places[4 * k + 2]);
        moved[atomAt[k]] = Vec3(state[4 * k], state[4 * k + 1], state[4 * k + 2]);
    }
    const std::vector<Vec3> before = r;
    activate(host.chains(), which);
    if (toVelocities) {
        host.applyToVelocities(r, moved, inverseMasses, 0);
    } else if (outsideOfSteps) {
        host.apply(r, r, inverseMasses, 0);
        for (int i = 0; i < n; ++i) moved[i] = r[i] - before[i];
    } else {
        for (int i = 0; i < n; ++i) moved[i] += r[i];
        host.apply(r, moved, inverseMasses, 0);
        for (int i = 0; i < n; ++i) moved[i] -= before[i];
    }
    // Nothing is changed of others, not even by a rounding.
    std::vector<bool> concerned(n, false);
    for (std::int64_t number : which)
        for (int atom : atomsOf(host.chains(), number)) concerned[atom] = true;
    for (int k = 0; k < n; ++k)
        if (concerned[atomAt[k]])
            for (int axis = 0; axis < 3; ++axis) state[4 * k + axis] = moved[atomAt[k]][axis];
    write(array, state);
}
