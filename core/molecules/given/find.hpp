// Finds the molecules that a list of bonds forms.
#pragma once

#include <cstdint>
#include <vector>

#include "core/error.hpp"
#include "core/molecules/given/labels.hpp"
#include "core/molecules/given/masses.hpp"
#include "core/molecules/given/shape.hpp"

namespace holonomic {

// Bonds as they were given.
struct BondList {
    std::int64_t n_bonds;
    const std::int64_t *pairs;  // [n_bonds][2], counted from base
    int base;
    const Labels *labels = nullptr;  // of the atoms, for messages
    std::int64_t bonds_round = 0;    // a cycle of fewer can't go round the periodic box; 0: none can
};

// Atoms of a molecule are ordered along a linear chain, its lower end first, else they ascend; a fixed atom stands once
// for each of its bonds. Bonds are ordered along a linear chain, else by their lower and then their higher atom.
struct FoundMolecule {
    Topology topology;
    std::int32_t n_atoms, n_bonds, n_fixed;
    std::int64_t first_atom, first_bond;  // where its atoms and bonds begin in the lists
};

struct FoundMolecules {
    std::vector<FoundMolecule> molecules;     // in the order of their lowest movable atoms
    std::vector<std::int64_t> atoms;          // numbers in the caller's arrays, from 0
    std::vector<unsigned char> fixed;         // of each atom
    std::vector<std::int64_t> bonds;          // numbers in the list, from 0
    std::vector<std::int32_t> pairs;          // [][2] of each bond: places of its two atoms in the molecule, ascending
    std::vector<std::int64_t> unconstrained;  // bonds between two fixed atoms, which are in no molecule
    std::vector<std::int64_t> unconstrained_atoms;  // [][2]
};

// The list. Throws Error for numbers that are out of range and bonds of an atom with itself.
const BondList &checked(std::int64_t n_atoms, const BondList &list);

// O(n_bonds), and O(n_atoms) of very small constant if the list is long. Throws Error for numbers that are out of
// range, bonds of an atom with itself, bonds that are given twice and parts of molecules with more bonds than freedoms.
FoundMolecules find_molecules(const Masses &masses, std::int64_t n_atoms, const BondList &list);

// The error of a bond of the list.
Error bond_error(const BondList &list, Status status, std::int64_t bond, const char *what);

}  // namespace holonomic
