/** How wrong a result is for molecules of any topology: the measures of errors.hpp. */
#ifndef BENCH_MOLECULES_MOLECULE_ERRORS_HPP
#define BENCH_MOLECULES_MOLECULE_ERRORS_HPP

#include "../method.hpp"
#include "molecules.hpp"

namespace bench {

/**
 * For positions and velocities the constraints themselves. For accelerations, of bonds spread over the scene:
 * multipliers by Eigen's simplicial L D L^T in long double, refined once, and the componentwise scale of the tests'
 * references,
 * (|A^-1| S)_k / 2, S = |d|.(w|F| + w|F|) + |dv|^2 + |d.a_i| + |d.a_j|.
 */
class MoleculeReference {
public:
    MoleculeReference(const Molecules &m, Level level, std::size_t bonds_at_most);
    double error(const State &s) const;

private:
    struct Exact {
        std::size_t bond;
        long double lambda, scale;
    };
    void add_molecule(const Molecules::Place &place, std::size_t bonds_wanted);
    const Molecules &molecules_;
    Level level_;
    std::vector<Exact> exact_;
};

}  // namespace bench

#endif
