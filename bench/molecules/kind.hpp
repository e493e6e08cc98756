/**
 * One kind of molecule: which atoms its bonds join, its masses and lengths, and how to draw a conformation.
 */
#ifndef BENCH_MOLECULES_KIND_HPP
#define BENCH_MOLECULES_KIND_HPP

#include <cstdint>
#include <string>
#include <vector>

#include "random.h"

namespace bench {

struct Kind {
    std::vector<int> first, second;  ///< atoms of each bond, first < second; bonds ascend by first, then by second
    std::vector<double> length;      ///< [bonds]
    std::vector<double> mass, w;     ///< [atoms]
    std::vector<std::vector<int>> polygons;  ///< atoms drawn as regular polygons; the first is there before the others
    bool closed_walk = false;                ///< all atoms are one ring, drawn as a closed random walk
    bool chemical = false;  ///< drawn with the angles that the numbers of neighbours ask for, otherwise at random

    std::size_t n_atoms() const { return mass.size(); }
    std::size_t n_bonds() const { return length.size(); }
};

/// Collects atoms and bonds in any order.
class KindMaker {
public:
    int atom(double mass);
    int atom(double mass, int bonded_to, double length);
    void bond(int i, int j, double length);
    Kind kind;  ///< unsorted until done() is called
    Kind done();
};

/// SPC/E, three distances; nm, atomic mass units.
Kind water_kind();
/**
 * Atoms with all their bonds, written like SMILES with all hydrogens: "C(H)(H)(H)C(H)(H)H" is ethane, a digit opens and
 * closes a ring. Lengths by elements; nm, atomic mass units.
 */
Kind formula_kind(const std::string &formula);
/// Residues in random order, all bonds rigid, of about so many bonds.
Kind protein_kind(std::int64_t n_bonds);

// Of beads with general masses over one decade and unit bonds.
Kind dendrimer_kind(int core, int branching, int generations);
/// A backbone of so many atoms, each with a side chain of so many.
Kind comb_kind(int backbone, int side);
Kind ring_kind(int n_atoms);
/// Atoms in a row with the distances to the next and to the next but one fixed: rigid angles.
Kind triangles_kind(int n_atoms);
/// Linear segments of so many bonds, joined as a random tree.
Kind arms_kind(std::int64_t n_bonds, std::int64_t segment);
/// Every atom is bonded to one before it, chosen at random, none to more than four.
Kind random_tree_kind(std::int64_t n_bonds);

/// A conformation with these lengths, to a few digits where it is a closed walk; r [atoms][3].
void place_atoms(const Kind &kind, random_stream &s, double *r);

}  // namespace bench

#endif
