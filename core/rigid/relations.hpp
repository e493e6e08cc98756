// Linear relations among atoms, sum c_i r_i = 0 with sum c_i = 0, in each coordinate: a site by its base, an atom that
// two bodies share, centroids that are one point. What they leave free is the span of constant vectors over the atoms.
// Fixed atoms among them, at coordinates that the caller has, are terms of the same sums.
#pragma once

#include <cstdint>
#include <vector>

#include "core/double_pair.hpp"

namespace holonomic::rigid {

struct Relations {
    std::int32_t n_atoms = 0;
    std::vector<double> c;  // [count()][n_atoms]
    std::int32_t n_fixed = 0;
    std::vector<double> of_fixed;  // [count()][n_fixed]
    std::int32_t count() const {
        return n_atoms > 0 ? static_cast<std::int32_t>(c.size() / static_cast<std::size_t>(n_atoms)) : 0;
    }
    const double *row(std::int32_t k) const { return c.data() + static_cast<std::ptrdiff_t>(k) * n_atoms; }
    double fixed(std::int32_t k, std::int32_t j) const {
        return of_fixed[static_cast<std::size_t>(k) * static_cast<std::size_t>(n_fixed) + static_cast<std::size_t>(j)];
    }
};

// Atoms that the others follow: r_i = sum_l of[i][l] r_leader[l] + sum_j of_fixed[i][j] r_fixed[j].
struct Leaders {
    std::vector<std::int32_t> atoms;     // ascending
    std::vector<DoublePair> of;          // [n_atoms][atoms]
    std::vector<DoublePair> of_fixed;    // [n_atoms][n_fixed]
    std::vector<std::int32_t> left_out;  // relations that the others imply, to `least`
};

// Gauss and Jordan's elimination, the largest coefficient first. least: what is left of a relation, of its largest
// coefficient, that counts as nothing.
Leaders leaders_of(const Relations &relations, double least);

}  // namespace holonomic::rigid
