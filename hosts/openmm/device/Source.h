// The text of the kernels for the kinds of molecules of a System, in OpenMM's common compute language.
#ifndef OPENMM_HOLONOMIC_SOURCE_H_
#define OPENMM_HOLONOMIC_SOURCE_H_

#include <string>
#include <vector>

#include "Kinds.h"

namespace OpenMM {

// So many molecules of one kind stand side by side in the arrays: the threads of a block.
constexpr int groupWidth = 64;

// Kernels solvePositions and solveVelocities. Data that they read:
//     groups      of groupWidth molecules of one kind: the kind, and where its atoms begin
//     atoms       [nAtoms + 1][groupWidth] of each group; the last row says where the molecule's parameters begin
//     parameters  inverse masses of the atoms, then inverse squares of the bonds' lengths
// The kernels are for the kinds from number first to number last - 1.
std::string kernelSource(const std::vector<MoleculesOfKind> &kinds, std::size_t first, std::size_t last);

// Room for a molecule in local memory; none: it stands in arrays for all of them.
struct LocalScratch {
    int nMixed, nReals;
};

// The kernel solvePositions or solveVelocities for molecules that blocks of blockSize threads solve, of any kind, by
// its plan. Data that it reads, instead of the groups: for each slot from firstBlock on where its plan, its atoms
// (followed by where its parameters begin), and its room in the arrays of scratch begin.
std::string blockSource(bool ofVelocities, int blockSize, int firstBlock, const LocalScratch &scratch);

// What all kernels begin with.
extern const char commonSource[];

}  // namespace OpenMM

#endif
