/** What is read of the files in which simulation programs keep their molecules. */
#ifndef BENCH_MOLECULES_TOPOLOGY_FILES_HPP
#define BENCH_MOLECULES_TOPOLOGY_FILES_HPP

#include <array>
#include <string>
#include <vector>

namespace bench {

/// Atoms in the order of their numbers, from 0 on; nm, atomic mass units.
struct TopologyFile {
    struct Bond {
        int i, j, type;
    };
    std::vector<double> mass;
    std::vector<std::array<double, 3>> r;
    std::vector<Bond> bonds;
    std::array<double, 3> box = {0, 0, 0};  ///< 0: not known
};

/// A data file of LAMMPS, packed by gzip if its name ends so; `charges`: whether its atoms have a column for them.
TopologyFile read_lammps_data(const std::string &name, bool charges);
/// Coordinates of GROMACS that hold nothing but water.
TopologyFile read_water_gro(const std::string &name);

}  // namespace bench

#endif
