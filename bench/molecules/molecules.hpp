/**
 * Scenes of molecules of any topology: each of a kind, one after the other in the arrays, with the state of its atoms.
 */
#ifndef BENCH_MOLECULES_MOLECULES_HPP
#define BENCH_MOLECULES_MOLECULES_HPP

#include <string>
#include <vector>

#include "../scene.hpp"
#include "kind.hpp"

namespace bench {

struct Molecules : Scene {
    struct Place {
        std::size_t kind, atom, bond;  ///< atom, bond: the molecule's first
    };
    std::vector<Kind> kinds;
    std::vector<Place> places;  ///< [molecules]
    std::vector<double> mass;   ///< [atoms]
    std::string source;         ///< file that the bonds were read from; empty: they are made

    const Kind &kind_of(const Place &place) const { return kinds[place.kind]; }
    /// Appends a molecule; its atoms have no position yet.
    void add(std::size_t kind);
};

/// `molecules` molecules of the given kinds in turns. Chemical ones at 300 K with dt = 2 fs (nm, ps, kJ/mol), others
/// with kT = 1, dt = 0.005.
Molecules make_molecules(const std::string &name, const std::vector<Kind> &kinds, std::int64_t molecules);

/// Velocities, forces and drifted positions for positions that nearly have the lengths of the bonds; they are put on
/// the constraints first.
void set_in_motion(Molecules &m, random_stream &s);

/**
 * The molecules of a file that a simulation program's distribution brings, with the bonds that are usually held rigid;
 * `name` is one of real_scenes(). Lengths are the means over the bonds of a type. Returns false if the file is missing.
 */
bool read_molecules(const std::string &name, Molecules &m);
const std::vector<std::string> &real_scenes();

}  // namespace bench

#endif
