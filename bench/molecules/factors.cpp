#include <algorithm>

#include "elimination.hpp"

namespace bench {
namespace {

double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace

Factors::Factors(const Elimination &list)
    : list_(list), diagonal_(list.n()), lower_(list.row.size()), upper_(list.row.size()) {}

void Factors::assemble(const double *d) {
    if (list_.couplings.size() < lower_.size()) std::fill(lower_.begin(), lower_.end(), 0.0);
    for (std::size_t k = 0; k < list_.n(); ++k) diagonal_[k] = list_.w[k] * dot(d + 3 * k, d + 3 * k);
    for (const Elimination::Coupling &c : list_.couplings)
        lower_[at(c.entry)] = c.factor * dot(d + 3 * c.row, d + 3 * c.column);
}

void Factors::assemble(const double *d_new, const double *b) {
    if (list_.couplings.size() < lower_.size()) {
        std::fill(lower_.begin(), lower_.end(), 0.0);
        std::fill(upper_.begin(), upper_.end(), 0.0);
    }
    for (std::size_t k = 0; k < list_.n(); ++k) diagonal_[k] = list_.w[k] * dot(d_new + 3 * k, b + 3 * k);
    for (const Elimination::Coupling &c : list_.couplings) {
        lower_[at(c.entry)] = c.factor * dot(d_new + 3 * c.row, b + 3 * c.column);
        upper_[at(c.entry)] = c.factor * dot(d_new + 3 * c.column, b + 3 * c.row);
    }
}

void Factors::factor_symmetric(double *x) {
    const int *target = list_.target.data(), *row = list_.row.data();
    double *lower = lower_.data(), *diagonal = diagonal_.data();
    for (std::size_t k = 0; k < list_.n(); ++k) {
        const double inverse = diagonal[k] = 1 / diagonal[k], right = x ? x[k] : 0;
        const int end = list_.column[k + 1];
        for (int a = list_.column[k]; a < end; ++a) {
            const double value = lower[a], l = value * inverse;
            diagonal[row[a]] -= l * value;
            for (int b = a + 1; b < end; ++b) lower[*target++] -= l * lower[b];
            if (x) x[row[a]] -= l * right;
            lower[a] = l;
        }
    }
}

void Factors::factor(double *x) {
    const int *target = list_.target.data(), *row = list_.row.data();
    double *lower = lower_.data(), *upper = upper_.data(), *diagonal = diagonal_.data();
    for (std::size_t k = 0; k < list_.n(); ++k) {
        const double inverse = diagonal[k] = 1 / diagonal[k], right = x ? x[k] : 0;
        const int begin = list_.column[k], end = list_.column[k + 1];
        for (int a = begin; a < end; ++a) {
            const double l = lower[a] *= inverse;
            diagonal[row[a]] -= l * upper[a];
            if (x) x[row[a]] -= l * right;
        }
        for (int a = begin; a < end; ++a)
            for (int b = a + 1; b < end; ++b, ++target) {
                lower[*target] -= lower[b] * upper[a];
                upper[*target] -= lower[a] * upper[b];
            }
    }
}

void Factors::forward(double *x) const {
    for (std::size_t k = 0; k < list_.n(); ++k)
        for (int a = list_.column[k]; a < list_.column[k + 1]; ++a) x[list_.row[at(a)]] -= lower_[at(a)] * x[k];
}

void Factors::back_symmetric(double *x) const {
    for (std::size_t k = list_.n(); k-- > 0;) {
        double sum = x[k] * diagonal_[k];
        for (int a = list_.column[k]; a < list_.column[k + 1]; ++a) sum -= lower_[at(a)] * x[list_.row[at(a)]];
        x[k] = sum;
    }
}

void Factors::back(double *x) const {
    for (std::size_t k = list_.n(); k-- > 0;) {
        double sum = x[k];
        for (int a = list_.column[k]; a < list_.column[k + 1]; ++a) sum -= upper_[at(a)] * x[list_.row[at(a)]];
        x[k] = sum * diagonal_[k];
    }
}

}  // namespace bench
