// A large molecule of linear parts at the position level: paths, which are worked on as chains are, and the junctions
// at which they end. Plain data, the same for every instruction set; core/molecules/planned/path_plan.hpp makes it.
#pragma once

#include <stdint.h>

namespace holonomic {

struct EliminationPlan;

struct PathPlan {
    // Bonds between consecutive atoms with consecutive numbers; no other bond is at an atom between them. A junction
    // finds the multipliers of bonds_of_end bonds at each end; where an end is free, there is no junction. The others
    // are the path's own; its own atoms are those between all of its bonds, and at free ends.
    static constexpr int32_t bonds_of_end = 2, shortest_path = 128, bonds_of_section = 512;
    struct Path {
        int32_t first_atom, first_bond, n_bonds;
        int32_t own, own_end;  // the bonds that are its own, counted from its first
        bool begins_free() const { return own == 0; }
        bool ends_free() const { return own_end == n_bonds; }
    };
    const Path *path;
    int32_t n_paths;

    // Own bonds of a path that one lane solves for, counted from its first bond. The longest come first.
    struct Section {
        int32_t path, from, end;
    };
    const Section *section;
    int32_t n_sections;

    // A junction: bonds that are in no path, the atoms at their ends and at those of paths, and of each path that ends
    // there an overlap, its first bonds from there. A bond is felt along an overlap no farther than the overlap
    // reaches; how far that is depends on the bonds, so there are elimination plans for several reaches.
    static constexpr int n_reaches = 3;
    static int32_t reach(int i) { return i == 0 ? 40 : i == 1 ? 56 : 98; }
    struct Overlap {
        int32_t path;
        bool backwards;  // from the path's last bond on
    };
    // Junctions that differ in nothing but masses and lengths. Local atoms are the junction's own, then those of the
    // overlaps, one overlap behind the other; bonds likewise.
    struct JunctionKind {
        const EliminationPlan *elimination[n_reaches];
        int32_t n_atoms, n_bonds, n_overlaps;
        int32_t first, count;                           // junctions
        int32_t first_atom, first_bond, first_overlap;  // of the first of them in the lists below
    };
    const JunctionKind *kind;
    int32_t n_kinds;
    const int32_t *atom, *bond;  // [n_atoms], [n_bonds] local ones of the molecule
    const Overlap *overlap;
    int32_t n_atoms, n_bonds;
};

}  // namespace holonomic
