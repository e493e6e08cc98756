/** The bonds of a scene as a program would hand them to the library: in order, or in any order. */
#ifndef BENCH_METHODS_BOND_LIST_HPP
#define BENCH_METHODS_BOND_LIST_HPP

#include "../molecules/molecules.hpp"
#include "holonomic_chains.hpp"

namespace bench {

struct BondList {
    std::vector<double> mass;         ///< [atoms]
    std::vector<std::int64_t> pairs;  ///< [bonds][2]
    std::vector<double> lengths;      ///< [bonds]

    /// Molecule after molecule, the bonds of each ascending.
    explicit BondList(const Molecules &m);
    std::int64_t size() const { return static_cast<std::int64_t>(lengths.size()); }
    /// Puts the bonds in random order, either atom first. Returns where each went.
    std::vector<std::size_t> shuffle_bonds();
    /// Gives the atoms random numbers: as good as no two molecules are then numbered alike.
    void shuffle_atoms();
};

/// A handle with these bonds, added in one call.
Handle make_handle(const BondList &bonds, int threads);

}  // namespace bench

#endif
