// How far given multipliers are from the exact ones: theory (37).
#include <cmath>

#include "core/inverse/chain_inverse.hpp"

namespace holonomic {

namespace {

PairVector combined(const DoublePair &a, const PairVector &x, const DoublePair &b, const PairVector &y) {
    return {a * x.x + b * y.x, a * x.y + b * y.y, a * x.z + b * y.z};
}

double size(const PairVector &a) { return std::fabs(a.x.hi) + std::fabs(a.y.hi) + std::fabs(a.z.hi); }

}  // namespace

// Of bond k, in the form d_k.(w_k A_k - w_{k-1} A_{k-1}) + |dv|^2 with A_i = F_i + G_i; `terms` gets the size of what
// is added up.
DoublePair ChainInverse::residual(const AtomArray &v, const AtomArray &f, const double *lambda, std::size_t k,
                                  double &terms) const {
    const DoublePair w0 = as_pair(w_[k]), w1 = as_pair(w_[k + 1]), minus = as_pair(-1);
    const PairVector &d = d_[k];
    const double q = dot(d, d).hi;
    const auto neighbour = [&](std::size_t m, const DoublePair &w) {
        const DoublePair g = dot(d, d_[m]);
        terms += std::fabs(w.hi * 2 * lambda[m]) * size(d) * size(d_[m]);
        return w * (g * as_pair(2 * lambda[m]));
    };
    DoublePair sum = -((w0 + w1) * (dot(d, d) * as_pair(2 * lambda[k])));
    terms = std::fabs((w0.hi + w1.hi) * 2 * lambda[k]) * q;
    if (k > 0) sum = sum + neighbour(k - 1, w0);
    if (k + 1 < n_) sum = sum + neighbour(k + 1, w1);
    if (f.x) {
        const PairVector f0 = vector_of_atom(f, atoms_[k]), f1 = vector_of_atom(f, atoms_[k + 1]);
        sum = sum + dot(d, combined(w1, f1, -w0, f0));
        terms += size(d) * (w1.hi * size(f1) + w0.hi * size(f0));
    }
    if (v.x) {
        const PairVector dv =
            combined(as_pair(1), vector_of_atom(v, atoms_[k + 1]), minus, vector_of_atom(v, atoms_[k]));
        const DoublePair square = dot(dv, dv);
        sum = sum + square;
        terms += square.hi;
    }
    return sum;
}

// Whether anything that stands in the equation of bond k is not zero; where nothing is, its residual is exactly zero.
bool ChainInverse::touched(const AtomArray &v, const AtomArray &f, const double *lambda, std::size_t k) const {
    const auto any = [&](const AtomArray &array) {
        return array.x &&
               (size(vector_of_atom(array, atoms_[k])) > 0 || size(vector_of_atom(array, atoms_[k + 1])) > 0);
    };
    return any(v) || any(f) || lambda[k] != 0 || (k > 0 && lambda[k - 1] != 0) || (k + 1 < n_ && lambda[k + 1] != 0);
}

std::vector<double> ChainInverse::error_bound(const AtomArray &v, const AtomArray &f, const double *lambda) const {
    check_finite(atoms_, v, f, lambda);
    // Each product and sum of the evaluation has a relative error below 2^-102 and there are fewer than 64 of them; a
    // box adds the same for lattice vectors up to 2^5 times as long as the bond. Among denormal numbers each is off by
    // up to the smallest number instead, before it is multiplied by at most one more vector and one more inverse mass;
    // that also covers what the sweeps of the inverse lose there.
    const double evaluation = 0x1p-90, denormal = 0x1p-1067;
    std::vector<double> bound(n_);
    for (std::size_t k = 0; k < n_; ++k) {
        double terms = 0;
        const double rest = std::fabs(rounded(residual(v, f, lambda, k, terms)));
        bound[k] = (rest + evaluation * terms) / bonds_[k].length;
        if (bound[k] < 0x1p-900 && touched(v, f, lambda, k))
            bound[k] += denormal * (1 + size(d_[k])) * (1 + w_[k] + w_[k + 1]) / std::fmin(bonds_[k].length, 1);
    }
    multiply_by_absolute_inverse(bound);
    // t = 2 lambda; one per cent for the rounding of this calculation, which has no differences in it.
    for (std::size_t k = 0; k < n_; ++k) {
        const double scale = 0.505 / bonds_[k].length;
        bound[k] = bound[k] > 0 ? bound[k] * scale + 0x1p-1074 : 0;
    }
    return bound;
}

}  // namespace holonomic
