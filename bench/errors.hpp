/** How wrong a result is, per level, as results.csv has it. */
#ifndef BENCH_ERRORS_HPP
#define BENCH_ERRORS_HPP

#include <vector>

#include "method.hpp"
#include "methods/tridiagonal_system.hpp"
#include "problem.hpp"

namespace bench {

/**
 * Solutions of a problem in 113-bit arithmetic, found once for all methods; of as many chains as make `bonds_at_most`
 * bonds, spread over all of them, and of one at least.
 */
class Reference {
public:
    Reference(const Problem &p, Level level, const UnitSystems *systems, std::size_t bonds_at_most);

    /**
     * Largest error of the first chains, `part` of all.
     *     acceleration: |lambda - exact| over the componentwise scale of tests/oracle/README.md, i.e. over what
     * relative changes of the inputs of size one can make of it: 1.1e-16 is one rounding of an input velocity: |d.dv|
     * over the root mean square of the velocities' components, unit bonds position:     |d.d - a^2| / a^2 metric: |ln
     * det Z~ - exact| / |exact| solve:        max |x - exact| / max |exact| of a chain A result that is not finite
     * counts as infinite.
     */
    double error(const State &s, double part = 1) const;

private:
    const Problem &problem_;
    Level level_;
    std::vector<std::size_t> chains_;
    std::vector<double> exact_, exact_low_,
        scale_;  ///< of the chains above, one after the other; low: what exact_ lost
};

}  // namespace bench

#endif
