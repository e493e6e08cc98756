// The transfer operator in the pivots Omega of a chain whose bond directions are independent and uniform.
#pragma once

#include <cstddef>

namespace holonomic {

// ln < det^(-1/2) > and ln < det^(+1/2) >.
struct PivotMeans {
    long double log_inverse_root, log_root;
};

// masses [n_bonds+1], > 0; only the first and the last may be infinite, and not both if n_bonds == 1.
PivotMeans pivot_means(const long double *masses, std::size_t n_bonds);

}  // namespace holonomic
