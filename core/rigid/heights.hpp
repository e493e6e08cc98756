// Coordinates by squared distances: Cholesky's factors of the inner products from atom 0, the largest remaining height
// first.
#pragma once

#include <cstdint>
#include <vector>

namespace holonomic::rigid {

// Coordinates [n][3] in so many dimensions by squared distances [n][n]. Returns the square of the largest height that
// is left, relative to the largest square: below 0 where distances fit no place in space.
double coordinates_in(int dimension, std::int64_t n, const double *squares, std::vector<double> &coordinates);

}  // namespace holonomic::rigid
