// Theory (42)-(49). The mean is a Markov chain in Omega: with w_n = gamma_n / Omega_{n-1} one has Omega_n^2 = 1 -
// w_n^2, and what the bonds n..N contribute, given Omega_{n-1}, is the mean of Omega_n^p times the next such mean over
// 0 < w_n < sqrt(x_n) / Omega_{n-1}. The substitution w_n = B_n cos phi, with B_n the backward Omega of the straight
// chain, moves all singularities of these functions to the line Re phi = 0, so that panels which halve towards phi = 0
// converge geometrically whatever the masses.
#include "core/partition/partition_operator.hpp"

#include <cmath>
#include <vector>

#include "core/partition/partition_panels.hpp"

namespace holonomic {

namespace {

using real = long double;

// B_n and C_n = sqrt(1 - B_n^2), from sums of masses: nothing cancels.
class StraightChain {
public:
    StraightChain(const real *masses, std::size_t n_bonds)
        : m_(masses), last_(n_bonds), inner_(n_bonds + 1, 0), infinite_end_(std::isinf(masses[n_bonds])) {
        for (std::size_t i = last_; i-- > 1;) inner_[i] = inner_[i + 1] + m_[i];
        least_.assign(last_ + 1, {1, 0});
        for (std::size_t n = 1; n < last_; ++n) {
            const real b = std::sqrt(b2(n)) * least_[n].sine, c = std::sqrt(c2(n)), omega = std::hypot(b, c);
            least_[n + 1] = {b / omega, c / omega};
        }
    }

    real b2(std::size_t n) const {
        if (n == last_) return 1;
        if (n == 1 && std::isinf(m_[0])) return infinite_end_ ? 0 : m_[1] / sum(1);
        return m_[n] / (m_[n - 1] + m_[n]) * (infinite_end_ ? 1 : sum(n - 1) / sum(n));
    }
    real c2(std::size_t n) const {
        if (n == last_) return 0;
        const real share = n == 1 && std::isinf(m_[0]) ? 1 : m_[n - 1] / (m_[n - 1] + m_[n]);
        return share * (infinite_end_ ? 1 : sum(n + 1) / sum(n));
    }

    // Smallest phi_n that a conformation reaches, i.e. that of the straight chain.
    PivotAngle least(std::size_t n) const { return least_[n]; }

    // Distance from phi_n = 0, where the functions are analytic, to their nearest singularity (n >= 2): there the chain
    // without its last atom is singular.
    real singularity(std::size_t n) const {
        if (n == last_) return 4;  // none; farther than any panel reaches
        const real share = infinite_end_ ? 1 : m_[last_] / sum(n - 1);
        return std::asinh(std::sqrt(share * (m_[n - 1] / inner_[n])));
    }

private:
    real sum(std::size_t n) const { return (n == 0 ? m_[0] + inner_[1] : inner_[n]) + m_[last_]; }

    const real *m_;
    std::size_t last_;
    std::vector<real> inner_;  // masses n .. N-1
    std::vector<PivotAngle> least_;
    bool infinite_end_;
};

}  // namespace

PivotMeans pivot_means(const long double *masses, std::size_t n_bonds) {
    if (n_bonds == 1) return {0, 0};
    const StraightChain straight(masses, n_bonds);
    Panels panels, next;
    long exponent[2] = {0, 0};
    for (std::size_t n = n_bonds; n >= 2; --n) {
        const real b = std::sqrt(straight.b2(n)), c2 = straight.c2(n), c = std::sqrt(c2);
        panels.divide(straight.least(n), straight.singularity(n));
        for (std::size_t i = 0; i < panels.size(); ++i) {
            const real s = panels.sine(i), bs = b * s, omega = std::sqrt(c2 + bs * bs);
            PivotValues mean = {{1, 1}};
            if (n < n_bonds) mean = next.mean({bs, c});  // tan phi_{n+1} = B_n sin phi_n / C_n
            panels.set(i, {{mean.of[0] * (s / omega), mean.of[1] * (s * omega)}});
        }
        panels.integrate(exponent);
        std::swap(panels, next);
    }
    const PivotValues total = next.mean({std::sqrt(straight.b2(1)), std::sqrt(straight.c2(1))});  // from Omega_1 = 1
    const real ln2 = std::log(real(2));
    return {std::log(total.of[0]) + static_cast<real>(exponent[0]) * ln2,
            std::log(total.of[1]) + static_cast<real>(exponent[1]) * ln2};
}

}  // namespace holonomic
