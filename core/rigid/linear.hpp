// Groups of atoms on a line or in a plane that share atoms, bodies that share atoms, and bonds of length zero: as
// linear relations, with the distances that they leave.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/rigid/bodies.hpp"

namespace holonomic::rigid {

// Atoms that have these coordinates in a frame that moves, and of which the first ones of a base determine the others.
struct LinearGroup {
    std::vector<std::int64_t> atoms;
    std::vector<double> coordinates;  // [..][3]
    int dimension;                    // 0: all at one point
};

// Parts as bodies are given; where parts are rigid bodies, too, these have no relations.
struct AffineParts {
    struct Distance {
        std::int64_t i, j;
        double length;
    };
    std::vector<AffinePart> affine;
    std::vector<std::vector<std::int64_t>> fixed;  // atoms that relations of each have; or empty: none has any
    std::vector<Distance> hidden;
    std::vector<std::pair<std::int64_t, std::int64_t>> links;
    std::vector<std::int64_t> held;  // bonds that bodies hold which are affine parts now, ascending
};

// sum c_i r_i = 0. Without coefficients: these atoms are of one part.
struct LinearRelation {
    std::vector<std::int64_t> atoms;
    std::vector<double> c;
    std::vector<std::int64_t> fixed{};
    std::vector<double> of_fixed{};
};
// Of the atoms of a group, by d + 1 of them that are far from each other, and from a line and a plane; those first.
struct GroupRelations {
    std::vector<std::int64_t> base;
    std::vector<LinearRelation> relations;
};
GroupRelations relations_of(const LinearGroup &group);

// What hangs together through atoms. Atoms are any numbers.
class LinearParts {
public:
    // least: as in leaders_of.
    LinearParts(const std::vector<LinearRelation> &all, double least);
    static LinearParts of_groups(const std::vector<LinearGroup> &groups);

    const std::vector<std::vector<std::int64_t>> &parts() const { return parts_; }  // atoms of each
    const std::vector<Relations> &relations() const { return relations_; }          // of each
    const std::vector<Leaders> &leaders() const { return leaders_; }                // of each
    const std::vector<std::vector<std::int64_t>> &fixed() const { return fixed_; }  // atoms that they have
    // An atom's part, and its place in it; null if it is in none.
    struct Membership {
        std::size_t part, atom;
        bool leads;
    };
    const Membership *find(std::int64_t atom) const {
        const auto found = membership_of_.find(atom);
        return found == membership_of_.end() ? nullptr : &found->second;
    }

    std::int64_t left_out() const { return left_out_; }  // a relation that others imply; -1

private:
    std::vector<std::vector<std::int64_t>> parts_, fixed_;
    std::vector<Relations> relations_;
    std::vector<Leaders> leaders_;
    std::unordered_map<std::int64_t, Membership> membership_of_;
    std::int64_t left_out_ = -1;
};

// Bodies as they are given, of which some share atoms: these as affine parts, behind the others, with the distances of
// their bases. Throws Error, naming the atoms, where two bodies have two atoms at different distances.
struct JoinedBodies {
    std::vector<std::int64_t> sizes, atoms;
    std::vector<double> coordinates;
    AffineParts parts;
};
bool share_atoms(std::int64_t n_bodies, const std::int64_t *sizes, const std::int64_t *atoms);
JoinedBodies join_bodies(std::int64_t n_bodies, const std::int64_t *sizes, const std::int64_t *atoms,
                         const double *coordinates, std::int64_t n_bonds, const std::int64_t *pairs,
                         const double *lengths);

}  // namespace holonomic::rigid
