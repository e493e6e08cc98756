// Reduced rows of a lattice: three of its vectors whose cell is as wide as any of its cells.
#pragma once

namespace holonomic {

// Rows m[i] of a cell, of which `periodic` ones are vectors of the lattice; the others are perpendicular to these. Puts
// other vectors of the same lattice in their place if the narrowest distance of opposite faces grows by that. Returns
// false, with m as it was, if it does not.
bool reduce_cell(double m[3][3], const bool *periodic);

// Columns of the inverse: gradient i of fractional coordinate i. Returns the volume, with its sign.
double gradients_of(const double m[3][3], double g[3][3]);

}  // namespace holonomic
