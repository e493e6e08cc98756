// Theory (33)-(36): elimination on unit bonds with the deficits of the rows carried instead of the diagonal, so that
// nothing is subtracted; then products of its multipliers.
#include "core/inverse/chain_inverse.hpp"

#include <algorithm>
#include <cmath>

#include "core/inverse/bond_vectors.hpp"

namespace holonomic {

ChainInverse::ChainInverse(const Chains &chains, std::int64_t chain, const AtomArray &r)
    : Inverse(chains.base), n_(static_cast<std::size_t>(chains.molecule(chain).n_bonds)), atoms_(n_ + 1), w_(n_ + 1),
      d_(bond_vectors(chains.molecule(chain), r, chains.box)), bonds_(n_), largest_row_(1) {
    const Molecule m = chains.molecule(chain);
    for (std::size_t k = 0; k <= n_; ++k) {
        atoms_[k] = m.atom(static_cast<std::int64_t>(k));
        w_[k] = m.w(static_cast<std::int64_t>(k));
    }
    std::vector<BondAngle> joints(n_ + 1, BondAngle{0, 1});  // k: between bonds k-1 and k
    ScaledBond before{};
    bool good = true;
    for (std::size_t k = 0; k < n_; ++k) {
        const ScaledBond here = scaled(d_[k]);
        if (k > 0) joints[k] = angle_between(before, here);
        bonds_[k].length = std::scalbn(here.length, here.exponent);
        good = good && here.length > 0 && std::isfinite(here.length);
        before = here;
    }
    const auto coupling = [&](std::size_t k) { return w_[k] * std::fabs(joints[k].cosine); };  // p of theory (25)
    const auto deficit = [&](std::size_t k) {
        return w_[k] * joints[k].complement + w_[k + 1] * joints[k + 1].complement;
    };
    // What is carried from bond to bond has twice the digits: along a straight chain each step would round it the same
    // way.
    DoublePair e = as_pair(0), pivot = as_pair(1);
    for (std::size_t k = 0; k < n_; ++k) {
        EliminatedBond &b = bonds_[k];
        b.root = std::sqrt(w_[k] + w_[k + 1]);
        const DoublePair l = k == 0 ? as_pair(0) : as_pair(coupling(k)) / pivot;
        e = as_pair(deficit(k)) + l * e;
        pivot = e + as_pair(k + 1 < n_ ? coupling(k + 1) : 0);
        b.l = rounded(l);
        b.l_rest = rounded(l - as_pair(b.l));
        b.inverse = rounded(e);
        b.pivot = pivot;
        good = good && rounded(pivot) > 0 && std::isfinite(rounded(pivot));
        if (!good) break;
    }
    if (!good) refuse(chains, chain, r);
    DoublePair rest = as_pair(0);  // R of theory (33)
    for (std::size_t k = n_; k-- > 0;) {
        if (k + 1 < n_) {
            const double p = coupling(k + 1);
            const DoublePair sum = as_pair(deficit(k + 1)) + rest;
            rest = p == 0 ? as_pair(0) : as_pair(p) * (sum / (sum + as_pair(p)));
        }
        bonds_[k].inverse = 1 / (bonds_[k].inverse + rounded(rest));
        good = good && std::isfinite(bonds_[k].inverse);
        double row = 1;
        if (k > 0) row += coupling(k) / (bonds_[k].root * bonds_[k - 1].root);
        if (k + 1 < n_) row += coupling(k + 1) / (bonds_[k].root * bonds_[k + 1].root);
        largest_row_ = std::max(largest_row_, row);
    }
    if (!good) refuse(chains, chain, r);
    for (std::size_t k = 1; k < n_; ++k) bonds_[k].l = std::copysign(bonds_[k].l, joints[k].cosine);
}

// Z~^-1 = S M^-1 S with S_k = sqrt(M_kk), Z^-1 the same with S_k = 1 / (2 |d_k|).
double ChainInverse::scale(bool physical, std::size_t k) const {
    return physical ? 0.5 / bonds_[k].length : bonds_[k].root;
}

// From an element on the diagonal upwards in its column: (M^-1)_{k-1,j} = l_k (M^-1)_kj. The product is kept in range,
// as its end may be needed times a large scale.
class ChainInverse::Walk {
public:
    Walk(const ChainInverse &inverse, bool physical, std::size_t j)
        : inverse_(inverse), physical_(physical), at_(j), exponent_(0),
          product_(inverse.bonds_[j].inverse * inverse.scale(physical, j)) {}
    double value() const {
        const double value = product_ * inverse_.scale(physical_, at_);
        return exponent_ == 0 ? value : std::scalbn(value, exponent_);
    }
    void up() {
        product_ *= inverse_.bonds_[at_--].l;
        if (std::fabs(product_) < 0x1p-500 && product_ != 0) {
            product_ *= 0x1p500;
            exponent_ -= 500;
        }
    }

private:
    const ChainInverse &inverse_;
    bool physical_;
    std::size_t at_;
    int exponent_;
    double product_;
};

double ChainInverse::entry(bool physical, std::int64_t i, std::int64_t j) const {
    check(i);
    check(j);
    Walk walk(*this, physical, static_cast<std::size_t>(std::max(i, j)));
    for (std::int64_t steps = std::max(i, j) - std::min(i, j); steps > 0; --steps) walk.up();
    return walk.value();
}

void ChainInverse::row(bool physical, std::int64_t i, double *out) const {
    check(i);
    const std::size_t row = static_cast<std::size_t>(i);
    Walk walk(*this, physical, row);
    for (std::size_t k = row;; --k) {
        out[k] = walk.value();
        if (k == 0) break;
        walk.up();
    }
    // To the right of the diagonal each element has a diagonal of its own; the product of l is common.
    double product = scale(physical, row);
    int exponent = 0;
    for (std::size_t j = row + 1; j < n_; ++j) {
        product *= bonds_[j].l;
        if (std::fabs(product) < 0x1p-500 && product != 0) {
            product *= 0x1p500;
            exponent -= 500;
        }
        const double value = product * (bonds_[j].inverse * scale(physical, j));
        out[j] = exponent == 0 ? value : std::scalbn(value, exponent);
    }
}

void ChainInverse::band(bool physical, std::int64_t width, double *out) const {
    if (width < 0)
        throw make_error(Status::value, "width is %lld; it must be at least 0", static_cast<long long>(width));
    const std::size_t columns = static_cast<std::size_t>(width) + 1;
    for (std::size_t j = 0; j < n_; ++j) {
        Walk walk(*this, physical, j);
        for (std::size_t k = 0; k < columns && k <= j; ++k) {
            if (k > 0) walk.up();
            out[(j - k) * columns + k] = walk.value();
        }
    }
    for (std::size_t i = 0; i < n_; ++i)
        for (std::size_t k = n_ - i; k < columns; ++k) out[i * columns + k] = 0;
}

void ChainInverse::matrix(bool physical, double *out) const {
    for (std::size_t j = 0; j < n_; ++j) {
        Walk walk(*this, physical, j);
        for (std::size_t i = j;; --i) {
            out[i * n_ + j] = out[j * n_ + i] = walk.value();
            if (i == 0) break;
            walk.up();
        }
    }
}

// x becomes |M^-1| x for x >= 0. Sums have twice the digits, as those of the elimination have: equal joints round them
// all the same way.
void ChainInverse::multiply_by_absolute_inverse(std::vector<double> &x) const {
    const auto factor = [&](std::size_t k) { return as_pair(std::fabs(bonds_[k].l)) + as_pair(bonds_[k].l_rest); };
    std::vector<DoublePair> sums(n_);
    for (std::size_t k = 0; k < n_; ++k) sums[k] = k == 0 ? as_pair(x[0]) : as_pair(x[k]) + factor(k) * sums[k - 1];
    DoublePair above = as_pair(0);
    for (std::size_t k = n_; k-- > 0;) {
        const DoublePair sum = sums[k] / bonds_[k].pivot;
        above = k + 1 < n_ ? sum + factor(k + 1) * above : sum;
        x[k] = rounded(above);
    }
}

double ChainInverse::condition() const {
    std::vector<double> x(n_);
    for (std::size_t k = 0; k < n_; ++k) x[k] = bonds_[k].root;
    multiply_by_absolute_inverse(x);
    double largest = 0;
    for (std::size_t k = 0; k < n_; ++k) largest = std::max(largest, bonds_[k].root * x[k]);
    return largest_row_ * largest;
}

}  // namespace holonomic
