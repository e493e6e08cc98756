// SPDX-License-Identifier: GPL-2.0-only
#ifndef HOLONOMIC_LAMMPS_FIX_IMAGE_HPP
#define HOLONOMIC_LAMMPS_FIX_IMAGE_HPP

#include <array>
#include <cmath>

#include "domain.h"

namespace holonomic_lammps {

using Shifts = std::array<int, 3>;

/** Some box vectors. */
inline std::array<double, 3> image_vector(const LAMMPS_NS::Domain &domain, const Shifts &n) {
    const double *h = domain.h;
    return {n[0] * h[0] + n[1] * h[5] + n[2] * h[4], n[1] * h[1] + n[2] * h[3], n[2] * h[2]};
}

/** How many box vectors to add to d to make it short. */
inline Shifts nearest_image(const LAMMPS_NS::Domain &domain, const double *d) {
    const double *h = domain.h;
    Shifts n{0, 0, 0};
    if (std::fabs(d[0]) < 0.5 * h[0] && std::fabs(d[1]) < 0.5 * h[1] && std::fabs(d[2]) < 0.5 * h[2]) return n;
    if (domain.zperiodic) n[2] = -static_cast<int>(std::lround(d[2] / h[2]));
    const double y = d[1] + n[2] * h[3];
    if (domain.yperiodic) n[1] = -static_cast<int>(std::lround(y / h[1]));
    const double x = d[0] + n[2] * h[4] + n[1] * h[5];
    if (domain.xperiodic) n[0] = -static_cast<int>(std::lround(x / h[0]));
    return n;
}

}  // namespace holonomic_lammps

#endif
