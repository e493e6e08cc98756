// The inverse of a molecule that is no linear chain: rows by solving for them.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/double_pair.hpp"
#include "core/extended/molecule.hpp"
#include "core/inverse/inverse.hpp"

namespace holonomic {

class MoleculeInverse final : public Inverse {
public:
    MoleculeInverse(const Chains &chains, std::int64_t molecule, const AtomArray &r);

    std::int64_t n_bonds() const override { return static_cast<std::int64_t>(d_.size()); }
    double entry(bool physical, std::int64_t i, std::int64_t j) const override;
    void row(bool physical, std::int64_t i, double *out) const override;
    void band(bool physical, std::int64_t width, double *out) const override;
    void matrix(bool physical, double *out) const override;
    double condition() const override;
    std::vector<double> error_bound(const AtomArray &v, const AtomArray &f, const double *lambda) const override;

private:
    struct BondResidual {
        double value, terms;  // and the size of what is added up
        bool exact;           // everything that stands in the equation is zero
    };
    std::vector<double> find_row(bool physical, std::int64_t i) const;
    std::vector<PairVector> pulls(const double *lambda, std::vector<double> &size) const;
    BondResidual residual(const AtomArray &v, const AtomArray &f, const std::vector<PairVector> &pull,
                          const std::vector<double> &size, std::size_t k) const;

    std::int64_t number_;
    std::vector<std::int64_t> atoms_;  // [n_atoms]
    std::vector<double> w_;            // [n_atoms]
    std::vector<std::size_t> i_, j_;   // [n_bonds] atoms within the molecule
    std::vector<PairVector> d_;        // [n_bonds], exact differences of the coordinates
    std::unique_ptr<const ExtendedMolecule> solver_;
};

}  // namespace holonomic
