#include "core/partition/partition_panels.hpp"

#include <cmath>

namespace holonomic {

namespace {

using real = long double;
constexpr std::size_t order = Panels::order;
const real pi = 3.14159265358979323846264338327950288L;
const real first_edge = pi / 6;  // the first panel is even in pi/2 - phi and may be wider than the others

struct Tables {
    real node[order];           // Chebyshev nodes on (-1, 1)
    real cosine[order][order];  // from values to coefficients
    Tables() {
        const real n = static_cast<real>(order);
        for (std::size_t j = 0; j < order; ++j) {
            const real angle = pi * (static_cast<real>(j) + 0.5L) / n;
            node[j] = std::cos(angle);
            for (std::size_t k = 0; k < order; ++k)
                cosine[k][j] = (k == 0 ? 1 : 2) / n * std::cos(static_cast<real>(k) * angle);
        }
    }
};

const Tables &tables() {
    static const Tables t;
    return t;
}

// Chebyshev coefficients of (1/u) integral_0^u of sum a_k T_2k(u), again in T_2k.
void average_even(const real *a, real *c) {
    real odd[order];  // the integral in T_{2k+1}
    odd[0] = a[0] - a[1] / 2;
    for (std::size_t k = 1; k < order; ++k)
        odd[k] = (a[k] - (k + 1 < order ? a[k + 1] : 0)) / (2 * static_cast<real>(2 * k + 1));
    real s = 0;  // T_{2k+1}(u)/u = 2 T_2k - T_{2k-1}(u)/u
    for (std::size_t k = order; k-- > 0;) {
        s = odd[k] - s;
        c[k] = k == 0 ? s : 2 * s;
    }
}

// Chebyshev coefficients of integral_x^1 of sum a_k T_k. The highest one is dropped: it is below rounding.
void integrate_down(const real *a, real *c) {
    real at_one = 0;
    for (std::size_t k = 1; k < order; ++k) {
        const real above = k + 1 < order ? a[k + 1] : 0;
        c[k] = -((k == 1 ? 2 : 1) * a[k - 1] - above) / (2 * static_cast<real>(k));
        at_one -= c[k];
    }
    c[0] = at_one;  // the integral vanishes at x = 1
}

}  // namespace

void Panels::divide(const PivotAngle &end, real singularity) {
    const real least = std::atan2(end.sine, end.cosine);
    edges_.clear();
    first_ = std::atan2(end.cosine, end.sine);
    if (least < first_edge) {
        first_ = pi / 2 - first_edge;
        edges_.push_back(first_edge);
        real edge = first_edge;
        while (edge / 2 > least && edge > 0.8L * singularity) edges_.push_back(edge /= 2);
        edges_.push_back(least);
    }
    n_panels_ = edges_.empty() ? 1 : edges_.size();
    values_.resize(size());
    before_.assign(n_panels_, {{0, 0}});
}

real Panels::sine(std::size_t node) const {
    const std::size_t panel = node / order;
    const real x = tables().node[node % order];
    if (panel == 0) return std::cos(first_ * std::sqrt((1 + x) / 2));
    const real high = edges_[panel - 1], low = edges_[panel];
    return std::sin((high + low) / 2 + x * ((high - low) / 2));
}

void Panels::integrate(long *exponent) {
    const Tables &t = tables();
    for (std::size_t panel = 0; panel < n_panels_; ++panel) {
        PivotValues *g = &values_[panel * order];
        for (int f = 0; f < 2; ++f) {
            real a[order], c[order];
            for (std::size_t k = 0; k < order; ++k) {
                real sum = 0;
                for (std::size_t j = 0; j < order; ++j) sum += t.cosine[k][j] * g[j].of[f];
                a[k] = sum;
            }
            if (panel == 0)
                average_even(a, c);
            else
                integrate_down(a, c);
            for (std::size_t k = 0; k < order; ++k) g[k].of[f] = c[k];
        }
        if (panel + 1 == n_panels_) break;
        const PivotValues end = series(panel, panel == 0 ? 1 : -1);
        const real length = panel == 0 ? first_ : (edges_[panel - 1] - edges_[panel]) / 2;
        for (int f = 0; f < 2; ++f) before_[panel + 1].of[f] = before_[panel].of[f] + length * end.of[f];
    }
    for (int f = 0; f < 2; ++f) {  // no overflow, however long the chain
        int e;
        std::frexp(values_[0].of[f], &e);
        exponent[f] += e;
        for (PivotValues &v : values_) v.of[f] = std::ldexp(v.of[f], -e);
        for (PivotValues &v : before_) v.of[f] = std::ldexp(v.of[f], -e);
    }
}

PivotValues Panels::series(std::size_t panel, real x) const {  // Clenshaw's recurrence
    const PivotValues *c = &values_[panel * order];
    PivotValues b1 = {{0, 0}}, b2 = {{0, 0}};
    for (std::size_t k = order - 1; k > 0; --k)
        for (int f = 0; f < 2; ++f) {
            const real b = c[k].of[f] + (2 * x * b1.of[f] - b2.of[f]);
            b2.of[f] = b1.of[f];
            b1.of[f] = b;
        }
    return {{c[0].of[0] + (x * b1.of[0] - b2.of[0]), c[0].of[1] + (x * b1.of[1] - b2.of[1])}};
}

PivotValues Panels::mean(const PivotAngle &at) const {
    const real theta = std::atan2(at.cosine, at.sine);  // pi/2 - phi
    if (theta <= first_ || n_panels_ == 1) {
        const real u = theta / first_;
        const PivotValues j = series(0, 2 * u * u - 1);
        const real factor = theta > 0 ? theta / std::sin(theta) : 1;
        return {{factor * j.of[0], factor * j.of[1]}};
    }
    const real phi = std::atan2(at.sine, at.cosine);
    std::size_t panel = 1;
    while (panel + 1 < n_panels_ && phi < edges_[panel]) ++panel;
    const real high = edges_[panel - 1], low = edges_[panel], half = (high - low) / 2;
    const PivotValues j = series(panel, (phi - (high + low) / 2) / half);
    const real secant = std::hypot(at.sine, at.cosine) / at.cosine;
    PivotValues mean;
    for (int f = 0; f < 2; ++f) mean.of[f] = secant * (before_[panel].of[f] + half * j.of[f]);
    return mean;
}

}  // namespace holonomic
