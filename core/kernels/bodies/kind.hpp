#ifndef HOLONOMIC_KERNELS_BODIES_KIND_HPP
#define HOLONOMIC_KERNELS_BODIES_KIND_HPP

#include <stdint.h>

namespace holonomic {

// A kind of rigid body that stands alone (core/rigid/body.hpp), as a kernel sees it.
struct BodyKind {
    int32_t n_atoms, rank;
    double mass, inverse_mass, extent;
    double square[3];                      // L_p^2
    double per_size[3][3], per_sum[3][3];  // 1/(L_p L_q), 1/(L_p^2 + L_q^2)
    const double *masses;                  // [n_atoms], 0: a massless site
    bool has_sites;
    const double *place, *place_low;  // [n_atoms][1 + rank]: 1, y_p; and what rounding left off
    const double *share, *share_low;  // [n_atoms][1 + rank]: m/M, m y_p / M
    const int32_t *steps;             // [n_atoms - 1][2]: an atom and one before it, where there is a box
};

}  // namespace holonomic
#endif
