// Functions of phi on [phi_least, pi/2], as polynomials on panels that halve towards phi = 0.
#pragma once

#include <cstddef>
#include <vector>

namespace holonomic {

// One function for det^(-1/2), one for det^(+1/2).
struct PivotValues {
    long double of[2];
};

// phi by its sine and cosine, or anything proportional to them: neither end of 0 .. pi/2 loses digits.
struct PivotAngle {
    long double sine, cosine;
};

class Panels {
public:
    // Chebyshev nodes per panel: the nearest singularity lies on a Bernstein ellipse of parameter 4.6 or more, and
    // 4.6^-28 = 3e-19 is below the rounding of a 64-bit significand.
    static constexpr std::size_t order = 28;

    // Panels from pi/2 down to `least`, halving until they are shorter than the distance to the singularity.
    void divide(const PivotAngle &least, long double singularity);

    std::size_t size() const { return n_panels_ * order; }
    long double sine(std::size_t node) const;  // sin phi
    void set(std::size_t node, const PivotValues &values) { values_[node] = values; }

    // From the values g at the nodes to the means (1 / cos phi) times the integral of g from phi to pi/2; these are
    // scaled by a power of two, which is added to exponent[2].
    void integrate(long *exponent);

    PivotValues mean(const PivotAngle &at) const;

private:
    PivotValues series(std::size_t panel, long double x) const;

    std::size_t n_panels_ = 0;
    long double first_ = 0;            // width of the first panel: pi/2 - phi is in 0 .. first_
    std::vector<long double> edges_;   // phi at the ends of the other panels, decreasing
    std::vector<PivotValues> values_;  // g at the nodes, then coefficients of the integrals, panel after panel
    std::vector<PivotValues> before_;  // integral from the upper end of a panel to pi/2
};

}  // namespace holonomic
