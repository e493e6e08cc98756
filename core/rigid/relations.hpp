// Linear relations among atoms, sum c_i r_i = 0 with sum c_i = 0, in each coordinate: a site by its base, an atom that
// two bodies share, centroids that are one point. What they leave free is the span of constant vectors over the atoms.
#pragma once

#include <cstdint>
#include <vector>

#include "core/double_pair.hpp"

namespace holonomic::rigid {

struct Relations {
    std::int32_t n_atoms = 0;
    std::vector<double> c;  // [count()][n_atoms]
    std::int32_t count() const {
        return n_atoms > 0 ? static_cast<std::int32_t>(c.size() / static_cast<std::size_t>(n_atoms)) : 0;
    }
    const double *row(std::int32_t k) const { return c.data() + static_cast<std::ptrdiff_t>(k) * n_atoms; }
};

// Atoms that the others follow: r_i = sum_l of[i][l] r_leader[l].
struct Leaders {
    std::vector<std::int32_t> atoms;     // ascending
    std::vector<DoublePair> of;          // [n_atoms][atoms]
    std::vector<std::int32_t> left_out;  // relations that the others imply, to `least`
};

// Gauss and Jordan's elimination, the largest coefficient first. least: what is left of a relation, of its largest
// coefficient, that counts as nothing.
Leaders leaders_of(const Relations &relations, double least);

}  // namespace holonomic::rigid
