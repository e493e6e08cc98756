// The periodic box and its inverse.
#pragma once

#include <cstdint>
#include <cstring>

#include "core/kernels/call.hpp"

namespace holonomic {

// A box and its vectors as they were given, of which image flags count.
struct Cell : Box {
    double given[9];  // zeros: no box
};

// h [9]: rows are the box vectors, a row of zeros is not periodic; null: no box. Throws Error.
Box make_box(const double *h);
Cell make_cell(const double *h);

// The box of a call. Of one that is not there nothing but that is read or copied: a box is larger than all that a call
// on one short chain reads.
inline void put_box(const Box &box, Box &of_call) {
    of_call.lattice = box.lattice;
    if (box.lattice != Box::none) of_call = box;
}

// The box vector along which opposite faces are nearer than twice this length, and how near; -1 if they are not.
int narrow_side(const Box &box, double longest_bond, double *width);

// One over the smallest distance between opposite faces; 0 without a box.
double steepest_gradient(const Box &box);

// How many bonds of at most this length a cycle must have at least to go round the box; 0: none does.
std::int64_t bonds_round(const Box &box, double longest_bond);

// How the box, and what follows it, changes: d(box)/dt = L box.
struct BoxRate {
    double L[9];
    double strain[6];  // d.(L d) is the sum over xx xy xz yy yz zz of these times the product of the components
};

inline double stretching(const BoxRate &rate, const double *d) {
    const double *const s = rate.strain;
    return d[0] * (s[0] * d[0] + s[1] * d[1] + s[2] * d[2]) + d[1] * (s[3] * d[1] + s[4] * d[2]) + d[2] * s[5] * d[2];
}

// L [9] or null: none. Throws Error.
BoxRate make_box_rate(const double *L);

// Replaces a bond vector by its minimum image.
void minimum_image(const Box &box, double *d);

// The minimum image of `to` - `from`.
inline void bond_vector(const Box &box, const double *from, const double *to, double *d) {
    for (int c = 0; c < 3; ++c) d[c] = to[c] - from[c];
    if (box.lattice != Box::none) minimum_image(box, d);
}

}  // namespace holonomic
