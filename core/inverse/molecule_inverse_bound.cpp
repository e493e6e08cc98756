// How far given multipliers of a molecule are from the exact ones: |A^-1| times what they leave of its equations.
#include <cmath>

#include "core/inverse/molecule_inverse.hpp"

namespace holonomic {

namespace {

PairVector vector_of(const AtomArray &array, std::int64_t atom) {
    return array.x ? vector_of_atom(array, atom) : PairVector{};
}

double size_of(const PairVector &a) { return std::fabs(a.x.hi) + std::fabs(a.y.hi) + std::fabs(a.z.hi); }

}  // namespace

// G of each atom; `size` gets the sizes of what is added up.
std::vector<PairVector> MoleculeInverse::pulls(const double *lambda, std::vector<double> &size) const {
    std::vector<PairVector> pull(atoms_.size(), PairVector{});
    size.assign(atoms_.size(), 0);
    for (std::size_t k = 0; k < d_.size(); ++k) {
        const PairVector p = (2 * lambda[k]) * d_[k];
        pull[i_[k]] = pull[i_[k]] + p;
        pull[j_[k]] = pull[j_[k]] - p;
        size[i_[k]] += size_of(p);
        size[j_[k]] += size_of(p);
    }
    return pull;
}

// Of bond k, in the form d_k.(w_j A_j - w_i A_i) + |dv|^2 with A_i = F_i + G_i.
MoleculeInverse::BondResidual MoleculeInverse::residual(const AtomArray &v, const AtomArray &f,
                                                        const std::vector<PairVector> &pull,
                                                        const std::vector<double> &size, std::size_t k) const {
    const std::size_t i = i_[k], j = j_[k];
    const PairVector fi = vector_of(f, atoms_[i]), fj = vector_of(f, atoms_[j]);
    const PairVector dv = vector_of(v, atoms_[j]) - vector_of(v, atoms_[i]);
    const DoublePair square = dot(dv, dv);
    const double forces = w_[j] * (size_of(fj) + size[j]) + w_[i] * (size_of(fi) + size[i]);
    BondResidual rest;
    rest.value = rounded(dot(d_[k], w_[j] * (fj + pull[j]) - w_[i] * (fi + pull[i])) + square);
    rest.terms = size_of(d_[k]) * forces + square.hi;
    rest.exact = forces == 0 && size_of(vector_of(v, atoms_[j])) == 0 && size_of(vector_of(v, atoms_[i])) == 0;
    return rest;
}

std::vector<double> MoleculeInverse::error_bound(const AtomArray &v, const AtomArray &f, const double *lambda) const {
    check_finite(atoms_, v, f, lambda);
    // Each product and sum of the evaluation has a relative error below 2^-102; there are fewer than 64 of them and
    // those of an atom's bonds. A box adds the same for lattice vectors up to 2^5 times as long as the bond. Among
    // denormal numbers each is off by up to the smallest number instead.
    const double evaluation = 0x1p-90, denormal = 0x1p-1067;
    const std::size_t n = d_.size();
    std::vector<double> size, root(n), rest(n), bound(n);
    const std::vector<PairVector> pull = pulls(lambda, size);
    for (std::size_t k = 0; k < n; ++k) {
        const std::int64_t bond = static_cast<std::int64_t>(k);
        const BondResidual of_bond = residual(v, f, pull, size, k);
        root[k] = std::scalbn(solver_->root(bond), solver_->exponent(bond));
        rest[k] = std::fabs(of_bond.value) + evaluation * of_bond.terms;
        if (!of_bond.exact && rest[k] < 0x1p-900)
            rest[k] += denormal * (1 + size_of(d_[k])) * (1 + w_[i_[k]] + w_[j_[k]]);
        rest[k] /= root[k];
    }
    // t = 2 lambda; one per cent for the rounding of this calculation, which has no differences in it.
    for (std::size_t k = 0; k < n; ++k) {
        const std::vector<double> row = solver_->inverse_row(static_cast<std::int64_t>(k));
        double sum = 0;
        for (std::size_t l = 0; l < n; ++l) sum += std::fabs(row[l]) * rest[l];
        bound[k] = sum > 0 ? 0.505 * sum / root[k] + 0x1p-1074 : 0;
    }
    return bound;
}

}  // namespace holonomic
