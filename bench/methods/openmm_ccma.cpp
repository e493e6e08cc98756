// OpenMM's CCMA (Eastman and Pande 2010, J. Chem. Theory Comput. 6, 434) on chains: one System with all of them.
#include <algorithm>

#include "methods.hpp"
#include "openmm_constraints.hpp"

namespace bench {

Methods openmm_ccma(Level level, const Problem &p, const std::vector<double> &tolerances, bool angles) {
    OpenmmInput input;
    // Setting it up takes a time that grows as the square of the bonds, half a minute for 20,000: of a pool as many
    // chains as make a few thousand.
    input.molecules_done = p.one_by_one ? std::clamp<std::size_t>(6000 / p.n(), 1, p.n_chains()) : p.n_chains();
    for (std::size_t c = 0; c < input.molecules_done; ++c) {
        const int base = static_cast<int>(p.first_atom(c));
        input.mass.insert(input.mass.end(), p.mass.begin(), p.mass.end());
        for (std::size_t k = 0; k < p.n(); ++k) {
            const int atom = base + static_cast<int>(k);
            input.pairs.push_back({atom, atom + 1});
            input.length.push_back(p.length[k]);
            if (!angles || k + 1 == p.n()) continue;
            const double *r = &p.r[3 * static_cast<std::size_t>(atom)];
            input.angles.push_back({atom, atom + 1, atom + 2});
            input.angle.push_back(angle_between(r, r + 3, r + 6));
        }
    }
    return openmm_methods("openmm-ccma", level, p, input, tolerances, angles ? " exact angles" : "");
}

}  // namespace bench
