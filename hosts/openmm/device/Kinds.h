// Molecules sorted by the graph of their constraints: those of one kind are solved by the same statements.
#ifndef OPENMM_HOLONOMIC_KINDS_H_
#define OPENMM_HOLONOMIC_KINDS_H_

#include <holonomic.h>

#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

namespace OpenMM {

// Bonds stand in the order of their elimination, each between two atoms of the molecule.
struct Kind {
    int nAtoms;
    std::vector<std::pair<int, int>> bonds;
    // Pairs of bonds, first < second, whose entry in the matrix of the multipliers is not 0: those that share an atom,
    // and what the elimination fills.
    std::vector<std::pair<int, int>> entries;

    bool operator<(const Kind &other) const { return std::tie(nAtoms, bonds) < std::tie(other.nAtoms, other.bonds); }
};

struct Molecule {
    std::int64_t number;          // that the library has given it
    std::vector<int> atoms;       // in the order of its Kind
    std::vector<double> lengths;  // in the order of the bonds of its Kind
};

struct MoleculesOfKind {
    Kind kind;
    std::vector<Molecule> molecules;
};

// The molecules of chains that a work-item of a device can solve alone, the largest kinds first. Left out are rigid
// bodies, which the library alone recognises, and what would take more than maxEntries entries.
std::vector<MoleculesOfKind> sortedByKind(const hol_chains *chains, std::size_t maxEntries);

}  // namespace OpenMM

#endif
