/** How wrong a result is, per level, as results.csv has it. */
#ifndef BENCH_ERRORS_HPP
#define BENCH_ERRORS_HPP

#include <vector>

#include "method.hpp"
#include "methods/tridiagonal_system.hpp"

namespace bench {

/**
 * Solutions of a problem in 113-bit arithmetic, found once for all methods; of as many chains as make `bonds_at_most`
 * bonds, spread over all of them, and of one at least.
 */
class Reference {
public:
    Reference(const Problem &p, Level level, const UnitSystems *systems, std::size_t bonds_at_most);

    /**
     * acceleration: largest |lambda - exact| over the componentwise scale of tests/oracle/README.md, i.e. over what
     * relative changes of the inputs of size one can make of it: 1.1e-16 is one rounding of an input velocity: largest
     * |d.dv| over the root mean square of the velocities' components, unit bonds position:     largest |d.d - a^2| /
     * a^2 metric:       largest |ln det Z~ - exact| / |exact| solve:        largest over chains of max |x - exact| /
     * max |exact| A result that is not finite counts as infinite.
     */
    double error(const State &s) const;

private:
    const Problem &problem_;
    Level level_;
    std::vector<std::size_t> chains_;
    std::vector<double> exact_, exact_low_,
        scale_;  ///< of the chains above, one after the other; low: what exact_ lost
};

}  // namespace bench

#endif
