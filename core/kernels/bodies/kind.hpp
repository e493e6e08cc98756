// What a kernel knows of a rigid body that stands alone. Plain data, the same for every instruction set; core/rigid
// makes it.
#pragma once

#include <stdint.h>

namespace holonomic {

// A kind of rigid body that stands alone (core/rigid/body.hpp), as a kernel sees it: with axes of length 1, those of
// the body over their lengths L_p. x_p = y_p L_p are an atom's coordinates along them.
struct BodyKind {
    int32_t n_atoms, rank;
    int32_t n_heavy;                    // atoms up to the last one that has mass
    bool has_sites, has_sites_between;  // massless ones, and before that one
    double mass, extent;
    double square[3];           // L_p^2
    double part[3][3];          // L_p^2 / (L_p^2 + L_q^2); the normal of a plane, p = 2, has the length 0
    double skew[3];             // part[j][k] - part[k][j], i, j, k in cyclic order
    bool is_spherical;          // three axes of one length
    double per_moment[4];       // 1/M, 1/(M L_p^2)
    double scale;               // by which shares are too large, inverse
    double excess[4][4];        // 1 less the inverse of P_kl = sum of share_k place_l, as they are rounded
    const double *height;       // [n_atoms] of sites off a plane along its normal a_1 x a_2; null: there are none
    const double *masses;       // [n_atoms], 0: a massless site
    const double *coordinates;  // [n_atoms][1 + rank]: 1, x_p
    const double *share;        // [n_atoms][1 + rank]: m/M, m x_p / (M L_p^2), but for what is in excess
    const int32_t *steps;       // [n_atoms - 1][2]: an atom and one before it, where there is a box
};

}  // namespace holonomic
