#include "core/inverse/extended_molecule.hpp"

#include <algorithm>
#include <cmath>

#include "core/double_pair.hpp"
#include "core/molecules/given/memory_limit.hpp"

#define HOL_ISA plain
#define HOL_LANES 2
#include "core/kernels/extended/plan_of.hpp"
#include "core/kernels/extended/system.hpp"
#undef HOL_ISA
#undef HOL_LANES

namespace holonomic {

namespace {

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

// Memory that the solver's parts are taken from, aligned to 64.
class Owned {
public:
    explicit Owned(std::int64_t bytes) : memory_(at(bytes) + 64) {}
    plain::extended::Memory begin() {
        const std::uintptr_t address = reinterpret_cast<std::uintptr_t>(memory_.data());
        return {memory_.data() + (64 - address % 64) % 64};
    }

private:
    std::vector<char> memory_;
};

}  // namespace

struct ExtendedMolecule::State {
    std::unique_ptr<const EliminationPlan> elimination;
    std::vector<std::int64_t> atoms;
    std::vector<double> w, length;
    MoleculeLane lane;
    Owned owned;
    plain::extended::Memory memory;
    ExtendedPlan plan;
    plain::extended::Molecule molecule;
    plain::extended::System system;
    std::vector<double> root;
    bool good = false;

    explicit State(const holonomic::Molecule &m)
        : elimination(make_extended_plan(*m.shape->elimination, default_memory_limit())), atoms(at(m.n_atoms)),
          w(at(m.n_atoms)), lane{}, owned(elimination->extended_bytes), memory(owned.begin()),
          plan(plain::extended::plan_of(*elimination, memory)), molecule(plan, lane, memory),
          system(plain::extended::take_system(molecule, memory)) {
        for (std::int64_t i = 0; i < m.n_atoms; ++i) {
            atoms[at(i)] = m.atom(i);
            w[at(i)] = m.w(i);
        }
        lane.atoms = atoms.data();
        lane.w = w.data();
    }
};

ExtendedMolecule::ExtendedMolecule(const Molecule &molecule, const AtomArray &r, const Box &box)
    : state_(std::make_unique<State>(molecule)) {
    State &s = *state_;
    const plain::extended::Molecule &m = s.molecule;
    s.good = load(s.molecule, r, box) && factorize(m, s.system);
    if (!s.good) return;
    for (std::int32_t k = 0; k < m.plan.n_bonds; ++k)
        s.root.push_back(std::sqrt((m.w[m.plan.atom_i[k]] + m.w[m.plan.atom_j[k]]) * rounded(dot(m.d[k], m.d[k]))));
}

ExtendedMolecule::~ExtendedMolecule() = default;

bool ExtendedMolecule::good() const { return state_->good; }
std::int64_t ExtendedMolecule::dependent_bond() const { return state_->system.bad; }

std::vector<double> ExtendedMolecule::inverse_row(std::int64_t i) const {
    const State &s = *state_;
    const ExtendedPlan &plan = s.molecule.plan;
    const std::size_t n = at(plan.n_bonds);
    // Solving writes into memory of its own.
    Owned owned(16 * (8 * plan.n_bonds) + 48 * plan.n_atoms + 64 * 10);
    plain::extended::Memory memory = owned.begin();
    plain::extended::System own = s.system;
    for (plain::Wide **array : {&own.rest, &own.change, &own.tree.y_up, &own.tree.y_down})
        *array = memory.take<plain::Wide>(plan.n_bonds);
    own.ring.y = own.graph.y = own.tree.y_up;
    own.graph.core_y = own.tree.y_down;
    own.pull = memory.take<plain::Wide3>(plan.n_atoms);
    std::vector<DoublePair> b(n, as_pair(0)), t(n);
    b[at(i)] = as_pair(1);
    solve(s.molecule, own, b.data(), t.data());
    std::vector<double> row(n);
    for (std::size_t k = 0; k < n; ++k) row[k] = (s.root[at(i)] * s.root[k]) * rounded(t[k]) + 0.0;
    return row;
}

double ExtendedMolecule::root(std::int64_t k) const {
    // sqrt(mass_unit) is a power of two if the exponent of mass_unit is even.
    const int odd = std::abs(std::ilogb(state_->molecule.mass_unit) % 2);
    return odd ? state_->root[at(k)] * 1.4142135623730951 : state_->root[at(k)];
}

int ExtendedMolecule::exponent(std::int64_t k) const {
    const int mass = std::ilogb(state_->molecule.mass_unit);
    return (mass - std::abs(mass % 2)) / 2 + std::ilogb(state_->molecule.unit[k]);
}

double ExtendedMolecule::largest_row() const {
    const State &s = *state_;
    const ExtendedPlan &plan = s.molecule.plan;
    std::vector<double> sum(at(plan.n_bonds), 1.0);
    for (std::int32_t i = 0; i < plan.n_atoms; ++i)
        for (std::int32_t a = plan.arm_start[i]; a < plan.arm_start[i + 1]; ++a)
            for (std::int32_t b = plan.arm_start[i]; b < plan.arm_start[i + 1]; ++b) {
                const std::int32_t k = plan.arms[a], l = plan.arms[b];
                if (k == l) continue;
                const double g = rounded(dot(s.molecule.d[k], s.molecule.d[l]));
                sum[at(k)] += std::fabs(s.molecule.w[i] * g) / (s.root[at(k)] * s.root[at(l)]);
            }
    return *std::max_element(sum.begin(), sum.end());
}

}  // namespace holonomic
