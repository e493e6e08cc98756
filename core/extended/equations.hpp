// The equations of one molecule in the arithmetic of the kernels' namespace HOL_ISA: twice the precision, or four times
// with HOL_QUAD_DOUBLE. A file that includes this defines HOL_ISA and HOL_LANES first, and has one arithmetic.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/extended/molecule.hpp"
#include "core/kernels/extended/plan_of.hpp"
#include "core/kernels/extended/solution.hpp"
#include "core/molecules/memory_limit.hpp"
#include "core/molecules/planned/elimination_plan.hpp"

namespace holonomic::HOL_ISA::extended {

// Memory that the solver's parts are taken from, aligned to 64.
class AlignedMemory {
public:
    explicit AlignedMemory(int64_t bytes) : memory_(static_cast<std::size_t>(bytes) + 64) {}
    ByteArena begin() {
        const std::uintptr_t address = reinterpret_cast<std::uintptr_t>(memory_.data());
        return {memory_.data() + (64 - address % 64) % 64};
    }

private:
    std::vector<char> memory_;
};

class Equations final : public ExtendedMolecule {
public:
    Equations(const holonomic::Molecule &m, const AtomArray &r, const Box &box)
        : elimination_(make_extended_plan(*m.shape->elimination, default_memory_limit())), lane_{},
          owned_(elimination_->extended_bytes), memory_(owned_.begin()), plan_(plan_of(*elimination_, memory_)),
          solution_(plan_, lane_, memory_) {
        for (int64_t i = 0; i < m.n_atoms; ++i) {
            atoms_.push_back(m.atom(i));
            w_.push_back(m.w(i));
        }
        lane_.atoms = atoms_.data();
        lane_.w = w_.data();
        good_ = solution_.open(r, box, true);
        if (!good_) return;
        const ScaledMolecule &own = solution_.m;
        for (int32_t k = 0; k < plan_.n_bonds; ++k)
            root_.push_back(
                std::sqrt((own.w[plan_.atom_i[k]] + own.w[plan_.atom_j[k]]) * rounded(dot(own.d[k], own.d[k]))));
        // Whether solving by the factors loses digits is seen by solving once.
        for (int32_t k = 0; k < plan_.n_bonds; ++k) solution_.b[k] = wide(root_[static_cast<std::size_t>(k)]);
        solve(own, solution_.system, solution_.b, solution_.t);
    }

    bool good() const override { return good_; }
    int64_t dependent_bond() const override { return solution_.system.bad; }
    bool lacks_digits() const override { return solution_.lacks_digits(); }

    std::vector<double> inverse_row(int64_t i) const override {
        const std::size_t n = static_cast<std::size_t>(plan_.n_bonds);
        // Solving writes into memory of its own.
        AlignedMemory owned(int64_t(sizeof(Wide)) * 6 * plan_.n_bonds + int64_t(sizeof(Wide3)) * plan_.n_atoms +
                            64 * 10);
        ByteArena memory = owned.begin();
        ExtendedSystem own = solution_.system;
        for (Wide **array : {&own.rest, &own.change, &own.tree.y_up, &own.tree.y_down})
            *array = memory.take<Wide>(plan_.n_bonds);
        own.ring.y = own.graph.y = own.tree.y_up;
        own.graph.core_y = own.tree.y_down;
        own.pull = memory.take<Wide3>(plan_.n_atoms);
        Wide *const b = memory.take<Wide>(plan_.n_bonds), *const t = memory.take<Wide>(plan_.n_bonds);
        for (int32_t k = 0; k < plan_.n_bonds; ++k) b[k] = wide(k == i ? 1 : 0);
        solve(solution_.m, own, b, t);
        std::vector<double> row(n);
        for (std::size_t k = 0; k < n; ++k)
            row[k] = (root_[static_cast<std::size_t>(i)] * root_[k]) * rounded(t[k]) + 0.0;
        return row;
    }

    double root(int64_t k) const override {
        // sqrt(mass_unit) is a power of two if the exponent of mass_unit is even.
        const double root = root_[static_cast<std::size_t>(k)];
        return std::ilogb(solution_.m.mass_unit) % 2 ? root * 1.4142135623730951 : root;
    }

    int exponent(int64_t k) const override {
        const int mass = std::ilogb(solution_.m.mass_unit);
        return (mass - std::abs(mass % 2)) / 2 + std::ilogb(solution_.m.unit[k]);
    }

    double largest_row() const override {
        const ScaledMolecule &m = solution_.m;
        std::vector<double> sum(root_.size(), 1.0);
        for (int32_t i = 0; i < plan_.n_atoms; ++i)
            for (int32_t a = plan_.arm_start[i]; a < plan_.arm_start[i + 1]; ++a)
                for (int32_t b = plan_.arm_start[i]; b < plan_.arm_start[i + 1]; ++b) {
                    const int32_t k = plan_.arms[a], l = plan_.arms[b];
                    if (k == l) continue;
                    const std::size_t row = static_cast<std::size_t>(k), column = static_cast<std::size_t>(l);
                    const double g = rounded(dot(m.d[k], m.d[l]));
                    sum[row] += std::fabs(m.w[i] * g) / (root_[row] * root_[column]);
                }
        return *std::max_element(sum.begin(), sum.end());
    }

private:
    std::unique_ptr<const EliminationPlan> elimination_;
    std::vector<int64_t> atoms_;
    std::vector<double> w_, root_;
    MoleculeLane lane_;
    AlignedMemory owned_;
    ByteArena memory_;
    ExtendedPlan plan_;
    ExtendedSolution solution_;
    bool good_ = false;
};

}  // namespace holonomic::HOL_ISA::extended
