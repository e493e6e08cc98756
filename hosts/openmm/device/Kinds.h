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
    // Of what a block of threads solves: where each level of bonds begins that have no entries with each other, and
    // where the last one ends. Empty: for one thread.
    std::vector<int> levels;

    bool isForBlock() const { return !levels.empty(); }
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

// The molecules of chains that a device can solve: the kinds for one thread, then those with more than
// maxEntriesOfThread entries, which are for a block of threads; the largest of each first. Left out are rigid bodies,
// which the library alone recognises, and what eliminateByLevels leaves out.
std::vector<MoleculesOfKind> sortedByKind(const hol_chains *chains, std::size_t maxEntriesOfThread);

}  // namespace OpenMM

#endif
