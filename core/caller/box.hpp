// The periodic box and its inverse.
#ifndef HOLONOMIC_BOX_HPP
#define HOLONOMIC_BOX_HPP

#include "core/kernels/call.hpp"

namespace holonomic {

// h [9]: rows are the box vectors, a row of zeros is not periodic; null: no box. Throws Error.
Box make_box(const double *h);

// Replaces a bond vector by its minimum image.
void minimum_image(const Box &box, double *d);

}  // namespace holonomic
#endif
