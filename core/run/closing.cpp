#include "core/run/closing.hpp"

#include <algorithm>
#include <cmath>

#include "core/caller/box.hpp"
#include "core/caller/view.hpp"

namespace holonomic {

namespace {

void read(const MoleculeLane &lane, const AtomArray &r, std::int32_t i, double *x) {
    read_atom(r, atom_of(lane, i), x);
}

// No two atoms are so far from each other that another image than the one that is there could be the nearest.
bool compact(const Schedule &shape, const MoleculeLane &lane, const Images &images) {
    if (images.box->shape != Box::orthorhombic) return false;
    double low[3], high[3], x[3];
    read(lane, *images.r, shape.atom_of[shape.n_tree], low);
    for (int c = 0; c < 3; ++c) high[c] = low[c];
    for (std::int32_t s = shape.n_tree + 1; s < shape.n_atoms; ++s) {
        read(lane, *images.r, shape.atom_of[s], x);
        for (int c = 0; c < 3; ++c) {
            low[c] = std::min(low[c], x[c]);
            high[c] = std::max(high[c], x[c]);
        }
    }
    for (int c = 0; c < 3; ++c) {
        const double side = std::fabs(images.box->h[4 * c]);
        if (side != 0 && !(high[c] - low[c] < 0.499 * side)) return false;
    }
    return true;
}

}  // namespace

bool closes(const Schedule &shape, const MoleculeLane &lane, const Images &images, double *scratch) {
    if (compact(shape, lane, images)) return true;
    // Places without images, from one core atom on along the bonds; a bond between two that have theirs must fit.
    const std::int32_t n = shape.n_core_atoms, first = shape.n_tree;
    double *const place = scratch;
    std::int32_t *const stack = reinterpret_cast<std::int32_t *>(place + 3 * n), *const reached = stack + n;
    std::fill(reached, reached + n, 0);
    std::int32_t size = 1;
    stack[0] = 0;
    reached[0] = 1;
    for (int c = 0; c < 3; ++c) place[c] = 0;
    while (size > 0) {
        const std::int32_t a = stack[--size];
        double from[3], to[3], d[3];
        read(lane, *images.r, shape.atom_of[first + a], from);
        for (std::int32_t m = shape.meet_start[a]; m < shape.meet_start[a + 1]; ++m) {
            const std::int32_t bond = shape.meet[m] / 2, b = shape.from[bond] + shape.to[bond] - 2 * first - a;
            read(lane, *images.r, shape.atom_of[first + b], to);
            double length = 0, gap = 0;
            bond_vector(*images.box, from, to, d);
            for (int c = 0; c < 3; ++c) {
                const double there = place[3 * a + c] + d[c];
                if (!reached[b]) place[3 * b + c] = there;
                gap = std::max(gap, std::fabs(there - place[3 * b + c]));
                length = std::max(length, std::fabs(d[c]));
            }
            if (gap > 1e-3 * length) return false;
            if (!reached[b]) stack[size++] = b;
            reached[b] = 1;
        }
    }
    return true;
}

}  // namespace holonomic
