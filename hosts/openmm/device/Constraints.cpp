#include "Constraints.h"

#include <algorithm>
#include <functional>
#include <string>

#include "Arrays.h"
#include "openmm/OpenMMException.h"
#include "openmm/common/ContextSelector.h"
#include "openmm/common/IntegrationUtilities.h"

using namespace OpenMM;

namespace {

constexpr std::size_t mostAtomsNamed = 20;

struct ReorderedAtoms : ComputeContext::ReorderListener {
    explicit ReorderedAtoms(std::function<void()> what) : tell(std::move(what)) {}
    void execute() override { tell(); }
    std::function<void()> tell;
};

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
    if (!host.chains()) return;
    launches = std::make_unique<Launches>(device, host.chains());
    left = launches->leftToHost();
    findMolecules();
    findAtoms();
    // Molecules of one kind may change places, as a whole: what stands in the plan's arrays stays true, and what was
    // told of atoms by their places must be told before.
    context.addReorderListener(new ReorderedAtoms([this] {
        check();
        findAtoms();
    }));
}

void DeviceConstraints::findMolecules() {
    moleculeOf.assign(inverseMasses.size(), -1);
    for (std::int64_t number = 0; number < hol_chains_n_molecules(host.chains()); ++number) {
        const std::vector<int> atoms = atomsOf(host.chains(), number);
        anyAtom.push_back(
            *std::find_if(atoms.begin(), atoms.end(), [this](int atom) { return inverseMasses[atom] > 0; }));
        for (int atom : atoms) moleculeOf[atom] = number;
    }
}

void DeviceConstraints::findAtoms() {
    atomOf.assign(context.getAtomIndex().begin(), context.getAtomIndex().begin() + context.getNumAtoms());
}

void DeviceConstraints::apply(bool toVelocities) {
    if (!launches) return;
    ContextSelector selector(context);
    if (outsideOfSteps) check();  // a failure of the last steps is none of this call's
    firstStep = std::min(firstStep, context.getStepCount());
    launches->execute(toVelocities, static_cast<int>(context.getStepCount() - firstStep) + 1);
    if (outsideOfSteps) {
        int call;
        std::vector<std::int64_t> which;
        for (std::int64_t number : launches->failedMolecules(call)) which.push_back(nowAt(number));
        if (!which.empty()) solveOnHost(toVelocities, which);
    }
    if (!left.empty()) solveOnHost(toVelocities, left);
}

std::int64_t DeviceConstraints::nowAt(std::int64_t number) const { return moleculeOf[atomOf[anyAtom[number]]]; }

void DeviceConstraints::check() {
    if (!launches || launches->empty()) return;
    ContextSelector selector(context);
    const long long since = firstStep;
    firstStep = context.getStepCount();
    int call;
    const std::vector<std::int64_t> failed = launches->failedMolecules(call);
    if (failed.empty()) return;
    const std::vector<int> atoms = atomsOf(host.chains(), nowAt(failed[0]));
    std::string words;
    for (std::size_t k = 0; k < std::min(atoms.size(), mostAtomsNamed); ++k)
        words += (k == 0 ? " " : ", ") + std::to_string(atoms[k]);
    if (atoms.size() > mostAtomsNamed) words += " and " + std::to_string(atoms.size() - mostAtomsNamed) + " more";
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
