/**
 * What every scene that is measured has, whatever is bonded: the state of its atoms, and how many bonds there are.
 */
#ifndef BENCH_SCENE_HPP
#define BENCH_SCENE_HPP

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace bench {

struct Scene {
    std::string name;         ///< column `problem` of results.csv
    std::int64_t chains = 0;  ///< in the arrays; or molecules
    std::int64_t bonds = 0;   ///< of a chain; of molecules that differ, the rounded mean
    bool one_by_one = false;  ///< a pool of single chains, each given to the method in a call of its own
    double dt = 0.005;
    std::vector<double> r;         ///< [atoms][3], on the constraints to rounding
    std::vector<double> raw_v;     ///< [atoms][3], normal; not on the constraints
    std::vector<double> v;         ///< [atoms][3], on the constraints
    std::vector<double> f;         ///< [atoms][3]
    std::vector<double> drifted;   ///< [atoms][3], r + dt v
    std::size_t bonds_of_all = 0;  ///< where the number differs from molecule to molecule; otherwise 0

    std::size_t n_chains() const { return static_cast<std::size_t>(chains); }
    std::size_t atoms() const { return r.size() / 3; }
    std::size_t all_bonds() const {
        return bonds_of_all > 0 ? bonds_of_all : n_chains() * static_cast<std::size_t>(bonds);
    }
    std::int64_t chains_per_call() const { return one_by_one ? 1 : chains; }
};

}  // namespace bench

#endif
