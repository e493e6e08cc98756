// Groups of atoms on a line or in a plane that share atoms, bodies that share atoms, and bonds of length zero: as linear
// relations, with the distances that they leave.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/rigid/bodies.hpp"

namespace holonomic::rigid {

// Atoms that have these places in a frame that moves, and of which the first ones of a base determine the others.
struct LinearGroup {
    std::vector<std::int64_t> atoms;
    std::vector<double> places;  // [..][3]
    int dimension;               // 0: all at one point
};

// Parts as bodies are given; where parts are rigid bodies, too, these have no relations.
struct LooseParts {
    struct Distance {
        std::int64_t i, j;
        double length;
    };
    std::vector<Loose> loose;
    std::vector<Distance> hidden;
    std::vector<std::pair<std::int64_t, std::int64_t>> links;
};

// What holds together of groups. Atoms are any numbers.
class Linear {
public:
    explicit Linear(const std::vector<LinearGroup> &groups);

    const std::vector<std::vector<std::int64_t>> &parts() const { return parts_; }  // atoms of each
    const std::vector<Relations> &relations() const { return relations_; }          // of each
    const std::vector<Leaders> &leaders() const { return leaders_; }                // of each
    // An atom's part, and its place in it; null if it is in none.
    struct Place {
        std::size_t part, atom;
        bool leads;
    };
    const Place *find(std::int64_t atom) const {
        const auto found = place_of_.find(atom);
        return found == place_of_.end() ? nullptr : &found->second;
    }

private:
    std::vector<std::vector<std::int64_t>> parts_;
    std::vector<Relations> relations_;
    std::vector<Leaders> leaders_;
    std::unordered_map<std::int64_t, Place> place_of_;
};

// d + 1 atoms of a group that are far from each other, and far from a line and a plane.
std::vector<std::size_t> base_of(const LinearGroup &group);

}  // namespace holonomic::rigid
