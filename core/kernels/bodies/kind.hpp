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
    double ratio[3][3];                    // L_q/L_p; for the normal of a plane, p = 2, L_q/(L_0 L_1)
    double excess[4][4];                   // sum of share place, as they are rounded, less 1
    const double *masses;                  // [n_atoms], 0: a massless site
    bool has_sites;
    const double *place;   // [n_atoms][1 + rank]: 1, y_p
    const double *share;   // [n_atoms][1 + rank]: m/M, m y_p / M
    const int32_t *steps;  // [n_atoms - 1][2]: an atom and one before it, where there is a box
};

}  // namespace holonomic
#endif
