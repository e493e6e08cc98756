#include "core/inverse/molecule_inverse.hpp"

#include <algorithm>
#include <cmath>

#include "core/inverse/bond_vectors.hpp"

namespace holonomic {

MoleculeInverse::MoleculeInverse(const Chains &chains, std::int64_t molecule, const AtomArray &r)
    : Inverse(chains.base), number_(molecule), d_(bond_vectors(chains.molecule(molecule), r, chains.box)),
      solver_(ExtendedMolecule::make(chains.molecule(molecule), r, chains.box)) {
    if (!solver_->good()) refuse(chains, molecule, r);
    const Molecule m = chains.molecule(molecule);
    for (std::int64_t i = 0; i < m.n_atoms; ++i) {
        atoms_.push_back(m.atom(i));
        w_.push_back(m.w(i));
    }
    for (std::int64_t k = 0; k < m.n_bonds; ++k) {
        i_.push_back(static_cast<std::size_t>(m.i(k)));
        j_.push_back(static_cast<std::size_t>(m.j(k)));
    }
}

// Z = 4 A.
std::vector<double> MoleculeInverse::find_row(bool physical, std::int64_t i) const {
    std::vector<double> row = solver_->inverse_row(i);
    for (std::size_t k = 0; physical && k < row.size(); ++k) {
        const std::int64_t j = static_cast<std::int64_t>(k);
        row[k] = std::scalbn(row[k] / (solver_->root(i) * solver_->root(j)),
                             -2 - solver_->exponent(i) - solver_->exponent(j));
    }
    return row;
}

double MoleculeInverse::entry(bool physical, std::int64_t i, std::int64_t j) const {
    check(i);
    check(j);
    return find_row(physical, std::min(i, j))[static_cast<std::size_t>(std::max(i, j))];
}

void MoleculeInverse::row(bool physical, std::int64_t i, double *out) const {
    check(i);
    const std::vector<double> row = find_row(physical, i);
    std::copy(row.begin(), row.end(), out);
}

void MoleculeInverse::band(bool physical, std::int64_t width, double *out) const {
    if (width != 0) {
        Error error =
            make_error(Status::value,
                       "width is %lld; molecule %lld is no linear chain, of its bonds none is beside another: "
                       "it has a diagonal (width 0), but no band",
                       static_cast<long long>(width), static_cast<long long>(number_ + base()));
        error.chain = number_;
        error.base = base();
        throw error;
    }
    for (std::int64_t k = 0; k < n_bonds(); ++k) out[k] = find_row(physical, k)[static_cast<std::size_t>(k)];
}

void MoleculeInverse::matrix(bool physical, double *out) const {
    const std::size_t n = d_.size();
    for (std::size_t i = 0; i < n; ++i) {
        const std::vector<double> row = find_row(physical, static_cast<std::int64_t>(i));
        for (std::size_t j = i; j < n; ++j) out[i * n + j] = out[j * n + i] = row[j];
    }
}

double MoleculeInverse::condition() const {
    double largest = 0;
    for (std::int64_t i = 0; i < n_bonds(); ++i) {
        double sum = 0;
        for (const double x : solver_->inverse_row(i)) sum += std::fabs(x);
        largest = std::max(largest, sum);
    }
    return solver_->largest_row() * largest;
}

}  // namespace holonomic
